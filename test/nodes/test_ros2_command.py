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

"""The stand-in for `ros2`: its words and output, and what they do to a node in another process."""

import os
from pathlib import Path
import re
import shlex
import signal
import subprocess
import sys
import threading
import time

import pytest

pytest.importorskip('rclpy')

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue  # noqa: E402, I100
from geometry_msgs.msg import TwistStamped, Vector3Stamped  # noqa: E402
from node_harness import Client, NodeProcess  # noqa: E402
from rigid_sim_ros.nodes import announcement  # noqa: E402
from rigid_sim_ros.nodes.ros2_command import run  # noqa: E402
from rigid_sim_ros.nodes.ros2_verbs.graph import VerbError  # noqa: E402
from rigid_sim_ros.nodes.ros2_verbs.message_text import (  # noqa: E402
    from_yaml, interface_class, to_yaml)
from rigid_sim_ros.nodes.ros2_verbs.topic_verbs import rate_text  # noqa: E402
from rigid_sim_ros.scene import load_scene  # noqa: E402
from rigid_sim_ros.topics import COMMANDS, PUBLISHED, SERVICES  # noqa: E402
from sensor_msgs.msg import Imu, MultiDOFJointState, PointCloud2  # noqa: E402
import yaml  # noqa: E402

SCENE = 'report_dynamics'
TWIST = 'geometry_msgs/msg/TwistStamped'
PATIENCE = 15.0
GRAPH = 'rigid_sim_ros.nodes.ros2_verbs.graph'


@pytest.fixture(scope='module')
def process(tmp_path_factory):
    """Return a running node that all these tests share."""
    with NodeProcess(tmp_path_factory.mktemp('node'), scene=SCENE) as node:
        node.wait_for_text('try, in another terminal')
        yield node


@pytest.fixture
def command(process, monkeypatch, capsys):
    """Yield a function that carries out a command and gives exit code, output and errors."""
    monkeypatch.setenv('ROS_DOMAIN_ID', str(process.domain_id))
    monkeypatch.setattr(f'{GRAPH}.PATIENCE', PATIENCE)
    monkeypatch.setattr(f'{GRAPH}.STILLNESS', 0.5)

    def give_up(number, frame):
        raise TimeoutError('the command does not end')

    def carry_out(line):
        signal.setitimer(signal.ITIMER_REAL, 1.5 * PATIENCE)
        code = run(shlex.split(line))
        signal.setitimer(signal.ITIMER_REAL, 0)
        return code, *capsys.readouterr()

    former = signal.signal(signal.SIGALRM, give_up)
    yield carry_out
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, former)


@pytest.fixture
def patient(monkeypatch):
    """Let a command believe in nobody's absence, however slowly this machine finds them."""
    monkeypatch.setattr(f'{GRAPH}.STILLNESS', PATIENCE)


def output(result):
    """Return what was printed by a command that has to have succeeded."""
    code, out, error = result
    assert (code, error) == (0, '')
    return out


# Messages from text and to text

def test_fields_that_are_given_are_set_and_the_others_are_not():
    message = from_yaml(
        TwistStamped, '{header: {frame_id: a}, twist: {linear: {x: 1, y: 1e-3, z: .inf}}}')
    expected = TwistStamped()
    expected.header.frame_id = 'a'
    expected.twist.linear.x, expected.twist.linear.y = 1.0, 0.001
    expected.twist.linear.z = float('inf')
    assert message == expected


def test_lists_of_messages_are_filled():
    message = from_yaml(MultiDOFJointState,
                        '{joint_names: [a, 2], wrench: [{force: {x: 1}}, {}]}')
    assert message.joint_names == ['a', '2']
    assert [wrench.force.x for wrench in message.wrench] == [1.0, 0.0]


@pytest.mark.parametrize('message_type, text, error', [
    (TwistStamped, '{header: ', "'{header: ' is not YAML: "),
    (TwistStamped, '7', 'the message is 7; allowed: a mapping of fields'),
    (TwistStamped, '{twist: [1]}', 'twist is [1]; allowed: a mapping of fields'),
    (TwistStamped, '{twist: {linaer: {x: 1}}}',
     "there is no field 'twist.linaer'; allowed: linear, angular"),
    (TwistStamped, '{twist: {linear: {x: fast}}}', "twist.linear.x is 'fast'; allowed: a number"),
    (TwistStamped, '{twist: {linear: {x: }}}', 'twist.linear.x is None; allowed: a number'),
    (TwistStamped, '{twist: {linear: {x: true}}}', 'twist.linear.x is True; allowed: double'),
    (TwistStamped, '{header: {stamp: {nanosec: -1}}}',
     'header.stamp.nanosec is -1; allowed: uint32'),
    (TwistStamped, '{header: {frame_id: }}', 'header.frame_id is None; allowed: string'),
    (Imu, '{orientation_covariance: [1, 2]}',
     'orientation_covariance is [1, 2]; allowed: double[9]'),
    (PointCloud2, '{data: [1, 256]}', 'data is [1, 256]; allowed: sequence<uint8>'),
    (PointCloud2, '{data: [a]}', "data is ['a']; allowed: sequence<uint8>"),
    (MultiDOFJointState, '{joint_names: a}', "joint_names is 'a'; allowed: a list"),
    (MultiDOFJointState, '{wrench: [{}, {forces: {}}]}', "there is no field 'wrench[1].forces'")])
