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

"""The player as a process of its own, and a real client that listens."""

from dataclasses import replace
import itertools
import os
from pathlib import Path
import random
import signal
import subprocess
import sys
import time

import pytest

rclpy = pytest.importorskip('rclpy')

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: E402
from rigid_sim_ros import messages, topics  # noqa: E402
from rigid_sim_ros.nodes import playing  # noqa: E402
from rigid_sim_ros.nodes.interfaces import interface  # noqa: E402
from rigid_sim_ros.nodes.signals import StopRequest  # noqa: E402
from rigid_sim_ros.recording import Recorder  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402

PATIENCE = 20.0
POSES, SCENE = '/rigid_sim/poses', '/rigid_sim/scene'
_domain_ids = itertools.cycle(random.SystemRandom().sample(range(1, 102), 101))


def poses(step):
    encoder = messages.PoseArrayEncoder('world', 2)
    return encoder.encode(step * 10**7, [[step, 0, 0], [0, step, 0]], [[0, 0, 0, 1]] * 2)


@pytest.fixture
def bag(tmp_path):
    rows = [replace(row, name=topics.resolve(row.name)) for row in topics.PUBLISHED]
    with Recorder(tmp_path / 'bag', rows) as recorder:
        recorder.write(SCENE, 0, messages.encode_string('the scene'))
        for step in range(100):
            recorder.write(POSES, step * 10**7, poses(step))
    return tmp_path / 'bag'


class Listener:
    """A client of a player that it starts itself."""

    def __init__(self, bag, *arguments):
        domain_id = next(_domain_ids)
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain_id)
        self.node = rclpy.create_node('listener', context=self._context)
        self._executor = rclpy.executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._clients = {}
        root = Path(__file__).resolve().parents[2]
        self.process = subprocess.Popen(
            [sys.executable, '-m', 'rigid_sim_ros.nodes.player', str(bag), *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, 'ROS_DOMAIN_ID': str(domain_id), 'PYTHONPATH': str(root)})

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.process.kill()
        self.process.communicate()
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def listen(self, name, durability='volatile'):
        row = next(row for row in topics.PUBLISHED if topics.resolve(row.name) == name)
        received = []
        self.node.create_subscription(
            interface(row.type_name), name, received.append,
            QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE if name != '/clock'
                       else ReliabilityPolicy.BEST_EFFORT,
                       durability=DurabilityPolicy[durability.upper()]), raw=True)
        return received

    def wait_for(self, condition):
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, 'waited in vain'
            self._executor.spin_once(timeout_sec=0.02)

    def client(self, kind, name):
        if name not in self._clients:
            self._clients[name] = self.node.create_client(kind, '/rigid_sim_player/' + name)
        return self._clients[name]

    def call(self, kind, name, **fields):
        client = self.client(kind, name)
        self.wait_for(client.service_is_ready)
        future = client.call_async(kind.Request(**fields))
        self.wait_for(future.done)
        return future.result()


def test_it_plays_the_recorded_bytes_under_control(bag):
    with Listener(bag, '--paused', '--clock', '--rate', '0.4') as listener:
        received, clock = listener.listen(POSES), listener.listen('/clock')
        listener.wait_for(lambda: listener.node.count_publishers(POSES) == 1
                          and listener.node.count_publishers('/clock') == 1)
        # a server that does not see yet who asks loses its answer
        for kind, name in ((Trigger, 'step'), (SetBool, 'pause')):
            listener.wait_for(listener.client(kind, name).service_is_ready)
        seen = time.monotonic() + 0.3
        listener.wait_for(lambda: time.monotonic() > seen)
        # the scene and the first poses have the same time: one step
        assert listener.call(Trigger, 'step').message == 'played 0.000000000 s'
        listener.wait_for(lambda: received)
        assert received == [poses(0)]
        # latched: it reaches whoever comes later
        scene = listener.listen(SCENE, 'transient_local')
        listener.wait_for(lambda: scene)
        assert messages.decode_string(scene[0]) == 'the scene'
        assert listener.call(SetBool, 'pause', data=False).message == 'playing'
        refused = listener.call(Trigger, 'step')
        # 100 states take 2.5 s so slowly: it is playing still
        assert not refused.success
        assert refused.message.startswith('it is playing')
        listener.wait_for(lambda: len(received) == 100)
        assert received == [poses(step) for step in range(100)]
        times = [messages.decode_clock(data) for data in clock]
        assert times == sorted(times) and times[-1] <= 990_000_000 and len(times) > 50
        assert listener.process.wait(PATIENCE) == 0


def test_a_signal_ends_it_in_order(bag):
    with Listener(bag, '--loop') as listener:
        received = listener.listen(POSES)
        listener.wait_for(lambda: len(received) > 3)
        listener.process.send_signal(signal.SIGINT)
        output, error = listener.process.communicate(timeout=PATIENCE)
        assert listener.process.returncode == 0
        assert 'Traceback' not in output + error
        assert 'messages played' in error + output


@pytest.mark.parametrize('arguments, reason', [
    (['none'], 'rigid_sim_player: cannot read'), (['none', '--rate', '0'], 'a positive number'),
    (['none', '--rate', 'fast'], "--rate: 'fast'; allowed: a positive number"),
    (['none', '--start', 'nan'], "--start: 'nan'; allowed: a number, 0 or more"),
    (['none', '--start', 'inf'], "--start: 'inf'; allowed: a number, 0 or more"),
    (['none', '--ros-args', '-p', 'x'], 'rigid_sim_player: Failed to parse ROS arguments')])
def test_mistakes_are_told_and_end_with_exit_code_2(arguments, reason, tmp_path):
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        [sys.executable, '-m', 'rigid_sim_ros.nodes.player', *arguments], cwd=tmp_path,
        capture_output=True, text=True, timeout=60, env={**os.environ, 'PYTHONPATH': str(root)})
    assert done.returncode == 2
    assert reason in done.stderr
    assert 'Traceback' not in done.stderr


def test_type_that_is_not_installed_is_told(bag, monkeypatch, capsys):
    monkeypatch.setattr(playing, 'interface', lambda name: interface(
        name.replace('geometry_msgs', 'foreign_msgs')))
    assert playing.run(['player', str(bag)], StopRequest()) == 2
    error = capsys.readouterr().err
    assert f'rigid_sim_player: {POSES} has messages of type geometry_msgs/msg/PoseArray, ' in error
    assert 'Traceback' not in error
