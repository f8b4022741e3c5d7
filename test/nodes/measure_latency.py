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
How long a command takes to show: from its publication to the first pose that is not as before.

    python test/nodes/measure_latency.py [COUNT]

Cubes drift without touching; so many times (300), at random moments, another process (this one)
gives one of them another velocity and waits for the pose that shows it. States are published once
a period, so half of one is the least there can be on average. The other figures are those of a
process that has nothing to compute: it changes a number in as many bytes.
"""

import itertools
import os
from pathlib import Path
import sys
import tempfile
import time

from geometry_msgs.msg import TwistStamped
from measure_publishing import alone, CASES, DEPTH, POSES, Reader, SCENE, TYPE
from node_harness import NodeProcess, PATIENCE
import numpy as np
import rclpy
from rclpy.node import Node
from rigid_sim_ros.messages import decode_pose_array, PoseArrayEncoder
from rigid_sim_ros.nodes.executors import AUTO, make_executor
from rigid_sim_ros.nodes.interfaces import interface
from rigid_sim_ros.topics import resolve

ALLOWED = 2e-3
"""Beyond a period [s], for the way there and back."""

FIRST_SPEED = 0.3
SPEEDS = -1.0, -2.0
"""Along x [m/s]: that of the scene, and those commanded, in turn: away from all others."""

PAUSES = 0.02, 0.05
"""Shortest and longest wait between two commands [s]."""

SHOWN = 1e-6
"""Distance [m] from where the cube would be without the command."""


class Commander(Reader):
    """Commands the first of the cubes and watches where it goes."""

    def __init__(self, domain_id):
        super().__init__(domain_id)
        self._publisher = self._node.create_publisher(TwistStamped, resolve('~/cmd_vel'), 10)
        self._speed = FIRST_SPEED
        self._latest = None

    def connect(self):
        """Wait until commands arrive and poses come."""
        self.spin_until(self._publisher.get_subscription_count)
        self.spin_until(lambda: self._latest)
        self.spin(1.0)

    def spin(self, duration):
        """Take messages for a wall time [s]."""
        end = time.monotonic() + duration
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.002)

    def spin_until(self, condition):
        """Take messages until a condition holds."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, 'waited in vain for the node'
            self._executor.spin_once(timeout_sec=0.05)

    def latency(self, name, speed):
        """Return how long [s] a cube of a name, the first, takes to be seen at a speed [m/s]."""
        message = TwistStamped()
        message.header.frame_id, message.twist.linear.x = name, speed
        _, start, place = self._latest

        def shown():
            _, now, x = self._latest
            return abs(x - place - self._speed * (now - start)) > SHOWN

        sent = time.monotonic()
        self._publisher.publish(message)
        self.spin_until(shown)
        self._speed = speed
        return self._latest[0] - sent

    def _receive(self, data):
        """Note when a state came [s], its time [s] and where the first cube is [m]."""
        arrival, poses = time.monotonic(), decode_pose_array(data)
        self._latest = arrival, poses.time_ns / 1e9, float(poses.position[0, 0])


def latencies(domain_id, repetitions):
    """Return those [s] of so many commands to what publishes poses in a domain."""
    random = np.random.default_rng(1)
    commander = Commander(domain_id)
    try:
        commander.connect()
        found = []
        for number in range(repetitions):
            commander.spin(random.uniform(*PAUSES))
            found.append(commander.latency('cube_0', SPEEDS[number % 2]))
        return np.array(found)
    finally:
        commander.close()


def measure_node(counts, rate, repetitions):
    """Return the latencies [s] of the node."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'drift.yaml'
        path.write_text(SCENE.format(count=list(counts)))
        with NodeProcess(folder, scene=path, publish_rate=rate) as process:
            return latencies(process.domain_id, repetitions)


def answer_alone(count, rate):
    """Publish as many bytes as poses of so many bodies take, changed by each command, for ever."""
    rclpy.init()
    node = Node('rigid_sim')
    executor, _ = make_executor(AUTO)
    executor.add_node(node)
    publisher = node.create_publisher(interface(TYPE), POSES, DEPTH)
    encoder, position = PoseArrayEncoder('world', count), np.zeros((count, 3))

    def change(_):
        position[0, 0] += 1.0

    node.create_subscription(TwistStamped, resolve('~/cmd_vel'), change, 10)
    start = time.monotonic()
    for number in itertools.count(1):
        data = encoder.encode(0, position, np.zeros((count, 4)))
        publisher.publish(data)
        while (left := start + number / rate - time.monotonic()) > 0.0:
            executor.spin_once(timeout_sec=left)


def main(repetitions):
    """Print a table."""
    print('| cubes | states [Hz] | median, 99 % [ms] | within a period and 2 ms | '
          'bytes alone: median, 99 % [ms] | within |')
    print('| --- | --- | --- | --- | --- | --- |')
    for counts, rate in CASES:
        print(f'| {np.prod(counts)} | {rate:g} |', end='')
        with alone(__file__, counts, rate) as (_, domain_id):
            least = latencies(domain_id, repetitions)
        for found in measure_node(counts, rate, repetitions), least:
            median, most = np.percentile(found, (50, 99)) * 1e3
            print(f' {median:.2f}, {most:.2f} | {np.mean(found <= 1 / rate + ALLOWED):.1%} |',
                  end='')
        print(flush=True)


if __name__ == '__main__':
    if sys.argv[1:2] == ['alone']:
        answer_alone(int(sys.argv[2]), float(sys.argv[3]))
    else:
        os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
        main(int(sys.argv[1]) if sys.argv[1:] else 300)
