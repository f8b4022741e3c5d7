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
The executable rigid_sim_send: one message to a topic, for machines without the command `ros2`.

It takes what `ros2 topic pub --once` takes: topic, type and the message as YAML.
"""

import argparse
import re
import sys
import time

import rclpy
from rclpy.duration import Duration
from rigid_sim_ros.nodes.interfaces import interface
import yaml

PATIENCE = 5.0
"""How long to wait for somebody who takes the message [s of wall time]."""


class MessageTextError(ValueError):
    """The text is not a message of the type; the text of this says where, in one line."""


def main(arguments=None):
    """Send one message; returns the exit code: 0, 1 if nobody takes it, 2 if it is wrong."""
    parser = argparse.ArgumentParser(
        'rigid_sim_send', description='Send one message to a topic.',
        epilog='example: rigid_sim_send /rigid_sim/cmd_vel geometry_msgs/msg/TwistStamped '
               '"{header: {frame_id: cube_1}, twist: {linear: {z: 3.0}}}"')
    parser.add_argument('topic', help='its full name')
    parser.add_argument('type', help='of the messages, e.g. geometry_msgs/msg/TwistStamped')
    parser.add_argument('message', help='as YAML; what is not given is zero')
    options = parser.parse_args(arguments)
    try:
        message = message_of(options.type, options.message)
    except MessageTextError as error:
        print(f'rigid_sim_send: {error}', file=sys.stderr)
        return 2
    if not send(options.topic, message):
        print(f'rigid_sim_send: nobody takes {options.type} on {options.topic}: is the node '
              'running, with the same ROS_DOMAIN_ID?', file=sys.stderr)
        return 1
    return 0


def message_of(type_name, text):
    """Return the message of a type, such as 'std_msgs/msg/String', that a YAML text describes."""
    try:
        message = interface(type_name)(check_fields=True)
    except (AttributeError, ImportError, ValueError):
        raise MessageTextError(f'there is no message type {type_name!r} here') from None
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise MessageTextError(f'not YAML: {" ".join(str(error).split())}') from None
    return _filled(message, values, 'message')


def send(topic, message):
    """Publish a message once to all who subscribe, and tell whether anybody received it."""
    rclpy.init(args=[])
    try:
        publisher = rclpy.create_node('rigid_sim_send').create_publisher(type(message), topic, 10)
        deadline = time.monotonic() + PATIENCE
        while not publisher.get_subscription_count():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.02)
        publisher.publish(message)
        return publisher.wait_for_all_acked(Duration(seconds=PATIENCE))
    finally:
        rclpy.shutdown()


def _filled(message, values, place):
    """Return the message with values set; `place` is its name in errors."""
    if not isinstance(values, dict):
        raise MessageTextError(f'{place} is {values!r}; allowed: a mapping')
    types = message.get_fields_and_field_types()
    for name, value in values.items():
        if name not in types:
            raise MessageTextError(f'{place} has no field {name!r}; allowed: {", ".join(types)}')
        inside = f'{place}.{name}'
        try:
            setattr(message, name, _value(getattr(message, name), types[name], value, inside))
        except AssertionError:
            raise MessageTextError(f'{inside} is {value!r}; allowed: {types[name]}') from None
    return message


def _value(present, type_name, value, place):
    """Return what to set a field to that has the value `present` now."""
    if hasattr(present, 'get_fields_and_field_types'):
        return _filled(type(present)(check_fields=True), value, place)
    element = re.fullmatch(r'sequence<(\w+)/(\w+)>', type_name)
    if element and isinstance(value, list):
        make = interface(f'{element[1]}/msg/{element[2]}')
        return [_filled(make(check_fields=True), part, f'{place}[{index}]')
                for index, part in enumerate(value)]
    if isinstance(present, float) and type(value) is int:
        return float(value)
    return value
