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
Collision events: sensor_msgs/PointCloud2 for programs, a line of JSON each for people.

One point is one event, in order of time. Position and normal are float32, because that is what
RViz and PCL take; a rounding of 1e-7 of the distance from the origin is below what is seen. The
impulse, speed and time are float64, so that sums over events keep the engine's accuracy. The
time of an event is the header's stamp plus `time_offset` [s], which is negative or zero for a
message stamped with the end of a step. `body_a` and `body_b` are indices into the names of all
bodies (uint32), `kind` (uint8) is 0 impact, 1 begin, 2 end.
"""

import json
from typing import NamedTuple

import numpy as np
from rigid_sim_ros.messages.cdr import MessageError, NANOSECONDS, Reader, Writer

KIND_NAMES = ('impact', 'begin', 'end')
"""What the number `kind` stands for; the order of the engine's events."""

_FLOAT32, _FLOAT64, _UINT32, _UINT8 = 7, 8, 6, 2

_FIELDS = (
    *((name, _FLOAT32) for name in ('x', 'y', 'z', 'normal_x', 'normal_y', 'normal_z')),
    *((name, _FLOAT64) for name in ('impulse_x', 'impulse_y', 'impulse_z', 'speed',
                                    'time_offset')),
    ('body_a', _UINT32), ('body_b', _UINT32), ('kind', _UINT8))

_DATATYPES = {1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 8: 'f8'}
"""The constants of sensor_msgs/PointField."""

_POINT_STEP = 80
"""Bytes a point: 73 in use, and the doubles of the next point stay aligned."""

_LARGEST_FIELD_COUNT = 256
"""More fields than any cloud has; a message that claims more is refused."""

_LARGEST_POINT_STEP = 65536
"""More bytes than any point has; a message that claims more is refused."""

COLLISION_TYPE = np.dtype([
    ('time', 'f8'), ('body_a', 'i4'), ('body_b', 'i4'), ('kind', 'u1'), ('point', 'f8', (3,)),
    ('normal', 'f8', (3,)), ('impulse', 'f8', (3,)), ('speed', 'f8')])
"""Events as `decode_collisions` gives them: the fields of the engine's own."""


def _point_type(fields, point_step):
    """Return the dtype of a point with (name, datatype) fields packed one after the other."""
    formats = [np.dtype('<' + _DATATYPES[datatype]) for _, datatype in fields]
    ends = np.cumsum([form.itemsize for form in formats])
    return np.dtype({
        'names': [name for name, _ in fields], 'formats': formats,
        'offsets': [int(end) - form.itemsize for end, form in zip(ends, formats)],
        'itemsize': point_step})


POINT_TYPE = _point_type(_FIELDS, _POINT_STEP)
"""A point as it lies in the message."""


class CollisionEncoder:
    """Makes sensor_msgs/PointCloud2 messages of collision events in a fixed frame."""

    def __init__(self, frame_id):
        self._frame_id = frame_id

    def encode(self, time_ns, events):
        """
        Return the message with a stamp [ns] and a point for each event.

        The events are a structured array with fields time [s], body_a, body_b, kind, point (3)
        [m], normal (3), impulse (3) [N s] and speed [m/s].
        """
        writer = Writer()
        writer.header(time_ns, self._frame_id)
        writer.pack('I', 1, len(events), len(_FIELDS))
        for name, datatype in _FIELDS:
            writer.string(name)
            writer.pack('I', POINT_TYPE.fields[name][1])
            writer.pack('B', datatype)
            writer.pack('I', 1)
        writer.pack('B', 0)
        writer.pack('I', _POINT_STEP, _POINT_STEP * len(events), _POINT_STEP * len(events))
        writer.raw(_points(events, time_ns).tobytes())
        writer.pack('B', 1)
        return writer.message()


def _points(events, time_ns):
    # np.zeros leaves the unused bytes of a point zero too
    points = np.zeros(len(events), POINT_TYPE)
    with np.errstate(over='ignore'):  # too far away for a float32 is infinitely far
        for name in ('point', 'normal', 'impulse'):
            prefix = '' if name == 'point' else name + '_'
            for axis, letter in enumerate('xyz'):
                points[prefix + letter] = events[name][:, axis]
    for name in ('speed', 'body_a', 'body_b', 'kind'):
        points[name] = events[name]
    points['time_offset'] = events['time'] - time_ns / NANOSECONDS
    return points


