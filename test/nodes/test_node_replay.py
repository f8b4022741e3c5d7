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

"""What nodes recorded, however eventful and whenever it began, simulated again bit for bit."""

import numpy as np
from numpy.testing import assert_array_equal
import pytest

pytest.importorskip('rclpy')

from node_harness import Client  # noqa: E402, I100
from rclpy.parameter import Parameter  # noqa: E402
from rigid_sim_ros.bag_tools import info, replay  # noqa: E402
from rigid_sim_ros.nodes.entities import described_body  # noqa: E402
from rigid_sim_ros.nodes.pacing import NANOSECONDS  # noqa: E402
from rigid_sim_ros.recording import read  # noqa: E402
from test_node_in_process import hosted  # noqa: E402

SCENE = """
material: {restitution: 0.5, friction: 0.4}
planes: [{name: ground, normal: [0, 0, 1], offset: 0}]
bodies:
  - {name: one, cube: {edge: 0.2}, mass: 1.0, position: [0, 0, 0.3], rpy: [0.1, 0.2, 0.3]}
  - {name: two, box: {size: [0.1, 0.2, 0.3]}, mass: 2.0, position: [0.05, 0, 0.7]}
  - {name: wall, cube: {edge: 1.0}, mass: 1.0, position: [0, 5, 0.6], fixed: true}
  - {name: three, sphere: {radius: 0.1}, mass: 1.0, position: [1, 0, 0.5], velocity: [-1, 0, 0]}
"""

BALL = '{sphere: {radius: 0.08}, mass: 0.7, velocity: [0.3, 0, 0], material: {friction: 0.9}}'


class Story:
    """A paused node, and all that can happen to it, the last in every order."""

    def __init__(self, node, run, client):
        self.node, self._run, self._client = node, run, client
        self._spawned = 0

    def step(self, count=1):
        for _ in range(count):
            assert self.node.step()

    def command(self, name, body, **fields):
        taken, pending = self._counts()
        self._client.command(name, body, **fields)
        self._run(lambda: self._counts() != (taken, pending))

    def _counts(self):
        commands = self.node.session.commands
        return commands.taken, commands.pending

    def change(self, **parameters):
        results = self.node.ros.set_parameters(
            [Parameter(name, value=value) for name, value in parameters.items()])
        assert all(result.successful for result in results)

    @property
    def names(self):
        return self.node.session.simulation.names

    def commands(self):
        self.command('~/cmd_vel', self.names[0], linear=(0.5, 0.1, 2), angular=(1, 2, 3))
        self.step(3)
        self.command('~/cmd_wrench', self.names[1], force=(0, 3, 5), torque=(0.1, 0, 0))
        self.step(5)

    def timed_commands(self):
        self.change(command_timing='stamp', command_timeout=0.02, command_axes='body')
        now = self.node.session.time
        for ahead in (3_333_333, 10_000_000, 20_000_000, 20_000_000):
            self.command('~/cmd_force', 'three', stamp_ns=now + ahead, vector=(ahead / 1e7, 0, 1))
        self.step(2)
        # when a wrench is released, another one comes, at once and at its stamp
        self.command('~/cmd_force', 'three', vector=(0, 1, 0))
        self.step(3)
        self.change(command_timing='arrival', command_timeout=0.0, command_axes='world')

    def spawn(self):
        self._spawned += 1
        self.node.entities.spawn(described_body(BALL, ''), f'ball_{self._spawned}',
                                 position=(0.1, 0.02, 1.5 + 0.5 * self._spawned),
                                 orientation=(0.1, 0.7, 0.3, 0.2))
        self.command('~/cmd_force', f'ball_{self._spawned}', vector=(0.1, 0, -2))
        self.step(20)

    def delete(self):
        self.node.entities.delete(self.names[0])
        self.step(4)

    def place(self):
        self.node.entities.place(self.names[-1], position=(0.01, 0, 4),
                                 orientation=(0.4, 0.3, 0.2, 0.1), velocity=(0, 0.1, -3),
                                 angular_velocity=(7, 1, 1))
        self.step(6)

    def change_rate(self):
        self.change(publish_rate=240.0, step_duration=0.0123)
        self.step(4)
        self.change(publish_rate=100.0, step_duration=0.01)

    def reset(self, time_from_zero, keep_bodies=False):
        self.node.reset(time_from_zero, keep_bodies)
        self.step(5)

    def everything(self):
        self.step(40)
        self.commands()
        self.timed_commands()
        self.spawn()
        self.place()
        self.delete()
        self.change_rate()


