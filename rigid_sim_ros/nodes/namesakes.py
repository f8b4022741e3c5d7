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

"""Nodes that have the name of another: nobody could say which of them is meant."""


class Namesakes:
    """Warns when there is another node of the same name."""

    def __init__(self, node):
        self._node = node
        self._warned = False

    def look(self):
        """Warn if there is one and there was none before; call now and then."""
        name = self._node.get_fully_qualified_name()
        count = sum(f'{namespace.rstrip("/")}/{found}' == name
                    for found, namespace in self._node.get_node_names_and_namespaces())
        if count > 1 and not self._warned:
            self._node.get_logger().warning(
                f'{count} nodes are named {name} (or one was killed moments ago): they share '
                'topics and services; give one another name with --ros-args -r __node:=NAME')
        self._warned = count > 1