class PointCloud2(NamedTuple):
    """A sensor_msgs/PointCloud2: time [ns], frame, and a structured array of the points."""

    time_ns: int
    frame_id: str
    points: np.ndarray


def decode_point_cloud(data):
    """Return the `PointCloud2` in CDR bytes, whatever its fields; raises `MessageError`."""
    reader = Reader(data, 'PointCloud2')
    header = reader.header()
    height, width = reader.unpack('II')
    fields = [_read_field(reader) for _ in range(_field_count(reader))]
    big_endian, point_step, row_step = reader.unpack('BII')
    payload = reader.raw(reader.count(1))
    reader.number('B')
    reader.end()
    if big_endian:
        reader.fail('big-endian points (only little-endian ones are read)')
    if row_step != width * point_step or len(payload) != height * row_step:
        reader.fail(f'{height} x {width} points of {point_step} bytes in rows of {row_step} do '
                    f'not make {len(payload)} bytes')
    point_type = _declared_type(reader, fields, point_step)
    return PointCloud2(*header, np.frombuffer(payload, point_type))


def _field_count(reader):
    count = reader.count(17)
    if count > _LARGEST_FIELD_COUNT:
        reader.fail(f'{count} fields (at most {_LARGEST_FIELD_COUNT} are read)')
    return count


def _read_field(reader):
    return (reader.string(), *reader.unpack('IBI'))


def _declared_type(reader, fields, point_step):
    """Return the dtype that (name, offset, datatype, count) fields declare, or refuse them."""
    if point_step > _LARGEST_POINT_STEP:
        reader.fail(f'points of {point_step} bytes (at most {_LARGEST_POINT_STEP} are read)')
    names, formats, offsets = [], [], []
    for name, offset, datatype, count in fields:
        if datatype not in _DATATYPES:
            reader.fail(f'field {name!r} has datatype {datatype} (1 to 8 are allowed)')
        form = np.dtype(_DATATYPES[datatype]).newbyteorder('<')
        if count < 1 or offset + form.itemsize * count > point_step:
            reader.fail(f'field {name!r} does not fit in a point of {point_step} bytes')
        if not name or name in names:
            reader.fail(f'field name {name!r} is empty or there twice')
        names.append(name)
        formats.append(form if count == 1 else (form, (count,)))
        offsets.append(offset)
    if not names:
        reader.fail('a point without fields')
    return np.dtype({'names': names, 'formats': formats, 'offsets': offsets,
                     'itemsize': point_step})


def decode_collisions(data):
    """
    Return the events in a message of `CollisionEncoder`, an array of `COLLISION_TYPE`.

    Times are absolute [s]. Raises `MessageError`, also for a cloud with other fields.
    """
    cloud = decode_point_cloud(data)
    if cloud.points.dtype != POINT_TYPE:
        raise MessageError('PointCloud2: the fields are not those of collision events: '
                           f'{", ".join(cloud.points.dtype.names)}')
    events = np.zeros(len(cloud.points), COLLISION_TYPE)
    for name in ('point', 'normal', 'impulse'):
        prefix = '' if name == 'point' else name + '_'
        for axis, letter in enumerate('xyz'):
            events[name][:, axis] = cloud.points[prefix + letter]
    for name in ('speed', 'body_a', 'body_b', 'kind'):
        events[name] = cloud.points[name]
    events['time'] = cloud.points['time_offset'] + cloud.time_ns / NANOSECONDS
    return events


def collision_lines(events, names):
    """
    Return one line of JSON for each event, joined by newlines, with names for indices.

    `names` are those of all bodies and planes. Numbers are written with all their digits.
    """
    return '\n'.join(json.dumps({
        'time': float(event['time']),
        'kind': KIND_NAMES[event['kind']],
        'body_a': names[event['body_a']],
        'body_b': names[event['body_b']],
        'point': event['point'].tolist(),
        'normal': event['normal'].tolist(),
        'impulse': event['impulse'].tolist(),
        'speed': float(event['speed']),
    }) for event in events)
