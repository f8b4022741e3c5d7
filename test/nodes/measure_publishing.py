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
What publishing costs: the node's share of a core, beside that of publishing bytes alone.

    python test/nodes/measure_publishing.py [DURATION]

Cubes drift without touching, and a reliable subscriber in another process (this one) reads their
poses. The other figure is that of a process which does nothing but publish the same number of
bytes as often. Both are of so many seconds [s] (5) of wall time, a state's processor time times
the rate; on a machine that is busy compare them with each other only. A state is on time if it
comes within a millisecond of when it should, counted from the tenth of the states that are the
earliest.
"""

from contextlib import contextmanager
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time

from node_harness import NodeProcess, PATIENCE, ROOT
import numpy as np
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rigid_sim_ros.messages import decode_pose_array, PoseArrayEncoder
from rigid_sim_ros.nodes.executors import AUTO, make_executor
from rigid_sim_ros.nodes.interfaces import interface
from rigid_sim_ros.topics import resolve

CASES = (((5, 2, 1), 100.0), ((10, 10, 10), 1000.0), ((25, 20, 20), 100.0))
"""Counts of cubes along x, y and z, and states a second [Hz]."""

SCENE = """
gravity: [0, 0, 0]
bodies:
  - {{name: cube, cube: {{edge: 0.2}}, mass: 1.0, velocity: [0.3, 0.2, 0.1],
     angular_velocity: [0.7, -1.1, 1.6], repeat: {{count: {count}, spacing: [0.5, 0.5, 0.5]}}}}
"""

POSES, TYPE = resolve('~/poses'), 'geometry_msgs/msg/PoseArray'

ON_TIME = 1e-3
"""[s]"""

DEPTH = 100
"""
Of the queues of node and subscriber: a tenth of a second at 1 kHz. A machine with other things to
do leaves a process waiting for longer than the 10 ms of queues of ten.
"""


class Reader:
    """Reads poses from a domain."""

    def __init__(self, domain_id):
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain_id)
        self._node = Node('reader', context=self._context)
        self._executor, _ = make_executor(AUTO, self._context)
        self._executor.add_node(self._node)
        self._node.create_subscription(
            interface(TYPE), POSES, self._receive, QoSProfile(depth=DEPTH), raw=True)
        self._times, self._stamps = [], []

    def close(self):
        """Leave the domain."""
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)

    def wait(self):
        """Wait for the first message."""
        deadline = time.monotonic() + PATIENCE
        while not self._times:
            assert time.monotonic() < deadline, f'waited in vain for {POSES}'
            self._executor.spin_once(timeout_sec=0.05)

    def read(self, duration):
        """Return the stamps and the times of arrival [s] of what comes within a duration [s]."""
        self._times.clear(), self._stamps.clear()
        end = time.monotonic() + duration
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.05)
        return np.array(self._stamps) / 1e9, np.array(self._times)

    def _receive(self, data):
        self._times.append(time.monotonic())
        self._stamps.append(decode_pose_array(data).time_ns)


def processor_time(pid):
    """Return the processor time [s] of all threads of a process so far."""
    return sum(int(Path(task, 'schedstat').read_text().split()[0])
               for task in Path(f'/proc/{pid}/task').iterdir()) / 1e9


def measure(pid, domain_id, duration):
    """Return the processor time [s] a state of a publishing process, and what `read` returns."""
    reader = Reader(domain_id)
    try:
        reader.wait()
        reader.read(1.0)
        before = processor_time(pid)
        stamps, times = reader.read(duration)
        return (processor_time(pid) - before) / len(times), stamps, times
    finally:
        reader.close()


def publish_alone(count, rate):
    """Publish as many bytes as poses of so many bodies take, for ever."""
    rclpy.init()
    publisher = Node('rigid_sim').create_publisher(interface(TYPE), POSES, DEPTH)
    data = PoseArrayEncoder('world', count).encode(0, np.zeros((count, 3)), np.zeros((count, 4)))
    start, number = time.monotonic(), 0
    while True:
        number += 1
        time.sleep(max(0.0, start + number / rate - time.monotonic()))
        publisher.publish(data)


def measure_node(count, rate, duration):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'drift.yaml'
        path.write_text(SCENE.format(count=list(count)))
        depth = {f'qos_overrides.{POSES}.publisher.depth': DEPTH}
        with NodeProcess(folder, scene=path, publish_rate=rate, **depth) as process:
            return measure(process.process.pid, process.domain_id, duration)


@contextmanager
def alone(script, counts, rate):
    """Run a script's part for bytes of poses of so many cubes alone; give its domain."""
    domain_id = os.getpid() % 100 + 1
    process = subprocess.Popen(
        [sys.executable, script, 'alone', str(np.prod(counts)), str(rate)],
        env={**os.environ, 'ROS_DOMAIN_ID': str(domain_id), 'PYTHONPATH': str(ROOT)})
    try:
        yield process.pid, domain_id
    finally:
        process.kill()
        process.wait()


def measure_alone(counts, rate, duration):
    with alone(__file__, counts, rate) as (pid, domain_id):
        return measure(pid, domain_id, duration)[0]


def main(duration):
    """Print a table."""
    print('| cubes | states [Hz] | node, of a core | bytes alone | lost | on time |')
    print('| --- | --- | --- | --- | --- | --- |')
    for count, rate in CASES:
        cost, stamps, times = measure_node(count, rate, duration)
        alone = measure_alone(count, rate, duration)
        lateness = times - stamps
        on_time = lateness <= np.percentile(lateness, 10) + ON_TIME
        lost = round((stamps[-1] - stamps[0]) * rate) + 1 - len(stamps)
        print(f'| {np.prod(count)} | {rate:g} | {cost * rate:.1%} | {alone * rate:.1%} | {lost} | '
              f'{on_time.mean():.2%} |', flush=True)


if __name__ == '__main__':
    if sys.argv[1:2] == ['alone']:
        publish_alone(int(sys.argv[2]), float(sys.argv[3]))
    else:
        os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
        main(float(sys.argv[1]) if sys.argv[1:] else 5.0)
