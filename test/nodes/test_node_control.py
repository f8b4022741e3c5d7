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

"""Control of time from outside: pause, step, reset, pause on collision, parameters."""

from math import sqrt

from numpy.testing import assert_allclose
import pytest

pytest.importorskip('rclpy')

from node_harness import Client, nanoseconds, NodeProcess  # noqa: E402, I100
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue  # noqa: E402

MILLISECOND = 1_000_000
GRAVITY = 9.81
HEIGHT = 0.5

SCENE = f"""
planes: [{{name: ground, normal: [0, 0, 1], offset: 0}}]
bodies:
  - {{name: ball, sphere: {{radius: 0.1}}, mass: 1.0, position: [0, 0, {0.1 + HEIGHT}]}}
"""

TOUCH = sqrt(2 * HEIGHT / GRAVITY)
"""When the ball touches the ground [s]."""

VALUES = {bool: ('bool_value', ParameterType.PARAMETER_BOOL),
          int: ('integer_value', ParameterType.PARAMETER_INTEGER),
          float: ('double_value', ParameterType.PARAMETER_DOUBLE),
          str: ('string_value', ParameterType.PARAMETER_STRING)}


def set_parameter(client, name, value):
    field, kind = VALUES[type(value)]
    response = client.call_type(
        'rcl_interfaces/srv/SetParameters', client.name + '/set_parameters',
        parameters=[Parameter(name=name, value=ParameterValue(type=kind, **{field: value}))])
    return response.results[0]


@pytest.fixture(scope='module')
def running(tmp_path_factory):
    folder = tmp_path_factory.mktemp('control')
    (folder / 'drop.yaml').write_text(SCENE)
    with NodeProcess(folder, scene=folder / 'drop.yaml', start_paused=True) as process, \
            Client(process) as client:
        yield client, client.listen('~/poses')
        assert process.running


@pytest.fixture
def paused(running):
    """Return the client and poses of a paused node at simulated time zero."""
    client, poses = running
    assert client.call('~/pause', data=True).success
    assert set_parameter(client, 'reset_time', True).successful
    assert client.call('~/reset').success
    client.spin_until(lambda: poses and nanoseconds(poses[-1]) == 0, 'the state at time zero')
    poses.clear()
    return client, poses


def test_paused_time_stands_still_and_steps_are_exact(paused):
    client, poses = paused
    client.spin(0.2)
    assert not poses
    for number in (1, 2, 3):
        response = client.call('~/step')
        assert response.success, response.message
        client.spin_until(lambda: poses, 'the state after a step')
        message = poses.pop()
        assert not poses
        assert nanoseconds(message) == number * 10 * MILLISECOND
        time = nanoseconds(message) / 1e9
        assert_allclose(message.poses[0].position.z, 0.6 - 0.5 * GRAVITY * time ** 2, atol=1e-12)


def test_a_parameter_that_does_not_exist_is_refused_by_name(paused):
    client, _ = paused
    near = '; near names: publish_rate, publish_tf, publish_clock'
    for name, hint in (('publish_rat', near), ('gravity', '')):
        result = set_parameter(client, name, 1.0)
        assert not result.successful
        assert result.reason.endswith(f"undeclared parameter(s): '{name}'{hint}")


