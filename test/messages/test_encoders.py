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
Every encoder against rclpy, and against bytes kept in golden.json.

The samples are small numbers with an exact binary form, so equality is exact.
"""

import importlib
import json
from pathlib import Path

import numpy as np
import pytest
from rigid_sim_ros import messages
from rigid_sim_ros.messages.collisions import POINT_TYPE

TIME_NS = 12_345_678_901
STAMP = {'sec': 12, 'nanosec': 345_678_901}
POSITION = np.array([[1.0, 2.0, 3.0], [-4.5, 5.25, 0.125]])
ORIENTATION = np.array([[0.5, -0.5, 0.5, -0.5], [0.0, 0.0, 1.0, 0.0]])
LINEAR = POSITION * 2
ANGULAR = POSITION * 4
FORCE = POSITION * 8
TORQUE = POSITION * 16
NAMES = ('cube', 'cube_22')

EVENTS = np.array(
    [(12.25, 0, 7, 0, (1, 2, 3), (0, 0, -1), (0.5, 0.25, -8), 1.5),
     (12.345678901, 1, 0, 2, (-1, 0.5, 0), (0, 1, 0), (0, 0, 0), 0)],
    dtype=messages.COLLISION_TYPE)

STATUS = messages.DiagnosticStatus(
    messages.WARN, 'rigid_sim: step', 'late', {'step_time': 0.25, 'missed': 3}, 'none')


def encoded():
    """Return our bytes of every sample, by type name."""
    markers = messages.MarkerArrayEncoder(
        'world', [messages.CUBE, messages.SPHERE], [[1, 2, 3], [4, 4, 4]],
        [[0.25, 0.5, 0.75, 1.0], [1.0, 0.0, 0.0, 0.5]])
    markers.encode(0, POSITION, ORIENTATION, POSITION, LINEAR)
    return {
        'geometry_msgs/msg/PoseArray':
            messages.PoseArrayEncoder('world', 2).encode(TIME_NS, POSITION, ORIENTATION),
        'sensor_msgs/msg/MultiDOFJointState':
            messages.MultiDOFJointStateEncoder('world', NAMES).encode(
                TIME_NS, POSITION, ORIENTATION, LINEAR, ANGULAR, FORCE, TORQUE),
        'sensor_msgs/msg/PointCloud2':
            messages.CollisionEncoder('world').encode(TIME_NS, EVENTS),
        'std_msgs/msg/String': messages.encode_string('two\nlines: \u00e4'),
        'rosgraph_msgs/msg/Clock': messages.encode_clock(TIME_NS),
        'visualization_msgs/msg/MarkerArray':
            markers.encode(TIME_NS, POSITION, ORIENTATION, POSITION[:1], LINEAR[:1]),
        'diagnostic_msgs/msg/DiagnosticArray':
            messages.encode_diagnostic_array(TIME_NS, [STATUS]),
    }


def as_dictionaries():
    """Return what every sample holds, field by field as the message definitions name them."""
    header = {'stamp': STAMP, 'frame_id': 'world'}
    poses = [{'position': xyz(p), 'orientation': xyz(q)}
             for p, q in zip(POSITION, ORIENTATION)]
    return {
        'geometry_msgs/msg/PoseArray': {'header': header, 'poses': poses},
        'sensor_msgs/msg/MultiDOFJointState': {
            'header': header, 'joint_names': list(NAMES),
            'transforms': [{'translation': xyz(p), 'rotation': xyz(q)}
                           for p, q in zip(POSITION, ORIENTATION)],
            'twist': [{'linear': xyz(v), 'angular': xyz(w)} for v, w in zip(LINEAR, ANGULAR)],
            'wrench': [{'force': xyz(f), 'torque': xyz(t)} for f, t in zip(FORCE, TORQUE)]},
        'sensor_msgs/msg/PointCloud2': point_cloud(header),
        'std_msgs/msg/String': {'data': 'two\nlines: \u00e4'},
        'rosgraph_msgs/msg/Clock': {'clock': STAMP},
        'visualization_msgs/msg/MarkerArray': {'markers': markers(header, poses)},
        'diagnostic_msgs/msg/DiagnosticArray': {
            'header': {'stamp': STAMP, 'frame_id': ''},
            'status': [{
                'level': b'\x01', 'name': 'rigid_sim: step', 'message': 'late',
                'hardware_id': 'none',
                'values': [{'key': 'step_time', 'value': '0.25'},
                           {'key': 'missed', 'value': '3'}]}]},
    }


def xyz(values):
    """Return a dictionary of x, y, z and, if there are four, w."""
    return {key: float(value) for key, value in zip('xyzw', values)}


def point_cloud(header):
    """Return the collisions as sensor_msgs/PointCloud2 defines them."""
    names = ['x', 'y', 'z', 'normal_x', 'normal_y', 'normal_z', 'impulse_x', 'impulse_y',
             'impulse_z', 'speed', 'time_offset', 'body_a', 'body_b', 'kind']
    offsets = [0, 4, 8, 12, 16, 20, 24, 32, 40, 48, 56, 64, 68, 72]
    datatypes = [7] * 6 + [8] * 5 + [6, 6, 2]
    rows = [(1, 2, 3, 0, 0, -1, 0.5, 0.25, -8, 1.5, 12.25 - 12.345678901, 0, 7, 0),
            (-1, 0.5, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 2)]
    points = np.zeros(2, POINT_TYPE)
    for index, row in enumerate(rows):
        points[index] = row
    return {
        'header': header, 'height': 1, 'width': 2,
        'fields': [{'name': name, 'offset': offset, 'datatype': datatype, 'count': 1}
                   for name, offset, datatype in zip(names, offsets, datatypes)],
        'is_bigendian': False, 'point_step': 80, 'row_step': 160,
        'data': points.tobytes(), 'is_dense': True}


def markers(header, poses):
    """Return two bodies, one arrow and one deleted arrow."""
    shared = {'header': header, 'lifetime': {'sec': 0, 'nanosec': 0}}
    identity = {'position': xyz([0, 0, 0]), 'orientation': xyz([0, 0, 0, 1])}
    colors = [dict(zip('rgba', rgba)) for rgba in ([0.25, 0.5, 0.75, 1.0], [1.0, 0.0, 0.0, 0.5])]
    red = dict(zip('rgba', (1.0, float(np.float32(0.2)), float(np.float32(0.1)), 1.0)))
    return [
        {**shared, 'ns': 'bodies', 'id': 0, 'type': 1, 'action': 0, 'pose': poses[0],
         'scale': xyz([1, 2, 3]), 'color': colors[0]},
        {**shared, 'ns': 'bodies', 'id': 1, 'type': 2, 'action': 0, 'pose': poses[1],
         'scale': xyz([4, 4, 4]), 'color': colors[1]},
        {**shared, 'ns': 'contacts', 'id': 0, 'type': 0, 'action': 0, 'pose': identity,
         'scale': xyz([0.01, 0.02, 0]), 'color': red,
         'points': [xyz(POSITION[0]), xyz(LINEAR[0])]},
        {**shared, 'ns': 'contacts', 'id': 1, 'type': 0, 'action': 2, 'pose': identity},
    ]


TYPES = sorted(encoded())
GOLDEN = json.loads(Path(__file__).with_name('golden.json').read_text())


@pytest.fixture(scope='module')
def serialization():
    return pytest.importorskip('rclpy.serialization')


def message_class(type_name):
    package, _, name = type_name.split('/')
    return getattr(importlib.import_module(package + '.msg'), name)


def fill(message, values):
    """Set the fields of a message from a dictionary, nested messages and lists too."""
    types = message.get_fields_and_field_types()
    for field, value in values.items():
        element = types[field].replace('sequence<', '').rstrip('>')
        if isinstance(value, dict):
            fill(getattr(message, field), value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            package, name = element.split('/')
            kind = message_class(f'{package}/msg/{name}')
            setattr(message, field, [fill(kind(), item) for item in value])
        else:
            setattr(message, field, value)
    return message


def expected(type_name):
    return fill(message_class(type_name)(), as_dictionaries()[type_name])


@pytest.mark.parametrize('type_name', TYPES)
def test_rclpy_reads_what_was_encoded(type_name, serialization):
    data = encoded()[type_name]
    assert serialization.deserialize_message(data, message_class(type_name)) == expected(type_name)


@pytest.mark.parametrize('type_name', TYPES)
def test_bytes_are_those_of_rclpy_outside_padding(type_name, serialization):
    data = encoded()[type_name]
    message = expected(type_name)
    theirs = serialization.serialize_message(message)
    assert len(data) == len(theirs)
    for index in range(len(data)):
        if data[index] != theirs[index]:
            assert data[index] == 0, f'byte {index} should be zero padding'
            changed = bytearray(data)
            changed[index] = 0xFF
            again = serialization.deserialize_message(bytes(changed), type(message))
            assert again == message, f'byte {index} is not padding'


@pytest.mark.parametrize('type_name', TYPES)
def test_bytes_do_not_change(type_name):
    # golden.json was made with rclpy 7.1.5 from `expected`, its padding set to zero
    assert encoded()[type_name].hex() == GOLDEN[type_name]


def test_golden_bytes_are_for_every_encoder():
    assert sorted(GOLDEN) == TYPES
