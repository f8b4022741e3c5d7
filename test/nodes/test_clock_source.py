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

"""What is said of somebody else who publishes /clock, as rcl tells of it."""

from types import SimpleNamespace

import pytest

pytest.importorskip('rclpy')

from rigid_sim_ros.nodes.clock_source import name_of  # noqa: E402


@pytest.mark.parametrize('name, namespace, text', [
    ('player', '/', '/player'),
    ('player', '/arena', '/arena/player'),
    # an endpoint may be known before the node it belongs to
    ('_NODE_NAME_UNKNOWN_', '_NODE_NAMESPACE_UNKNOWN_', 'another node')])
def test_the_node_of_an_endpoint_is_named_as_ros_does(name, namespace, text):
    """By its full name, if that is known."""
    assert name_of(SimpleNamespace(node_name=name, node_namespace=namespace)) == text
