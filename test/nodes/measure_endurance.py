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
Whether a node can run on and on: its memory by the minute, and the states that got lost.

    python test/nodes/measure_endurance.py [MINUTES]

Ten cubes drift at 1 kHz for so many minutes (30), while a subscriber reads their poses and pushes
one of them a hundred times a second. Each line tells what the node's memory is beyond that at the
end of the first minute, and how many states did not come.
Whoever joins the node's domain leaves a little in every process there, so nobody else should.
"""

import os
from pathlib import Path
import sys
import tempfile
import time

from measure_stages import drifting
from node_harness import Client, NodeProcess
from rigid_sim_ros.messages import decode_pose_array

RATE = 1000
"""States a second [Hz]."""

COMMAND_RATE = 100
"""Commands a second [Hz]."""

DEPTH = 1000
"""Of the queues: a second of states."""

MINUTE = 60.0


class Stream:
    """What has come of a stream of states."""

    def __init__(self):
        self.count = 0
        self.first = self.last = None
        """Stamps [ns]."""

    def take(self, data):
        """Take a message."""
        self.last = decode_pose_array(data).time_ns
        if self.first is None:
            self.first = self.last
        self.count += 1

    @property
    def lost(self):
        """Return how many states did not come between the first and the last."""
        return (self.last - self.first) * RATE // 10 ** 9 + 1 - self.count


def resident_memory(pid):
    """Return the memory [KiB] of a process that is in use."""
    status = Path(f'/proc/{pid}/status').read_text()
    return int(status.split('VmRSS:')[1].split()[0])


def push(client, received, stream, duration):
    """Send commands and take states for a wall time [s]."""
    start, number = time.monotonic(), 0
    while time.monotonic() < start + duration:
        number += 1
        client.command('~/cmd_force', f'cube_{number % 10 + 1}',
                       vector=(1e-3 * (number % 7 - 3), 0, 0))
        client.spin(start + number / COMMAND_RATE - time.monotonic())
        for data in received:
            stream.take(data)
        received.clear()


def main(minutes):
    """Print a table."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'drift.yaml'
        path.write_text(drifting((5, 2, 1)))
        depth = {'qos_overrides./rigid_sim/poses.publisher.depth': DEPTH}
        with NodeProcess(folder, scene=path, publish_rate=float(RATE), **depth) as process, \
                Client(process) as client:
            stream = Stream()
            received = client.listen('~/poses', DEPTH, raw=True)
            push(client, received, stream, MINUTE)
            memory = resident_memory(process.process.pid)
            begin, first = time.monotonic(), stream.last
            print('| minute | memory [KiB] | real-time factor | lost |')
            print('| --- | --- | --- | --- |')
            for minute in range(1, minutes):
                push(client, received, stream, MINUTE)
                factor = (stream.last - first) / 1e9 / (time.monotonic() - begin)
                print(f'| {minute + 1} | {resident_memory(process.process.pid) - memory:+} | '
                      f'{factor:.5f} | {stream.lost} |', flush=True)
            print(process.error)


if __name__ == '__main__':
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    main(int(sys.argv[1]) if sys.argv[1:] else 30)
