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

"""What is wrong never reaches the state: bad commands to a running node."""

import math

import numpy as np
from numpy.testing import assert_array_equal
import pytest

pytest.importorskip('rclpy')

from geometry_msgs.msg import Transform, Twist, Vector3, Vector3Stamped, Wrench  # noqa: E402, I100
from node_harness import Client, NodeProcess  # noqa: E402
from sensor_msgs.msg import MultiDOFJointState  # noqa: E402

SCENE = """
gravity: [0, 0, 0]
planes: [{name: ground, normal: [0, 0, 1], offset: -50}]
bodies:
  - {name: cube_1, cube: {edge: 0.2}, mass: 1.0, position: [0, 0, 0]}
  - {name: cube_2, cube: {edge: 0.2}, mass: 1.0, position: [9, 0, 0], angular_velocity: [1, 2, 3]}
  - {name: pillar, cube: {edge: 0.2}, mass: 1.0, position: [0, 9, 0], fixed: true}
"""


@pytest.fixture(scope='module')
def running(tmp_path_factory):
    folder = tmp_path_factory.mktemp('refusals')
    (folder / 'scene.yaml').write_text(SCENE)
    with NodeProcess(folder, scene=folder / 'scene.yaml', start_paused=True) as process, \
            Client(process) as client:
        states = client.listen('~/states')
        diagnostics = client.listen('/diagnostics')
        yield client, process, states, diagnostics
        assert process.running


def counts(diagnostics):
    """Return the numbers of the status of commands in the latest diagnostics."""
    status = next(status for status in diagnostics[-1].status if status.name.endswith('commands'))
    return {value.key: int(value.value) for value in status.values}


def wait_for_counts(client, diagnostics, condition):
    client.spin_until(lambda: diagnostics and condition(counts(diagnostics)), 'counts')
    return counts(diagnostics)


def state_bytes(client, states):
    """Make the paused node publish its state again, and return it as bytes."""
    states.clear()
    assert client.call('~/pause', data=True).success
    client.node.create_subscription(MultiDOFJointState, client.topic('~/states'),
                                    lambda message: None, 10)
    message = client.spin_until(lambda: states and states[-1], 'the state of a paused node')
    numbers = [getattr(part, name) for rows in (message.transforms, message.twist, message.wrench)
               for row in rows for part in (getattr(row, field) for field in row.__slots__
                                            if not field.startswith('_check'))
               for name in ('x', 'y', 'z')]
    return np.array(numbers).tobytes()


def many(**fields):
    return lambda client: client.publisher('~/cmd_states').publish(MultiDOFJointState(**fields))


def one(topic, body, **vectors):
    return lambda client: client.command(topic, body, **vectors)


BAD = {
    'unknown body': [
        one('~/cmd_vel', '', linear=(1, 0, 0)),
        one('~/cmd_torque', 'Ω\n\x1b[31m', vector=(1, 0, 0)),
        many(joint_names=['cube_1', 'nobody'], twist=[Twist(linear=Vector3(x=1.0))] * 2)],
    'fixed body': [
        one('~/cmd_wrench', 'pillar', force=(1, 0, 0)),
        one('~/cmd_vel', 'ground', linear=(1, 0, 0))],
    'not finite': [
        one('~/cmd_force', 'cube_1', vector=(math.nan, 0, 0)),
        one('~/cmd_torque', 'cube_1', vector=(0, math.inf, 0)),
        one('~/cmd_vel', 'cube_1', angular=(0, 0, -math.inf)),
        one('~/cmd_wrench', 'cube_2', force=(1, 0, 0), torque=(0, math.nan, 0)),
        many(joint_names=['cube_1', 'cube_2'],
             wrench=[Wrench(force=Vector3(x=1.0)), Wrench(force=Vector3(x=math.nan))])],
    'too large': [
        one('~/cmd_vel', 'cube_1', linear=(1e300, 0, 0)),
        one('~/cmd_force', 'cube_1', vector=(0, -1e10, 0))],
    'empty': [many(), many(joint_names=['cube_1'])],
    'malformed': [
        many(joint_names=['cube_1', 'cube_2'], twist=[Twist(linear=Vector3(x=1.0))]),
        many(joint_names=['cube_1'], wrench=[Wrench(force=Vector3(x=1.0))] * 3),
        many(wrench=[Wrench(force=Vector3(x=1.0))]),
        lambda client: client.publisher('~/cmd_vel').publish(b'\0\1\0\0\0'),
        lambda client: client.publisher('~/cmd_states').publish(bytes(4) + b'\xff' * 60)],
    'named twice': [
        many(joint_names=['cube_1', 'cube_2', 'cube_1'], twist=[Twist(), Twist(), Twist()])],
    'poses': [many(joint_names=['cube_1'], transforms=[Transform()])],
}


