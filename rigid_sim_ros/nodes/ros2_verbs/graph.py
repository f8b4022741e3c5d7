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

"""A look at the ROS graph from outside: a hidden node, and waiting for what others offer."""

import os
import time

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rigid_sim_ros.nodes.counted_warnings import near_names_only
from rigid_sim_ros.nodes.executors import LONGEST_WAIT

PATIENCE = 5.0
"""Wall time [s] to wait for others; on an idle machine they are found within 0.3 s."""

STILLNESS = 1.5
"""Wall time [s] without news after which those who have been found are taken to be all."""


class VerbError(Exception):
    """The command cannot be carried out; the text of this says why, in one line."""


def full_name(name):
    """Return the full name of a topic, service or node that may lack the first slash."""
    return name if name.startswith('/') else '/' + name


class Graph:
    """The nodes, topics and services that are there, and a node of our own among them."""

    def __enter__(self):
        self._context = Context()
        rclpy.init(args=[], context=self._context)
        # a leading underscore hides the node from lists of nodes
        self.node = Node(f'_rigid_sim_ros2_{os.getpid()}', context=self._context,
                         use_global_arguments=False, enable_rosout=False,
                         start_parameter_services=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        return self

    def __exit__(self, *exception):
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def spin(self):
        """Take one message or answer, if one comes soon."""
        self._executor.spin_once(timeout_sec=LONGEST_WAIT)

    def wait(self, condition, patience=None):
        """Wait until a condition is true and return its value; something false if it never is."""
        deadline = time.monotonic() + (PATIENCE if patience is None else patience)
        while not (value := condition()) and time.monotonic() < deadline:
            self.spin()
        return value

    def wait_for_all(self):
        """Wait until everybody who is there has been found."""
        self._wait_until_found(lambda: False)

    def nodes(self):
        """Return the full names of the nodes, sorted."""
        pairs = self.node.get_node_names_and_namespaces()
        return sorted(f'{namespace.rstrip("/")}/{name}' for name, namespace in pairs
                      if not name.startswith('_'))

    def topics(self):
        """Return the types of each topic by its name, sorted."""
        return _visible(self.node.get_topic_names_and_types())

    def services(self):
        """Return the types of each service by its name, sorted."""
        return _visible(self.node.get_service_names_and_types())

    def type_of_topic(self, name):
        """Return the type of a topic, waiting for it; if there is none say what there is."""
        return self._find('topic', name, self.topics)

    def type_of_service(self, name):
        """Return the type of a service, waiting for it; if there is none say what there is."""
        return self._find('service', name, self.services)

    def wait_for_node(self, name):
        """Wait until a node is there; if there is none say what there is."""
        self._find('node', name, lambda: dict.fromkeys(self.nodes(), ('',)))

    def _find(self, kind, name, listing):
        self._wait_until_found(lambda: name in listing())
        found = listing()
        if name not in found:
            raise VerbError(f'there is no {kind} {name!r}{self._explanation(name, found)}')
        if len(found[name]) > 1:
            raise VerbError(f'{kind} {name!r} has more than one type: {", ".join(found[name])}')
        return found[name][0]

    def _explanation(self, name, found):
        if not self.nodes():
            return (', and no node at all: is one running, with the same ROS_DOMAIN_ID '
                    f'({os.environ.get("ROS_DOMAIN_ID", 0)}) and discovery range?')
        near = near_names_only(name, found)
        return f'; {near}' if near else ''

    def _wait_until_found(self, condition):
        """Wait until a condition holds, or others are there and nothing changes any more."""
        known, changed = None, time.monotonic()

        def finished():
            nonlocal known, changed
            if condition():
                return True
            now = self.nodes(), self.topics(), self.services()
            if now != known:
                known, changed = now, time.monotonic()
            return bool(self.nodes()) and time.monotonic() - changed > STILLNESS

        self.wait(finished)


def _visible(names_and_types):
    return {name: tuple(types) for name, types in sorted(names_and_types)
            if not topic_or_service_is_hidden(name)}
