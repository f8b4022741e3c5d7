# Copyright 2026 The rigid_sim_ros authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
Copies of a simulation, made at any moment, go the same way to the last bit, and their own way.

Each is compared with a simulation that nobody has copied.
"""

from concurrent.futures import ProcessPoolExecutor
from copy import copy, deepcopy
from multiprocessing import get_context
import pickle

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.scene import load_scene

GROUND = {'name': 'ground'}

FLIGHT = [
    {'name': 'free', 'box': {'size': [0.1, 0.2, 0.3]}, 'mass': 1.0, 'position': [0, 0, 4],
     'angular_velocity': [1, 5, 3]},
    {'name': 'driven', 'box': {'size': [0.1, 0.2, 0.3]}, 'mass': 1.0, 'position': [1, 0, 4],
     'angular_velocity': [1, 2, 3], 'torque': [0.1, 0.02, 0.01]},
    {'name': 'equal', 'cube': {'edge': 0.2}, 'mass': 1.0, 'position': [2, 0, 4],
     'angular_velocity': [1, 2, 3], 'torque': [0.1, 0.2, 0.01]},
    {'name': 'faster', 'cube': {'edge': 0.2}, 'mass': 1.0, 'position': [3, 0, 4],
     'torque': [0.1, 0.2, 0.01]}]
"""Every kind of rotation: free, driven, and about an axis that stays."""

FEW = [
    {'name': 'tossed', 'box': {'size': [0.2, 0.3, 0.1]}, 'mass': 1.0, 'position': [0, 2, 0.25],
     'angular_velocity': [3, 1, 4]},
    {'name': 'lower', 'box': {'size': [0.2, 0.3, 0.1]}, 'mass': 1.0, 'position': [0, 4, 0.05],
     'velocity': [1, 0.2, 0], 'angular_velocity': [0, 0, 4]},
    {'name': 'upper', 'box': {'size': [0.2, 0.3, 0.1]}, 'mass': 1.0, 'position': [0, 4, 0.16]},
    {'name': 'ball', 'sphere': {'radius': 0.1}, 'mass': 1.0, 'position': [1, 2, 0.3],
     'velocity': [1, 0, 0], 'material': {'rolling_friction': 0.002}}]
"""One body on a plane, and few on each other."""

PILE = {'name': 'cube', 'cube': {'edge': 0.2}, 'mass': 1.0, 'position': [0, 6, 0.11],
        'repeat': {'count': [2, 2, 2], 'spacing': [0.23, 0.23, 0.23], 'jitter': 0.01, 'seed': 1}}


def simulation_of(bodies, method='exact'):
    """Return a simulation of these bodies and the ground."""
    return Simulation(load_scene({'planes': [GROUND], 'bodies': bodies}), method=method)


def pickled(simulation):
    """Return a copy by way of bytes."""
    return pickle.loads(pickle.dumps(simulation))


def readings(simulation):
    """Return all that can be read."""
    return [simulation.time, simulation.work, simulation.names, *(values.tobytes() for values in (
        simulation.position, simulation.orientation, simulation.linear_velocity,
        simulation.angular_velocity, simulation.force, simulation.asleep,
        simulation.collisions))]


def goes_on(simulation, count=3):
    """Return the readings of some more steps."""
    result = []
    for _ in range(count):
        simulation.advance(0.02)
        result.append(readings(simulation))
    return result


def command(simulation, number):
    """Command one of the bodies, each in its turn."""
    name = simulation.names[number % len(simulation.names)]
    generator = np.random.default_rng(number)
    if number % 2:
        simulation.apply_wrench(name, *generator.uniform(-1.0, 1.0, (2, 3)) * [[5.0], [0.1]])
    else:
        simulation.set_velocity(name, generator.uniform(-0.3, 0.3, 3))


@pytest.mark.parametrize('copied', [deepcopy, pickled])
@pytest.mark.parametrize('bodies, method, count', [
    (FLIGHT, 'exact', 30), (FEW, 'exact', 40), ([PILE], 'exact', 10),
    (FEW, 'stepped', 10), ([PILE], 'report', 10)])
def test_a_copy_made_at_any_moment_does_the_same(bodies, method, count, copied):
    alone, relay = simulation_of(bodies, method), simulation_of(bodies, method)
    # the pile has just come together then
    alone.advance(0.1)
    relay.advance(0.1)
    for number in range(count):
        # the original and the copy go on in turns, and nothing of what the other then does counts
        pair = relay, copied(relay)
        relay, other = pair if number % 2 else pair[::-1]
        goes_on(other, 1)
        assert readings(relay) == readings(alone)
        if number % 8 == 7:
            command(alone, number)
            command(relay, number)
        assert goes_on(relay, 1) == goes_on(alone, 1)


def test_what_sleeps_and_what_is_ordered_is_copied():
    """All sleep but one, which a wrench holds up that was ordered last."""
    simulation = simulation_of([PILE, FEW[0]])
    simulation.advance(3.0)
    assert simulation.asleep.all()
    simulation.apply_wrench('tossed', (0.0, 0.0, 12.0))
    copies = [deepcopy(simulation), pickled(simulation)]
    expected = goes_on(simulation)
    assert simulation.asleep.tolist() == [True] * 8 + [False]
    for each in copies:
        assert goes_on(each) == expected
    for each in (simulation, *copies):
        each.reset()
    assert goes_on(copies[0]) == goes_on(copies[1]) == goes_on(simulation)


def test_bodies_are_added_to_a_copy_alone():
    simulation = simulation_of(FEW)
    simulation.advance(0.1)
    other = copy(simulation)
    other.add(load_scene({'bodies': [FLIGHT[0]]}).bodies[0])
    other.remove('ball')
    assert other.names == ('tossed', 'lower', 'upper', 'free')
    alone = simulation_of(FEW)
    alone.advance(0.1)
    assert goes_on(simulation) == goes_on(alone)


def test_another_process_does_the_same():
    simulations = [simulation_of(FLIGHT), simulation_of(FEW), simulation_of([PILE])]
    for simulation in simulations:
        simulation.advance(0.3)
    with ProcessPoolExecutor(1, mp_context=get_context('spawn')) as pool:
        theirs = list(pool.map(goes_on, simulations))
    assert theirs == [goes_on(simulation) for simulation in simulations]
