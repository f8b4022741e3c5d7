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

"""Recordings: rosbag2 bags of MCAP files, written and read without ROS."""

from rigid_sim_ros.recording.bag import Bag, BagMessage
from rigid_sim_ros.recording.errors import RecordingError
from rigid_sim_ros.recording.read import read, Recording
from rigid_sim_ros.recording.recorder import (
    CLOSED, DROP, FAILED, Recorder, RecorderState, RECORDING, WAIT)
from rigid_sim_ros.recording.recover import recover
from rigid_sim_ros.recording.software import software

__all__ = ['Bag', 'BagMessage', 'CLOSED', 'DROP', 'FAILED', 'RECORDING', 'Recorder',
           'RecorderState', 'Recording', 'RecordingError', 'WAIT', 'read', 'recover', 'software']
