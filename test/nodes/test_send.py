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

"""Commands can be sent where there is no command `ros2`."""

import re
import shlex

import pytest

pytest.importorskip('rclpy')

from geometry_msgs.msg import TwistStamped  # noqa: E402, I100
from node_harness import Client, NodeProcess  # noqa: E402
from rigid_sim_ros.nodes.send import main, message_of, MessageTextError  # noqa: E402
import yaml  # noqa: E402

TWIST = 'geometry_msgs/msg/TwistStamped'
STATES = 'sensor_msgs/msg/MultiDOFJointState'


def test_message_has_what_the_text_gives_and_zeros():
    message = message_of(TWIST, '{header: {frame_id: a}, twist: {linear: {x: 1, z: 2.5}}}')
    expected = TwistStamped()
    expected.header.frame_id = 'a'
    expected.twist.linear.x, expected.twist.linear.z = 1.0, 2.5
    assert message == expected


def test_lists_of_messages_are_filled():
    message = message_of(STATES, '{joint_names: [a, b], wrench: [{force: {x: 1}}, {}]}')
    assert message.joint_names == ['a', 'b']
    assert [wrench.force.x for wrench in message.wrench] == [1.0, 0.0]


@pytest.mark.parametrize('type_name, text, error', [
    ('geometry_msgs/msg/Twisted', '{}', "there is no message type 'geometry_msgs/msg/Twisted'"),
    ('Twist', '{}', "there is no message type 'Twist'"),
    (TWIST, '{header: ', 'not YAML'),
    (TWIST, '7', 'message is 7; allowed: a mapping'),
    (TWIST, '{twist: {linaer: {x: 1}}}', "message.twist has no field 'linaer'; allowed: linear,"),
    (TWIST, '{twist: {linear: {x: fast}}}', "message.twist.linear.x is 'fast'; allowed: double"),
    (TWIST, '{twist: [1]}', 'message.twist is [1]; allowed: a mapping'),
    (STATES, '{wrench: [{forces: {}}]}', "message.wrench[0] has no field 'forces'"),
    (STATES, '{joint_names: [1]}', 'message.joint_names is [1]; allowed: sequence<string>'),
])
def test_wrong_text_is_refused_in_one_line(type_name, text, error):
    with pytest.raises(MessageTextError, match=re.escape(error)) as refusal:
        message_of(type_name, text)
    assert '\n' not in str(refusal.value)


def test_command_is_obeyed(tmp_path, capsys, monkeypatch):
    with NodeProcess(tmp_path, scene='report_dynamics') as process, Client(process) as client:
        monkeypatch.setenv('ROS_DOMAIN_ID', str(process.domain_id))
        scene = client.listen('~/scene', durability='transient_local')
        poses = client.listen('~/poses')
        text = client.spin_until(lambda: scene and scene[0].data, 'the latched scene')
        first = yaml.safe_load(text)['bodies'][0]['name']
        assert main([client.topic('~/cmd_vel'), TWIST,
                     f'{{header: {{frame_id: {first}}}, twist: {{linear: {{y: 300}}}}}}']) == 0
        # nothing in this scene is anywhere near so fast
        client.spin_until(lambda: poses and poses[-1].poses[0].position.y > 30, 'the motion')
    assert capsys.readouterr().err == ''


def test_commands_that_the_node_offers_can_be_sent(tmp_path, capsys, monkeypatch):
    with NodeProcess(tmp_path, scene='report_dynamics') as process:
        monkeypatch.setenv('ROS_DOMAIN_ID', str(process.domain_id))
        process.wait_for_text('cmd_torque geometry_msgs')
        offers = [line for line in process.error.splitlines() if ' geometry_msgs/msg/' in line]
        assert len(offers) == 3
        for line in offers:
            assert main(shlex.split(line.split(': ', 1)[1])[-3:]) == 0
        # a refused command is warned of
        assert '[WARN]' not in process.error
    assert capsys.readouterr().err == ''


def test_nobody_there_is_said(capsys, monkeypatch):
    monkeypatch.setattr('rigid_sim_ros.nodes.send.PATIENCE', 0.2)
    assert main(['/nobody/cmd_vel', TWIST, '{}']) == 1
    assert 'nobody takes' in capsys.readouterr().err
