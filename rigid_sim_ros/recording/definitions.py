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
What the messages of a recording look like: definition texts and type hashes.

A recording must explain itself to whoever opens it, so every channel carries the full text of its
message and of all messages in it. The texts are shipped (`message_definitions.json`): they belong
to the bytes this package makes, and a recording needs no ROS. They are those of ROS 2 Jazzy,
copied from an installation by

    python -m rigid_sim_ros.recording.definitions PREFIX/share
"""

from functools import lru_cache
import json
from pathlib import Path
import re
import sys

ROS_DISTRO = 'jazzy'

ROOT_TYPES = (
    'diagnostic_msgs/msg/DiagnosticArray', 'geometry_msgs/msg/PoseArray',
    'geometry_msgs/msg/TwistStamped', 'geometry_msgs/msg/Vector3Stamped',
    'geometry_msgs/msg/WrenchStamped', 'rosgraph_msgs/msg/Clock',
    'sensor_msgs/msg/MultiDOFJointState', 'sensor_msgs/msg/PointCloud2', 'std_msgs/msg/String',
    'visualization_msgs/msg/MarkerArray')
"""The types that can be recorded; the shipped file has these and what they are made of."""

_FILE = Path(__file__).with_name('message_definitions.json')

_PRIMITIVES = frozenset((
    'bool', 'byte', 'char', 'float32', 'float64', 'int8', 'uint8', 'int16', 'uint16', 'int32',
    'uint32', 'int64', 'uint64', 'string', 'wstring'))

_SEPARATOR = '=' * 80


@lru_cache(maxsize=None)
def _shipped():
    return json.loads(_FILE.read_text(encoding='utf-8'))


def _entry(type_name):
    try:
        return _shipped()[type_name]
    except KeyError:
        raise ValueError(f'no definition of message type {type_name!r}; known: '
                         f'{", ".join(ROOT_TYPES)}') from None


def type_hash(type_name):
    """Return the RIHS01 hash of a message type; ValueError if it is not known."""
    return _entry(type_name)['hash']


@lru_cache(maxsize=None)
def schema_text(type_name):
    """
    Return a message definition with all it depends on, as MCAP's encoding `ros2msg` wants it.

    The text of the type comes first, then that of each type in it, once, after a line of 80
    equals signs and one that names it. ValueError if the type is not known.
    """
    parts = [_entry(type_name)['text']]
    for name in _dependencies_of(type_name):
        package, _, short = name.split('/')
        parts.append(f'{_SEPARATOR}\nMSG: {package}/{short}\n{_entry(name)["text"]}')
    return '\n'.join(part.rstrip('\n') for part in parts) + '\n'


def _dependencies_of(type_name):
    found, pending = [], [type_name]
    while pending:
        for name in dependencies(pending[0], _entry(pending[0])['text']):
            if name not in found:
                found.append(name)
                pending.append(name)
        pending.pop(0)
    return found


def dependencies(type_name, text):
    """Return the types of the fields of a message, in order, without primitive ones."""
    package = type_name.split('/')[0]
    found = []
    for line in text.splitlines():
        words = line.partition('#')[0].split()
        if len(words) < 2 or '=' in words[1] or words[2:3] == ['=']:
            continue
        name = re.sub(r'\[.*|<=.*', '', words[0])
        if name not in _PRIMITIVES:
            parts = name.split('/')
            found.append(f'{parts[0] if len(parts) > 1 else package}/msg/{parts[-1]}')
    return found


def collect(share):
    """Return the file's content, read from the share folder of a ROS installation."""
    found, pending = {}, list(ROOT_TYPES)
    while pending:
        type_name = pending.pop()
        if type_name in found:
            continue
        package, _, short = type_name.split('/')
        folder = Path(share) / package / 'msg'
        text = (folder / f'{short}.msg').read_text(encoding='utf-8')
        hashes = json.loads((folder / f'{short}.json').read_text(encoding='utf-8'))['type_hashes']
        found[type_name] = {
            'hash': next(row['hash_string'] for row in hashes if row['type_name'] == type_name),
            'text': text}
        pending += dependencies(type_name, text)
    return dict(sorted(found.items()))


if __name__ == '__main__':
    _FILE.write_text(json.dumps(collect(sys.argv[1]), indent=1) + '\n', encoding='utf-8')
