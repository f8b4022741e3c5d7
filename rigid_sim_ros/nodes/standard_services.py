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
The services of simulation_interfaces, the standard that ROS 2 simulators share, if it is there.

They call the same functions as the node's own services. What a release of the package does not
have is not offered; nothing here runs if it is not installed.
"""

from importlib import import_module
from importlib.util import find_spec

from rigid_sim_ros.nodes.entities import (
    BadDescription, BadPlace, BadState, described_body, EntityError, NameTaken, UnknownEntity)
from rigid_sim_ros.nodes.pacing import NANOSECONDS

PACKAGE = 'simulation_interfaces'

SERVICES = (
    'GetSimulatorFeatures', 'GetSimulationState', 'SetSimulationState', 'StepSimulation',
    'ResetSimulation', 'GetEntities', 'GetEntityState', 'GetEntitiesStates', 'SetEntityState',
    'SpawnEntity', 'DeleteEntity')
"""Those that are offered, as `~/get_simulator_features` and so on."""

_FEATURES = (
    'SPAWNING', 'SPAWNING_RESOURCE_STRING', 'DELETING', 'ENTITY_STATE_GETTING',
    'ENTITY_STATE_SETTING', 'SIMULATION_RESET', 'SIMULATION_RESET_TIME',
    'SIMULATION_RESET_STATE', 'SIMULATION_RESET_SPAWNED', 'SIMULATION_STATE_GETTING',
    'SIMULATION_STATE_SETTING', 'SIMULATION_STATE_PAUSE', 'STEP_SIMULATION_SINGLE',
    'STEP_SIMULATION_MULTIPLE')

_SPAWN_ERRORS = {NameTaken: 'NAME_NOT_UNIQUE', BadDescription: 'RESOURCE_PARSE_ERROR',
                 BadPlace: 'INVALID_POSE', BadState: 'INVALID_POSE'}
"""The constants of SpawnEntity's response for what can be wrong."""


def is_available():
    """Tell whether simulation_interfaces is installed."""
    return find_spec(PACKAGE) is not None


def snake_case(name):
    """Return 'get_entity_state' for 'GetEntityState'."""
    return ''.join('_' + letter.lower() if letter.isupper() else letter
                   for letter in name).lstrip('_')