def test_text_that_is_no_message_is_refused_in_one_line(message_type, text, error):
    with pytest.raises(VerbError, match=re.escape(error)) as refusal:
        from_yaml(message_type, text)
    assert '\n' not in str(refusal.value)


def test_message_is_shown_as_ros2_shows_it():
    # by the rules of rosidl_runtime_py.message_to_yaml: fields in the order of the definition, a
    # byte as the character of that number, arrays by type and length if they are not wanted
    status = DiagnosticStatus(level=b'\x01', name='a', values=[KeyValue(key='k', value='1.5')])
    assert to_yaml(status) == (
        'level: "\\x01"\nname: a\nmessage: \'\'\nhardware_id: \'\'\n'
        "values:\n- key: k\n  value: '1.5'\n")
    assert "values: '<sequence type: diagnostic_msgs/msg/KeyValue, length: 1>'\n" in to_yaml(
        status, arrays=False)


def test_long_parts_are_cut_unless_told():
    status = DiagnosticStatus(name='x' * 129, values=[KeyValue()] * 129)
    shown = yaml.safe_load(to_yaml(status))
    assert shown['name'] == 'x' * 128 + '...'
    assert len(shown['values']) == 129 and shown['values'][-1] == '...'
    whole = yaml.safe_load(to_yaml(status, longest=None))
    assert whole['name'] == status.name and len(whole['values']) == 129


@pytest.mark.parametrize('name', ['std_msgs/msg/String', 'std_msgs/String'])
def test_type_may_be_given_without_its_folder(name):
    assert interface_class('msg', name).__name__ == 'String'


@pytest.mark.parametrize('name', [
    'std_msgs', 'std_msgs/msg/Nothing', 'nothing/msg/String', 'std_srvs/srv/SetBool', '//', ''])
def test_type_that_is_not_there_is_refused(name):
    with pytest.raises(VerbError, match=re.escape(f'there is no message type {name!r}')):
        interface_class('msg', name)


def test_rate_is_that_of_the_arrivals():
    # intervals 1, 1, 2: mean 4/3, variance (1/9 + 1/9 + 4/9) / 3
    assert rate_text([0.0, 1.0, 2.0, 4.0]) == (
        'average rate: 0.750\n\tmin: 1.000s max: 2.000s std dev: 0.47140s window: 3')


# What the node tells to type

def test_node_tells_to_type_what_is_there(tmp_path, monkeypatch):
    folder = tmp_path / 'a folder' / '.venv' / 'bin'
    folder.mkdir(parents=True)
    monkeypatch.setattr(sys, 'executable', str(folder / 'python'))
    monkeypatch.setattr('shutil.which', lambda name: None)
    assert announcement.ros2_command() == 'ros2'
    (folder / 'rigid_sim_ros2').touch()
    monkeypatch.chdir(tmp_path / 'a folder')
    assert announcement.ros2_command() == os.path.join('.venv', 'bin', 'rigid_sim_ros2')
    monkeypatch.chdir('/')
    assert announcement.ros2_command() == str(folder / 'rigid_sim_ros2')[1:]
    monkeypatch.setattr('shutil.which', lambda name: f'/opt/ros/jazzy/bin/{name}')
    assert announcement.ros2_command() == 'ros2'


@pytest.mark.parametrize('name', [
    'cube_1', "Bob's cube", 'yes', 'y', 'null', '1e3', '{a: b}', 'a "b" \\', 'Würfel', '#1',
    '\U0001f3b2', '$HOME `date`'])
def test_commands_the_node_offers_name_the_body_whatever_it_is_called(name):
    for line in announcement.examples('ros2', str, [name]):
        program, topic, pub, once, where, what, text = shlex.split(line)
        assert from_yaml(TwistStamped if 'vel' in where else Vector3Stamped,
                         text).header.frame_id == name
    assert '"' not in announcement.examples('ros2', str, ['cube_1'])[0]


