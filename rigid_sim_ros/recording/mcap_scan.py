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
Reads MCAP files that may be cut short, damaged or made to do harm.

A file is read from front to back, record by record. No length is believed before the bytes are
there, nothing is unpacked beyond what it says and a fixed limit, every chunk is checked against
its CRC, and every channel's messages against their numbers. What does not pass is left out and
told in `damage`; it is never guessed.
"""

from io import BytesIO
import os
import struct

import lz4.frame
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Header, Schema, Statistics
from rigid_sim_ros.recording.bag_metadata import BagTopic
from rigid_sim_ros.recording.checksum import crc32
from rigid_sim_ros.recording.errors import RecordingError
from rigid_sim_ros.recording.mcap_file import MAGIC
import zstandard

LARGEST_CHUNK = 2**28
"""Bytes of an unpacked chunk; a file that claims more is not believed."""

_PREFIX = struct.Struct('<BQ')
_CHUNK_FIELDS = struct.Struct('<QQQII')
_MESSAGE_FIELDS = struct.Struct('<HIQQ')
_FOOTER_SIZE = _PREFIX.size + 20 + len(MAGIC)

_UNREADABLE = (
    McapError, struct.error, UnicodeDecodeError, ValueError, MemoryError, OverflowError)
"""What parsing a damaged record with the `mcap` package may raise."""


class McapScan:
    """
    An MCAP file as far as it can be read.

    `messages` goes through it once; the other attributes are complete after that, apart from
    `topics`, which has what was declared so far. Raises `RecordingError` if the file cannot be
    opened or is no MCAP file at all.
    """

    def __init__(self, path):
        self.path = path
        self.name = os.path.basename(path)
        self.library = ''
        self.topics = {}
        """`BagTopic` by the number of the channel."""

        self.attachments = {}
        """Bytes by name."""

        self.damage = []
        """What could not be read, one line each."""

        self.finished = False
        """Whether the file has the end that it should have."""

        self._schemas = {}
        self._next_sequence = {}
        self._message_count = 0
        self._open()

    def _open(self):
        try:
            self._stream = open(self.path, 'rb')
            self._size = os.fstat(self._stream.fileno()).st_size
            magic = self._stream.read(len(MAGIC))
        except OSError as error:
            raise RecordingError(f'cannot read {self.path}: {error.strerror}') from error
        if magic != MAGIC:
            self._stream.close()
            raise RecordingError(f'{self.path} is not an MCAP file')

    def messages(self):
        """Go through the messages in file order: channel, number, time [ns] and data of each."""
        with self._stream:
            summary = self._summary()
            for message in self._from_chunks(self._records(summary)):
                self._message_count += 1
                yield message
            self._compare_count(summary)

    def statistics(self):
        """
        Return the record at the end of a sound file that counts its messages, or None.

        `topics` has all of the file's topics then. This instead of `messages`: nothing but the
        end is read, and what is in between may be damaged.
        """
        with self._stream:
            records = self._summary() or ()
        for code, content in records:
            if code == Opcode.STATISTICS:
                try:
                    return Statistics.read(ReadDataStream(BytesIO(content)))
                except _UNREADABLE:
                    return None
        return None

    # -- the file ------------------------------------------------------------------------------

    def _records(self, summary):
        """Go through the top-level records: opcode, offset, content."""
        offset = len(MAGIC)
        while True:
            record = self._record_at(offset)
            if record is None:
                break
            opcode, content = record
            if opcode == Opcode.DATA_END:
                self.finished = summary is not None
                break
            yield opcode, offset, content
            offset += _PREFIX.size + len(content)
        if not self.finished:
            self._tell(f'{self.name} has no sound end: read up to byte {offset} of {self._size}')
            # past damage, the summary knows where the remaining chunks are
            for offset in self._chunk_offsets_after(summary, offset):
                record = self._record_at(offset)
                if record is not None and record[0] == Opcode.CHUNK:
                    yield record[0], offset, record[1]

    def _record_at(self, offset):
        """Return opcode and content of the record at an offset; None if it is not all there."""
        self._stream.seek(offset)
        prefix = self._stream.read(_PREFIX.size)
        if len(prefix) < _PREFIX.size:
            return None
        opcode, length = _PREFIX.unpack(prefix)
        if length > self._size - offset - _PREFIX.size or opcode == 0:
            return None
        content = self._stream.read(length)
        return (opcode, content) if len(content) == length else None

    def _summary(self):
        """Return the summary's records as opcodes and contents; None if it is not sound."""
        if self._size < len(MAGIC) + _FOOTER_SIZE:
            return None
        self._stream.seek(self._size - _FOOTER_SIZE)
        footer = self._stream.read(_FOOTER_SIZE)
        opcode, length, start, _, crc = struct.unpack('<BQQQI', footer[:-len(MAGIC)])
        if (opcode, length, footer[-len(MAGIC):]) != (Opcode.FOOTER, 20, MAGIC):
            return None
        end = self._size - _FOOTER_SIZE
        if not len(MAGIC) <= start <= end:
            return None
        self._stream.seek(start)
        data = self._stream.read(end - start)
        if crc and crc32(footer[:-len(MAGIC) - 4], crc32(data)) != crc:
            return None
        records = list(_split(data))
        for code, content in records:
            self._declare(code, content)
        return records

    def _chunk_offsets_after(self, summary, offset):
        indexes = [content for code, content in summary or () if code == Opcode.CHUNK_INDEX]
        starts = sorted({struct.unpack_from('<Q', content, 16)[0]
                         for content in indexes if len(content) >= 24})
        return [start for start in starts if start > offset]

    def _compare_count(self, summary):
        for code, content in summary or ():
            if code == Opcode.STATISTICS and len(content) >= 8:
                expected, = struct.unpack_from('<Q', content)
                if expected != self._message_count:
                    self._tell(f'{self.name}: {self._message_count} of {expected} messages read')

    def _tell(self, text):
        self.damage.append(text)

    # -- records -------------------------------------------------------------------------------

    def _from_chunks(self, records):
        for opcode, offset, content in records:
            if opcode == Opcode.CHUNK:
                data = self._unpacked(content, offset)
                yield from self._from_chunk(data, offset)
            elif opcode == Opcode.MESSAGE:
                self._tell(f'{self.name}: message outside a chunk at byte {offset} left out')
            elif opcode == Opcode.ATTACHMENT:
                self._attachment(content, offset)
            elif opcode == Opcode.HEADER:
                self._header(content)

    def _unpacked(self, content, offset):
        """Return a chunk's data after checking it; empty, and told, if it is damaged."""
        try:
            _, _, size, crc, name_length = _CHUNK_FIELDS.unpack_from(content)
            start = _CHUNK_FIELDS.size + name_length
            name = content[_CHUNK_FIELDS.size:start].decode()
            length, = struct.unpack_from('<Q', content, start)
            packed = content[start + 8:start + 8 + length]
            data = _DECOMPRESS[name](packed, size) if size <= LARGEST_CHUNK else b''
        except (struct.error, UnicodeDecodeError, KeyError, RuntimeError, MemoryError,
                zstandard.ZstdError) as error:
            self._tell(f'{self.name}: chunk at byte {offset} left out: damaged ({error})')
            return b''
        if len(packed) != length or len(data) != size or (crc and crc32(data) != crc):
            self._tell(f'{self.name}: chunk at byte {offset} left out: its check fails')
            return b''
        return data

    def _from_chunk(self, data, offset):
        for opcode, content in _split(data):
            if opcode != Opcode.MESSAGE:
                self._declare(opcode, content)
            elif len(content) < _MESSAGE_FIELDS.size:
                self._tell(f'{self.name}: short message in the chunk at byte {offset} left out')
            else:
                channel, sequence, time_ns, _ = _MESSAGE_FIELDS.unpack_from(content)
                self._check_sequence(channel, sequence)
                yield channel, sequence, time_ns, content[_MESSAGE_FIELDS.size:]

    def _check_sequence(self, channel, sequence):
        expected = self._next_sequence.get(channel, 0)
        # others than this package number all messages 0
        if sequence > expected:
            topic = self.topics[channel].name if channel in self.topics else f'channel {channel}'
            self._tell(f'{self.name}: {sequence - expected} messages of {topic} are missing')
        self._next_sequence[channel] = sequence + 1

    def _declare(self, opcode, content):
        stream = ReadDataStream(BytesIO(content))
        try:
            if opcode == Opcode.SCHEMA:
                schema = Schema.read(stream)
                self._schemas[schema.id] = schema
            elif opcode == Opcode.CHANNEL:
                channel = Channel.read(stream)
                schema = self._schemas[channel.schema_id]
                self.topics[channel.id] = BagTopic(
                    channel.topic, schema.name, channel.metadata.get('offered_qos_profiles', ''),
                    channel.metadata.get('topic_type_hash', ''), schema.data.decode())
        except (*_UNREADABLE, KeyError) as error:
            self._tell(f'{self.name}: a channel is not readable ({type(error).__name__})')

    def _attachment(self, content, offset):
        try:
            attachment = Attachment.read(ReadDataStream(BytesIO(content)))
            if struct.unpack('<I', content[-4:])[0] != crc32(content[:-4]):
                raise ValueError('its check fails')
        except _UNREADABLE as error:
            self._tell(f'{self.name}: attachment at byte {offset} left out: damaged ({error})')
        else:
            self.attachments[attachment.name] = attachment

    def _header(self, content):
        try:
            self.library = Header.read(ReadDataStream(BytesIO(content))).library
        except _UNREADABLE:
            self._tell(f'{self.name}: the header is damaged')


def _split(data):
    """Go through records that lie one after the other: opcode and content, a view."""
    view, offset = memoryview(data), 0
    while offset + _PREFIX.size <= len(view):
        opcode, length = _PREFIX.unpack_from(view, offset)
        start = offset + _PREFIX.size
        offset = start + length
        if offset > len(view):
            return
        yield opcode, view[start:offset]


def _from_zstd(data, size):
    # the frame says its size too; only what was promised is unpacked
    if zstandard.frame_content_size(data) not in (-1, size):
        raise zstandard.ZstdError('two sizes')
    return zstandard.ZstdDecompressor().decompress(data, max_output_size=size)


def _from_lz4(data, size):
    return lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=size)


_DECOMPRESS = {'': lambda data, size: data, 'zstd': _from_zstd, 'lz4': _from_lz4}
