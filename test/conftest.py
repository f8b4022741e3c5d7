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
Keep the tests apart from every other ROS 2 program on this machine and network.

The environment is set here, before any test module can import rclpy, and the processes that
tests start inherit it.
"""

import os
import random
import tempfile

HIGHEST_DOMAIN_ID = 101
"""Above this the ports collide with those Linux hands out to other programs."""

os.environ['ROS_DOMAIN_ID'] = str(random.SystemRandom().randint(1, HIGHEST_DOMAIN_ID))
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
for name in ('ROS_LOCALHOST_ONLY', 'ROS_STATIC_PEERS', 'ROS_DISCOVERY_SERVER'):
    os.environ.pop(name, None)
log_folder = tempfile.TemporaryDirectory(prefix='rigid_sim_test_log_')
os.environ['ROS_LOG_DIR'] = log_folder.name
