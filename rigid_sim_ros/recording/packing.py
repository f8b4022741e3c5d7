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

"""Puts the messages of a bag into chunks, and decides where its files begin."""

from collections import defaultdict, deque

from rigid_sim_ros.recording.chunk import Chunk, CHUNK_BYTES

_MOST_SPARE_BYTES = 2**26
"""Memory kept for use again: for what comes while the disk confirms."""


class PackedChunk(Chunk):
    """A chunk that knows where it belongs."""

    file_number = 0
    """The file of the bag it goes into, from 0."""

    head_bytes = 0
    """Bytes in it that are no message."""


class Packing:
    """
    Messages in chunks: those that are closed, and the one that is open.

    A file ends where time goes back, and where it has become large or long enough. Each begins
    with its declarations and what is latched, so that it stands alone.

    Parameters
    ----------
    latched : set of int
        The channels whose last message every later file begins with.
    declarations : bytes
        Records of all schemas and channels.
    head_bytes : int
        Size of a file without any chunk.
    max_bytes, max_ns : int
        Size [bytes] and simulated time [ns] after which a new file begins; 0: never.

    """

    def __init__(self, latched, declarations, head_bytes, max_bytes=0, max_ns=0):
        self._latched_channels, self._declarations = latched, declarations
        self._head_bytes = head_bytes
        self._max_bytes, self._max_ns = max_bytes, max_ns
        self._is_limited = max_bytes > 0 or max_ns > 0
        self._latched = {}
        self._start_ns = self._last_ns = None
        self.message_count = self.byte_count = 0
        """What was added and is not written yet."""

        self.closed = deque()
        """Chunks to be written, oldest first."""

        self._spare = []
        self._file_number = -1
        self._begin_file()

    def add(self, channel, time_ns, data):
        """
        Add a message on a channel, the number of its topic from 1.

        The messages of a channel are numbered from 0 in each file, so that a gap shows.
        """
        if self._start_ns is None:
            self._start_ns = time_ns
        elif time_ns < self._last_ns or self._is_limited and self._is_full(time_ns):
            self._begin_next_file(channel, time_ns)
        self._last_ns = time_ns
        self._append(channel, time_ns, data)
        if channel in self._latched_channels:
            self._latched[channel] = bytes(data)
        if self._chunk.size >= CHUNK_BYTES:
            self.close_chunk()

    def close_chunk(self):
        """Close the open chunk, if it holds a message."""
        if self._chunk.message_count:
            self.closed.append(self._chunk)
            self._file_bytes += self._chunk.size
            self._begin_chunk()

    def take(self):
        """Return the chunks that are closed, to be written by the caller."""
        chunks = list(self.closed)
        self.closed.clear()
        return chunks

    def give_back(self, chunk, byte_count):
        """Take back a chunk that was written and made so many bytes of its file."""
        self.message_count -= chunk.message_count
        self.byte_count -= chunk.size - chunk.head_bytes
        if chunk.file_number == self._file_number:
            self._file_bytes += byte_count - chunk.size
        if sum(spare.capacity for spare in self._spare) + chunk.capacity <= _MOST_SPARE_BYTES:
            self._spare.append(chunk)

    def _is_full(self, time_ns):
        return (0 < self._max_ns <= time_ns - self._start_ns
                or 0 < self._max_bytes <= self._file_bytes + self._chunk.size)

    def _begin_next_file(self, channel, time_ns):
        """Begin a file for a message on a channel, and for what is latched on all others."""
        self.close_chunk()
        self._begin_file()
        self._start_ns = time_ns
        for latched, data in self._latched.items():
            if latched != channel:
                self._append(latched, time_ns, data)

    def _begin_file(self):
        self._file_number += 1
        self._sequences = defaultdict(int)
        # without the open chunk
        self._file_bytes = self._head_bytes
        self._begin_chunk(self._declarations)

    def _begin_chunk(self, declarations=b''):
        self._chunk = self._spare.pop() if self._spare else PackedChunk()
        self._chunk.clear(declarations)
        self._chunk.head_bytes = len(declarations)
        self._chunk.file_number = self._file_number

    def _append(self, channel, time_ns, data):
        sequences = self._sequences
        self.byte_count += self._chunk.add(channel, sequences[channel], time_ns, data)
        self.message_count += 1
        sequences[channel] += 1