class StandardServices:
    """Offers `SERVICES` for a `SimulationNode`."""

    def __init__(self, simulation_node):
        self._node = simulation_node
        self._messages = import_module(PACKAGE + '.msg')
        self._types = import_module(PACKAGE + '.srv')
        self._stopped = False
        for name in SERVICES:
            if hasattr(self._types, name):
                simulation_node.ros.create_service(
                    getattr(self._types, name), '~/' + snake_case(name),
                    getattr(self, snake_case(name)))

    def get_simulator_features(self, request, response):
        """Tell what is supported."""
        features = self._messages.SimulatorFeatures
        response.features.features = [
            getattr(features, name) for name in _FEATURES if hasattr(features, name)]
        response.features.spawn_formats = ['rigid_sim_ros']
        response.features.custom_info = (
            'entities are spawned from what stands for a body in a scene file of rigid_sim_ros: '
            '{cube: {edge: 0.2}, mass: 1.0}')
        return response

    def get_simulation_state(self, request, response):
        """Tell whether it plays, is paused or stopped."""
        response.state.state = self._state()
        return self._ok(response)

    def set_simulation_state(self, request, response):
        """Play, pause, stop (which is pause and reset) or quit."""
        state, node = self._messages.SimulationState, self._node
        wanted = request.state.state
        if wanted not in (state.STATE_STOPPED, state.STATE_PLAYING, state.STATE_PAUSED,
                          state.STATE_QUITTING):
            return self._unsupported(response, f'state {wanted}')
        if wanted == self._state():
            return self._answer(response, type(response).ALREADY_IN_TARGET_STATE)
        self._stopped = False
        if wanted == state.STATE_QUITTING:
            node.end()
        elif not node.set_paused(wanted != state.STATE_PLAYING):
            return self._answer(response, type(response).STATE_TRANSITION_ERROR, node.failure)
        elif wanted == state.STATE_STOPPED:
            node.reset(time_from_zero=True)
            self._stopped = True
        return self._ok(response)

    def step_simulation(self, request, response):
        """Advance by `step_duration` so many times, while paused."""
        result = self._messages.Result
        for _ in range(request.steps):
            if self._node.control.ending:
                return self._answer(response, result.RESULT_OPERATION_FAILED, 'the node ends')
            if not self._node.step():
                return self._answer(
                    response, result.RESULT_INCORRECT_STATE,
                    self._node.failure or 'the simulation is running: pause it first')
            self._stopped = False
        return self._ok(response)

    def reset_simulation(self, request, response):
        """Begin again: state and, if asked for, time; spawned entities stay if not asked for."""
        kind = type(request)
        scope = request.scope or kind.SCOPE_ALL
        if scope & kind.SCOPE_TIME and not scope & kind.SCOPE_STATE:
            return self._unsupported(response, 'a reset of time but not of the state')
        if scope & kind.SCOPE_STATE:
            keep_bodies = not scope & kind.SCOPE_SPAWNED
            try:
                if keep_bodies:
                    self._node.entities.check_reset()
            except EntityError as error:
                return self._answer(
                    response, self._messages.Result.RESULT_OPERATION_FAILED, error)
            self._node.reset(time_from_zero=bool(scope & kind.SCOPE_TIME),
                             keep_bodies=keep_bodies)
            return self._ok(response)

        def delete_spawned():
            with self._node.control.failing_softly():
                for name in self._node.session.added_names:
                    self._node.entities.delete(name)

        return self._do(response, self._entity_result, delete_spawned)

    def get_entities(self, request, response):
        """Tell the names of all bodies."""
        return self._with_entities(request, response, lambda names: {'entities': names})

    def get_entities_states(self, request, response):
        """Tell the names and states of all bodies."""
        return self._with_entities(request, response, lambda names: {
            'entities': names, 'states': [self._entity_state(name) for name in names]})

    def get_entity_state(self, request, response):
        """Tell where a body is and how it moves."""
        def tell():
            with self._node.control.failing_softly():
                response.state = self._entity_state(request.entity)

        return self._do(response, self._entity_result, tell)

    def set_entity_state(self, request, response):
        """Place a body and set its velocity."""
        if not self._is_world(request.state.header.frame_id):
            return self._unsupported(response, f'frame {request.state.header.frame_id!r}')
        pose, twist = request.state.pose, request.state.twist

        def place():
            with self._node.control.failing_softly():
                self._node.entities.place(
                    request.entity, position=_vector(pose.position),
                    orientation=_quaternion(pose.orientation), velocity=_vector(twist.linear),
                    angular_velocity=_vector(twist.angular))

        return self._do(response, self._entity_result, place)

    def spawn_entity(self, request, response):
        """Add a body, described as in a scene file."""
        # before release 2 the resource was not a message of its own
        resource = getattr(request, 'entity_resource', request)
        if request.entity_namespace:
            return self._unsupported(response, 'a namespace: bodies have no topics of their own')
        if not self._is_world(request.initial_pose.header.frame_id):
            return self._unsupported(response,
                                     f'frame {request.initial_pose.header.frame_id!r}')
        if not (resource.uri or resource.resource_string):
            return self._answer(response, type(response).NO_RESOURCE,
                                'uri and resource_string are empty')
        pose = request.initial_pose.pose

        def spawn():
            body = described_body(resource.resource_string, resource.uri)
            with self._node.control.failing_softly():
                response.entity_name = self._node.entities.spawn(
                    body, request.name, request.allow_renaming, position=_vector(pose.position),
                    orientation=_quaternion(pose.orientation))

        return self._do(
            response, lambda error: self._spawn_result(response, error), spawn)

    def delete_entity(self, request, response):
        """Take a body out."""
        def delete():
            with self._node.control.failing_softly():
                self._node.entities.delete(request.entity)

        return self._do(response, self._entity_result, delete)

    # -- inside --------------------------------------------------------------------------------

    def _state(self):
        state = self._messages.SimulationState
        if not self._node.control.paused:
            self._stopped = False
            return state.STATE_PLAYING
        return state.STATE_STOPPED if self._stopped else state.STATE_PAUSED

    def _is_world(self, frame_id):
        return frame_id in ('', self._node.parameters.world_frame)

    def _with_entities(self, request, response, fields):
        filters = request.filters
        if len(filters.categories) or len(filters.tags.tags) or filters.bounds.type:
            return self._unsupported(response, 'a filter by category, tag or bounds')

        def tell():
            names = self._node.entities.matching(filters.filter)
            with self._node.control.failing_softly():
                for field, value in fields(list(names)).items():
                    setattr(response, field, value)

        return self._do(response, self._entity_result, tell)

    def _entity_state(self, name):
        body, time = self._node.entities.body(name), self._node.session.time
        state = self._messages.EntityState()
        state.header.frame_id = self._node.parameters.world_frame
        state.header.stamp.sec, state.header.stamp.nanosec = divmod(time, NANOSECONDS)
        for target, values in ((state.pose.position, body.position),
                               (state.pose.orientation, body.orientation),
                               (state.twist.linear, body.velocity),
                               (state.twist.angular, body.angular_velocity)):
            for axis, value in zip('xyzw', values):
                setattr(target, axis, float(value))
        return state

    def _do(self, response, result_of, act):
        """Do what needs a simulation that can go on, by `act()`, and answer how it went."""
        node = self._node
        try:
            if not node.failure:
                act()
        except EntityError as error:
            return self._answer(response, result_of(error), error)
        if node.failure:
            return self._answer(response, self._messages.Result.RESULT_OPERATION_FAILED,
                                node.failure)
        return self._ok(response)

    def _entity_result(self, error):
        result = self._messages.Result
        return (result.RESULT_NOT_FOUND if isinstance(error, UnknownEntity)
                else result.RESULT_OPERATION_FAILED)

    def _spawn_result(self, response, error):
        name = _SPAWN_ERRORS.get(type(error), '')
        return getattr(type(response), name, self._messages.Result.RESULT_OPERATION_FAILED)

    def _ok(self, response):
        return self._answer(response, self._messages.Result.RESULT_OK)

    def _unsupported(self, response, what):
        return self._answer(response, self._messages.Result.RESULT_FEATURE_UNSUPPORTED,
                            f'{what} is not supported')

    def _answer(self, response, result, message=''):
        response.result.result = result
        response.result.error_message = str(message)
        return response


def _vector(message):
    return (message.x, message.y, message.z)


def _quaternion(message):
    return (message.x, message.y, message.z, message.w)
