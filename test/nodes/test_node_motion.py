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
Commands to the running node lead to the motion that formulas give.

The scene has no gravity, and its bodies meet nothing. All expected numbers are closed forms of
uniform or uniformly accelerated motion, evaluated at the stamps of the messages.
"""

import numpy as np
from numpy.testing import assert_allclose
import pytest

pytest.importorskip('rclpy')

from node_harness import Client, nanoseconds, NodeProcess, states  # noqa: E402, I100

MASS, EDGE = 2.0, 0.2
INERTIA = MASS * EDGE ** 2 / 6

SCENE = f"""
gravity: [0, 0, 0]
bodies:
  - {{name: one, cube: {{edge: {EDGE}}}, mass: {MASS}, position: [0, 0, 0]}}
  - {{name: two, cube: {{edge: {EDGE}}}, mass: {MASS}, position: [0, 100, 0]}}
  - {{name: three, cube: {{edge: {EDGE}}}, mass: {MASS}, position: [0, 200, 0]}}
  - {{name: four, sphere: {{radius: 0.1}}, mass: {MASS}, position: [0, 300, 0]}}
"""


@pytest.fixture(scope='module')
def running(tmp_path_factory):
    folder = tmp_path_factory.mktemp('motion')
    (folder / 'free.yaml').write_text(SCENE)
    with NodeProcess(folder, scene=folder / 'free.yaml', publish_rate=200.0) as process, \
            Client(process) as client:
        messages = client.listen('~/states')
        client.spin_until(lambda: messages, 'a first state')
        assert messages[0].joint_names == ['one', 'two', 'three', 'four']
        yield client, messages
        assert process.running


@pytest.fixture
def motion(running):
    """Return the client and a function that gives the states since the reset, as arrays."""
    client, messages = running
    assert client.call('~/reset').success
    messages.clear()

    def wait_for(condition, count=20):
        """Wait for `count` states of which the first fulfils a condition; return those."""
        def found():
            for start, message in enumerate(messages):
                if condition(message) and len(messages) >= start + count:
                    return messages[start:start + count]
            return None
        return states(client.spin_until(found, 'the commanded motion'))

    return client, messages, wait_for


def test_velocity_shows_within_one_message(motion):
    client, messages, _ = motion
    poses = client.listen('~/poses')
    client.spin_until(lambda: poses, 'a state at rest')
    linear = np.array([2.0, -1.0, 0.5])
    client.command('~/cmd_vel', 'two', linear=linear, angular=(0, 0, 3))
    client.spin_until(lambda: poses and poses[-1].poses[1].position.x > 0.2, 'motion')
    times = np.array([nanoseconds(message) for message in poses]) / 1e9
    position = np.array([[message.poses[1].position.x, message.poses[1].position.y,
                          message.poses[1].position.z] for message in poses])
    assert np.all(np.diff(times) > 0)
    velocity = np.diff(position, axis=0) / np.diff(times)[:, None]
    moving = np.abs(velocity).max(axis=1) > 0
    first = int(np.argmax(moving))
    assert moving[first:].all()
    # the first difference that is not zero is already the whole velocity: stamps are rounded to
    # 1 ns of 5 ms, hence 1e-6
    assert_allclose(velocity[first:], np.broadcast_to(linear, velocity[first:].shape), rtol=1e-6)
    # it turns about z at 3 rad/s: half the angle is in the quaternion
    turn = np.array([2 * np.arctan2(message.poses[1].orientation.z, message.poses[1].orientation.w)
                     for message in poses])
    assert_allclose(turn[first:], 3.0 * (times[first:] - times[first]), atol=1e-8)


def test_force_accelerates(motion):
    client, _, wait_for = motion
    force = np.array([4.0, -2.0, 1.0])
    client.command('~/cmd_force', 'one', vector=force)
    time, position, linear, angular, held, _ = wait_for(lambda m: m.wrench[0].force.x == 4.0)
    elapsed = (time - time[0])[:, None]
    acceleration = force / MASS
    assert_allclose(held[:, 0], np.broadcast_to(force, (len(time), 3)))
    assert_allclose(linear[:, 0], linear[0, 0] + acceleration * elapsed, atol=1e-8)
    assert_allclose(
        position[:, 0],
        position[0, 0] + linear[0, 0] * elapsed + 0.5 * acceleration * elapsed ** 2, atol=1e-9)
    assert_allclose(angular[:, 0], 0, atol=0)
    assert_allclose(linear[:, 1:], 0, atol=0)


def test_torque_spins_up(motion):
    client, _, wait_for = motion
    torque = np.array([0.02, 0.01, -0.03])
    client.command('~/cmd_torque', 'three', vector=torque)
    time, position, _, angular, _, held = wait_for(lambda m: m.wrench[2].torque.x == 0.02)
    elapsed = (time - time[0])[:, None]
    assert_allclose(held[:, 2], np.broadcast_to(torque, (len(time), 3)))
    assert_allclose(angular[:, 2], angular[0, 2] + torque / INERTIA * elapsed, atol=1e-7)
    assert_allclose(position[:, 2], [[0, 200, 0]] * len(time), atol=1e-12)


def test_wrench_is_both_and_force_replaces_its_part(motion):
    client, _, wait_for = motion
    client.command('~/cmd_wrench', 'four', force=(1, 0, 0), torque=(0, 0.01, 0))
    wait_for(lambda m: m.wrench[3].force.x == 1.0 and m.wrench[3].torque.y == 0.01, count=1)
    client.command('~/cmd_force', 'four', vector=(0, 0, -5))
    time, _, linear, angular, force, torque = wait_for(lambda m: m.wrench[3].force.z == -5.0)
    assert_allclose(force[:, 3], [[0, 0, -5]] * len(time))
    assert_allclose(torque[:, 3], [[0, 0.01, 0]] * len(time))
    elapsed = (time - time[0])[:, None]
    assert_allclose(linear[:, 3], linear[0, 3] + [0, 0, -5 / MASS] * elapsed, atol=1e-8)
    sphere_inertia = 0.4 * MASS * 0.1 ** 2
    assert_allclose(angular[:, 3], angular[0, 3] + [0, 0.01 / sphere_inertia, 0] * elapsed,
                    atol=1e-7)


def test_many_bodies_in_one_message(motion):
    client, _, wait_for = motion
    from geometry_msgs.msg import Twist, Vector3
    from sensor_msgs.msg import MultiDOFJointState
    names = ['three', 'one', 'four']
    twists = [Twist(linear=Vector3(x=float(number), y=1.0), angular=Vector3(z=-float(number)))
              for number in range(1, 4)]
    client.publisher('~/cmd_states').publish(
        MultiDOFJointState(joint_names=names, twist=twists))
    time, position, linear, angular, force, _ = wait_for(lambda m: m.twist[0].linear.x == 2.0)
    assert_allclose(linear[-1], [[2, 1, 0], [0, 0, 0], [1, 1, 0], [3, 1, 0]], atol=1e-12)
    assert_allclose(angular[-1], [[0, 0, -2], [0, 0, 0], [0, 0, -1], [0, 0, -3]], atol=1e-12)
    assert_allclose(position[-1] - position[0], linear[-1] * (time[-1] - time[0]), atol=1e-8)
    assert_allclose(force, 0, atol=0)


def test_reset_starts_again_and_time_runs_on(motion):
    client, messages, wait_for = motion
    client.command('~/cmd_vel', 'one', linear=(5, 0, 0))
    wait_for(lambda m: m.twist[0].linear.x == 5.0, count=3)
    before = nanoseconds(messages[-1])
    assert client.call('~/reset').success
    time, position, linear, *_ = wait_for(
        lambda m: nanoseconds(m) > before and m.twist[0].linear.x == 0.0, count=5)
    assert_allclose(position[:, 0], 0, atol=0)
    assert np.all(np.diff(time) > 0)