def test_commands_the_node_offers_push_let_go_and_throw(process, command, patient):
    names = [body.name for body in load_scene(SCENE).bodies]
    push, let_go, throw = announcement.examples(
        '/a folder/rigid_sim_ros2', lambda name: name.replace('~', '/rigid_sim'), names)
    with Client(process) as client:
        received = client.listen('~/states')

        def carry_out(line, seen):
            program, *arguments = shlex.split(line)
            assert program == '/a folder/rigid_sim_ros2'
            assert 'publishing #1: geometry_msgs.msg.' in output(command(shlex.join(arguments)))
            client.spin_until(lambda: received and seen(received[-1]), line)

        carry_out(push, lambda message: message.wrench[-1].force.x == 8.0)
        carry_out(let_go, lambda message: message.wrench[-1].force.x == 0.0)
        carry_out(throw, lambda message: message.twist[0].linear.z == 3.0)
    # the first body has neither force nor torque, so that it keeps what was commanded
    assert (received[-1].twist[0].linear.z, received[-1].twist[0].angular.x) == (3.0, 5.0)


# Topics

def listed(command, line, expected):
    """Return the lines of a list, as soon as it has what is expected: it may come too early."""
    deadline = time.monotonic() + PATIENCE
    while not expected <= set(lines := output(command(line)).splitlines()):
        assert time.monotonic() < deadline, lines
    return lines


def test_topics_services_and_nodes_are_listed(command):
    topics = listed(command, 'topic list -t', {
        f'{row.name.replace("~", "/rigid_sim")} [{row.type_name}]'
        for row in (*PUBLISHED, *COMMANDS) if row.name != '/tf'})
    assert topics == sorted(topics)
    assert not [line for line in topics if '_rigid_sim_ros2' in line]
    listed(command, 'service list', {
        row.name.replace('~', '/rigid_sim') for row in SERVICES})
    assert listed(command, 'node list', {'/rigid_sim'}) == ['/rigid_sim']


def test_latched_text_is_printed_whole(command, patient):
    text = output(command('topic echo --once rigid_sim/scene --field data'))
    assert text.endswith('\n---\n')
    assert load_scene(yaml.safe_load(text[:-4])) == load_scene(SCENE)


def test_message_of_a_best_effort_publisher_is_printed(command, patient):
    shown = yaml.safe_load(output(command('topic echo --once /clock'))[:-4])
    assert set(shown) == {'clock'} and set(shown['clock']) == {'sec', 'nanosec'}


def test_users_of_a_topic_are_counted(command):
    text = 'Type: geometry_msgs/msg/TwistStamped\nPublisher count: 0\nSubscription count: 1\n'
    listed(command, 'topic info /rigid_sim/cmd_vel', set(text.splitlines()))


def test_message_is_published_so_many_times_and_so_often(process, command, patient):
    with Client(process) as client:
        received = client.listen('~/poses')
        start = time.monotonic()
        text = output(command('topic pub -t 3 -r 5 /rigid_sim/poses geometry_msgs/PoseArray '
                              "'{header: {frame_id: mine}}'"))
        assert time.monotonic() - start >= 2 / 5

        def count():
            return [message.header.frame_id for message in received].count('mine')

        client.spin_until(lambda: count() >= 3, 'the messages')
        client.spin(0.2)
    assert re.findall(r'publishing #(\d)', text) == ['1', '2', '3']
    assert count() == 3


# Services and parameters

def test_services_are_called(command, patient):
    def call(name, request):
        text = output(command(f'service call /rigid_sim/{name} std_srvs/srv/{request}'))
        return float(re.search(r"success=True, message='\w+ at (\d+\.\d+) s'", text)[1])

    paused = call('pause', "SetBool '{data: true}'")
    stepped = call('step', 'Trigger')
    assert call('pause', "SetBool '{data: false}'") == stepped
    assert stepped == pytest.approx(paused + 0.01, abs=1e-9)


def test_parameters_are_read_and_set(command, patient):
    assert '  real_time_factor\n' in output(command('param list /rigid_sim'))
    assert output(command('param set /rigid_sim step_duration 0.02')) == (
        'Set parameter successful\n')
    assert output(command('param get /rigid_sim step_duration')) == 'Double value is: 0.02\n'
    output(command('param set /rigid_sim step_duration 0.01'))
    assert output(command('param get /rigid_sim scene')) == f'String value is: {SCENE}\n'


# What goes wrong

