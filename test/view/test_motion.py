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

"""What moves is what is simulated or was recorded, at the times that are asked for."""

from dataclasses import replace

import numpy as np
import pytest
from rigid_sim_ros import messages, topics
from rigid_sim_ros.engine import events
from rigid_sim_ros.recording import Recorder, RecordingError
from rigid_sim_ros.recording.journal import encode_bodies
from rigid_sim_ros.scene import load_scene, SceneError
from rigid_sim_ros.view.command_line import main
from rigid_sim_ros.view.errors import ViewError
from rigid_sim_ros.view.motion import CONTACT_SHOWN, open_motion, SimulatedMotion

SCENE = """
gravity: [0, 0, 0]
bodies:
  - {name: wall, cube: {edge: 1}, fixed: true, position: [5, 0, 0]}
  - {name: flying, cube: {edge: 0.2}, mass: 1, velocity: [1, 0, 0]}
  - {name: falling, sphere: {radius: 0.1}, mass: 2, position: [0, 3, 0], force: [0, 0, -4]}
"""
PERIOD_NS = 20_000_000
ROWS = tuple(replace(row, name=topics.resolve(row.name)) for row in topics.PUBLISHED)


def test_simulated_states_are_those_of_the_closed_form():
    motion = SimulatedMotion(load_scene(SCENE))
    states = motion.states([0.0, 0.5, 2.0])
    assert [body.name for body in motion.bodies] == ['flying', 'falling', 'wall']
    assert states.time.tolist() == [0, 0.5, 2]
    # moving bodies first: x = v t, and z = -F / m t^2 / 2
    assert states.position[:, 0] == pytest.approx(np.array([[0, 0, 0], [0.5, 0, 0], [2, 0, 0]]))
    assert states.position[:, 1] == pytest.approx(np.array([[0, 3, 0], [0, 3, -0.25], [0, 3, -4]]))
    assert (states.position[:, 2] == [5, 0, 0]).all()
    assert (states.orientation == [0, 0, 0, 1]).all()


def test_the_first_collision_and_how_long_it_is_shown():
    motion = open_motion('report_detection')
    # the time in the scene's comment
    time = motion.first_collision()
    assert time == pytest.approx(1.3268, abs=1e-4)
    states = motion.states([time - 0.01, time, time + CONTACT_SHOWN + 0.01])
    assert [len(contacts) for contacts in states.contacts] == [0, 1, 0]
    with pytest.raises(ViewError, match='nothing collides'):
        open_motion('report_dynamics').first_collision()


@pytest.fixture
def bag(tmp_path):
    """Return a function that records states of two bodies: runs of so many steps from a step."""
    def record(*runs, scene=SCENE, body_count=2, begin=0):
        poses = messages.PoseArrayEncoder('world', body_count)
        collisions = messages.CollisionEncoder('world')
        event = np.zeros(1, messages.COLLISION_TYPE)
        event['body_b'], event['kind'] = 2, events.IMPACT
        with Recorder(tmp_path / 'bag', ROWS, scene=scene, options={}) as recorder:
            for run, count in enumerate(runs):
                for step in range(count):
                    time_ns = (begin + step) * PERIOD_NS
                    position = np.full((body_count, 3), 100.0 * run + step)
                    orientation = np.tile((0.0, 0.0, 0.0, 1.0), (body_count, 1))
                    recorder.write('/rigid_sim/poses', time_ns,
                                   poses.encode(time_ns, position, orientation))
                    if step == 3:
                        # of each run at another time
                        event['time'] = 0.05 - 0.01 * run
                        recorder.write('/rigid_sim/collisions', time_ns,
                                       collisions.encode(time_ns, event))
        return str(tmp_path / 'bag')
    return record


def test_recorded_states_are_the_nearest(bag):
    motion = open_motion(bag(11))
    assert motion.end == pytest.approx(0.2)
    states = motion.states(np.array([0.0, 0.009, 0.011, 0.1, 0.195, 0.2]))
    assert states.time == pytest.approx([0, 0, 0.02, 0.1, 0.2, 0.2])
    assert states.position[:, 0, 0].tolist() == [0, 0, 1, 5, 10, 10]
    assert (states.position[:, 2] == [5, 0, 0]).all()
    assert motion.first_collision() == pytest.approx(0.05)
    assert [len(contacts) for contacts in states.contacts] == [0, 0, 0, 1, 0, 0]


def test_the_longest_run_is_shown(bag):
    motion = open_motion(bag(3, 9, 5))
    assert motion.end == pytest.approx(0.16)
    assert motion.states([0.16]).position[0, 0, 0] == 108
    assert motion.first_collision() == pytest.approx(0.04)
    assert [len(contacts) for contacts in motion.states([0.06, 0.145]).contacts] == [1, 0]


def test_a_recording_of_one_state(bag):
    motion = open_motion(bag(1))
    assert motion.states([0.0, 1.0]).position[:, 0, 0].tolist() == [0, 0]
    with pytest.raises(ViewError, match='holds no collision'):
        motion.first_collision()


def test_a_recording_that_was_begun_later(bag, tmp_path, capsys):
    path, picture = bag(6, begin=50), str(tmp_path / 'a.png')
    assert open_motion(path).begin == pytest.approx(1.0)
    for time in ([], ['--time', '1'], ['--time', '1.1'], ['--time', '1.05', '--exposures', '3']):
        assert main([path, '-o', picture, '--size', '96x64', *time]) == 0
    assert capsys.readouterr().err == ''
    for time in ('0', '0.99', '1.11'):
        assert main([path, '-o', picture, '--time', time]) == 2
        assert capsys.readouterr().err == (
            f'rigid_sim_view: --time {time} is not allowed; must be from 1 to 1.1 s\n')


def test_refusals(bag, tmp_path):
    with pytest.raises(ViewError, match='holds no scene'):
        open_motion(bag(3, scene=''))


def test_states_with_bodies_that_came_later_are_left_out(tmp_path):
    rows = [*ROWS, replace(topics.JOURNAL, name='/rigid_sim/journal')]
    names = [body.name for body in load_scene(SCENE).bodies if not body.fixed]
    with Recorder(tmp_path / 'bag', rows, scene=SCENE, options={'names': names}) as recorder:
        for step, count in enumerate((2, 2, 3, 3, 2)):
            bodies = [*names, 'new'][:count]
            recorder.write('/rigid_sim/journal', step, encode_bodies(count, [*bodies, 'ground']))
            encoder = messages.PoseArrayEncoder('world', count)
            recorder.write('/rigid_sim/poses', step, encoder.encode(
                step, np.full((count, 3), float(step)), np.ones((count, 4))))
    motion = open_motion(str(tmp_path / 'bag'))
    states = motion.states([0, 1e-9, 4e-9])
    assert states.position[:, 1, 0].tolist() == [0, 1, 4]
    assert motion.states([2e-9]).position[0, 1, 0] == 1


def test_a_scene_of_other_bodies_is_refused(bag):
    with pytest.raises(ViewError, match='poses of 3 bodies, but its scene has 2 that move'):
        open_motion(bag(3, body_count=3))


def test_a_recorded_scene_that_cannot_be_read_is_refused(bag):
    with pytest.raises(SceneError, match='bodies is missing'):
        open_motion(bag(3, scene='gravity: [0, 0, 0]'))


def test_no_recording(tmp_path):
    with pytest.raises(RecordingError, match='no MCAP file'):
        open_motion(str(tmp_path))
    with pytest.raises(RecordingError):
        open_motion(str(tmp_path / 'missing.mcap'))
