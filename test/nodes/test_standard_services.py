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
The services of simulation_interfaces called as methods, whether the package is there or not.

Its messages are stood in for: the constants have its names, and numbers of their own.
"""

import sys
from types import ModuleType, SimpleNamespace as Message

import numpy as np
from numpy.testing import assert_allclose
import pytest

rclpy = pytest.importorskip('rclpy')

from rclpy.context import Context  # noqa: E402, I100
from rclpy.parameter import Parameter  # noqa: E402
from rigid_sim_ros.nodes.node import SimulationNode  # noqa: E402
from rigid_sim_ros.nodes.signals import StopRequest  # noqa: E402
from rigid_sim_ros.nodes.standard_services import StandardServices  # noqa: E402

SCENE = """
gravity: [0, 0, 0]
planes: [{name: ground, normal: [0, 0, 1], offset: -10}]
bodies:
  - {name: one, cube: {edge: 0.2}, mass: 1.0, velocity: [1, 0, 0]}
  - {name: wall, cube: {edge: 1.0}, mass: 1.0, position: [0, 5, 0], fixed: true}
"""

CUBE = '{cube: {edge: 0.2}, mass: 1.0, velocity: [0, 1, 0]}'

UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE, FAILED = range(5)


class Result:
    RESULT_FEATURE_UNSUPPORTED, RESULT_OK, RESULT_NOT_FOUND = UNSUPPORTED, OK, NOT_FOUND
    RESULT_INCORRECT_STATE, RESULT_OPERATION_FAILED = INCORRECT_STATE, FAILED


class SimulationState:
    STATE_STOPPED, STATE_PLAYING, STATE_PAUSED, STATE_QUITTING = range(4)


class Request(Message):
    SCOPE_TIME, SCOPE_STATE, SCOPE_SPAWNED, SCOPE_ALL = 1, 2, 4, 255


class Response(Message):
    ALREADY_IN_TARGET_STATE, STATE_TRANSITION_ERROR = 101, 102
    NAME_NOT_UNIQUE, NAME_INVALID, UNSUPPORTED_FORMAT, NO_RESOURCE = 101, 102, 103, 104
    NAMESPACE_INVALID, RESOURCE_PARSE_ERROR, MISSING_ASSETS = 105, 106, 107
    UNSUPPORTED_ASSETS, INVALID_POSE = 108, 109


def vector(x=0.0, y=0.0, z=0.0):
    return Message(x=x, y=y, z=z)


def pose(position=(0, 0, 0), orientation=(0, 0, 0, 1)):
    return Message(position=vector(*position),
                   orientation=Message(**dict(zip('xyzw', orientation))))


def header(frame_id=''):
    return Message(frame_id=frame_id, stamp=Message(sec=0, nanosec=0))


def entity_state():
    return Message(header=header(), pose=pose(),
                   twist=Message(linear=vector(), angular=vector()))


class Caller:
    """Calls the methods by name, with a request that has what every field is by default."""

    def __init__(self, node):
        self.node = node
        self._services = StandardServices(node)

    def __call__(self, service, /, **fields):
        response = Response(result=Message(result=None, error_message=''),
                            state=Message(state=None))
        filters = Message(filter=fields.pop('filter', ''), categories=[], tags=Message(tags=[]),
                          bounds=Message(type=0))
        return getattr(self._services, service)(Request(filters=filters, **fields), response)

    def result(self, service, /, **fields):
        return self(service, **fields).result.result

    def state(self, value):
        return self.result('set_simulation_state', state=Message(state=value))

    def spawn(self, name, position=(0, 0, 3), text=CUBE, orientation=(0, 0, 0, 1), rename=False,
              frame_id=''):
        return self('spawn_entity', name=name, allow_renaming=rename, entity_namespace='',
                    entity_resource=Message(uri='', resource_string=text),
                    initial_pose=Message(header=header(frame_id),
                                         pose=pose(position, orientation)))

    def entities(self):
        return self('get_entities').entities

    def position(self, name):
        place = self('get_entity_state', entity=name).state.pose.position
        return np.array([place.x, place.y, place.z])


@pytest.fixture
def call(tmp_path, monkeypatch):
    """Yield a caller of a node that is paused."""
    messages, types = ModuleType('simulation_interfaces.msg'), ModuleType('')
    messages.Result, messages.SimulationState = Result, SimulationState
    messages.EntityState = entity_state
    for name, module in (('', ModuleType('')), ('.msg', messages), ('.srv', types)):
        monkeypatch.setitem(sys.modules, 'simulation_interfaces' + name, module)
    monkeypatch.setattr('rigid_sim_ros.nodes.node.is_available', lambda: False)
    (tmp_path / 'scene.yaml').write_text(SCENE)
    parameters = {'scene': str(tmp_path / 'scene.yaml'), 'start_paused': True}
    context = Context()
    rclpy.init(context=context)
    node = SimulationNode(StopRequest(), context=context, parameter_overrides=[
        Parameter(name, value=value) for name, value in parameters.items()])
    node.start()
    yield Caller(node)
    node.close()
    rclpy.shutdown(context=context)


def test_states(call):
    def state():
        return call('get_simulation_state').state.state

    assert state() == SimulationState.STATE_PAUSED
    assert call.state(SimulationState.STATE_PLAYING) == OK
    assert call.state(SimulationState.STATE_PLAYING) == Response.ALREADY_IN_TARGET_STATE
    assert call.state(SimulationState.STATE_PAUSED) == OK
    call('step_simulation', steps=3)
    assert call.state(SimulationState.STATE_STOPPED) == OK
    assert state() == SimulationState.STATE_STOPPED
    assert_allclose(call.position('one'), 0, atol=0)
    assert call.state(200) == UNSUPPORTED
    assert call.state(SimulationState.STATE_QUITTING) == OK
    assert call.node.control.ending


def test_steps_are_counted_and_refused_while_running(call):
    assert call.result('step_simulation', steps=7) == OK
    assert_allclose(call.position('one'), [0.07, 0, 0], atol=1e-12)
    call.state(SimulationState.STATE_PLAYING)
    assert call.result('step_simulation', steps=1) == INCORRECT_STATE


def test_any_number_of_steps_ends_with_the_node(call, monkeypatch):
    states = []

    def publish(time, collisions):
        states.append(time)
        if len(states) == 3:
            call.node.end()

    monkeypatch.setattr(call.node.session, '_publish', publish)
    assert call.result('step_simulation', steps=2 ** 64 - 1) == FAILED
    assert states == [10_000_000, 20_000_000, 30_000_000]


def test_spawned_entity_moves_until_it_is_deleted(call):
    response = call.spawn('new', (0, 0, 2), frame_id='world')
    assert (response.result.result, response.entity_name) == (OK, 'new')
    assert call.entities() == ['one', 'wall', 'new']
    call('step_simulation', steps=10)
    assert_allclose(call.position('new'), [0, 0.1, 2], atol=1e-12)
    assert call.result('delete_entity', entity='new') == OK
    assert call.result('delete_entity', entity='new') == NOT_FOUND


@pytest.mark.parametrize('fields, expected', [
    ({'name': 'one'}, Response.NAME_NOT_UNIQUE),
    ({'name': 'new', 'position': (0, 0, 0.1)}, Response.INVALID_POSE),
    ({'name': 'new', 'orientation': (0, 0, 0, 0)}, Response.INVALID_POSE),
    ({'name': 'new', 'position': (0, float('nan'), 3)}, Response.INVALID_POSE),
    ({'name': 'new', 'position': (0, 0, 2e9)}, Response.INVALID_POSE),
    ({'name': 'new', 'text': '{cube: {edge: -1}, mass: 1}'}, Response.RESOURCE_PARSE_ERROR),
    ({'name': 'new', 'text': '{cube: {edge: 1}, mass: 2001-13-45}'},
     Response.RESOURCE_PARSE_ERROR),
    ({'name': 'new', 'text': ''}, Response.NO_RESOURCE),
    ({'name': 'new', 'frame_id': 'map'}, UNSUPPORTED)])
def test_what_cannot_be_spawned(call, fields, expected):
    response = call.spawn(**fields)
    assert response.result.result == expected
    assert response.result.error_message
    assert call.entities() == ['one', 'wall']
    assert not call.node.failure


def test_renaming(call):
    assert call.spawn('one', rename=True).entity_name == 'one_1'


def test_filter_that_is_none_is_no_failure_of_the_engine(call):
    assert call('get_entities', filter='^o').entities == ['one']
    for pattern in ('a{99999999999}', '('):
        for name in ('get_entities', 'get_entities_states'):
            response = call(name, filter=pattern)
            assert response.result.result == FAILED
            assert 'no regular expression' in response.result.error_message
    assert not call.node.failure
    assert call.result('step_simulation', steps=1) == OK


def test_resets_by_scope(call):
    call.spawn('new', (0, 0, 2))
    call('step_simulation', steps=10)
    assert call.result('reset_simulation', scope=Request.SCOPE_STATE) == OK
    assert call.entities() == ['one', 'wall', 'new']
    assert_allclose(call.position('new'), [0, 0, 2], atol=0)
    # time ran on: ten steps of 10 ms
    assert call.node.session.time == 100_000_000
    call('step_simulation', steps=10)
    for scope in (Request.SCOPE_TIME, Request.SCOPE_TIME | Request.SCOPE_SPAWNED):
        assert call.result('reset_simulation', scope=scope) == UNSUPPORTED
    assert call.entities() == ['one', 'wall', 'new']
    assert call.result('reset_simulation', scope=Request.SCOPE_SPAWNED) == OK
    assert call.entities() == ['one', 'wall']
    assert_allclose(call.position('one'), [0.1, 0, 0], atol=1e-12)
    # 0 is what a request has that says nothing, and means all
    assert call.result('reset_simulation', scope=0) == OK
    assert call.node.session.time == 0


def test_reset_that_would_put_bodies_into_each_other_is_refused(call):
    assert call.spawn('first').result.result == OK
    call('step_simulation', steps=50)
    # half a metre on, there is room
    assert call.spawn('second').result.result == OK
    refused = call('reset_simulation', scope=Request.SCOPE_STATE | Request.SCOPE_TIME).result
    assert refused.result == FAILED
    assert 'first would overlap second by 0.2 m' in refused.error_message
    assert call.node.session.time == 500_000_000
    assert_allclose(call.position('first'), [0, 0.5, 3], atol=1e-12)
    call('delete_entity', entity='first')
    assert call.result('reset_simulation', scope=Request.SCOPE_STATE) == OK
    assert call.entities() == ['one', 'wall', 'second']


def test_entity_state_is_set_and_told(call):
    state = call('get_entity_state', entity='one').state
    assert (state.header.frame_id, state.twist.linear.x) == ('world', 1.0)
    state.pose.position.z, state.twist.linear.x, state.twist.angular.z = 4.0, -2.0, 3.0
    assert call.result('set_entity_state', entity='one', state=state) == OK
    call('step_simulation', steps=5)
    states = call('get_entities_states')
    assert states.entities == ['one', 'wall']
    place = states.states[0].pose
    assert_allclose([place.position.x, place.position.z, 2 * np.arcsin(place.orientation.z)],
                    [-0.1, 4, 0.15], atol=1e-12)
    assert call.result('set_entity_state', entity='nobody', state=state) == NOT_FOUND
    state.pose.position.z = -9.95
    refused = call('set_entity_state', entity='one', state=state).result
    assert refused.result == FAILED
    assert 'overlap' in refused.error_message


def test_step_that_takes_long_can_be_broken_off(call, monkeypatch):
    stop = call.node.control._stop
    # what the alarm a second after the first signal does
    monkeypatch.setattr(call.node.session, 'step', lambda *_: stop._break_off(None, None))
    assert call.result('step_simulation', steps=2) == INCORRECT_STATE
    assert 'broken off' in call.node.failure


def test_nothing_is_changed_once_the_simulation_cannot_go_on(call):
    def fail(*arguments):
        raise FloatingPointError('too fast')

    call.node.session.place = fail
    assert call.result('set_entity_state', entity='one', state=entity_state()) == FAILED
    for name, fields in (('delete_entity', {'entity': 'one'}), ('step_simulation', {'steps': 1}),
                         ('get_entity_state', {'entity': 'one'}), ('get_entities', {})):
        response = call(name, **fields)
        assert response.result.result != OK
        assert 'cannot go on, only be reset' in response.result.error_message
    assert call.result('reset_simulation', scope=Request.SCOPE_ALL) == OK
    assert call.result('step_simulation', steps=1) == OK