@pytest.mark.parametrize('line, error', [
    ('topic echo /rigid_sim/pose',
     "there is no topic '/rigid_sim/pose'; near names: /rigid_sim/poses"),
    ('service call /rigid_sim/stop std_srvs/srv/Trigger',
     "there is no service '/rigid_sim/stop'; near names: /rigid_sim/step"),
    ('param get /rigid_simm scene', "there is no node '/rigid_simm'; near names: /rigid_sim")])
def test_what_is_not_there_is_one_line_with_near_names_and_exit_code_1(command, line, error):
    deadline = time.monotonic() + PATIENCE
    while True:
        code, out, errors = command(line)
        assert (code, out) == (1, '')
        assert re.fullmatch('rigid_sim_ros2: there is no .*\n', errors)
        # under load the command may have given up before all were found
        if errors.startswith(f'rigid_sim_ros2: {error}'):
            return
        assert time.monotonic() < deadline, errors


@pytest.mark.parametrize('line, error', [
    ('topic echo /rigid_sim/poses --field header.frame',
     "there is no field 'header.frame': 'frame' is not one of stamp, frame_id"),
    (f'topic pub --once /rigid_sim/cmd_force {TWIST} "{{}}"',
     f"topic '/rigid_sim/cmd_force' has the type geometry_msgs/msg/Vector3Stamped, not {TWIST}"),
    ('topic pub --once /rigid_sim/cmd_vel nothing/Twist', 'there is no message type .nothing/T'),
    ('service call /rigid_sim/pause std_srvs/srv/Trigger',
     "service '/rigid_sim/pause' has the type std_srvs/srv/SetBool, not std_srvs/srv/Trigger"),
    ('service call /rigid_sim/pause std_srvs/srv/Pause', 'there is no service type'),
    ('param get /rigid_sim scenes', "node /rigid_sim has no parameter 'scenes'"),
    ('param set /rigid_sim real_time_factor 101.0', 'Setting parameter failed: .*real_time_fac'),
    ('param set /rigid_sim scene tower', 'Setting parameter failed: .*read-only.*scene')])
def test_what_is_refused_is_one_line_and_exit_code_1(command, patient, line, error):
    code, out, errors = command(line)
    assert (code, out) == (1, '')
    assert re.fullmatch(f'rigid_sim_ros2: {error}.*\n', errors), errors


def test_message_that_nobody_takes_is_one_line_and_exit_code_1(command, monkeypatch):
    # long enough to find the node on a busy machine
    monkeypatch.setattr(f'{GRAPH}.PATIENCE', 4.0)
    code, out, error = command('topic pub --once /rigid_sim/states '
                               'sensor_msgs/msg/MultiDOFJointState')
    assert (code, out) == (1, 'Waiting for at least 1 matching subscription(s)...\n')
    assert error == 'rigid_sim_ros2: nobody subscribes to /rigid_sim/states\n'


def test_empty_domain_is_told(command, monkeypatch):
    monkeypatch.setenv('ROS_DOMAIN_ID', '0')
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'OFF')
    monkeypatch.setattr(f'{GRAPH}.PATIENCE', 0.3)
    code, _, error = command('topic hz /rigid_sim/poses')
    assert code == 1
    assert error.startswith("rigid_sim_ros2: there is no topic '/rigid_sim/poses', and no node")
    assert 'ROS_DOMAIN_ID (0)' in error and len(error.splitlines()) == 1


@pytest.fixture
def started(process):
    """Return a function that starts a command as a process of its own, which is killed in time."""
    children, timers = [], []

    def start(line):
        root = Path(__file__).resolve().parents[2]
        child = subprocess.Popen(
            [sys.executable, '-m', 'rigid_sim_ros.nodes.ros2_command', *shlex.split(line)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, 'ROS_DOMAIN_ID': str(process.domain_id), 'PYTHONPATH': str(root)})
        children.append(child)
        timers.append(threading.Timer(PATIENCE, child.kill))
        timers[-1].start()
        return child

    yield start
    for child, timer in zip(children, timers):
        timer.cancel()
        child.kill()
        child.wait()
        child.stdout.close()
        child.stderr.close()


def test_interrupt_ends_it_quietly(started):
    child = started('topic hz /rigid_sim/poses')
    assert child.stdout.readline().startswith('average rate: ')
    child.send_signal(signal.SIGINT)
    assert child.wait() == 0
    assert child.stderr.read() == ''


def test_reader_that_goes_away_ends_it_quietly(started):
    child = started('topic echo /rigid_sim/poses --field header')
    assert child.stdout.readline() == 'stamp:\n'
    child.stdout.close()
    assert child.wait() == 0
    assert child.stderr.read() == ''
