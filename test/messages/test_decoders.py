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

"""Decoders: right values for right bytes, and one kind of error for all others."""

import struct
import tracemalloc

import numpy as np
import pytest
from rigid_sim_ros import messages
from rigid_sim_ros.engine import events as engine_events

POSITION = np.arange(6.0).reshape(2, 3)
ORIENTATION = np.arange(8.0).reshape(2, 4) + 10
NAMES = ('one', 'body_two')
EVENTS = np.array([(1.25, 2, 3, 1, (1, 2, 3), (0, 1, 0), (0.1, 0.2, 0.3), 0.7)],
                  dtype=messages.COLLISION_TYPE)


def vectors(frame_id, *values):
    """Return a stamped message of vectors, built by hand."""
    name = frame_id.encode() + b'\0'
    body = struct.pack('<iII', 3, 500, len(name)) + name
    body += bytes(-len(body) % 8)
    return b'\0\1\0\0' + body + np.array(values, dtype='<f8').tobytes()


def states(names=NAMES):
    encoder = messages.MultiDOFJointStateEncoder('world', names)
    count = len(names)
    values = np.arange(float(count * 3)).reshape(count, 3)
    return encoder.encode(5, values, np.ones((count, 4)), values + 1, values + 2, values + 3,
                          values + 4)


def joint_state_decoder(data):
    return messages.MultiDOFJointStateDecoder().decode(data)


DECODERS = {
    'pose_array': (messages.decode_pose_array,
                   messages.PoseArrayEncoder('world', 2).encode(7, POSITION, ORIENTATION)),
    'joint_state': (joint_state_decoder, states()),
    'collisions': (messages.decode_collisions,
                   messages.CollisionEncoder('world').encode(10**9, EVENTS)),
    'point_cloud': (messages.decode_point_cloud,
                    messages.CollisionEncoder('world').encode(10**9, EVENTS)),
    'string': (messages.decode_string, messages.encode_string('hello')),
    'clock': (messages.decode_clock, messages.encode_clock(12)),
    'vector3': (messages.decode_vector3_stamped, vectors('cube', 1, 2, 3)),
    'wrench': (messages.decode_wrench_stamped, vectors('cube', *range(6))),
    'twist': (messages.decode_twist_stamped, vectors('cube', *range(6))),
}
EVERY_DECODER = pytest.mark.parametrize('name', sorted(DECODERS))


def test_commands_hold_time_body_and_vectors():
    command = messages.decode_vector3_stamped(vectors('cube_1', 1, 2, 3))
    assert (command.time_ns, command.frame_id) == (3_000_000_500, 'cube_1')
    assert command.vector.tolist() == [1, 2, 3]
    command = messages.decode_wrench_stamped(vectors('a', 1, 2, 3, 4, 5, 6))
    assert (command.force.tolist(), command.torque.tolist()) == ([1, 2, 3], [4, 5, 6])
    command = messages.decode_twist_stamped(vectors('a', 1, 2, 3, 4, 5, 6))
    assert (command.linear.tolist(), command.angular.tolist()) == ([1, 2, 3], [4, 5, 6])


def test_pose_array_comes_back():
    poses = messages.decode_pose_array(DECODERS['pose_array'][1])
    assert (poses.time_ns, poses.frame_id) == (7, 'world')
    assert poses.position.tolist() == POSITION.tolist()
    assert poses.orientation.tolist() == ORIENTATION.tolist()


def test_pose_array_of_nothing_comes_back():
    data = messages.PoseArrayEncoder('world', 0).encode(7, np.empty((0, 3)), np.empty((0, 4)))
    assert messages.decode_pose_array(data).position.shape == (0, 3)


def test_joint_state_comes_back_and_keeps_the_names_of_equal_bytes():
    decoder = messages.MultiDOFJointStateDecoder()
    first = decoder.decode(states())
    assert first.names == NAMES
    assert first.transforms[1].tolist() == [3, 4, 5, 1, 1, 1, 1]
    assert first.twists[1].tolist() == [4, 5, 6, 5, 6, 7]
    assert first.wrenches[1].tolist() == [6, 7, 8, 7, 8, 9]
    assert decoder.decode(states()).names is first.names
    # the same number of names in as many bytes, then a prefix of names, then more names
    for names in (('two', 'body_one'), ('one',), (*NAMES, 'three'), ()):
        state = decoder.decode(states(names))
        assert state.names == names
        assert state.wrenches.shape == (len(names), 6)


