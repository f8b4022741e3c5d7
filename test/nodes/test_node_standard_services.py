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
The services of simulation_interfaces, called by a real client; only where it is installed.

test_standard_services.py calls the same methods everywhere.
"""

import numpy as np
from numpy.testing import assert_allclose
import pytest

pytest.importorskip('rclpy')
pytest.importorskip('simulation_interfaces.srv', reason='needs simulation_interfaces')

from node_harness import Client, NodeProcess  # noqa: E402, I100
from rigid_sim_ros.bag_tools import replay  # noqa: E402
from rigid_sim_ros.nodes.standard_services import SERVICES, snake_case  # noqa: E402
from simulation_interfaces.msg import Result, SimulationState, SimulatorFeatures  # noqa: E402
from simulation_interfaces.srv import (  # noqa: E402
    ResetSimulation, SetSimulationState, SpawnEntity)

SCENE = """
gravity: [0, 0, 0]
planes: [{name: ground, normal: [0, 0, 1], offset: -10}]
bodies:
  - {name: one, cube: {edge: 0.2}, mass: 1.0, velocity: [1, 0, 0]}
  - {name: wall, cube: {edge: 1.0}, mass: 1.0, position: [0, 5, 0], fixed: true}
"""

CUBE = '{cube: {edge: 0.2}, mass: 1.0, velocity: [0, 1, 0]}'


class Caller:
    """Calls the services by their type's name."""

    def __init__(self, client):
        self._client = client

    def __call__(self, service, /, **fields):
        return self._client.call_type(f'simulation_interfaces/srv/{service}',
                                      f'{self._client.name}/{snake_case(service)}', **fields)

    def state(self, value):
        return self('SetSimulationState', state=SimulationState(state=value)).result.result

    def entities(self):
        return self('GetEntities').entities


@pytest.fixture(scope='module')
def running(tmp_path_factory):
    folder = tmp_path_factory.mktemp('standard')
    (folder / 'scene.yaml').write_text(SCENE)
    with NodeProcess(folder, scene='scene.yaml', start_paused=True) as process, \
            Client(process) as client:
        yield client, process


@pytest.fixture
def call(running):
    """Return a caller of a node that is stopped."""
    call = Caller(running[0])
    call.state(SimulationState.STATE_PAUSED)
    assert call('ResetSimulation').result.result == Result.RESULT_OK
    return call


def spawn(call, name, position, text=CUBE, rename=False, frame=''):
    request = SpawnEntity.Request()
    request.name, request.allow_renaming = name, rename
    getattr(request, 'entity_resource', request).resource_string = text
    pose = request.initial_pose
    pose.header.frame_id = frame
    pose.pose.position.x, pose.pose.position.y, pose.pose.position.z = map(float, position)
    fields = {field: getattr(request, field) for field in request.get_fields_and_field_types()}
    return call('SpawnEntity', **fields)


def position(call, name):
    state = call('GetEntityState', entity=name).state
    return np.array([state.pose.position.x, state.pose.position.y, state.pose.position.z])


def test_features_are_those_offered(running, call):
    features = call('GetSimulatorFeatures').features
    assert SimulatorFeatures.SPAWNING in features.features
    assert SimulatorFeatures.STEP_SIMULATION_MULTIPLE in features.features
    services = {name for name, _ in running[0].node.get_service_names_and_types()}
    assert {f'/rigid_sim/{snake_case(name)}' for name in SERVICES} <= services


def test_states(call):
    assert call('GetSimulationState').state.state == SimulationState.STATE_PAUSED
    assert call.state(SimulationState.STATE_PLAYING) == Result.RESULT_OK
    assert call.state(SimulationState.STATE_PLAYING) == (
        SetSimulationState.Response.ALREADY_IN_TARGET_STATE)
    assert call.state(SimulationState.STATE_STOPPED) == Result.RESULT_OK
    assert call('GetSimulationState').state.state == SimulationState.STATE_STOPPED
    assert_allclose(position(call, 'one'), 0, atol=0)
    assert call.state(SimulationState.STATE_PAUSED) == Result.RESULT_OK
    assert call.state(200) == Result.RESULT_FEATURE_UNSUPPORTED


