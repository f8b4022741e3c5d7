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

"""Recording by the node, read back with a reader that is not ours."""

from datetime import datetime, timedelta
import os
import signal

import numpy as np
from numpy.testing import assert_array_equal
import pytest

pytest.importorskip('rclpy')
rosbag2 = pytest.importorskip('rosbags.rosbag2')

from node_harness import Client, CROWD, nanoseconds, NodeProcess  # noqa: E402, I100
from rclpy.serialization import deserialize_message  # noqa: E402
from rigid_sim_ros import recording  # noqa: E402
from rigid_sim_ros.bag_tools import replay  # noqa: E402
from rigid_sim_ros.nodes.interfaces import interface  # noqa: E402
from rigid_sim_ros.nodes.playback import Playback  # noqa: E402

MILLISECOND = 1_000_000
POSES = 'geometry_msgs/msg/PoseArray'


def messages_of(path, topic):
    """Return (time [ns], message, bytes) of a topic, deserialised by rclpy."""
    with rosbag2.Reader(path) as reader:
        connections = [row for row in reader.connections if row.topic == topic]
        return [(time, deserialize_message(data, interface(connection.msgtype)), data)
                for connection, time, data in reader.messages(connections)]


def path_in(text):
    return text.split(' to ')[-1].strip()


@pytest.mark.parametrize('signals', [(signal.SIGINT, signal.SIGINT), (signal.SIGTERM,)])
def test_recording_is_what_was_published_and_complete(tmp_path, signals):
    (tmp_path / 'crowd.yaml').write_text(CROWD)
    with NodeProcess(tmp_path, scene='crowd.yaml', record=True, record_path=tmp_path / 'bag',
                     start_paused=True) as process, Client(process) as client:
        received = client.listen('~/poses', raw=True)
        assert client.call('~/pause', data=False).success
        client.command('~/cmd_vel', 'cube_3', linear=(0, 0, 2))
        client.spin_until(lambda: len(received) >= 40, 'forty states')
        code, duration = process.stop(*signals, gap=0.01)
        assert (code, duration < 2.0) == (0, True), process.error
        assert 'recorded' in process.error.splitlines()[-1]
        client.spin(0.1)
    poses = messages_of(tmp_path / 'bag', '/rigid_sim/poses')
    times = [time for time, *_ in poses]
    # every state from the first to the last, none twice, stamped with its simulated time
    assert times == [10 * MILLISECOND * number for number in range(len(poses))]
    assert [nanoseconds(message) for _, message, _ in poses] == times
    # byte for byte what subscribers got; they may miss the state shown before they came
    recorded = {bytes(data) for *_, data in poses}
    assert len(recorded) == len(poses)
    assert len(received) >= 40
    assert all(bytes(data) in recorded for data in received)
    # the command, with the simulated time at which it took effect
    (time, message, _), = messages_of(tmp_path / 'bag', '/rigid_sim/cmd_vel')
    assert (message.header.frame_id, message.twist.linear.z) == ('cube_3', 2.0)
    assert time in times
    scene, = messages_of(tmp_path / 'bag', '/rigid_sim/scene')
    assert 'cube_10' in scene[1].data


@pytest.mark.parametrize('count', [3, pytest.param(100, marks=pytest.mark.stress)])
def test_a_node_killed_at_any_moment_loses_no_more_than_the_last_second(tmp_path, capsys, count):
    (tmp_path / 'crowd.yaml').write_text(CROWD)
    generator = np.random.default_rng(7)
    # of a hundred nodes some share their domain with those of other tests
    name = f'killed_{os.getpid()}'
    for number in range(count):
        bag = tmp_path / f'bag_{number}'
        with NodeProcess(
                tmp_path / f'node_{number}', ['--ros-args', '-r', f'__node:={name}', '--'],
                scene=tmp_path / 'crowd.yaml', record=True,
                record_path=bag) as process, Client(process, f'/{name}') as client:
            received = client.listen('~/poses', raw=True)
            # the topics are there a moment before the bag is
            process.wait_for_text('recording to ')
            client.spin(float(generator.uniform(0.0, 3.0)))
            process.process.kill()
            process.wait()
            client.spin(0.1)
        found = recording.read(bag)
        assert not found.finished
        # from the first state on with no gap, but for a second and what a busy machine takes
        times = found.time_ns.tolist()
        assert times == [10 * MILLISECOND * step for step in range(len(times))]
        published = {nanoseconds(deserialize_message(data, interface(POSES))): bytes(data)
                     for data in received}
        assert max(published, default=0) - max(times, default=0) < 1500 * MILLISECOND
        recording.recover(bag)
        assert recording.read(bag).time_ns.tolist() == times
        if times:
            recorded = messages_of(bag, f'/{name}/poses')
            assert [time for time, *_ in recorded] == times
            assert all(data == published.get(time, data) for time, _, data in recorded)
            assert replay.main([str(bag)]) == 0, capsys.readouterr()


