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

"""Small messages: std_msgs/String, rosgraph_msgs/Clock and diagnostic_msgs/DiagnosticArray."""

from dataclasses import dataclass, field
import struct

from rigid_sim_ros.messages.cdr import (
    ENCAPSULATION, Reader, seconds_and_nanoseconds, Writer)

OK, WARN, ERROR, STALE = range(4)
"""Levels of a diagnostic status."""

_CLOCK = struct.Struct('<4siI')


@dataclass(frozen=True)
class DiagnosticStatus:
    """A diagnostic_msgs/DiagnosticStatus; keys and values are written as text."""

    level: int
    name: str
    message: str
    values: dict = field(default_factory=dict)
    hardware_id: str = ''


def encode_string(text):
    """Return a std_msgs/String."""
    writer = Writer()
    writer.string(text)
    return writer.message()


def decode_string(data):
    """Return the text of a std_msgs/String; raises `MessageError`."""
    reader = Reader(data, 'String')
    text = reader.string()
    reader.end()
    return text


def encode_clock(time_ns):
    """Return a rosgraph_msgs/Clock of a time [ns]."""
    return _CLOCK.pack(ENCAPSULATION, *seconds_and_nanoseconds(time_ns))


def decode_clock(data):
    """Return the time [ns] of a rosgraph_msgs/Clock; raises `MessageError`."""
    reader = Reader(data, 'Clock')
    time_ns = reader.time()
    reader.end()
    return time_ns


def encode_diagnostic_array(time_ns, statuses):
    """Return a diagnostic_msgs/DiagnosticArray of `DiagnosticStatus` with a stamp [ns]."""
    writer = Writer()
    writer.header(time_ns, '')
    writer.pack('I', len(statuses))
    for status in statuses:
        writer.pack('B', status.level)
        for text in (status.name, status.message, status.hardware_id):
            writer.string(text)
        writer.pack('I', len(status.values))
        for key, value in status.values.items():
            writer.string(str(key))
            writer.string(str(value))
    return writer.message()
