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

"""The subscribed topics: bytes to `Command`, carried out or refused with a warning."""

from functools import partial

from rclpy.qos_overriding_options import QoSOverridingOptions

from rigid_sim_ros import messages
from rigid_sim_ros.nodes.command_readers import READERS
from rigid_sim_ros.nodes.commands import Refused
from rigid_sim_ros.nodes.interfaces import interface, quality_of_service
from rigid_sim_ros.topics import COMMANDS


class CommandTopics:
    """Subscribes to every command topic and hands over what arrives."""

    def __init__(self, node, take, refused):
        """
        Call `take(command, stamp, rank, topic, data)` for each; it may raise `Refused`.

        Stamps are in nanoseconds, `rank` and `topic` are the number and name of the row of
        `topics.COMMANDS`, and `data` are the bytes received.
        """
        self._take = take
        self._refused = refused
        for rank, row in enumerate(COMMANDS):
            node.create_subscription(
                interface(row.type_name), row.name,
                partial(self._receive, READERS[row.name](), rank, row.name),
                quality_of_service(row.quality), raw=True,
                qos_overriding_options=QoSOverridingOptions.with_default_policies())

    def _receive(self, read, rank, topic, data):
        try:
            stamp, command = read(data)
            self._take(command, stamp, rank, topic, data)
        except messages.MessageError as error:
            text = f'message on {topic} refused: {error}'
            self._refused.add('malformed', lambda: text)
        except Refused as reason:
            describe = reason.describe
            self._refused.add(reason.kind, lambda: f'{topic}: {describe()}')