def test_recording_can_be_switched_and_never_replaces_another(tmp_path):
    (tmp_path / 'crowd.yaml').write_text(CROWD)
    with NodeProcess(tmp_path, scene='crowd.yaml', record_path='bag') as process, \
            Client(process) as client:
        poses = client.listen('~/poses')
        client.spin_until(lambda: poses, 'a state')
        assert not client.call('~/record', data=False).success
        (tmp_path / 'bag').mkdir()
        refused = client.call('~/record', data=True)
        assert not refused.success and 'is there already' in refused.message
        (tmp_path / 'bag').rmdir()
        first = client.call('~/record', data=True)
        assert first.success and path_in(first.message) == str(tmp_path / 'bag')
        again = client.call('~/record', data=True)
        assert not again.success and 'already recording' in again.message
        count = len(poses)
        client.spin_until(lambda: len(poses) > count + 20, 'twenty states')
        ended = client.call('~/record', data=False)
        assert ended.success and path_in(ended.message) == str(tmp_path / 'bag')
        second = client.call('~/record', data=True)
        assert second.success and path_in(second.message) == str(tmp_path / 'bag_2')
        count = len(poses)
        client.spin_until(lambda: len(poses) > count + 5, 'five states')
        assert process.stop(signal.SIGINT)[0] == 0
    for name, least in (('bag', 20), ('bag_2', 5)):
        recorded = messages_of(tmp_path / name, '/rigid_sim/poses')
        assert len(recorded) >= least
        steps = np.diff([time for time, *_ in recorded])
        assert_array_equal(steps, 10 * MILLISECOND)
        # each begins with the scene, for whoever opens it alone
        assert len(messages_of(tmp_path / name, '/rigid_sim/scene')) == 1


def test_topics_of_other_names_are_read_replayed_and_played_as_what_they_are(tmp_path, capsys):
    (tmp_path / 'crowd.yaml').write_text(CROWD)
    names = {'poses': 'where', 'states': 'all/poses', 'cmd_vel': 'poses', 'journal': 'diary'}
    remapping = [word for own, other in names.items() for word in ('-r', f'~/{own}:=/{other}')]
    with NodeProcess(tmp_path, ['--ros-args', *remapping, '--'], scene='crowd.yaml', record=True,
                     record_path='bag') as process, Client(process) as client:
        publisher = client.node.create_publisher(
            interface('geometry_msgs/msg/TwistStamped'), '/poses', 10)
        client.spin_until(publisher.get_subscription_count, 'a subscriber of /poses')
        message = interface('geometry_msgs/msg/TwistStamped')()
        message.header.frame_id, message.twist.linear.z = 'cube_3', 2.0
        received = []
        client.node.create_subscription(
            interface('sensor_msgs/msg/MultiDOFJointState'), '/all/poses', received.append, 10)
        client.spin_until(lambda: received, 'a state')
        publisher.publish(message)
        client.spin_until(lambda: received[-1].twist[2].linear.z > 1.0, 'the command')
        assert process.stop(signal.SIGINT)[0] == 0
    recorded = recording.read(tmp_path / 'bag')
    assert recorded.linear_velocity[-1, 2, 2] > 1.0 > recorded.linear_velocity[0, 2, 2]
    assert [command.topic for command in recorded.commands] == ['/diary', '/poses']
    assert replay.main([str(tmp_path / 'bag')]) == 0
    assert capsys.readouterr().out.startswith('identical: ')
    played = set(Playback(str(tmp_path / 'bag')).topics)
    assert {'/where', '/all/poses'} <= played and not played & {'/poses', '/diary'}


def test_recording_is_split_after_so_long(tmp_path):
    (tmp_path / 'crowd.yaml').write_text(CROWD)
    with NodeProcess(tmp_path, scene='crowd.yaml', record=True, record_path='bag',
                     record_split_duration=0.2) as process, Client(process) as client:
        poses = client.listen('~/poses')
        client.spin_until(lambda: len(poses) > 50, 'fifty states')
        assert process.stop(signal.SIGINT)[0] == 0
    times = [recording.read(tmp_path / 'bag' / f'bag_{number}.mcap').time_ns.tolist()
             for number in range(2)]
    assert times == [[10 * MILLISECOND * number for number in range(first, first + 20)]
                     for first in (0, 20)]


def test_a_folder_that_was_moved_away_is_told_when_it_is_stopped(tmp_path):
    (tmp_path / 'crowd.yaml').write_text(CROWD)
    with NodeProcess(tmp_path, scene='crowd.yaml', record=True, record_path='bag') as process, \
            Client(process) as client:
        process.wait_for_text('recording to ')
        poses = client.listen('~/poses')
        client.spin_until(lambda: len(poses) > 10, 'ten states')
        (tmp_path / 'bag').rename(tmp_path / 'moved')
        ended = client.call('~/record', data=False)
        assert not ended.success and 'No such file or directory' in ended.message
        assert process.running
    # the file itself is whole
    assert len(recording.read(tmp_path / 'moved').time) > 10


def test_nodes_that_begin_in_the_same_second_record_beside_each_other(tmp_path):
    (tmp_path / 'crowd.yaml').write_text(CROWD)
    (tmp_path / 'recordings').mkdir()
    # whatever the second is in which it begins, the folder is there
    now = datetime.now()
    for seconds in range(60):
        time = now + timedelta(seconds=seconds)
        (tmp_path / 'recordings' / f'crowd_{time:%Y_%m_%d-%H_%M_%S}').mkdir()
    with NodeProcess(tmp_path, scene='crowd.yaml', record=True) as process:
        process.wait_for_text('recording to ')
        assert process.stop(signal.SIGINT)[0] == 0
        path = path_in(process.error.splitlines()[-1])
    assert path.endswith('_2') and messages_of(path, '/rigid_sim/poses')


def test_path_that_exists_is_refused(tmp_path):
    (tmp_path / 'bag').mkdir()
    with NodeProcess(tmp_path, record=True, record_path='bag') as process:
        assert process.wait() == 2
        assert 'is there already' in process.error
        assert len(process.error.splitlines()) == 1
    assert os.listdir(tmp_path / 'bag') == []
