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

"""Bytes of a command message to a `Command`, for the node and for replay of a recording."""

from rigid_sim_ros import messages
from rigid_sim_ros.nodes.commands import body_command, Command, Refused


def read_force(data):
    """Return the stamp [ns] and the `Command` in a geometry_msgs/Vector3Stamped, a force."""
    message = messages.decode_vector3_stamped(data)
    return message.time_ns, body_command(message.frame_id, force=message.vector)


def read_torque(data):
    """Return the stamp [ns] and the `Command` in a geometry_msgs/Vector3Stamped, a torque."""
    message = messages.decode_vector3_stamped(data)
    return message.time_ns, body_command(message.frame_id, torque=message.vector)


def read_wrench(data):
    """Return the stamp [ns] and the `Command` in a geometry_msgs/WrenchStamped."""
    message = messages.decode_wrench_stamped(data)
    return message.time_ns, body_command(message.frame_id, force=message.force,
                                         torque=message.torque)


def read_velocity(data):
    """Return the stamp [ns] and the `Command` in a geometry_msgs/TwistStamped."""
    message = messages.decode_twist_stamped(data)
    return message.time_ns, body_command(message.frame_id, linear_velocity=message.linear,
                                         angular_velocity=message.angular)


def states_reader():
    """
    Return a function like those above, for sensor_msgs/MultiDOFJointState.

    It remembers the names of the last message, so it serves one topic.
    """
    decoder = messages.MultiDOFJointStateDecoder()

    def read_states(data):
        message = decoder.decode(data)
        if len(message.transforms):
            raise Refused('poses', lambda: (
                'command refused: it has transforms; poses cannot be commanded, leave '
                'transforms empty'))
        given = {}
        if len(message.wrenches):
            given.update(force=message.wrenches[:, :3], torque=message.wrenches[:, 3:])
        if len(message.twists):
            given.update(linear_velocity=message.twists[:, :3],
                         angular_velocity=message.twists[:, 3:])
        return message.time_ns, Command(message.names, **given)

    return read_states


READERS = {
    '~/cmd_force': lambda: read_force,
    '~/cmd_torque': lambda: read_torque,
    '~/cmd_wrench': lambda: read_wrench,
    '~/cmd_vel': lambda: read_velocity,
    '~/cmd_states': states_reader,
}
"""For each row of `topics.COMMANDS`, what makes its reader."""