def test_steps_are_counted_and_refused_while_running(call):
    assert call('StepSimulation', steps=7).result.result == Result.RESULT_OK
    assert_allclose(position(call, 'one'), [0.07, 0, 0], atol=1e-12)
    call.state(SimulationState.STATE_PLAYING)
    refused = call('StepSimulation', steps=1).result
    assert refused.result == Result.RESULT_INCORRECT_STATE
    assert 'pause' in refused.error_message


def test_spawned_entity_moves_until_it_is_deleted(running, call):
    client, _ = running
    poses, scenes = client.listen('~/poses'), client.listen('~/scene')
    response = spawn(call, 'new', (0, 0, 2), frame='world')
    assert (response.result.result, response.entity_name) == (Result.RESULT_OK, 'new')
    assert call.entities() == ['one', 'wall', 'new']
    client.spin_until(lambda: scenes and 'new' in scenes[-1].data, 'the new scene')
    call('StepSimulation', steps=10)
    assert_allclose(position(call, 'new'), [0, 0.1, 2], atol=1e-12)
    client.spin_until(lambda: len(poses[-1].poses) == 2 and poses[-1].poses[1].position.y > 0.09,
                      'the pose of the new body')
    assert call('DeleteEntity', entity='new').result.result == Result.RESULT_OK
    client.spin_until(lambda: len(poses[-1].poses) == 1, 'a pose less')
    assert call('DeleteEntity', entity='new').result.result == Result.RESULT_NOT_FOUND


@pytest.mark.parametrize('arguments, expected', [
    (('one', (0, 0, 3)), 'NAME_NOT_UNIQUE'), (('new', (0, 0, 0.1)), 'INVALID_POSE'),
    (('new', (0, 0, 3), '{cube: {edge: -1}, mass: 1}'), 'RESOURCE_PARSE_ERROR'),
    (('new', (0, 0, 3), ''), 'NO_RESOURCE')])
def test_what_cannot_be_spawned(call, arguments, expected):
    response = spawn(call, *arguments)
    assert response.result.result == getattr(SpawnEntity.Response, expected)
    assert response.result.error_message
    assert call.entities() == ['one', 'wall']


def test_renaming_and_foreign_frames(call):
    assert spawn(call, 'one', (0, 0, 3), rename=True).entity_name == 'one_1'
    refused = spawn(call, 'two', (0, 0, 5), frame='map').result
    assert refused.result == Result.RESULT_FEATURE_UNSUPPORTED


def test_resets_by_scope(call):
    scope = ResetSimulation.Request
    spawn(call, 'new', (0, 0, 2))
    call('StepSimulation', steps=10)
    assert call('ResetSimulation', scope=scope.SCOPE_STATE).result.result == Result.RESULT_OK
    assert call.entities() == ['one', 'wall', 'new']
    assert_allclose(position(call, 'new'), [0, 0, 2], atol=0)
    # time ran on: ten steps of 10 ms
    assert call('GetEntityState', entity='one').state.header.stamp.nanosec == 100_000_000
    call('StepSimulation', steps=10)
    assert call('ResetSimulation', scope=scope.SCOPE_SPAWNED).result.result == Result.RESULT_OK
    assert call.entities() == ['one', 'wall']
    assert_allclose(position(call, 'one'), [0.1, 0, 0], atol=1e-12)
    assert call('ResetSimulation', scope=scope.SCOPE_TIME).result.result == (
        Result.RESULT_FEATURE_UNSUPPORTED)
    assert call('ResetSimulation', scope=scope.SCOPE_ALL).result.result == Result.RESULT_OK
    state = call('GetEntityState', entity='one').state
    assert (state.header.stamp.sec, state.header.stamp.nanosec) == (0, 0)