def test_joint_state_with_rows_that_match_no_name_is_refused():
    data = bytearray(states())
    names_end = 4 + 4 + 4 + 4 + 8 + 4 + 4 + 4 + 4 + 9
    count = names_end + -(names_end - 4) % 4
    assert struct.unpack_from('<I', data, count) == (2,)
    data[count:] = struct.pack('<I', 0) * 1 + struct.pack('<I', 1)
    data += bytes(-(len(data) - 4) % 8) + bytes(48) + struct.pack('<I', 0)
    with pytest.raises(messages.MessageError, match='1 rows of twist for 2 names'):
        joint_state_decoder(bytes(data))


def test_collisions_come_back_in_the_engine_s_own_type():
    assert messages.COLLISION_TYPE == engine_events.COLLISION
    events = messages.decode_collisions(DECODERS['collisions'][1])
    assert events.dtype == engine_events.COLLISION
    assert events.tobytes() == EVENTS.tobytes()


def test_positions_of_collisions_are_rounded_to_float32_and_nothing_else_is():
    events = EVENTS.copy()
    events['point'] = events['impulse'] = [np.pi, np.e, 0.1]
    data = messages.CollisionEncoder('world').encode(123_456_789, events)
    back = messages.decode_collisions(data)
    assert back['point'].tolist() == [np.float32([np.pi, np.e, 0.1]).tolist()]
    assert back['impulse'].tolist() == events['impulse'].tolist()
    assert back['time'].tolist() == [1.25]


def test_collision_lines_are_json_with_names():
    names = ('a', 'b', 'cube', 'ground')
    assert messages.collision_lines(EVENTS, names) == (
        '{"time": 1.25, "kind": "begin", "body_a": "cube", "body_b": "ground", '
        '"point": [1.0, 2.0, 3.0], "normal": [0.0, 1.0, 0.0], '
        '"impulse": [0.1, 0.2, 0.3], "speed": 0.7}')
    assert messages.collision_lines(np.concatenate([EVENTS, EVENTS]), names).count('\n') == 1


def test_collision_kinds_are_named_as_in_the_engine():
    kinds = engine_events.IMPACT, engine_events.BEGIN, engine_events.END
    assert [messages.collisions.KIND_NAMES[kind] for kind in kinds] == ['impact', 'begin', 'end']


@EVERY_DECODER
def test_every_truncation_is_refused(name):
    decode, data = DECODERS[name]
    decode(data)
    for length in range(len(data)):
        with pytest.raises(messages.MessageError):
            decode(data[:length])


@EVERY_DECODER
def test_more_than_padding_after_the_end_is_refused(name):
    decode, data = DECODERS[name]
    decode(data + bytes(3))
    with pytest.raises(messages.MessageError, match='after the last field'):
        decode(data + bytes(4))


@EVERY_DECODER
@pytest.mark.parametrize('word', [0, 1, 0x7FFFFFFF, 0xFFFFFFFF])
def test_any_word_may_be_wrong(name, word):
    decode, data = DECODERS[name]
    tracemalloc.start()
    for offset in range(0, len(data) - 3):
        damaged = bytearray(data)
        struct.pack_into('<I', damaged, offset, word)
        try:
            decode(bytes(damaged))
        except messages.MessageError as error:
            assert '\n' not in str(error)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e6


@EVERY_DECODER
def test_random_bytes_are_refused_or_read(name):
    decode, data = DECODERS[name]
    generator = np.random.default_rng(5)
    for _ in range(300):
        size = int(generator.integers(0, 2 * len(data)))
        try:
            decode(b'\0\1\0\0' + generator.integers(0, 256, size, dtype=np.uint8).tobytes())
        except messages.MessageError:
            pass


def test_other_encapsulations_are_named():
    with pytest.raises(messages.MessageError, match='encapsulation 0000, only 0001'):
        messages.decode_clock(b'\0\0' + messages.encode_clock(0)[2:])


def test_a_string_that_is_not_utf_8_is_refused():
    with pytest.raises(messages.MessageError, match='not UTF-8'):
        messages.decode_string(messages.encode_string('ab').replace(b'ab', b'\xff\xfe'))
