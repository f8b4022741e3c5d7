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

"""Commands on a simulation without ROS: closed forms for motion, state untouched when refused."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.nodes.commands import (
    BODY_AXES, body_command, Command, Commands, FARTHEST_AHEAD, LARGEST_VALUE, NEVER,
    Refused)
from rigid_sim_ros.nodes.pacing import NANOSECONDS
from rigid_sim_ros.scene import load_scene

SCENE = {
    'gravity': [0, 0, 0],
    'planes': [{'name': 'ground', 'normal': [0, 0, 1], 'offset': -100.0}],
    'bodies': [
        {'name': 'one', 'cube': {'edge': 0.2}, 'mass': 2.0, 'position': [0, 0, 0],
         'force': [0, 0, 3]},
        {'name': 'two', 'cube': {'edge': 0.2}, 'mass': 1.0, 'position': [5, 0, 0],
         'rpy': [0, 0, 1.5707963267948966]},
        {'name': 'wall', 'cube': {'edge': 1.0}, 'mass': 1.0, 'position': [0, 50, 0],
         'fixed': True}]}

VECTOR = np.array([1.0, -2.0, 0.5])


@pytest.fixture
def simulation():
    return Simulation(load_scene(SCENE))


@pytest.fixture
def commands(simulation):
    return Commands(simulation)


def everything(simulation):
    return [getattr(simulation, name).copy() for name in (
        'position', 'orientation', 'linear_velocity', 'angular_velocity', 'force', 'torque')]


def test_force_and_torque_replace_only_their_part(simulation, commands):
    commands.carry_out(body_command('one', force=VECTOR), 0)
    commands.carry_out(body_command('one', torque=2 * VECTOR), 0)
    assert_array_equal(simulation.force, [VECTOR, [0, 0, 0]])
    assert_array_equal(simulation.torque, [2 * VECTOR, [0, 0, 0]])
    commands.carry_out(body_command('one', force=-VECTOR), 0)
    assert_array_equal(simulation.force[0], -VECTOR)
    assert_array_equal(simulation.torque[0], 2 * VECTOR)


def test_velocity_is_set_at_once(simulation, commands):
    commands.carry_out(
        body_command('two', linear_velocity=VECTOR, angular_velocity=-VECTOR), 0)
    assert_array_equal(simulation.linear_velocity, [[0, 0, 0], VECTOR])
    assert_array_equal(simulation.angular_velocity, [[0, 0, 0], -VECTOR])


def test_many_bodies_in_any_order(simulation, commands):
    values = np.array([[1.0, 2, 3], [4, 5, 6]])
    for names, order in ((('one', 'two'), [0, 1]), (('two', 'one'), [1, 0])):
        commands.carry_out(Command(names, force=values, torque=2 * values,
                                   linear_velocity=3 * values, angular_velocity=4 * values), 0)
        assert_array_equal(simulation.force, values[order])
        assert_array_equal(simulation.torque, 2 * values[order])
        assert_array_equal(simulation.linear_velocity, 3 * values[order])
        assert_array_equal(simulation.angular_velocity, 4 * values[order])


def test_body_axes_are_turned_into_world_axes(simulation, commands):
    commands.axes = BODY_AXES
    commands.carry_out(body_command('two', force=[1, 0, 0], linear_velocity=[0, 1, 0]), 0)
    # the body is turned by a quarter about z: its x is the world's y, its y the world's -x
    assert_allclose(simulation.force[1], [0, 1, 0], atol=1e-15)
    assert_allclose(simulation.linear_velocity[1], [-1, 0, 0], atol=1e-15)


def test_wrench_gives_way_to_that_of_the_scene_after_the_timeout(simulation, commands):
    commands.timeout = 0.5
    commands.carry_out(body_command('one', force=VECTOR), 0)
    commands.carry_out(body_command('one', torque=VECTOR), NANOSECONDS // 4)
    assert commands.next_time == NANOSECONDS // 2
    commands.carry_out_due(NANOSECONDS // 2)
    assert_array_equal(simulation.force[0], [0, 0, 3])
    assert_array_equal(simulation.torque[0], VECTOR)
    commands.carry_out_due(3 * NANOSECONDS // 4)
    assert_array_equal(simulation.torque[0], [0, 0, 0])


def test_command_that_came_later_is_not_released_with_an_earlier_one(simulation, commands):
    commands.timeout = 0.5
    commands.carry_out(body_command('one', force=VECTOR), 0)
    commands.carry_out(body_command('one', force=-VECTOR), NANOSECONDS // 4)
    commands.carry_out_due(NANOSECONDS // 2)
    assert_array_equal(simulation.force[0], -VECTOR)
    commands.carry_out_due(NANOSECONDS)
    assert_array_equal(simulation.force[0], [0, 0, 3])


def test_command_that_holds_for_ever_is_not_released_with_an_earlier_one(simulation, commands):
    commands.timeout = 0.5
    commands.carry_out(body_command('one', force=VECTOR, torque=VECTOR), 0)
    commands.timeout = 0.0
    commands.carry_out(body_command('one', force=-VECTOR), NANOSECONDS // 4)
    commands.carry_out_due(NANOSECONDS)
    assert_array_equal(simulation.force[0], -VECTOR)
    assert_array_equal(simulation.torque[0], [0, 0, 0])
    assert commands.next_time == NEVER


def test_one_release_is_kept_for_a_body_however_often_it_is_commanded(commands):
    commands.timeout = 200.0
    for number in range(2000):
        commands.carry_out(body_command('one', force=VECTOR), number)
    assert commands.pending == 0
    # only the last of them ends by itself: nothing is to be done until then
    assert commands.next_time == 1999 + 200 * NANOSECONDS


def test_releases_take_no_room_of_commands_that_wait(commands, monkeypatch):
    monkeypatch.setattr('rigid_sim_ros.nodes.commands.MOST_PENDING', 2)
    commands.timeout = 1.0
    for number in range(4):
        commands.schedule(body_command('one', force=VECTOR), number, 0, number)
        commands.carry_out_due(number)
    for time in (10, 11):
        commands.schedule(body_command('one', force=VECTOR), time, 0, 4)
    with pytest.raises(Refused, match='too many pending'):
        commands.schedule(body_command('one', force=VECTOR), 12, 0, 4)


def test_release_comes_before_a_command_of_the_same_time(simulation, commands):
    commands.timeout = 1.0
    commands.carry_out(body_command('one', force=VECTOR), 0)
    commands.schedule(body_command('one', force=-VECTOR), NANOSECONDS, 0, 0)
    commands.carry_out_due(NANOSECONDS)
    assert_array_equal(simulation.force[0], -VECTOR)


def test_order_of_one_time_is_rank_then_arrival(simulation, commands):
    for rank, scale in ((3, 1.0), (1, 2.0), (1, 3.0), (0, 4.0)):
        commands.schedule(body_command('one', force=scale * VECTOR), 10, rank, now=0)
    assert commands.pending == 4
    commands.carry_out_due(9)
    assert_array_equal(simulation.force[0], [0, 0, 3])
    commands.carry_out_due(10)
    assert_array_equal(simulation.force[0], VECTOR)
    assert (commands.pending, commands.taken) == (0, 4)


@pytest.mark.parametrize('command, kind, text', [
    (body_command('onw', force=VECTOR), 'unknown body', "no body is named 'onw'; near names: one"),
    (body_command('', force=VECTOR), 'unknown body', 'frame_id is empty'),
    (body_command('x' * 10_000_000, force=VECTOR), 'unknown body', '10000000 characters'),
    (body_command('wall', force=VECTOR), 'fixed body', "'wall' refused: it is fixed"),
    (body_command('ground', force=VECTOR), 'fixed body', "'ground' refused: it is fixed"),
    (body_command('one', force=[np.nan, 0, 0]), 'not finite', 'force is [nan, 0.0, 0.0]'),
    (body_command('one', torque=[0, np.inf, 0]), 'not finite', 'torque is [0.0, inf, 0.0]'),
    (body_command('one', linear_velocity=[0, -np.inf, 0]), 'not finite', 'linear velocity'),
    (body_command('one', angular_velocity=[0, 2e6, 0]), 'too large', 'at most 1e+06'),
    (body_command('one', linear_velocity=[0, -1e300, 0]), 'too large', 'at most 1e+06'),
    (body_command('one', force=[2e9, 0, 0]), 'too large', 'at most 1e+09'),
    (body_command('one', force=VECTOR, torque=[0, -2 * LARGEST_VALUE, 0]), 'too large', 'torque'),
    (Command(('one', 'two'), force=np.array([VECTOR, VECTOR * np.nan])), 'not finite', "'two'"),
    (Command(('one', 'three'), force=np.array([VECTOR, VECTOR])), 'unknown body', "'three'"),
    (Command((), force=np.empty((0, 3))), 'empty', 'names no body'),
    (Command(('one',)), 'empty', 'neither wrenches nor velocities'),
])
def test_refused_command_changes_nothing(simulation, commands, command, kind, text):
    before = everything(simulation)
    for carry_out in (lambda: commands.carry_out(command, 0),
                      lambda: commands.schedule(command, 10, 0, 0)):
        with pytest.raises(Refused) as refused:
            carry_out()
        assert refused.value.kind == kind
        assert text in refused.value.describe()
        assert len(refused.value.describe()) < 300
    for earlier, now in zip(before, everything(simulation)):
        assert_array_equal(earlier, now)
    assert (commands.pending, commands.taken) == (0, 0)


def test_wall_time_as_a_stamp_is_refused(commands):
    with pytest.raises(Refused, match='too far ahead'):
        commands.schedule(body_command('one', force=VECTOR), FARTHEST_AHEAD + 1, 0, 0)
    commands.schedule(body_command('one', force=VECTOR), FARTHEST_AHEAD, 0, 0)


def test_late_command_is_carried_out_next_and_held_from_then(simulation, commands):
    commands.timeout = 1.0
    commands.schedule(body_command('one', force=VECTOR), 10, 0, now=NANOSECONDS)
    commands.carry_out_due(NANOSECONDS)
    assert_array_equal(simulation.force[0], VECTOR)
    assert commands.next_time == 2 * NANOSECONDS


def test_what_is_due_goes_before_what_comes_now(simulation, commands):
    commands.schedule(body_command('one', linear_velocity=-VECTOR), 10, 0, now=10)
    commands.carry_out(body_command('one', linear_velocity=VECTOR), 10)
    commands.carry_out_due(10)
    assert_array_equal(simulation.linear_velocity[0], VECTOR)
