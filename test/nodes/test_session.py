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

"""A session without ROS: its times, its events, and that a run depends on nothing else."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.methods.read_ahead import MOST_TIMES
from rigid_sim_ros.nodes.commands import body_command
from rigid_sim_ros.nodes.pacing import NANOSECONDS
from rigid_sim_ros.nodes.session import Session
from rigid_sim_ros.scene import load_scene

MILLISECOND = 1_000_000
GRAVITY = 9.81

FREE = {'gravity': [0, 0, 0], 'bodies': [
    {'name': 'one', 'cube': {'edge': 0.2}, 'mass': 2.0, 'position': [0, 0, 0]}]}

DROP = {'planes': [{'name': 'ground', 'normal': [0, 0, 1], 'offset': 0.0}], 'bodies': [
    {'name': 'ball', 'sphere': {'radius': 0.1}, 'mass': 1.0, 'position': [0, 0, 0.6]}]}


class Run:
    """A session whose states are kept."""

    def __init__(self, scene, rate=100.0):
        self.times, self.positions, self.collisions = [], [], []
        self.simulation = Simulation(load_scene(scene))
        self.session = Session(self.simulation, rate, self.publish)

    def publish(self, time, collisions):
        self.times.append(time)
        self.positions.append(self.simulation.position.copy())
        self.collisions.append(collisions.copy())


def test_states_are_published_on_the_grid():
    run = Run(FREE, rate=240.0)
    for _ in range(240):
        run.session.advance()
    assert run.times == [round(number * NANOSECONDS / 240) for number in range(1, 241)]
    assert run.simulation.time == pytest.approx(1.0, abs=1e-12)


def test_command_takes_effect_at_its_time_also_between_states():
    run = Run(FREE)
    force, start = np.array([4.0, 0.0, -2.0]), 13 * MILLISECOND + 7
    run.session.commands.schedule(body_command('one', force=force), start, 0, 0)
    for _ in range(5):
        run.session.advance()
    for time, position in zip(run.times, run.positions):
        pushed = max(0, time - start) / NANOSECONDS
        assert_allclose(position[0], 0.5 * force / 2.0 * pushed ** 2, atol=1e-15)


def test_step_ends_at_its_time_and_the_grid_goes_on():
    run = Run(FREE)
    run.session.step(0.025)
    run.session.step(0.001)
    run.session.advance()
    assert run.times == [10 * MILLISECOND, 20 * MILLISECOND, 25 * MILLISECOND,
                         26 * MILLISECOND, 30 * MILLISECOND]


def test_step_can_be_stopped_between_states():
    run = Run(FREE)
    run.session.step(60.0, stop=lambda: len(run.times) == 3)
    assert len(run.times) == 3


def test_pause_on_collision():
    run = Run(DROP)
    run.session.pause_on_collision = True
    # a fall of 0.5 m takes sqrt(2 h / g) = 0.319 s
    touch = np.sqrt(2 * 0.5 / GRAVITY)
    while not run.session.paused:
        run.session.advance()
        assert run.session.time < NANOSECONDS
    # at that very instant, told by the nanosecond after it
    assert 0 <= run.session.time - touch * NANOSECONDS < 1.001
    assert run.times[-2:] == [310 * MILLISECOND, run.session.time]
    assert run.positions[-1][0, 2] == pytest.approx(0.1, abs=1e-12)
    assert run.collisions[-1]['time'].tolist() == pytest.approx([touch], abs=1e-12)
    # going on, the states are on the grid again, up to the next collision
    run.session.paused = False
    run.session.advance()
    assert run.times[-1] == 320 * MILLISECOND
    while not run.session.paused:
        run.session.advance()
        assert run.session.time < 10 * NANOSECONDS
    assert run.session.time > touch * NANOSECONDS
    assert len(run.collisions[-1])


def test_pause_on_collision_leaves_a_step_whole():
    run = Run(DROP)
    run.session.pause_on_collision = True
    run.session.step(0.5)
    assert run.session.time == NANOSECONDS // 2


@pytest.mark.parametrize('from_zero', [False, True])
def test_reset_repeats_the_run(from_zero):
    run = Run(DROP)
    for _ in range(50):
        run.session.advance()
    start = 0 if from_zero else run.session.time
    first, first_events = run.positions[:], np.concatenate(run.collisions)
    run.session.commands.schedule(body_command('ball', force=[9, 9, 9]), start + 100, 0, start)
    run.times.clear(), run.positions.clear(), run.collisions.clear()
    run.session.reset(from_zero)
    assert run.times == [start]
    assert_array_equal(run.positions[0], [[0, 0, 0.6]])
    for _ in range(50):
        run.session.advance()
    assert run.times[-1] == start + NANOSECONDS // 2
    # the pending command was dropped; time is start + t instead of t, so equal up to rounding
    assert_allclose(run.positions[1:], first, rtol=0, atol=1e-13)
    again = np.concatenate(run.collisions)
    assert_allclose(again['time'], first_events['time'] + start / NANOSECONDS, atol=1e-12)


def test_change_of_rate_counts_from_now():
    run = Run(FREE)
    run.session.advance()
    run.session.set_publish_rate(400.0)
    run.session.advance()
    assert run.times == [10 * MILLISECOND, 12_500_000]


def test_same_commands_at_the_same_times_give_the_same_bits():
    def play(rate_of_calls):
        run = Run(DROP)
        generator = np.random.default_rng(5)
        for time in np.sort(generator.integers(0, NANOSECONDS, 20)):
            run.session.commands.schedule(
                body_command('ball', force=generator.normal(size=3)), int(time), 0, 0)
        while run.session.time < NANOSECONDS:
            if rate_of_calls == 'steps':
                run.session.step(0.03)
            else:
                run.session.advance()
        return {time: position.tobytes() for time, position in zip(run.times, run.positions)}

    advanced, stepped = play('states'), play('steps')
    common = advanced.keys() & stepped.keys()
    assert len(common) >= 100
    assert all(advanced[time] == stepped[time] for time in common)


def test_states_on_the_grid_are_evaluated_together():
    run = Run(FREE, rate=240.0)
    for _ in range(1000):
        run.session.advance()
    # each once, and a few that are yet to come: no time was expected in vain
    assert 1000 <= run.simulation.work.pose_evaluations < 1000 + MOST_TIMES
    run.session.reset(time_from_zero=False)
    for _ in range(100):
        run.session.advance()
    assert run.simulation.work.pose_evaluations < 100 + MOST_TIMES
