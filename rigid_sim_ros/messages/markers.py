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

"""Bodies and contacts for RViz and Foxglove: visualization_msgs/MarkerArray."""

import numpy as np
from rigid_sim_ros.messages.cdr import seconds_and_nanoseconds, Template, Writer

ARROW, CUBE, SPHERE = 0, 1, 2
"""Types of a visualization_msgs/Marker."""

_ADD, _DELETE, _DELETE_ALL = 0, 2, 3

_ARROW_SCALE = (0.01, 0.02, 0.0)
"""Diameters [m] of an arrow's shaft and head."""

_ARROW_COLOR = (1.0, 0.2, 0.1, 1.0)


class MarkerArrayEncoder:
    """
    Makes visualization_msgs/MarkerArray messages: one marker a body, one arrow a contact.

    Bodies are in the namespace `bodies`, with their index as id, and are laid out once; then
    only poses and stamps are written. Arrows are in the namespace `contacts`; those of the
    message before that are not needed any more are deleted.
    """

    def __init__(self, frame_id, kinds, scale, color):
        """
        Lay out the bodies.

        `kinds` (n,) are CUBE or SPHERE, `scale` (n, 3) are the sides or diameters [m], `color`
        (n, 4) is red, green, blue, alpha from 0 to 1.
        """
        self._frame_id = frame_id
        self._arrow_count = 0
        writer = Writer()
        writer.pack('I', len(kinds))
        offsets = [
            _add_marker(writer, frame_id, 'bodies', index, int(kind), scale=sides, color=rgba)
            for index, (kind, sides, rgba) in enumerate(zip(kinds, scale, color))]
        self._template = Template(writer)
        end = writer.offset // 8 * 8
        self._doubles = self._template.doubles(0, end // 8, 1)[:, 0]
        self._integers = self._doubles.view(np.int32)
        stamps, poses = np.array(offsets, dtype=int).reshape(-1, 2).T
        self._stamps = stamps[:, np.newaxis] // 4 + np.arange(2)
        self._poses = poses[:, np.newaxis] // 8 + np.arange(7)
        self._body_count = len(kinds)

    def encode(self, time_ns, position, orientation, arrow_start=(), arrow_end=()):
        """
        Return the message with a stamp [ns], the bodies' poses and the contacts' arrows.

        Positions (n, 3) [m] and orientations (n, 4) are those of the bodies laid out; arrows go
        from `arrow_start` (k, 3) to `arrow_end` (k, 3) [m].
        """
        self._integers[self._stamps] = seconds_and_nanoseconds(time_ns)
        self._doubles[self._poses[:, :3]] = position
        self._doubles[self._poses[:, 3:]] = orientation
        deleted = range(len(arrow_start), self._arrow_count)
        self._arrow_count = len(arrow_start)
        writer = self._template.continued()
        for index, points in enumerate(zip(arrow_start, arrow_end)):
            _add_marker(writer, self._frame_id, 'contacts', index, ARROW, time_ns=time_ns,
                        scale=_ARROW_SCALE, color=_ARROW_COLOR, points=points)
        for index in deleted:
            _add_marker(writer, self._frame_id, 'contacts', index, ARROW, _DELETE, time_ns)
        writer.set_count(0, self._body_count + len(arrow_start) + len(deleted))
        return writer.message()


def encode_delete_all(time_ns, frame_id):
    """Return a visualization_msgs/MarkerArray that removes every marker, with a stamp [ns]."""
    writer = Writer()
    writer.pack('I', 1)
    _add_marker(writer, frame_id, '', 0, ARROW, _DELETE_ALL, time_ns)
    return writer.message()


def _add_marker(writer, frame_id, namespace, index, kind, action=_ADD, time_ns=0,
                scale=(0.0, 0.0, 0.0), color=(0.0, 0.0, 0.0, 0.0), points=()):
    """Append a visualization_msgs/Marker; give the offsets of its stamp and of its pose."""
    writer.align(4)
    stamp = writer.offset
    writer.header(time_ns, frame_id)
    writer.string(namespace)
    writer.pack('i', index, kind, action)
    pose = writer.pack('d', 0, 0, 0, 0, 0, 0, 1)
    writer.pack('d', *scale)
    writer.pack('f', *color)
    writer.pack('i', 0, 0)  # lifetime: until replaced
    writer.pack('B', 0)  # frame_locked
    writer.pack('I', len(points))
    for point in points:
        writer.pack('d', *point)
    writer.pack('I', 0)  # colors
    writer.string('')  # texture_resource
    writer.header(0, '')  # texture
    writer.string('')
    writer.pack('I', 0)
    writer.pack('I', 0)  # uv_coordinates
    writer.string('')  # text
    writer.string('')  # mesh_resource
    writer.string('')  # mesh_file
    writer.pack('I', 0)
    writer.pack('B', 0)  # mesh_use_embedded_materials
    return stamp, pose
