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
The node as a process of its own, and a real ROS client to talk to it.

Every wait has an end: a node that hangs is killed, a message that does not come fails the test.
"""

import itertools
import os
from pathlib import Path
import random
import signal
import subprocess
import sys
import time

import numpy as np
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rigid_sim_ros.nodes.interfaces import interface
from rigid_sim_ros.topics import COMMANDS, PUBLISHED, SERVICES

ROOT = Path(__file__).resolve().parents[2]

HIGHEST_DOMAIN_ID = 101

PATIENCE = 15.0
"""Wall time [s] to wait for what takes milliseconds on an idle machine."""

TYPES = {row.name: row.type_name for row in (*PUBLISHED, *COMMANDS, *SERVICES)}
TYPES['/rosout'] = 'rcl_interfaces/msg/Log'


CROWD = """
gravity: [0, 0, 0]
material: {restitution: 0.9, friction: 0.3}
bodies:
""" + ''.join(
    f"""  - {{name: cube_{number + 1}, cube: {{edge: 0.2}}, mass: 1.0,
     position: [{0.6 * (number % 4)}, {0.6 * (number // 4)}, 0], rpy: [{number}, 0.3, 0],
     velocity: [{0.9 - 0.6 * (number % 4)}, {0.6 - 0.6 * (number // 4)}, 0],
     angular_velocity: [1, {number}, 2]}}
""" for number in range(10))
"""
Ten cubes that fly towards their middle without gravity and bounce off each other within a second.
Cheap to simulate, since nothing touches for long.
"""

_domain_ids = itertools.cycle(random.SystemRandom().sample(
    range(1, HIGHEST_DOMAIN_ID + 1), HIGHEST_DOMAIN_ID))


class NodeProcess:
    """
    The node, started with parameters; its output goes to files in a folder.

    Each has a domain of its own: one that was killed is remembered for a while by all others.
    """

    def __init__(self, folder, arguments=(), **parameters):
        self.folder = Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        ros_arguments = [*arguments, '--ros-args']
        for name, value in parameters.items():
            text = str(value).lower() if isinstance(value, bool) else str(value)
            ros_arguments += ['-p', f'{name}:={text}']
        if not parameters:
            ros_arguments = list(arguments)
        self.domain_id = next(_domain_ids)
        modules = [str(ROOT), *filter(None, [os.environ.get('PYTHONPATH')])]
        environment = {**os.environ, 'ROS_DOMAIN_ID': str(self.domain_id),
                       'PYTHONPATH': os.pathsep.join(modules)}
        with open(self.folder / 'out', 'w') as out, open(self.folder / 'error', 'w') as error:
            self.process = subprocess.Popen(
                [sys.executable, '-m', 'rigid_sim_ros.nodes.simulation_node', *ros_arguments],
                stdout=out, stderr=error, cwd=self.folder, env=environment,
                start_new_session=True)

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        if self.running:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait(PATIENCE)

    @property
    def running(self):
        """Whether it has not ended."""
        return self.process.poll() is None

    @property
    def output(self):
        """Return what it printed to stdout so far."""
        return (self.folder / 'out').read_text(errors='replace')

    @property
    def error(self):
        """Return what it printed to stderr so far; the log goes there too."""
        return (self.folder / 'error').read_text(errors='replace')

    def wait_for_text(self, text):
        """Wait until the node has printed a text."""
        deadline = time.monotonic() + PATIENCE
        while text not in self.error + self.output:
            assert self.running, f'the node ended:\n{self.error}{self.output}'
            assert time.monotonic() < deadline, f'no {text!r} in\n{self.error}{self.output}'
            time.sleep(0.01)

    def wait(self, patience=PATIENCE):
        """Wait until the node has ended by itself, and return its exit code."""
        return self.process.wait(patience)

    def stop(self, *signals, gap=0.0):
        """Send signals, and return the exit code and the wall time [s] from first to end."""
        start = time.monotonic()
        for number in signals or (signal.SIGINT,):
            self.process.send_signal(number)
            time.sleep(gap)
        code = self.process.wait(PATIENCE)
        return code, time.monotonic() - start


class Client:
    """
    A node that listens to, commands and calls the simulation under test.

    If a `NodeProcess` is given, a wait fails as soon as that has ended.
    """

    def __init__(self, process=None, name='/rigid_sim'):
        self.name = name
        self._process = process
        self._context = Context()
        rclpy.init(context=self._context, domain_id=process.domain_id if process else None)
        self.node = Node('test_client', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._publishers = {}
        self._clients = {}

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def spin(self, duration):
        """Take messages for some wall time [s]."""
        end = time.monotonic() + duration
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)

    def spin_until(self, condition, what='it', patience=PATIENCE):
        """Take messages until a condition holds, and return its value."""
        deadline = time.monotonic() + patience
        while not condition():
            assert time.monotonic() < deadline, f'waited {patience} s in vain for {what}'
            assert self._process is None or self._process.running, self._process.error
            self._executor.spin_once(timeout_sec=0.02)
        return condition()

    def poll(self, messages):
        """Take what is there, without waiting, and return the list given."""
        self._executor.spin_once(timeout_sec=0)
        return messages

    def topic(self, name):
        """Return the full name of a topic in the words of `topics`."""
        return name.replace('~', self.name)

    def listen(self, name, depth=10000, reliability='reliable', durability='volatile', raw=False):
        """Subscribe, wait for the publisher, and return the list messages will be put in."""
        received = []
        topic = self.topic(name)
        self.node.create_subscription(
            interface(TYPES[name]), topic, received.append,
            QoSProfile(depth=depth, reliability=ReliabilityPolicy[reliability.upper()],
                       durability=DurabilityPolicy[durability.upper()]), raw=raw)
        self.spin_until(lambda: self.node.count_publishers(topic), f'a publisher of {topic}')
        return received

    def publisher(self, name):
        """Return a publisher of a command topic that is connected to the node."""
        if name not in self._publishers:
            publisher = self.node.create_publisher(
                interface(TYPES[name]), self.topic(name), 1000)
            self.spin_until(publisher.get_subscription_count, f'a subscriber of {name}')
            self._publishers[name] = publisher
        return self._publishers[name]

    def command(self, name, body, stamp_ns=0, **vectors):
        """Publish a command to a body; vectors are linear, angular, force, torque or vector."""
        message = interface(TYPES[name])()
        message.header.frame_id = body
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, 10 ** 9)
        part = {'~/cmd_vel': 'twist', '~/cmd_wrench': 'wrench'}.get(name)
        target = getattr(message, part) if part else message
        for field, values in vectors.items():
            for axis, value in zip('xyz', values):
                setattr(getattr(target, field), axis, float(value))
        self.publisher(name).publish(message)

    def client(self, type_name, service):
        """Return a client of a service that is there."""
        if service not in self._clients:
            client = self.node.create_client(interface(type_name), service)
            self.spin_until(client.service_is_ready, f'the service {service}')
            self._clients[service] = client
        return self._clients[service]

    def call(self, name, **fields):
        """Call a service of the node and return the response."""
        service = self.topic(name)
        return self.call_type(TYPES[name], service, **fields)

    def call_type(self, type_name, service, **fields):
        """Call any service and return the response."""
        request = interface(type_name).Request(**fields)
        future = self.client(type_name, service).call_async(request)
        self.spin_until(future.done, f'an answer of {service}')
        return future.result()


def nanoseconds(message):
    """Return the stamp of a message [ns]."""
    stamp = message.header.stamp
    return stamp.sec * 10 ** 9 + stamp.nanosec


def states(messages):
    """
    Return MultiDOFJointState messages as arrays.

    Times (k,) [s], positions (k, n, 3), linear and angular velocities (k, n, 3), forces and
    torques (k, n, 3).
    """
    def rows(parts):
        return np.array([[[vector.x, vector.y, vector.z] for vector in row] for row in parts])

    return (
        np.array([nanoseconds(message) for message in messages]) / 1e9,
        rows([[transform.translation for transform in message.transforms]
              for message in messages]),
        rows([[twist.linear for twist in message.twist] for message in messages]),
        rows([[twist.angular for twist in message.twist] for message in messages]),
        rows([[wrench.force for wrench in message.wrench] for message in messages]),
        rows([[wrench.torque for wrench in message.wrench] for message in messages]))
