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

"""Commands to some of the bodies at once are those to each of them, and nothing to the others."""

import numpy as np
import pytest
from rigid_sim_ros.engine import CommandError, Simulation
from rigid_sim_ros.engine.methods import METHODS
from rigid_sim_ros.engine.model import Body, Scene
from rigid_sim_ros.engine.shapes import Box

COUNT = 5
CHOSEN = [3, 0, 4]
QUANTITIES = ('position', 'orientation', 'linear_velocity', 'angular_velocity', 'force', 'torque')


def boxes(method='exact'):
    """Return a simulation of boxes far from each other, which all turn."""
    shape = Box((0.1, 0.2, 0.3))
    return Simulation(Scene(gravity=(0.0, 0.0, 0.0), bodies=tuple(
        Body(f'box_{row}', shape, 1.0, shape.inertia(1.0), position=(10.0 * row, 0.0, 0.0),
             angular_velocity=(0.1, 0.2, 0.3)) for row in range(COUNT))), method, 0.01)


def vectors(seed):
    return np.random.default_rng(seed).normal(size=(len(CHOSEN), 3))


@pytest.mark.parametrize('method', METHODS)
def test_they_are_single_commands(method):
    some, each = boxes(method), boxes(method)
    some.apply_wrenches(vectors(1), vectors(2), CHOSEN)
    some.set_velocities(vectors(3), vectors(4), indices=np.array(CHOSEN))
    for row, force, torque, linear, angular in zip(
            CHOSEN, vectors(1), vectors(2), vectors(3), vectors(4)):
        each.apply_wrench(f'box_{row}', force, torque)
        each.set_velocity(f'box_{row}', linear, angular)
    for _ in range(3):
        for quantity in QUANTITIES:
            np.testing.assert_array_equal(getattr(some, quantity), getattr(each, quantity))
        some.advance(0.07)
        each.advance(0.07)


def test_a_velocity_not_given_stays():
    simulation = boxes()
    simulation.set_velocities(linear=vectors(1), indices=CHOSEN)
    np.testing.assert_array_equal(simulation.linear_velocity[CHOSEN], vectors(1))
    np.testing.assert_allclose(simulation.angular_velocity, [(0.1, 0.2, 0.3)] * COUNT, atol=1e-15)
    simulation.set_velocities(angular=vectors(2), indices=CHOSEN)
    np.testing.assert_array_equal(simulation.linear_velocity[CHOSEN], vectors(1))


def test_nobody_is_nothing():
    simulation = boxes()
    simulation.apply_wrenches(np.zeros((0, 3)), np.zeros((0, 3)), [])
    simulation.set_velocities(np.zeros((0, 3)), np.zeros((0, 3)), indices=[])
    assert not simulation.force.any()


@pytest.mark.parametrize('indices, message', [
    ([0, 1, COUNT], 'indices is .* allowed: 0 to 4'),
    ([0, 1, -1], 'indices is .* allowed: 0 to 4'),
    ([0, 1, 0], 'indices is .* allowed: each body once'),
    ([0.0, 1.0, 2.0], 'indices is .* allowed: whole numbers'),
    ([[0, 1, 2]], 'indices is .* allowed: whole numbers'),
    ('abc', 'indices is .* allowed: whole numbers'),
    ([0, 1], r'has the shape \(3, 3\); allowed: \(2, 3\)')])
def test_bad_indices_change_nothing(indices, message):
    simulation = boxes()
    for command in (simulation.apply_wrenches, simulation.set_velocities):
        with pytest.raises(CommandError, match=message):
            command(vectors(1), vectors(2), indices)
    assert not simulation.force.any() and not simulation.linear_velocity.any()
