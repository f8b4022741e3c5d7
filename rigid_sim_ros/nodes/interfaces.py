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

"""From the words of `topics` to what rclpy wants: message types and quality of service."""

from importlib import import_module

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def interface(type_name):
    """Return the class of an interface type, such as 'geometry_msgs/msg/PoseArray'."""
    package, folder, name = type_name.split('/')
    return getattr(import_module(f'{package}.{folder}'), name)


def quality_of_service(quality, reliability=None):
    """Return the `QoSProfile` of a `topics.Quality`, with another reliability if one is given."""
    return QoSProfile(
        depth=quality.depth,
        reliability=ReliabilityPolicy[(reliability or quality.reliability).upper()],
        durability=DurabilityPolicy[quality.durability.upper()])
