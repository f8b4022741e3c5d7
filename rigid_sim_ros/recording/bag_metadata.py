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
What rosbag2 wants to know about a bag: metadata.yaml beside it, and QoS text in it.

Version 9 of the format, that of ROS 2 Jazzy (rosbag2_storage: yaml.hpp, qos.cpp).
"""

from dataclasses import dataclass, field
from functools import lru_cache
import json
import os
import re

from rigid_sim_ros.recording.definitions import ROS_DISTRO, schema_text, type_hash
import yaml

METADATA_FILE = 'metadata.yaml'
ROOT_KEY = 'rosbag2_bagfile_information'
VERSION = 9

_PLAIN = re.compile(r'[A-Za-z/_][A-Za-z0-9/_.]*')

_RESERVED = frozenset(('true', 'false', 'null', 'yes', 'no', 'on', 'off', 'y', 'n'))

_INFINITE = {'sec': 9223372036, 'nsec': 854775807}


@dataclass(frozen=True)
class BagTopic:
    """A topic as a bag declares it."""

    name: str
    type_name: str
    profiles: str
    """Quality of service: YAML, a list of `offered_qos_profiles` as rosbag2 has them."""

    type_hash: str
    definition: str
    """The message definition with all it depends on."""

    @property
    def is_latched(self):
        """Whether late subscribers are to get the last message."""
        return 'durability: transient_local' in self.profiles


def bag_topic(row):
    """Return the `BagTopic` of a row with a full name, a type_name and a quality."""
    return BagTopic(row.name, row.type_name, to_yaml([quality_profile(row.quality)]),
                    type_hash(row.type_name), schema_text(row.type_name))


@dataclass
class FileSummary:
    """What is in one file of a bag; times in nanoseconds."""

    path: str
    start_ns: int = 0
    end_ns: int = 0
    counts: dict = field(default_factory=dict)
    """Number of messages by topic."""

    @property
    def message_count(self):
        """Return the number of messages in all topics."""
        return sum(self.counts.values())

    def add(self, topic, time_ns, count=1):
        """Count messages of a topic at a time."""
        if not self.message_count:
            self.start_ns = self.end_ns = time_ns
        self.start_ns = min(self.start_ns, time_ns)
        self.end_ns = max(self.end_ns, time_ns)
        self.counts[topic] = self.counts.get(topic, 0) + count


def quality_profile(quality):
    """Return one `offered_qos_profiles` entry for a quality of service."""
    return {
        'history': 'keep_last', 'depth': quality.depth, 'reliability': quality.reliability,
        'durability': quality.durability, 'deadline': dict(_INFINITE), 'lifespan': dict(_INFINITE),
        'liveliness': 'automatic', 'liveliness_lease_duration': dict(_INFINITE),
        'avoid_ros_namespace_conventions': False}


def quality_profiles(topic):
    """Return the quality of service of a `BagTopic` as a list of dicts; empty if unreadable."""
    return _parsed(topic.profiles)


@lru_cache(maxsize=256)
def _parsed(text):
    try:
        # no aliases, with which a short text can stand for an endless one
        profiles = [] if '&' in text else yaml.safe_load(text)
    except yaml.YAMLError:
        return []
    return [item for item in profiles if isinstance(item, dict)] if isinstance(
        profiles, list) else []


def bag_metadata(topics, files):
    """
    Return what metadata.yaml holds under its root key.

    `topics` are `BagTopic`; `files` are `FileSummary`, oldest first.
    """
    counts = {topic.name: sum(file.counts.get(topic.name, 0) for file in files)
              for topic in topics}
    filled = [file for file in files if file.message_count]
    start = min((file.start_ns for file in filled), default=0)
    end = max((file.end_ns for file in filled), default=0)
    return {
        'version': VERSION,
        'storage_identifier': 'mcap',
        'duration': {'nanoseconds': end - start},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': sum(counts.values()),
        'topics_with_message_count': [{
            'topic_metadata': {
                'name': topic.name, 'type': topic.type_name, 'serialization_format': 'cdr',
                'offered_qos_profiles': quality_profiles(topic),
                'type_description_hash': topic.type_hash},
            'message_count': counts[topic.name]} for topic in topics],
        'compression_format': '', 'compression_mode': '',
        'relative_file_paths': [file.path for file in files],
        'files': [{
            'path': file.path,
            'starting_time': {'nanoseconds_since_epoch': file.start_ns},
            'duration': {'nanoseconds': file.end_ns - file.start_ns},
            'message_count': file.message_count} for file in files],
        'custom_data': {}, 'ros_distro': ROS_DISTRO}


def to_yaml(value, indent=''):
    """
    Return dicts, lists, text, integers and booleans as YAML in block style.

    PyYAML takes 50 ms for a bag's metadata, with the interpreter to itself: too long beside a
    simulation in real time.
    """
    if isinstance(value, dict) and value:
        return ''.join(f'{indent}{_scalar(key)}:{_nested(item, indent)}'
                       for key, item in value.items())
    if isinstance(value, list) and value:
        # the first line of an item is behind its dash
        items = (_nested_item(item, indent) for item in value)
        return ''.join(f'{indent}- {item}' for item in items)
    return f'{indent}{_scalar(value)}\n'


def _nested(value, indent):
    if isinstance(value, (dict, list)) and value:
        return '\n' + to_yaml(value, indent + '  ')
    return f' {_scalar(value)}\n'


def _nested_item(value, indent):
    return to_yaml(value, indent + '  ')[len(indent) + 2:]


def _scalar(value):
    """Return a scalar or an empty collection, in quotes if it could be taken for another."""
    if isinstance(value, str) and _PLAIN.fullmatch(value) and value.lower() not in _RESERVED:
        return value
    return json.dumps(value)


def write_metadata(folder, topics, files):
    """
    Write metadata.yaml of a bag, and return its path.

    It is written in one stroke: whoever reads sees the old or the new one.
    """
    path = os.path.join(folder, METADATA_FILE)
    text = to_yaml({ROOT_KEY: bag_metadata(topics, files)})
    with open(path + '.new', 'w', encoding='utf-8') as stream:
        stream.write(text)
    os.replace(path + '.new', path)
    return path
