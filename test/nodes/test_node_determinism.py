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

"""The same commands at the same simulated times give the same bytes, however the run is driven."""

import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip('rclpy')

from node_harness import Client, CROWD, NodeProcess  # noqa: E402, I100
from rigid_sim_ros.recording import Bag  # noqa: E402

DURATION_NS = 1_500_000_000
COMMAND_COUNT = 60
DEPTH = 'qos_overrides./rigid_sim/{}.subscription.depth'

BUSY = 'import time\nend = time.monotonic() + 60\nwhile time.monotonic() < end: pass'


def command_all(client):
    """Send commands that take effect in the first second, also between states."""
    generator = np.random.default_rng(11)
    for number in range(COMMAND_COUNT):
        stamp = int(generator.integers(1, 1_000_000_000))
        body = f'cube_{generator.integers(1, 11)}'
        vector = generator.normal(size=3)
        if number % 2:
            client.command('~/cmd_vel', body, stamp, linear=vector, angular=2 * vector)
        else:
            client.command('~/cmd_force', body, stamp, vector=4 * vector)


def waiting(diagnostics):
    for status in diagnostics[-1].status if diagnostics else ():
        for value in status.values:
            if value.key == 'waiting for their time':
                return int(value.value)
    return 0


def run(folder, factor):
    """Return what a run recorded, by topic, up to a simulated time."""
    folder.mkdir()
    (folder / 'crowd.yaml').write_text(CROWD)
    depths = {DEPTH.format(name): 1000 for name in ('cmd_vel', 'cmd_force')}
    with NodeProcess(folder, scene='crowd.yaml', start_paused=True, command_timing='stamp',
                     real_time_factor=factor, record=True, record_path=folder / 'bag',
                     **depths) as process, Client(process) as client:
        diagnostics = client.listen('/diagnostics')
        command_all(client)
        client.spin_until(lambda: waiting(diagnostics) == COMMAND_COUNT, 'all commands')
        clock = client.listen('/clock', reliability='best_effort')
        assert client.call('~/pause', data=False).success
        client.spin_until(lambda: clock and clock[-1].clock.sec * 10 ** 9
                          + clock[-1].clock.nanosec >= DURATION_NS, 'the end', patience=30.0)
        assert process.stop()[0] == 0, process.error
    messages = {}
    for message in Bag(folder / 'bag').messages():
        if message.time_ns <= DURATION_NS:
            messages.setdefault(message.topic, []).append((message.time_ns, bytes(message.data)))
    return messages


def test_load_and_pace_change_no_bit(tmp_path):
    fast = run(tmp_path / 'fast', 0)
    # two processes that do nothing but take time
    load = [subprocess.Popen([sys.executable, '-c', BUSY]) for _ in range(2)]
    try:
        slow = run(tmp_path / 'slow', 1)
    finally:
        for process in load:
            process.kill()
            process.wait()
    assert fast.keys() == slow.keys()
    for topic in fast:
        assert fast[topic] == slow[topic], topic
    assert len(fast['/rigid_sim/poses']) == 151
    assert len(fast['/rigid_sim/states']) == 151
    assert len(fast['/rigid_sim/cmd_vel']) == len(fast['/rigid_sim/cmd_force']) == 30
    assert len(fast['/rigid_sim/collisions']) > 3
