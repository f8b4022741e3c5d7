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

"""The verbs of `topic`: who publishes what, how often, and publishing oneself."""

from math import sqrt
import time

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rigid_sim_ros.nodes.ros2_verbs import graph as graphs
from rigid_sim_ros.nodes.ros2_verbs.graph import full_name, VerbError
from rigid_sim_ros.nodes.ros2_verbs.message_text import (
    from_yaml, interface_class, LONGEST_SHOWN, to_yaml)

_DEPTH = 100

_REPORT_INTERVAL = 1.0
"""Wall time [s] between two lines of `topic hz`."""

_LARGEST_WINDOW = 10000
"""Intervals that a line of `topic hz` is about, at most."""


def list_topics(graph, options):
    """Print the names of all topics."""
    graph.wait_for_all()
    for name, types in graph.topics().items():
        print(f'{name} [{", ".join(types)}]' if options.show_types else name)


def info(graph, options):
    """Print a topic's type and the numbers of its publishers and subscriptions."""
    topic = full_name(options.topic)
    type_name = graph.type_of_topic(topic)
    graph.wait_for_all()
    print(f'Type: {type_name}')
    print(f'Publisher count: {graph.node.count_publishers(topic)}')
    print(f'Subscription count: {graph.node.count_subscribers(topic)}')


def echo(graph, options):
    """Print messages for ever, or one if only one is asked for."""
    topic = full_name(options.topic)
    message_type = _type_on(graph, topic, options.type)
    path = options.field.split('.') if options.field else []
    _part(message_type(), path)
    longest = None if options.full_length else LONGEST_SHOWN
    count = 0

    def show(message):
        nonlocal count
        count += 1
        if count == 1 or not options.once:
            part = _part(message, path)
            print(to_yaml(part, longest, not options.no_arr)
                  if hasattr(part, 'SLOT_TYPES') else f'{part}\n', end='---\n')

    graph.node.create_subscription(message_type, topic, show, _quality(graph, topic))
    while not (options.once and count):
        graph.spin()


def hz(graph, options):
    """Print each second how often messages came so far."""
    topic = full_name(options.topic)
    arrivals = []
    graph.node.create_subscription(
        _type_on(graph, topic), topic, lambda data: arrivals.append(time.monotonic()),
        _quality(graph, topic), raw=True)
    due = time.monotonic() + _REPORT_INTERVAL
    latest = None
    while True:
        graph.spin()
        if time.monotonic() >= due:
            due += _REPORT_INTERVAL
            del arrivals[:-_LARGEST_WINDOW - 1]
            if len(arrivals) > 1 and arrivals[-1] != latest:
                latest = arrivals[-1]
                print(rate_text(arrivals))


def rate_text(arrivals):
    """Return the mean rate of arrivals at some times [s], and how much their intervals differ."""
    intervals = [later - sooner for sooner, later in zip(arrivals, arrivals[1:])]
    mean = sum(intervals) / len(intervals)
    deviation = sqrt(sum((interval - mean) ** 2 for interval in intervals) / len(intervals))
    return (f'average rate: {1 / mean:.3f}\n\tmin: {min(intervals):.3f}s '
            f'max: {max(intervals):.3f}s std dev: {deviation:.5f}s window: {len(intervals)}')


def publish(graph, options):
    """Publish a message: once, some times, or for ever."""
    topic = full_name(options.topic)
    message = from_yaml(interface_class('msg', options.type), options.values)
    times = 1 if options.once else options.times
    if times:
        _type_on(graph, topic, options.type)
    publisher = graph.node.create_publisher(type(message), topic, 10)
    if times:
        _wait_for_subscription(graph, publisher)
    print('publisher: beginning loop')
    count, due = 0, time.monotonic()
    while not times or count < times:
        count += 1
        print(f'publishing #{count}: {message!r}\n')
        publisher.publish(message)
        due += 1 / options.rate
        if count != times:
            time.sleep(max(0.0, due - time.monotonic()))
    if not publisher.wait_for_all_acked(Duration(seconds=graphs.PATIENCE)):
        raise VerbError(f'published on {topic}, but a subscriber did not acknowledge it')


def _wait_for_subscription(graph, publisher):
    if not publisher.get_subscription_count():
        print('Waiting for at least 1 matching subscription(s)...')
        if not graph.wait(publisher.get_subscription_count):
            raise VerbError(f'nobody subscribes to {publisher.topic_name}')


def _type_on(graph, topic, wanted=None):
    """Return the type of a topic; it has to be the one that is wanted, if one is."""
    wanted_type = None if wanted is None else interface_class('msg', wanted)
    type_name = graph.type_of_topic(topic)
    message_type = interface_class('msg', type_name)
    if wanted_type not in (None, message_type):
        raise VerbError(f'topic {topic!r} has the type {type_name}, not {wanted}')
    return message_type


def _part(message, path):
    """Return a part of a message, such as that at ['pose', 'position']."""
    part = message
    for name in path:
        fields = getattr(part, 'get_fields_and_field_types', dict)()
        if name not in fields:
            raise VerbError(f'there is no field {".".join(path)!r}: {name!r} is not one of '
                            f'{", ".join(fields) or "none"}')
        part = getattr(part, name)
    return part


def _quality(graph, topic):
    """Return the quality of service that gets the most of all publishers of a topic."""
    profiles = [publisher.qos_profile
                for publisher in graph.node.get_publishers_info_by_topic(topic)]
    reliable = bool(profiles) and all(
        profile.reliability == ReliabilityPolicy.RELIABLE for profile in profiles)
    latched = bool(profiles) and all(
        profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for profile in profiles)
    return QoSProfile(
        depth=_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE)
