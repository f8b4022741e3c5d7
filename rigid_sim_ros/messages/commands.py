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

"""Commands to one body, which `header.frame_id` names: Vector3, wrench and twist, stamped."""

from typing import NamedTuple

import numpy as np
from rigid_sim_ros.messages.cdr import Reader


class Vector3Stamped(NamedTuple):
    """A geometry_msgs/Vector3Stamped: time [ns], frame, vector (3,)."""

    time_ns: int
    frame_id: str
    vector: np.ndarray


class WrenchStamped(NamedTuple):
    """A geometry_msgs/WrenchStamped: time [ns], frame, force [N] (3,), torque [N m] (3,)."""

    time_ns: int
    frame_id: str
    force: np.ndarray
    torque: np.ndarray


class TwistStamped(NamedTuple):
    """A geometry_msgs/TwistStamped: time [ns], frame, linear [m/s], angular [rad/s], (3,)."""

    time_ns: int
    frame_id: str
    linear: np.ndarray
    angular: np.ndarray


def _decode(kind, data, vector_count):
    reader = Reader(data, kind.__name__)
    header = reader.header()
    vectors = reader.doubles(3 * vector_count).reshape(vector_count, 3)
    reader.end()
    return kind(*header, *vectors)


def decode_vector3_stamped(data):
    """Return the `Vector3Stamped` in CDR bytes; raises `MessageError`."""
    return _decode(Vector3Stamped, data, 1)


def decode_wrench_stamped(data):
    """Return the `WrenchStamped` in CDR bytes; raises `MessageError`."""
    return _decode(WrenchStamped, data, 2)


def decode_twist_stamped(data):
    """Return the `TwistStamped` in CDR bytes; raises `MessageError`."""
    return _decode(TwistStamped, data, 2)
