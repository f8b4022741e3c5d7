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

"""The verbs of `param`."""

from rcl_interfaces.msg import Parameter, ParameterType
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.parameter import get_parameter_value, parameter_value_to_python
from rigid_sim_ros.nodes.ros2_verbs.graph import full_name, VerbError
from rigid_sim_ros.nodes.ros2_verbs.service_verbs import answer

_LABELS = {
    ParameterType.PARAMETER_BOOL: 'Boolean value is',
    ParameterType.PARAMETER_INTEGER: 'Integer value is',
    ParameterType.PARAMETER_DOUBLE: 'Double value is',
    ParameterType.PARAMETER_STRING: 'String value is',
    ParameterType.PARAMETER_BYTE_ARRAY: 'Byte values are',
    ParameterType.PARAMETER_BOOL_ARRAY: 'Boolean values are',
    ParameterType.PARAMETER_INTEGER_ARRAY: 'Integer values are',
    ParameterType.PARAMETER_DOUBLE_ARRAY: 'Double values are',
    ParameterType.PARAMETER_STRING_ARRAY: 'String values are',
}


def list_parameters(graph, options):
    """Print the names of a node's parameters, or of those of all nodes."""
    if options.node is not None:
        for name in _names(graph, full_name(options.node)):
            print(f'  {name}')
        return
    graph.wait_for_all()
    for node in graph.nodes():
        if f'{node}/list_parameters' in graph.services():
            print(f'{node}:')
            for name in _names(graph, node):
                print(f'  {name}')


def get(graph, options):
    """Print the value of a parameter."""
    response = _ask(graph, full_name(options.node), 'get_parameters', GetParameters,
                    names=[options.name])
    value = response.values[0] if response.values else None
    if value is None or value.type not in _LABELS:
        raise VerbError(f'node {options.node} has no parameter {options.name!r}')
    print(f'{_LABELS[value.type]}: {parameter_value_to_python(value)}')


def set_value(graph, options):
    """Set a parameter, or say why the node refused it."""
    parameter = Parameter(name=options.name, value=get_parameter_value(options.value))
    response = _ask(graph, full_name(options.node), 'set_parameters', SetParameters,
                    parameters=[parameter])
    result, = response.results
    if not result.successful:
        raise VerbError(f'Setting parameter failed: {result.reason}')
    print('Set parameter successful')


def _names(graph, node):
    return sorted(_ask(graph, node, 'list_parameters', ListParameters).result.names)


def _ask(graph, node, service, service_type, **fields):
    graph.wait_for_node(node)
    client = graph.node.create_client(service_type, f'{node}/{service}')
    return answer(graph, client, service_type.Request(**fields))
