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

"""The services that control a session: pause, step, reset, record."""

from rigid_sim_ros.nodes.interfaces import interface
from rigid_sim_ros.topics import SERVICES


class Services:
    """Offers every row of `topics.SERVICES` with the method of this class of the same name."""

    def __init__(self, node, simulation_node):
        """Act on a `SimulationNode`."""
        self._simulation_node = simulation_node
        for row in SERVICES:
            node.create_service(interface(row.type_name), row.name,
                                getattr(self, row.name.split('/')[-1]))

    def pause(self, request, response):
        """Stop simulated time, or let it go on."""
        node = self._simulation_node
        response.success = node.set_paused(request.data)
        state = 'paused' if request.data else 'running'
        response.message = node.failure or f'{state} at {node.time_text}'
        return response

    def step(self, request, response):
        """Advance by `step_duration` while paused."""
        node = self._simulation_node
        response.success = node.step()
        response.message = (
            f'paused at {node.time_text}' if response.success
            else node.failure or 'the simulation is running: pause it first')
        return response

    def reset(self, request, response):
        """Begin again with the scene as loaded."""
        self._simulation_node.reset()
        response.success = True
        response.message = f'reset; simulated time is {self._simulation_node.time_text}'
        return response

    def record(self, request, response):
        """Start or stop recording; the message says where."""
        response.success, response.message = self._simulation_node.record(request.data)
        return response
