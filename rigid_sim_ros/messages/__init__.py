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
ROS 2 messages as bytes: NumPy arrays to CDR and back, without ROS and without the engine.

Encoders of bulk messages are objects that lay a message out once and then fill it in; the
others are functions. Decoders take bytes from anywhere and raise `MessageError`, and nothing
else, for bytes that are not their message. Times are integers [ns].
"""

from rigid_sim_ros.messages.basic import (
    decode_clock, decode_string, DiagnosticStatus, encode_clock, encode_diagnostic_array,
    encode_string, ERROR, OK, STALE, WARN)
from rigid_sim_ros.messages.bodies import (
    decode_pose_array, MultiDOFJointState, MultiDOFJointStateDecoder, MultiDOFJointStateEncoder,
    PoseArray, PoseArrayEncoder)
from rigid_sim_ros.messages.cdr import MessageError
from rigid_sim_ros.messages.collisions import (
    collision_lines, COLLISION_TYPE, CollisionEncoder, decode_collisions, decode_point_cloud,
    POINT_TYPE, PointCloud2)
from rigid_sim_ros.messages.commands import (
    decode_twist_stamped, decode_vector3_stamped, decode_wrench_stamped, TwistStamped,
    Vector3Stamped, WrenchStamped)
from rigid_sim_ros.messages.markers import (
    ARROW, CUBE, encode_delete_all, MarkerArrayEncoder, SPHERE)
from rigid_sim_ros.messages.transforms import TransformsEncoder

__all__ = [
    'ARROW', 'COLLISION_TYPE', 'CUBE', 'CollisionEncoder', 'DiagnosticStatus', 'ERROR',
    'MarkerArrayEncoder', 'MessageError', 'MultiDOFJointState', 'MultiDOFJointStateDecoder',
    'MultiDOFJointStateEncoder', 'OK', 'POINT_TYPE', 'PointCloud2', 'PoseArray',
    'PoseArrayEncoder', 'SPHERE', 'STALE', 'TransformsEncoder', 'TwistStamped', 'Vector3Stamped',
    'WARN', 'WrenchStamped', 'collision_lines', 'decode_clock', 'decode_collisions',
    'decode_point_cloud', 'decode_pose_array', 'decode_string', 'decode_twist_stamped',
    'decode_vector3_stamped', 'decode_wrench_stamped', 'encode_clock', 'encode_delete_all',
    'encode_diagnostic_array', 'encode_string']
