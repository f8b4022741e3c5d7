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

"""Who publishes /clock: one node, or everybody who is told to."""

from rigid_sim_ros.topics import PUBLISHED

ROW = next(row for row in PUBLISHED if row.parameter == 'publish_clock')

_UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""The name rcl gives a node that has not been discovered yet."""


class ClockSource:
    """
    Publishes /clock if the parameter says so, and if it says nothing, while nobody else does.

    Two sources of one clock make every listener's time jump back and forth. A node that was told
    nothing leaves /clock to a publisher that is already there, for as long as there is one. If two
    such nodes find that they both publish, because they started before they saw each other, the
    one with the larger identifier stops.
    """

    def __init__(self, node, publications, parameters):
        self._node = node
        self._publications = publications
        self._parameters = parameters
        self._own = frozenset()
        self._told = 'publish_clock' in parameters.given
        parameters.when_changed('publish_clock', self._obey)
        others = [] if self._told else self._publishers()
        if others:
            self._say_left_to(next(iter(others.values())))
        elif parameters.publish_clock:
            self._begin()

    def look(self):
        """Stop if somebody else publishes too, begin if nobody does; call now and then."""
        if self._told:
            return
        publishers = self._publishers()
        if not self._publications.is_open(ROW):
            if not publishers:
                self._begin()
                self._node.get_logger().info(f'nobody publishes {ROW.name} any more: begun')
            return
        first = min(publishers, default=None)
        if len(publishers) > 1 and not self._is_own(first, publishers[first]):
            self._publications.end(ROW)
            self._say_left_to(publishers[first])

    def _obey(self):
        self._told = True
        if self._parameters.publish_clock:
            self._begin()
        else:
            self._publications.end(ROW)

    def _begin(self):
        # rclpy does not tell the identifier of a publisher: it is the one that is new
        before = self._publishers()
        self._publications.begin(ROW)
        self._own = self._publishers().keys() - before.keys()

    def _publishers(self):
        """Return who publishes it: endpoint information by identifier."""
        return {bytes(info.endpoint_gid): info
                for info in self._node.get_publishers_info_by_topic(ROW.name)}

    def _is_own(self, identifier, info):
        # not every middleware knows a publisher as soon as it is made
        return identifier in self._own if self._own else (
            info.node_name, info.node_namespace) == (
                self._node.get_name(), self._node.get_namespace())

    def _say_left_to(self, info):
        self._node.get_logger().info(
            f'{ROW.name} is left to {name_of(info)}; set publish_clock to publish it too')


def name_of(info):
    """Return the name of the node of an endpoint; its publisher may be known before it is."""
    if info.node_name == _UNKNOWN:
        return 'another node'
    return f'{info.node_namespace.rstrip("/")}/{info.node_name}'
