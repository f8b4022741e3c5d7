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

"""The table of topics: what it says is what ROS knows, and every row makes a message."""

import importlib

import numpy as np
import pytest
from rigid_sim_ros import messages, topics
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.scene import dump_scene, load_scene

SCENE = """
bodies:
  - {name: wall, box: {size: [1, 2, 3]}, mass: 1, position: [9, 0, 0], fixed: true}
  - {name: cube, cube: {edge: 0.2}, mass: 1, position: [1, 2, 3], velocity: [4, 5, 6],
     force: [7, 8, 9]}
  - {name: ball, sphere: {radius: 0.3}, mass: 1, position: [-1, -2, -3]}
planes:
  - {name: ground, normal: [0, 0, 1], offset: -5}
  - {name: side, normal: [0.6, 0.8, 0], offset: -20}
  - {name: ceiling, normal: [0, 0, -1], offset: -50}
"""
TIME_NS = 1_500_000_000


@pytest.fixture
def source():
    scene = load_scene(SCENE)
    events = np.zeros(2, messages.COLLISION_TYPE)
    events['point'], events['normal'] = [[1, 1, 1], [2, 2, 2]], [[0, 0, 1], [1, 0, 0]]
    events['body_b'], events['time'] = [3, 2], [1.25, 1.5]
    return topics.Source(Simulation(scene), 'map', dump_scene(scene), events,
                         (messages.DiagnosticStatus(messages.OK, 'name', 'fine', {'a': 1}),))


def encode(source, name):
    row = next(row for row in topics.PUBLISHED if row.name == name)
    return bytes(row.encoder(source)(TIME_NS))


@pytest.mark.parametrize('row', [*topics.PUBLISHED, *topics.COMMANDS, topics.JOURNAL],
                         ids=lambda row: row.name)
def test_names_and_qualities_are_those_of_ros(row):
    assert row.name.startswith(('~/', '/'))
    assert row.quality.reliability in ('reliable', 'best_effort')
    assert row.quality.durability in ('volatile', 'transient_local')
    assert row.quality.depth > 0 and row.what


def test_names_are_there_once():
    names = [row.name for row in (*topics.PUBLISHED, *topics.COMMANDS, topics.JOURNAL,
                                  *topics.SERVICES)]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize('row', topics.PUBLISHED, ids=lambda row: row.name)
def test_ros_reads_the_message_of_every_row(row, source):
    serialization = pytest.importorskip('rclpy.serialization')
    package, _, name = row.type_name.split('/')
    kind = getattr(importlib.import_module(package + '.msg'), name)
    data = bytes(row.encoder(source)(TIME_NS))
    message = serialization.deserialize_message(data, kind)
    assert len(serialization.serialize_message(message)) == len(data)
    if hasattr(message, 'header'):
        assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 500_000_000)


def test_states_have_names_poses_velocities_and_held_wrenches(source):
    state = messages.MultiDOFJointStateDecoder().decode(encode(source, '~/states'))
    assert (state.frame_id, state.names) == ('map', ('cube', 'ball'))
    assert state.transforms[0].tolist() == [1, 2, 3, 0, 0, 0, 1]
    assert state.twists[0].tolist() == [4, 5, 6, 0, 0, 0]
    assert state.wrenches.tolist() == [[7, 8, 9, 0, 0, 0], [0] * 6]


def test_poses_follow_the_simulation(source):
    encoder = topics.PUBLISHED[0].encoder(source)
    encoder(0)
    source.simulation.advance(0.5)
    poses = messages.decode_pose_array(encoder(TIME_NS))
    assert poses.position.tolist() == source.simulation.position.tolist()
    # x + v t + f / m t^2 / 2
    assert poses.position[0, 0] == 1 + 4 * 0.5 + 7 * 0.5 ** 2 / 2


@pytest.mark.parametrize('method', ('exact', 'stepped'))
def test_states_made_beside_poses_again_and_again_are_those_made_alone(method):
    simulation = Simulation(load_scene(SCENE), method)
    alone, beside = topics.Source(simulation), topics.Source(simulation)
    poses, states = (row.encoder(beside) for row in topics.PUBLISHED[:2])

    def changes():
        yield lambda: simulation.advance(0.01)
        yield lambda: simulation.apply_wrench('cube', (1, 0, 0), (0, 2, 0))
        yield lambda: simulation.advance(0.01)
        yield lambda: simulation.apply_wrench('ball', (0, 0, 3))
        yield lambda: simulation.apply_wrenches(np.ones((2, 3)), np.zeros((2, 3)))
        yield lambda: simulation.set_pose('ball', (-1, -2, -2))
        yield lambda: simulation.set_velocity('ball', linear=(1, 0, 0))
        yield lambda: simulation.set_velocity('cube', angular=(0, 1, 0))
        yield lambda: simulation.reset()
        yield lambda: simulation.advance(0.5)

    seen = {encode(alone, '~/states')}
    for change in changes():
        change()
        beside.shared = {}
        poses(TIME_NS)
        data = bytes(states(TIME_NS))
        beside.shared = None
        assert data == encode(alone, '~/states') == bytes(states(TIME_NS))
        seen.add(data)
    assert len(seen) == 11 - 1  # after the reset it is as at the start


def test_collisions_and_their_text_tell_the_same(source):
    events = messages.decode_collisions(encode(source, '~/collisions'))
    assert events['time'].tolist() == [1.25, 1.5]
    lines = messages.decode_string(encode(source, '~/collision_text')).splitlines()
    assert '"body_a": "cube", "body_b": "ground"' in lines[0]
    assert '"body_a": "cube", "body_b": "wall"' in lines[1]


def test_the_scene_can_be_loaded_again(source):
    assert load_scene(messages.decode_string(encode(source, '~/scene'))) == (
        source.simulation.scene)


def test_markers_show_bodies_planes_and_contacts(source):
    serialization = pytest.importorskip('rclpy.serialization')
    kind = importlib.import_module('visualization_msgs.msg').MarkerArray
    markers = serialization.deserialize_message(encode(source, '~/markers'), kind).markers
    bodies = [marker for marker in markers if marker.ns == 'bodies']
    assert [marker.type for marker in bodies] == [1, 2, 1, 1, 1, 1]
    assert [marker.scale.x for marker in bodies[:3]] == [0.2, 0.6, 1.0]
    assert [marker.pose.position.x for marker in bodies[:3]] == [1.0, -1.0, 9.0]
    for marker, plane in zip(bodies[3:], source.simulation.scene.planes):
        center = np.array([getattr(marker.pose.position, axis) for axis in 'xyz'])
        x, y, z, w = (getattr(marker.pose.orientation, axis) for axis in 'xyzw')
        # the third column of the rotation matrix: where the upper side of the slab looks
        upward = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        assert upward == pytest.approx(plane.normal, abs=1e-12)
        assert upward @ center + marker.scale.z / 2 == pytest.approx(plane.offset, abs=1e-12)
    arrows = [marker for marker in markers if marker.ns == 'contacts']
    assert [[point.z for point in arrow.points] for arrow in arrows] == [[1.0, 1.1], [2.0, 2.0]]


def test_resolve_puts_the_node_s_name():
    assert topics.resolve('~/poses') == '/rigid_sim/poses'
    assert topics.resolve('~/poses', '/a/b') == '/a/b/poses'
    assert topics.resolve('/clock') == '/clock'