def test_entity_state_is_set_and_told(call):
    state = call('GetEntityState', entity='one').state
    assert (state.header.frame_id, state.twist.linear.x) == ('world', 1.0)
    state.pose.position.z, state.twist.linear.x, state.twist.angular.z = 4.0, -2.0, 3.0
    assert call('SetEntityState', entity='one', state=state).result.result == Result.RESULT_OK
    call('StepSimulation', steps=5)
    states = call('GetEntitiesStates')
    assert states.entities == ['one', 'wall']
    assert_allclose([states.states[0].pose.position.x, states.states[0].pose.position.z,
                     2 * np.arcsin(states.states[0].pose.orientation.z)], [-0.1, 4, 0.15],
                    atol=1e-12)
    assert call('SetEntityState', entity='nobody', state=state).result.result == (
        Result.RESULT_NOT_FOUND)
    state.pose.position.z = -9.95
    refused = call('SetEntityState', entity='one', state=state).result
    assert refused.result == Result.RESULT_OPERATION_FAILED
    assert 'overlap' in refused.error_message


def test_what_services_did_is_simulated_again(running, call, tmp_path, capsys):
    client, _ = running
    scope = ResetSimulation.Request
    call('StepSimulation', steps=3)
    assert spawn(call, 'early', (0, 0, 2)).result.result == Result.RESULT_OK
    recording = client.call('~/record', data=True)
    assert recording.success, recording.message
    for number in range(3):
        assert spawn(call, f'new_{number}', (3, number, 2)).result.result == Result.RESULT_OK
        call('StepSimulation', steps=4)
        state = call('GetEntityState', entity='one').state
        state.pose.position.z, state.twist.angular.x = 1.5 * number, 2.0
        assert call('SetEntityState', entity='one', state=state).result.result == Result.RESULT_OK
        call('StepSimulation', steps=4)
        assert call('DeleteEntity', entity='early').result.result in (
            Result.RESULT_OK, Result.RESULT_NOT_FOUND)
        call('StepSimulation', steps=4)
        call('ResetSimulation', scope=(scope.SCOPE_STATE, scope.SCOPE_SPAWNED,
                                       scope.SCOPE_TIME | scope.SCOPE_STATE)[number])
        call('StepSimulation', steps=4)
    assert client.call('~/record', data=False).success
    assert replay.main([recording.message.split(' to ')[-1]]) == 0
    assert capsys.readouterr().out.startswith('identical: ')


def test_nothing_is_changed_once_the_simulation_cannot_go_on(running, call):
    client, process = running
    plank = '{box: {size: [0.1, 0.2, 0.3]}, mass: 1.0}'
    assert spawn(call, 'plank', (0, 0, 3), plank).result.result == Result.RESULT_OK
    call.state(SimulationState.STATE_PLAYING)
    client.command('~/cmd_torque', 'plank', vector=(9e8, 3e8, -1e8))
    process.wait_for_text('the simulation cannot go on, only be reset')
    for response in (spawn(call, 'new', (0, 0, 5)), call('DeleteEntity', entity='one'),
                     call('SetEntityState', entity='one'), call('GetEntityState', entity='one'),
                     call('GetEntitiesStates')):
        assert response.result.result == Result.RESULT_OPERATION_FAILED
        assert 'cannot go on, only be reset' in response.result.error_message
    # it can be recorded, to see what the reset does
    recording = client.call('~/record', data=True)
    assert recording.success
    call('ResetSimulation')
    assert call.entities() == ['one', 'wall']
    call('StepSimulation', steps=3)
    assert client.call('~/record', data=False).success
    assert replay.main([recording.message.split(' to ')[-1]]) == 0


def test_quitting_ends_the_process(running, call):
    assert call.state(SimulationState.STATE_QUITTING) == Result.RESULT_OK
    assert running[1].wait() == 0
