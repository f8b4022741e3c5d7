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

"""Poses as transforms for tf2: tf2_msgs/TFMessage."""

import numpy as np
from rigid_sim_ros.messages.cdr import seconds_and_nanoseconds, Template, Writer


class TransformsEncoder:
    """
    Makes tf2_msgs/TFMessage messages: where each of fixed, named bodies is in a fixed frame.

    The names are the child frames. They are laid out once; then only poses and stamps are written.
    """

    def __init__(self, frame_id, names):
        writer = Writer()
        writer.pack('I', len(names))
        stamps, poses = [], []
        for name in names:
            writer.align(4)
            stamps.append(writer.offset)
            writer.header(0, frame_id)
            writer.string(name)
            poses.append(writer.pack('d', 0, 0, 0, 0, 0, 0, 1))
        writer.align(8)
        self._length = 4 + (poses[-1] + 56 if poses else 4)
        self._template = Template(writer)
        self._doubles = self._template.doubles(0, writer.offset // 8, 1)[:, 0]
        self._integers = self._doubles.view(np.int32)
        self._stamps = np.array(stamps, dtype=int)[:, np.newaxis] // 4 + np.arange(2)
        self._poses = np.array(poses, dtype=int)[:, np.newaxis] // 8 + np.arange(7)

    def encode(self, time_ns, position, orientation):
        """Return the message with a stamp [ns], positions (n, 3) and orientations (n, 4)."""
        self._integers[self._stamps] = seconds_and_nanoseconds(time_ns)
        self._doubles[self._poses[:, :3]] = position
        self._doubles[self._poses[:, 3:]] = orientation
        return self._template.message()[:self._length]