@pytest.fixture
def story(tmp_path):
    (tmp_path / 'scene.yaml').write_text(SCENE)
    with hosted('', scene=str(tmp_path / 'scene.yaml'), start_paused=True, publish_clock=False,
                record_path=str(tmp_path / 'bag')) as ([node], run), Client() as client:
        yield Story(node, run, client)


def replayed(path, capsys):
    """Simulate a bag again, and return the exit code and the first word that was printed."""
    capsys.readouterr()
    code = replay.main([str(path)])
    output = capsys.readouterr()
    return code, (output.out + output.err).strip()


def test_all_that_can_happen_is_identical(story, tmp_path, capsys):
    assert story.node.record(True)[0]
    story.everything()
    story.reset(False)
    story.spawn()
    story.reset(False, keep_bodies=True)
    story.everything()
    story.reset(True)
    story.everything()
    assert story.node.record(False)[0]
    code, text = replayed(tmp_path / 'bag', capsys)
    assert (code, text.split(':')[0]) == (0, 'identical')
    assert info.main([str(tmp_path / 'bag')]) == 0
    recorded = read(tmp_path / 'bag')
    assert not recorded.damage
    assert len(recorded.collisions) > 50
    assert recorded.names[:3] == ('one', 'two', 'three')
    assert set(recorded.names[3:]) == {'ball_1', 'ball_2', 'ball_3', 'ball_4'}


@pytest.mark.parametrize('before', [
    ['everything'], ['commands', 'spawn'], ['spawn', 'delete', ('reset', False, True)],
    ['everything', ('reset', True)], ['spawn', ('reset', False)], ['timed_commands'],
    ['everything', ('reset', True, True), 'timed_commands', 'place'], []])
def test_what_was_before_the_recording_is_in_it(story, tmp_path, capsys, before):
    for event in before:
        name, *arguments = [event] if isinstance(event, str) else event
        getattr(story, name)(*arguments)
    story.command('~/cmd_torque', story.names[-1], vector=(0, 0, 0.3))
    began = story.node.session.time
    assert story.node.record(True)[0]
    story.commands()
    story.spawn()
    assert story.node.record(False)[0]
    code, text = replayed(tmp_path / 'bag', capsys)
    assert (code, text.split(':')[0]) == (0, 'identical')
    recorded = read(tmp_path / 'bag')
    # the state it began in is the first
    assert recorded.time_ns[0] == began
    assert recorded.time_ns[-1] == began + (3 + 5 + 20) * NANOSECONDS // 100
    if before:
        assert began > 0


def test_without_its_history_it_is_another_run(story, tmp_path, capsys):
    story.everything()
    story.node.recording._history._largest = -1
    story.node.recording._history._close_block()
    began, text = story.node.record(True)
    assert began and 'cannot be simulated again' in text
    story.step(3)
    assert story.node.record(False)[0]
    code, text = replayed(tmp_path / 'bag', capsys)
    assert code == 2 and 'of a run, and what was before it is not in it' in text


def test_arrays_tell_who_was_there_and_who_was_not(story, tmp_path):
    assert story.node.record(True)[0]
    story.step(2)
    story.spawn()
    story.node.entities.delete('one')
    story.step(30)
    assert story.node.record(False)[0]
    recorded = read(tmp_path / 'bag')
    assert recorded.names == ('one', 'two', 'three', 'ball_1')
    assert recorded.all_names == (*recorded.names, 'wall', 'ground')
    there = ~np.isnan(recorded.position[:, :, 0])
    # the states shown when it was spawned and deleted are there as well
    assert_array_equal(there.sum(axis=0), [3 + 21, 3 + 21 + 31, 3 + 21 + 31, 21 + 31])
    assert_array_equal(there, ~np.isnan(recorded.linear_velocity[:, :, 0]))
    assert_array_equal(recorded.position[-1, 3], story.node.session.simulation.position[2])
    assert_array_equal(recorded.force[-1, 3], [0.1, 0, -2])
    # the ball falls on the ground, a plane: named so although its number changed twice
    names = np.array(recorded.all_names)
    touched = {frozenset(names[[event['body_a'], event['body_b']]])
               for event in recorded.collisions}
    assert frozenset(('three', 'ground')) in touched
    assert all('ground' in pair or 'wall' not in pair for pair in touched)