def test_bad_commands_change_nothing_and_are_counted(running):
    client, process, states, diagnostics = running
    before = state_bytes(client, states)
    # the first of its kind is the one that is warned of
    client.command('~/cmd_force', 'cube1', vector=(1, 0, 0))
    process.wait_for_text("no body is named 'cube1'; near names: cube_1")
    for commands in BAD.values():
        for send in commands:
            send(client)
    expected = {f'refused, {kind}': len(commands) for kind, commands in BAD.items()}
    expected['refused, unknown body'] += 1
    total = sum(expected.values())
    found = wait_for_counts(client, diagnostics, lambda now: now['refused'] >= total)
    assert {key: value for key, value in found.items() if key.startswith('refused,')} == expected
    assert found['carried out'] == 0
    assert state_bytes(client, states) == before
    # one warning a kind
    warnings = [line for line in process.error.splitlines() if 'WARN' in line]
    assert len(warnings) == len(BAD), warnings
    assert all(line.isprintable() for line in warnings)


def test_flood_is_survived_with_few_warnings(running):
    client, process, states, diagnostics = running
    before = state_bytes(client, states)
    start = wait_for_counts(client, diagnostics, lambda now: True)['refused']
    lines = len(process.error.splitlines())
    huge = Vector3Stamped()
    huge.header.frame_id = 'x' * 10_000_000
    client.publisher('~/cmd_torque').publish(huge)
    wait_for_counts(client, diagnostics, lambda now: now['refused'] > start)
    for number in range(2000):
        client.command('~/cmd_force', f'nobody_{number}', vector=(1, 2, 3))
        client.command('~/cmd_vel', 'cube_1', linear=(math.nan, 0, 0))
    client.command('~/cmd_vel', 'cube_1')  # the last one is good
    wait_for_counts(client, diagnostics, lambda now: now['carried out'] == 1)
    # a queue of ten keeps the last ten of a burst, so most of the flood is not even seen
    assert counts(diagnostics)['refused'] > start + 10
    assert state_bytes(client, states) == before
    news = process.error.splitlines()[lines:]
    assert len(news) <= 6, news
    assert all(len(line) < 500 for line in news)


def test_node_still_takes_commands(running):
    client, _, states, _ = running
    states.clear()
    client.command('~/cmd_vel', 'cube_1', linear=(0.25, 0, 0), angular=(0, 0.5, 0))
    message = client.spin_until(
        lambda: states and states[-1].twist[0].linear.x and states[-1], 'the commanded velocity')
    assert_array_equal([message.twist[0].linear.x, message.twist[0].angular.y], [0.25, 0.5])


def test_what_cannot_be_simulated_pauses_and_a_reset_helps(tmp_path):
    (tmp_path / 'scene.yaml').write_text("""
gravity: [0, 0, 0]
bodies: [{name: plank, box: {size: [0.1, 0.2, 0.3]}, mass: 1.0}]
""")
    with NodeProcess(tmp_path, scene='scene.yaml') as process, Client(process) as client:
        states = client.listen('~/states')
        diagnostics = client.listen('/diagnostics')
        client.command('~/cmd_torque', 'plank', vector=(9e8, 3e8, -1e8))
        process.wait_for_text('the simulation cannot go on, only be reset')
        response = client.call('~/pause', data=False)
        assert not response.success and 'only be reset' in response.message
        assert not client.call('~/step').success
        client.command('~/cmd_vel', 'plank', linear=(1, 0, 0))
        wait_for_counts(client, diagnostics, lambda now: now.get('refused, simulation failed'))
        assert any(status.level == b'\x02' for status in diagnostics[-1].status)
        assert client.call('~/reset').success
        assert client.call('~/pause', data=False).success
        states.clear()
        client.command('~/cmd_vel', 'plank', linear=(1, 0, 0))
        client.spin_until(lambda: states and states[-1].twist[0].linear.x == 1.0
                          and states[-1].transforms[0].translation.x > 0.1, 'motion')
        assert 'Traceback' not in process.error