def test_long_step_publishes_every_state_of_it(paused):
    client, poses = paused
    assert set_parameter(client, 'step_duration', 0.045).successful
    assert client.call('~/step').success
    client.spin_until(lambda: len(poses) == 5, 'five states')
    assert [nanoseconds(message) // MILLISECOND for message in poses] == [10, 20, 30, 40, 45]
    assert set_parameter(client, 'step_duration', 0.01).successful


def test_step_is_refused_while_running(paused):
    client, poses = paused
    assert client.call('~/pause', data=False).success
    response = client.call('~/step')
    assert not response.success
    assert 'pause' in response.message
    client.spin_until(lambda: len(poses) > 5, 'motion')
    assert client.call('~/pause', data=True).success


def test_resumed_time_continues_where_it_was(paused):
    client, poses = paused
    assert client.call('~/step').success
    client.spin(0.3)
    assert client.call('~/pause', data=False).success
    client.spin_until(lambda: len(poses) >= 10, 'ten states')
    assert client.call('~/pause', data=True).success
    times = [nanoseconds(message) // MILLISECOND for message in poses[:10]]
    assert times == list(range(10, 101, 10))


def test_reset_with_time_running_on(paused):
    client, poses = paused
    assert set_parameter(client, 'reset_time', False).successful
    assert client.call('~/step').success
    assert client.call('~/step').success
    poses.clear()
    assert client.call('~/reset').success
    client.spin_until(lambda: poses, 'the state after the reset')
    assert nanoseconds(poses[-1]) == 20 * MILLISECOND
    assert poses[-1].poses[0].position.z == 0.1 + HEIGHT


def test_pause_on_collision(paused):
    client, poses = paused
    events = client.listen('~/collisions')
    lines, log = client.listen('~/collision_text'), client.listen('/rosout')
    assert set_parameter(client, 'pause_on_collision', True).successful
    assert client.call('~/pause', data=False).success
    client.spin_until(lambda: events and lines, 'a collision')
    client.spin(0.2)
    end = nanoseconds(poses[-1])
    assert TOUCH <= end / 1e9 <= TOUCH + 2e-9
    assert len(events) == len(lines) == 1
    assert '"body_a": "ball", "body_b": "ground"' in lines[0].data
    assert nanoseconds(events[0]) == end
    client.spin_until(lambda: any(f'paused at {end / 1e9:.9f} s: ball and ground collided'
                                  in entry.msg for entry in log), 'a line about it')
    # it goes on when told to
    assert set_parameter(client, 'pause_on_collision', False).successful
    assert client.call('~/pause', data=False).success
    client.spin_until(lambda: nanoseconds(poses[-1]) > end, 'motion')


def test_late_subscriber_sees_the_paused_state(paused):
    client, _ = paused
    markers = client.listen('~/markers')
    message = client.spin_until(lambda: markers and markers[-1], 'markers of a paused node')
    assert {marker.ns for marker in message.markers} == {'bodies'}


def test_speed_follows_the_real_time_factor(paused):
    client, poses = paused
    assert set_parameter(client, 'real_time_factor', 0).successful
    assert client.call('~/pause', data=False).success
    # ten simulated seconds of rest in far less than ten of wall time
    client.spin_until(lambda: poses and nanoseconds(poses[-1]) > 10_000 * MILLISECOND, '10 s',
                      patience=8.0)
    assert client.call('~/pause', data=True).success
    assert set_parameter(client, 'real_time_factor', 1.0).successful


def test_parameters_are_described_and_guarded(running):
    client, _ = running
    describe = client.call_type(
        'rcl_interfaces/srv/DescribeParameters', client.name + '/describe_parameters',
        names=['publish_rate', 'scene', 'command_axes'])
    rate, scene, axes = describe.descriptors
    assert 'per second' in rate.description
    assert (rate.floating_point_range[0].from_value, rate.floating_point_range[0].to_value) == (
        0.1, 1e4)
    assert scene.read_only and not rate.read_only
    assert axes.additional_constraints == 'allowed: world, body'
    for name, value, reason in [
            ('publish_rate', -1.0, 'Min: 0.1, Max: 10000'),
            ('publish_rate', float('nan'), 'Min: 0.1, Max: 10000'),
            ('publish_rate', 'fast', 'Wrong parameter type'),
            ('command_axes', 'bodies', 'allowed: world, body'),
            ('scene', 'tower', 'read-only'), ('record', True, 'read-only')]:
        result = set_parameter(client, name, value)
        assert not result.successful
        assert reason in result.reason


def test_publish_rate_can_be_changed(paused):
    client, poses = paused
    assert set_parameter(client, 'publish_rate', 250).successful
    assert client.call('~/step').success
    client.spin_until(lambda: len(poses) == 3, 'three states')
    assert [nanoseconds(message) // MILLISECOND for message in poses] == [4, 8, 10]
    assert set_parameter(client, 'publish_rate', 100).successful
