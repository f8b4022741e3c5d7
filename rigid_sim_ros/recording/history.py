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
What happened since the scene was loaded or last reset, kept by whoever may record later.

A simulation is more than its poses: flights, islands, sleep and the forces of the last step are
in it too, and none of them can be read off a state. A recording that begins in the middle of a
run is therefore simulated again from the beginning of that run, and compared from its first
message on. What is needed for that is the attachment `history` of the recording: a line of JSON,

    {"history": 1, "begin_ns": 0, "topics": ["~/cmd_force", ...]}

then blocks, each the size of a zstd frame (uint32) and the frame, and in the frames records:

    uint8 0, int64 dt                           a state was reached
    uint8 k, int64 dt, uint32 size, bytes       a message of topic number k, counted from 1

with times dt [ns] since the record before, the first since begin_ns; all little-endian.

Noting a state or a command takes a microsecond. It is kept in a temporary file without a name,
which is gone with the process, so that memory does not grow with the length of a run. Compressed,
a state is 0.01 to 0.25 bytes, and a command what is new in it: forces on one body at 1 kHz, none
like the one before, are 85 MB an hour, wrenches 170, constant ones less than one. A reset forgets
all that. What exceeds `LARGEST_HISTORY`, or has no place on the disk, is given up: until the next
reset recordings begin without a history, and whoever begins one is told that it cannot be
simulated again.
"""

import json
import operator
import struct
import tempfile
from typing import NamedTuple

from rigid_sim_ros.recording.errors import RecordingError
import zstandard

ATTACHMENT, MEDIA_TYPE = 'history', 'application/octet-stream'

LARGEST_HISTORY = 2**28
"""Bytes, compressed: an hour and a half of wrenches at 1 kHz that never repeat."""

_BLOCK_BYTES = 2**16

_LEVEL = 1

_STATE = struct.Struct('<Bq')
_MESSAGE = struct.Struct('<BqI')
_SIZE = struct.Struct('<I')


class History:
    """
    A history in the making.

    Parameters
    ----------
    topics : sequence of str
        The names of all topics whose messages belong to it.
    largest : int
        Bytes after which it is given up.

    """

    def __init__(self, topics, largest=LARGEST_HISTORY):
        self._topics = tuple(topics)
        self._numbers = {name: number for number, name in enumerate(self._topics, 1)}
        self._largest = largest
        self._compress = zstandard.ZstdCompressor(level=_LEVEL).compress
        self.begin(0)

    def begin(self, time_ns):
        """Forget everything: the scene begins at a simulated time [ns]."""
        self._begin_ns = self._last_ns = time_ns
        self._blocks = None
        self._block_bytes = 0
        self._records = bytearray()
        self.complete = True
        """Whether nothing since the beginning is missing."""

    @property
    def byte_count(self):
        """Bytes it takes, most of them in a file."""
        return self._block_bytes + len(self._records)

    def add_state(self, time_ns):
        """Note that the simulation was advanced to a time [ns]; nothing if it is there already."""
        if time_ns != self._last_ns:
            record = _STATE.pack(0, time_ns - self._last_ns)
            self._last_ns = time_ns
            if self.complete:
                self._records += record
                if len(self._records) >= _BLOCK_BYTES:
                    self._close_block()

    def add_message(self, name, time_ns, data):
        """Note a message of a topic that took effect at a time [ns]."""
        head = _MESSAGE.pack(self._numbers[name], time_ns - self._last_ns, len(data))
        self._add(time_ns, head, data)

    def pieces(self):
        """Return the bytes to attach, as a list of parts; none if it was given up."""
        head = json.dumps({'history': 1, 'begin_ns': self._begin_ns, 'topics': self._topics})
        blocks = b''
        if self._blocks is not None:
            try:
                self._blocks.seek(0)
                blocks = self._blocks.read()
            except OSError:
                self._give_up()
        return [head.encode() + b'\n', blocks, self._packed()] if self.complete else []

    def _add(self, time_ns, *parts):
        self._last_ns = time_ns
        if not self.complete:
            return
        for part in parts:
            self._records += part
        if len(self._records) >= _BLOCK_BYTES:
            self._close_block()

    def _close_block(self):
        block = self._packed()
        self._block_bytes += len(block)
        self._records.clear()
        try:
            if self._blocks is None:
                self._blocks = tempfile.TemporaryFile(prefix='rigid_sim_history_')
            self._blocks.write(block)
        except OSError:
            self._give_up()
        if self._block_bytes > self._largest:
            self._give_up()

    def _give_up(self):
        self.begin(self._last_ns)
        self.complete = False

    def _packed(self):
        frame = self._compress(bytes(self._records))
        return _SIZE.pack(len(frame)) + frame


class PastMessage(NamedTuple):
    """What a history holds: a message that took effect, or a state that was reached."""

    topic: str
    """Empty for a state."""

    time_ns: int
    data: bytes


def read_history(data):
    """
    Return the time [ns] at which a history begins and a generator of `PastMessage`.

    Both raise `RecordingError` if the bytes are not those of a history.
    """
    line, _, blocks = bytes(data).partition(b'\n')
    try:
        head = json.loads(line)
        known = head['history'] == 1
        begin_ns, topics = operator.index(head['begin_ns']), [str(name) for name in head['topics']]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise RecordingError(f'the attachment history cannot be read ({error!r})') from error
    if not known:
        raise RecordingError('the attachment history is of a later version of this package')
    return begin_ns, _past(blocks, begin_ns, topics)


def _past(blocks, time_ns, topics):
    try:
        for records in _unpacked(blocks):
            offset = 0
            while offset < len(records):
                number, step = _STATE.unpack_from(records, offset)
                time_ns += step
                size, start = 0, offset + _STATE.size
                if number:
                    _, _, size = _MESSAGE.unpack_from(records, offset)
                    start = offset + _MESSAGE.size
                offset = start + size
                if offset > len(records):
                    raise ValueError('a message is cut')
                yield PastMessage(('', *topics)[number], time_ns, records[start:offset])
    except (struct.error, ValueError, IndexError, MemoryError, zstandard.ZstdError) as error:
        raise RecordingError(f'the attachment history is damaged ({error})') from error


def _unpacked(blocks):
    offset = 0
    while offset < len(blocks):
        size, = _SIZE.unpack_from(blocks, offset)
        offset += _SIZE.size
        frame = blocks[offset:offset + size]
        if len(frame) < size:
            raise ValueError('a block is cut')
        if zstandard.frame_content_size(frame) > LARGEST_HISTORY:
            raise ValueError('a block is too large')
        offset += size
        yield zstandard.ZstdDecompressor().decompress(frame)
