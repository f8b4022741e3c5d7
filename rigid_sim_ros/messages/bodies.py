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
The state of many bodies in one message: PoseArray and MultiDOFJointState.

Rows are bodies: positions [m] (n, 3), orientations (n, 4) as x, y, z, w, velocities [m/s] and
[rad/s] and wrenches [N] and [N m] (n, 3). Any strides will do; a transposed view of a
component-major array is copied once, into the message.
"""

from typing import NamedTuple

import numpy as np
from rigid_sim_ros.messages.cdr import Reader, Template, Writer


class PoseArrayEncoder:
    """Makes geometry_msgs/PoseArray messages of a fixed number of bodies in a fixed frame."""

    def __init__(self, frame_id, body_count):
        writer = Writer()
        writer.header(0, frame_id)
        offset = writer.array(body_count, 7)
        self._template = Template(writer)
        self.poses = self._template.doubles(offset, body_count, 7)
        """What is in the message, a row a body: x, y, z and the quaternion x, y, z, w."""
        self._position, self._orientation = self.poses[:, :3], self.poses[:, 3:]

    def encode(self, time_ns, position, orientation):
        """Return the message with a stamp [ns], positions (n, 3) and orientations (n, 4)."""
        return bytes(self.view(time_ns, position, orientation))

    def view(self, time_ns, position, orientation):
        """Return what `encode` does as a view, which holds until the next message is made."""
        self._template.set_time(time_ns)
        self._position[...] = position
        self._orientation[...] = orientation
        return self._template.view()


class MultiDOFJointStateEncoder:
    """Makes sensor_msgs/MultiDOFJointState messages of fixed, named bodies in a fixed frame."""

    def __init__(self, frame_id, names):
        body_count = len(names)
        writer = Writer()
        writer.header(0, frame_id)
        writer.strings(names)
        offsets = [writer.array(body_count, width) for width in (7, 6, 6)]
        self._template = Template(writer)
        self._poses, twists, wrenches = (
            self._template.doubles(offset, body_count, width)
            for offset, width in zip(offsets, (7, 6, 6)))
        self._position, self._orientation = self._poses[:, :3], self._poses[:, 3:]
        self.steady_parts = {
            'linear_velocity': twists[:, :3], 'angular_velocity': twists[:, 3:],
            'force': wrenches[:, :3], 'torque': wrenches[:, 3:]}
        """What else is in the message, (n, 3) each, to be written to where it has changed."""

    def encode(self, time_ns, position, orientation, *others):
        """Return the message with a stamp [ns], poses and rows (n, 3) for `steady_parts`."""
        self.write_poses(position, orientation)
        for part, rows in zip(self.steady_parts.values(), others, strict=True):
            part[...] = rows
        return bytes(self.view(time_ns))

    def write_poses(self, position, orientation):
        """Let the message have positions (n, 3) and orientations (n, 4) from now on."""
        self._position[...] = position
        self._orientation[...] = orientation

    def copy_poses(self, poses):
        """Let it have those that are rows (n, 7) of another message."""
        self._poses[...] = poses

    def view(self, time_ns):
        """Return the message with a stamp [ns], to be read until anything is written to it."""
        self._template.set_time(time_ns)
        return self._template.view()


class PoseArray(NamedTuple):
    """A geometry_msgs/PoseArray; arrays are views of the message and cannot be written."""

    time_ns: int
    frame_id: str
    position: np.ndarray
    orientation: np.ndarray


class MultiDOFJointState(NamedTuple):
    """
    A sensor_msgs/MultiDOFJointState; arrays are views of the message and cannot be written.

    Each array has a row for every name, or none at all.
    """

    time_ns: int
    frame_id: str
    names: tuple
    transforms: np.ndarray
    """(n, 7): x, y, z [m] and the quaternion x, y, z, w."""

    twists: np.ndarray
    """(n, 6): linear [m/s], angular [rad/s]."""

    wrenches: np.ndarray
    """(n, 6): force [N], torque [N m]."""


def decode_pose_array(data):
    """Return the `PoseArray` in CDR bytes; raises `MessageError`."""
    reader = Reader(data, 'PoseArray')
    header = reader.header()
    poses = reader.array(7)
    reader.end()
    return PoseArray(*header, poses[:, :3], poses[:, 3:])


class MultiDOFJointStateDecoder:
    """
    Reads sensor_msgs/MultiDOFJointState messages.

    The names of the last message are kept: a sender that commands the same bodies again and
    again sends the same bytes for them, and then they are compared as a whole instead of read
    one by one. The tuple of names is then the very same object, so a caller can keep what it
    found for it.
    """

    def __init__(self):
        self._names = ()
        self._raw_names = b''

    def decode(self, data):
        """Return the `MultiDOFJointState` in CDR bytes; raises `MessageError`."""
        reader = Reader(data, 'MultiDOFJointState')
        time_ns, frame_id = reader.header()
        names = self._read_names(reader)
        arrays = [reader.array(width) for width in (7, 6, 6)]
        reader.end()
        for array, what in zip(arrays, ('transforms', 'twist', 'wrench')):
            if len(array) not in (0, len(names)):
                reader.fail(f'{len(array)} rows of {what} for {len(names)} names (as many, or '
                            'none, are allowed)')
        return MultiDOFJointState(time_ns, frame_id, names, *arrays)

    def _read_names(self, reader):
        reader.align(4)
        if self._raw_names and reader.skip(self._raw_names):
            return self._names
        view = reader.rest()
        start = reader.offset
        names = reader.strings()
        self._names, self._raw_names = names, bytes(view[:reader.offset - start])
        return names
