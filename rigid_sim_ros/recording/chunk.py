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

"""Messages on their way into an MCAP file: records in one stretch of memory."""

from collections import defaultdict
import struct

from mcap.opcode import Opcode

CHUNK_BYTES = 2**22
"""
A chunk is written when it has grown to so many bytes, if its time is not up before.

Each repeats names and what else does not change once more, and each wakes the thread that writes.
"""

_MESSAGE = struct.Struct('<BQHIQQ')
_MESSAGE_FIELDS = 22
_INDEX = struct.Struct('<BQHI')
_INDEX_FIELDS = 6


class Chunk:
    """
    A chunk in the making, empty at first.

    It is used again and again: fresh memory costs more than what is done with it.
    """

    def __init__(self):
        # a view: an assignment to a bytearray copies twice
        self._data = memoryview(bytearray(CHUNK_BYTES + CHUNK_BYTES // 4))
        self.clear()

    def clear(self, declarations=b''):
        """Begin anew with the records of schemas and channels, if there are any."""
        self.size = len(declarations)
        """Bytes in it, before compression."""

        self._data[:self.size] = declarations
        # times [ns] and offsets of the messages of each channel, in turn
        self._entries = defaultdict(list)

        self.message_count = 0
        self.start_ns = self.end_ns = 0
        """Times of the earliest and of the latest message [ns]."""

    def add(self, channel, sequence, time_ns, data):
        """Add a message on a channel, with its number and time [ns]; return the bytes it takes."""
        size, length = self.size, len(data)
        start = size + _MESSAGE.size
        end = start + length
        if end > len(self._data):
            grown = memoryview(bytearray(2 * end))
            grown[:size] = self._data[:size]
            self._data = grown
        _MESSAGE.pack_into(self._data, size, Opcode.MESSAGE, _MESSAGE_FIELDS + length, channel,
                           sequence, time_ns, time_ns)
        self._data[start:end] = data
        self.size = end
        self._entries[channel] += time_ns, size
        if not self.message_count:
            self.start_ns = self.end_ns = time_ns
        elif time_ns > self.end_ns:
            self.end_ns = time_ns
        elif time_ns < self.start_ns:
            self.start_ns = time_ns
        self.message_count += 1
        return end - size

    @property
    def capacity(self):
        """Bytes of memory it takes, however much is in it."""
        return len(self._data)

    def data(self):
        """Return the records, a view."""
        return self._data[:self.size]

    def counts(self):
        """Return the number of messages of each channel that has any."""
        return {channel: len(entries) // 2 for channel, entries in self._entries.items()}

    def indexes(self):
        """Return the message index record of each channel, by channel."""
        return {channel: _index(channel, entries) for channel, entries in self._entries.items()}


def _index(channel, entries):
    body = struct.pack(f'<{len(entries)}Q', *entries)
    return _INDEX.pack(Opcode.MESSAGE_INDEX, _INDEX_FIELDS + len(body), channel, len(body)) + body
