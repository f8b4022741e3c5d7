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

"""The verbs of `service` and `node`."""

from rigid_sim_ros.nodes.ros2_verbs.graph import full_name, VerbError
from rigid_sim_ros.nodes.ros2_verbs.message_text import from_yaml, interface_class


def list_nodes(graph, options):
    """Print the names of all nodes."""
    graph.wait_for_all()
    for name in graph.nodes():
        print(name)


def list_services(graph, options):
    """Print the names of all services."""
    graph.wait_for_all()
    for name, types in graph.services().items():
        print(f'{name} [{", ".join(types)}]' if options.show_types else name)


def call(graph, options):
    """Call a service and print what was asked and answered."""
    name = full_name(options.service)
    service_type = interface_class('srv', options.type)
    request = from_yaml(service_type.Request, options.values)
    type_name = graph.type_of_service(name)
    if interface_class('srv', type_name) is not service_type:
        raise VerbError(f'service {name!r} has the type {type_name}, not {options.type}')
    print(f'requester: making request: {request!r}\n')
    print(f'response:\n{answer(graph, graph.node.create_client(service_type, name), request)!r}\n')


def answer(graph, client, request):
    """Return the response of a service that is known to be there."""
    if not graph.wait(client.service_is_ready):
        raise VerbError(f'service {client.srv_name!r} does not answer')
    future = client.call_async(request)
    while not graph.wait(future.done, 1.0):
        if not client.service_is_ready():
            raise VerbError(f'service {client.srv_name!r} went away without an answer')
    return future.result()
