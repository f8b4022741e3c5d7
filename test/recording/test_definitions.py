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


import json
from pathlib import Path
import sys

import pytest
from rigid_sim_ros import topics
from rigid_sim_ros.recording import definitions

SHARES = [Path(prefix) / 'share' for prefix in (sys.prefix, '/opt/ros/jazzy')]


def test_every_recorded_topic_has_a_definition():
    for row in (*topics.PUBLISHED, *topics.COMMANDS, topics.JOURNAL):
        assert definitions.type_hash(row.type_name).startswith('RIHS01_')
        assert definitions.schema_text(row.type_name)


@pytest.mark.parametrize('share', SHARES, ids=str)
def test_shipped_definitions_are_those_of_an_installation(share):
    if not (share / 'geometry_msgs' / 'msg').is_dir():
        pytest.skip('no ROS there')
    shipped = json.loads(Path(definitions.__file__).with_name(
        'message_definitions.json').read_text())
    assert definitions.collect(share) == shipped


def test_dependencies_leave_out_primitives_constants_and_comments():
    text = '\n'.join([
        '# geometry_msgs/Ignored x', 'int32 A=1', 'string NAME = "a/b c"', 'float64[36] x',
        'string<=10 s', 'Pose[<=3] poses', 'std_msgs/Header header # comment', 'uint8[] data', ''])
    assert definitions.dependencies('geometry_msgs/msg/X', text) == [
        'geometry_msgs/msg/Pose', 'std_msgs/msg/Header']


def test_schema_text_has_every_dependency_once_after_a_line_of_80_equals_signs():
    parts = definitions.schema_text('geometry_msgs/msg/PoseArray').split('=' * 80 + '\n')
    assert sorted(part.splitlines()[0] for part in parts[1:]) == [
        'MSG: builtin_interfaces/Time', 'MSG: geometry_msgs/Point', 'MSG: geometry_msgs/Pose',
        'MSG: geometry_msgs/Quaternion', 'MSG: std_msgs/Header']


def test_an_unknown_type_is_named_and_the_known_ones_listed():
    with pytest.raises(ValueError, match="'a/msg/B'; known: diagnostic_msgs/msg/Diagnos"):
        definitions.schema_text('a/msg/B')
