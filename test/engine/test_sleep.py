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

"""Sleep and waking: who rests is skipped, and goes on when something is done to it or near it."""

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Cube

EDGE = 0.2
GROUND = Plane('ground', (0.0, 0.0, 1.0), 0.0)
STEP = 0.01


def cube(name, x, z=EDGE / 2, **values):
    """Return a cube of 1 kg that stands at x [m]."""
    shape = Cube(EDGE)
    return Body(name, shape, 1.0, shape.inertia(1.0), position=(x, 0.0, z),
                material=Material(restitution=0.0, friction=0.5), **values)


def asleep(*bodies):
    """Return a simulation of bodies on the ground that all rest."""
    simulation = Simulation(Scene(bodies=bodies, planes=(GROUND,)))
    for _ in range(100):
        simulation.advance(STEP)
        if simulation.asleep.all():
            return simulation
    pytest.fail(f'awake after {simulation.time} s: {simulation.asleep}')


def tower(x, count, name):
    """Return cubes on each other."""
    return [cube(f'{name}{row}', x, (row + 0.5) * EDGE) for row in range(count)]


def test_nothing_is_done_for_those_who_rest():
    simulation = asleep(*tower(0.0, 3, 'a'), *(cube(f'b{row}', 1.0 + row) for row in range(20)))
    position = simulation.position.copy()
    work = vars(simulation.work).copy()
    for _ in range(100):
        simulation.advance(STEP)
        np.testing.assert_array_equal(simulation.position, position)
    assert vars(simulation.work) == work


def test_one_that_is_pushed_moves_and_its_tower_with_it_but_no_other():
    simulation = asleep(*tower(0.0, 3, 'a'), *tower(2.0, 2, 'b'))
    # the lowest of three slides under the others: mu g (3 m + 2 m) holds it at least
    simulation.apply_wrench('a0', force=(40.0, 0.0, 0.0))
    simulation.advance(STEP)
    assert simulation.asleep.tolist() == [False, False, False, True, True]
    assert simulation.linear_velocity[0, 0] > 0.0


@pytest.mark.parametrize('rest', [0.0, 1.0])
def test_a_push_moves_one_of_many_that_lean_on_each_other(rest):
    """However long they have not moved."""
    count, force, duration = 9, 10.0, 0.1
    simulation = asleep(*(cube(f'c{row}', row * EDGE) for row in range(count)))
    simulation.advance(rest)
    simulation.apply_wrench(f'c{count - 1}', force=(force, 0.0, 0.0))
    simulation.advance(duration)
    expected = (force - 0.5 * 9.81) * duration
    assert simulation.linear_velocity[-1] == pytest.approx((expected, 0.0, 0.0), abs=1e-5)
    assert abs(simulation.linear_velocity[:-1]).max() < 1e-5


def test_a_push_that_friction_holds_ends_in_sleep_again():
    simulation = asleep(cube('a', 0.0))
    simulation.apply_wrench('a', force=(4.0, 0.0, 0.0))
    # it would not wake by that alone
    simulation.set_velocity('a', linear=(0.0, 0.0, 0.0))
    assert not simulation.asleep.any()
    for _ in range(20):
        simulation.advance(STEP)
    assert simulation.asleep.all()
    assert simulation.position[0, 0] == pytest.approx(0.0, abs=1e-12)
    simulation.apply_wrench('a', force=(6.0, 0.0, 0.0))
    simulation.advance(0.5)
    # mu m g = 4.905 N
    assert simulation.position[0, 0] == pytest.approx((6.0 - 4.905) * 0.5 ** 2 / 2, rel=1e-6)


def test_pushes_that_are_held_wake_nobody():
    """A tower under forces that change each step, all below mu g of what is above: no work."""
    simulation = asleep(*tower(0.0, 10, 'a'))
    position = simulation.position.copy()
    work = vars(simulation.work).copy()
    for step in range(50):
        simulation.apply_wrench('a3', force=(4.0 * np.cos(step), 4.0 * np.sin(step), -step),
                                torque=(0.0, 0.0, 0.1 * np.sin(step)))
        assert simulation.asleep.all()
        simulation.advance(STEP)
    assert vars(simulation.work) == work
    np.testing.assert_array_equal(simulation.position, position)


@pytest.mark.parametrize('part, held', [(0.999, True), (1.001, False)])
def test_pushes_are_held_together_or_not(part, held):
    """Each alone would be: 0.8 mu m g on the upper of two cubes, the rest of 2 mu m g below."""
    limit = 0.5 * 9.81
    simulation = asleep(*tower(0.0, 2, 'a'))
    simulation.apply_wrench('a1', force=(0.8 * limit, 0.0, 0.0))
    assert simulation.asleep.all()
    simulation.apply_wrench('a0', force=((2.0 * part - 0.8) * limit, 0.0, 0.0))
    assert simulation.asleep.all() == held
    simulation.advance(0.5)
    assert simulation.asleep.all() == held
    way = 0.0 if held else (part - 1.0) * limit * 0.5 ** 2 / 2
    assert simulation.position[:, 0] == pytest.approx((way, way), abs=1e-7)


@pytest.mark.parametrize('part, held', [(0.999, True), (1.001, False)])
def test_a_pull_upwards_is_held_up_to_the_weight(part, held):
    simulation = asleep(cube('a', 0.0), cube('b', 1.0))
    simulation.apply_wrench('a', force=(0.0, 0.0, part * 9.81))
    assert simulation.asleep.tolist() == [held, True]
    simulation.advance(0.5)
    rise = 0.0 if held else (part - 1.0) * 9.81 * 0.5 ** 2 / 2
    assert simulation.position[0, 2] == pytest.approx(EDGE / 2 + rise, abs=1e-9)


def test_what_is_hit_wakes_and_what_is_not_sleeps_on():
    simulation = asleep(cube('a', 0.0), cube('b', 5.0))
    simulation.add(cube('bullet', -1.0, velocity=(4.0, 0.0, 0.0), z=0.15))
    states = []
    while simulation.time < 1.5:
        simulation.advance(STEP)
        states.append(simulation.asleep.tolist())
    assert [True, True, False] in states, 'the one that is not hit yet still sleeps'
    assert [False, True, False] in states
    assert simulation.position[0, 0] > 0.05
    assert simulation.position[1].tolist() == [5.0, 0.0, simulation.position[1, 2]]
    assert all(state[1] for state in states[10:])


def test_those_whose_support_is_taken_away_fall():
    simulation = asleep(*tower(0.0, 3, 'a'))
    simulation.remove('a0')
    simulation.advance(0.1)
    fall = 9.81 * 0.1 ** 2 / 2
    assert simulation.position[:, 2].tolist() == pytest.approx(
        [1.5 * EDGE - fall, 2.5 * EDGE - fall], abs=1e-6)


def test_one_that_is_pulled_from_below_another_lets_it_fall():
    simulation = asleep(*tower(0.0, 2, 'a'))
    simulation.set_pose('a0', position=(1.0, 0.0, EDGE / 2))
    simulation.advance(0.1)
    assert simulation.position[1, 2] == pytest.approx(
        1.5 * EDGE - 9.81 * 0.1 ** 2 / 2, abs=1e-6)


def test_one_balanced_on_an_edge_only_rests_if_it_is_balanced():
    shape = Cube(EDGE)
    angle = 0.01

    def tilted(turn):
        half = np.pi / 8 + turn / 2
        height = EDGE / np.sqrt(2) * np.cos(turn)
        return Body('a', shape, 1.0, shape.inertia(1.0), position=(0.0, 0.0, height),
                    orientation=(0.0, np.sin(half), 0.0, np.cos(half)),
                    material=Material(restitution=0.0, friction=0.9))

    simulation = Simulation(Scene(bodies=(tilted(angle),), planes=(GROUND,)))
    for _ in range(300):
        simulation.advance(STEP)
        if simulation.asleep.all():
            break
    assert simulation.position[0, 2] == pytest.approx(EDGE / 2, abs=1e-9), 'it lies on a face'
