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
One MCAP file, written so that what has been written stays readable whatever comes.

The records are those of the `mcap` package. Only the chunks are put together here, from the
bytes of the messages: it takes half the time of that package's own writer, compresses at a speed
that floating-point data is worth, and lets a chunk end when its time is up.
"""

from functools import partial, reduce
import os
import struct
from zlib import crc32

import lz4.frame
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment, AttachmentIndex, Channel, ChunkIndex, DataEnd, Footer, Header, MessageIndex,
    Metadata, MetadataIndex, Schema, Statistics, SummaryOffset)
from rigid_sim_ros.recording.bag_metadata import FileSummary
from rigid_sim_ros.recording.disk import lock
import zstandard

CHUNK_BYTES = 2**20
"""A chunk is written when it has grown to so many bytes, if its time is not up before."""

MAGIC = b'\x89MCAP0\r\n'

_ZSTD_LEVEL = -3
"""
Poses in motion are noise to a compressor: level 3 makes chunks of them 4 % smaller in fourteen
times the time. What rests or repeats shrinks as much at this level.
"""

COMPRESSIONS = {
    'none': ('', lambda: memoryview),
    # blocks as large as a chunk: a third faster than the usual small ones
    'lz4': ('lz4', lambda: partial(lz4.frame.compress,
                                   block_size=lz4.frame.BLOCKSIZE_MAX1MB)),
    'zstd': ('zstd', lambda: zstandard.ZstdCompressor(level=_ZSTD_LEVEL).compress),
}
"""The name in the file and what makes the function, by the name users give."""

_MESSAGE = struct.Struct('<BQHIQQ')
_MESSAGE_FIELDS = 22
_CHUNK = struct.Struct('<BQQQQI')


class McapFile:
    """
    An MCAP file that is being written.

    Parameters
    ----------
    path : str
        Where; the file must not be there yet.
    topics : sequence
        Every `BagTopic` it may hold; all are declared from the start.
    compression : str
        A key of `COMPRESSIONS`.
    library : str
        Who writes, for the header.
    attachments : sequence of (str, str, bytes)
        Name, media type and data of what is attached, at the start of the file.

    Every method may raise OSError. The file then ends with the last chunk that is whole, and
    `finish` may still be tried.

    """

    def __init__(self, path, topics, compression, library, attachments=()):
        self._format, make_compress = COMPRESSIONS[compression]
        self._compress = make_compress()
        self._stream = open(path, 'xb', buffering=0)
        lock(self._stream)
        self.path = path
        self.size = 0
        self.summary = FileSummary(os.path.basename(path))
        # one place for all chunks: fresh memory costs more than what is done with it
        self._chunk = bytearray(2 * CHUNK_BYTES)
        self._schemas, self._channels = _declare(topics)
        self._sequences = [0] * (len(topics) + 1)
        self._index = {code: [] for code in (
            Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX)}
        # whoever reads a file without a summary learns the channels from the first chunk
        self._begin_chunk(_packed([*self._schemas, *self._channels]))
        self._put(MAGIC + _packed([Header('ros2', library)]))
        for name, media_type, data in attachments:
            self.attach(name, media_type, [data])

    @property
    def has_messages(self):
        """Whether a message was added."""
        return bool(self._chunk_message_count or self.summary.counts)

    @property
    def chunk_size(self):
        """Bytes in the chunk that is not written yet, before compression."""
        return self._chunk_size

    def add(self, channel, time_ns, data, sequence=None):
        """
        Add a message on a channel, the number of its topic from 1, to the open chunk.

        The messages of a channel are numbered from 0, so that a gap shows, unless a number is
        given.
        """
        if sequence is None:
            sequence = self._sequences[channel]
        self._sequences[channel] = sequence + 1
        self._entries.setdefault(channel, []).append((time_ns, self._chunk_size))
        start = self._chunk_size + _MESSAGE.size
        end = start + len(data)
        if end > len(self._chunk):
            self._chunk += bytes(end)
        _MESSAGE.pack_into(self._chunk, self._chunk_size, Opcode.MESSAGE,
                           _MESSAGE_FIELDS + len(data), channel, sequence, time_ns, time_ns)
        self._chunk[start:end] = data
        self._chunk_size = end
        if not self._chunk_message_count:
            self._chunk_start = self._chunk_end = time_ns
        self._chunk_start = min(self._chunk_start, time_ns)
        self._chunk_end = max(self._chunk_end, time_ns)
        self._chunk_message_count += 1

    def close_chunk(self):
        """Write the open chunk, if it holds a message, with its index."""
        if not self._chunk_message_count:
            return
        data = memoryview(self._chunk)[:self._chunk_size]
        compressed = self._compress(data)
        head = self._chunk_head(data, len(compressed))
        length = len(head) + len(compressed)
        offsets, indexes = {}, b''
        for channel, entries in self._entries.items():
            offsets[channel] = self.size + length + len(indexes)
            indexes += _packed([MessageIndex(channel, entries)])
        index = ChunkIndex(
            message_start_time=self._chunk_start, message_end_time=self._chunk_end,
            chunk_start_offset=self.size, chunk_length=length, message_index_offsets=offsets,
            message_index_length=len(indexes), compression=self._format,
            compressed_size=len(compressed), uncompressed_size=len(data))
        self._put(head, compressed, indexes)
        self._index[Opcode.CHUNK_INDEX].append(index)
        self._count_chunk()
        self._begin_chunk()

    def sync(self):
        """Hand what is written to the disk, so that a power cut does not take it."""
        os.fdatasync(self._stream.fileno())

    def is_there(self):
        """Tell whether the file still has a name; the folder may have been removed."""
        return os.fstat(self._stream.fileno()).st_nlink > 0

    def write_metadata(self, name, values):
        """Write a metadata record: a name, and a dict of text."""
        record = _packed([Metadata(name, values)])
        index = MetadataIndex(offset=self.size, length=len(record), name=name)
        self._put(record)
        self._index[Opcode.METADATA_INDEX].append(index)

    def attach(self, name, media_type, parts):
        """Attach data that comes in parts, which together may be large."""
        size = sum(map(len, parts))
        # what the package writes for no data, and the data put in
        head = bytearray(_packed([Attachment(0, 0, name, media_type, b'')])[:-4])
        struct.pack_into('<Q', head, 1, len(head) - 9 + size + 4)
        struct.pack_into('<Q', head, len(head) - 8, size)
        crc = reduce(lambda crc, part: crc32(part, crc), parts, crc32(head[9:]))
        index = AttachmentIndex(self.size, len(head) + size + 4, 0, 0, size, name, media_type)
        self._put(head, *parts, struct.pack('<I', crc))
        self._index[Opcode.ATTACHMENT_INDEX].append(index)

    def finish(self):
        """Write the open chunk, the summary and the footer, and close the file."""
        try:
            self.close_chunk()
            self._put(self._ending())
        finally:
            self._stream.close()

    def abandon(self):
        """Close the file as it is."""
        self._stream.close()

    def _begin_chunk(self, declarations=b''):
        self._entries = {}
        self._chunk_size = len(declarations)
        self._chunk[:self._chunk_size] = declarations
        self._chunk_message_count = self._chunk_start = self._chunk_end = 0

    def _chunk_head(self, data, compressed_size):
        """Return the chunk record up to its last field, the compressed data."""
        name = self._format.encode()
        length = _CHUNK.size - 9 + 4 + len(name) + 8 + compressed_size
        return (_CHUNK.pack(Opcode.CHUNK, length, self._chunk_start, self._chunk_end, len(data),
                            crc32(data))
                + struct.pack('<I', len(name)) + name + struct.pack('<Q', compressed_size))

    def _count_chunk(self):
        for channel, entries in self._entries.items():
            topic = self._channels[channel - 1].topic
            self.summary.add(topic, self._chunk_start, len(entries))
        self.summary.end_ns = max(self.summary.end_ns, self._chunk_end)

    def _put(self, *parts):
        """Write whole records at the end, all or none of them."""
        try:
            for part in parts:
                view = memoryview(part)
                while view:
                    view = view[self._stream.write(view):]
        except OSError:
            self._stream.truncate(self.size)
            self._stream.seek(self.size)
            raise
        self.size += sum(map(len, parts))

    def _ending(self):
        data_end = _packed([DataEnd(0)])
        summary_start = self.size + len(data_end)
        indexes = self._index
        statistics = Statistics(
            attachment_count=len(indexes[Opcode.ATTACHMENT_INDEX]),
            channel_count=len(self._channels),
            channel_message_counts={
                channel.id: self.summary.counts[channel.topic] for channel in self._channels
                if channel.topic in self.summary.counts},
            chunk_count=len(indexes[Opcode.CHUNK_INDEX]),
            message_count=self.summary.message_count,
            message_start_time=self.summary.start_ns, message_end_time=self.summary.end_ns,
            metadata_count=len(indexes[Opcode.METADATA_INDEX]), schema_count=len(self._schemas))
        groups = {Opcode.SCHEMA: self._schemas, Opcode.CHANNEL: self._channels,
                  Opcode.STATISTICS: [statistics], **indexes}
        summary, offsets = b'', []
        for opcode, records in groups.items():
            group = _packed(records)
            if group:
                offsets.append(SummaryOffset(opcode, summary_start + len(summary), len(group)))
            summary += group
        offset_start = summary_start + len(summary)
        summary += _packed(offsets)
        footer = _packed([Footer(summary_start, offset_start, 0)])[:-4]
        footer += struct.pack('<I', crc32(footer, crc32(summary)))
        return data_end + summary + footer + MAGIC


def _packed(records):
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return builder.end()


def _declare(topics):
    """Return schemas and channels, numbered from 1; topics of one type share a schema."""
    definitions = {topic.type_name: topic.definition for topic in topics}
    schemas = [Schema(id=number, name=name, encoding='ros2msg', data=text.encode())
               for number, (name, text) in enumerate(definitions.items(), 1)]
    numbers = {schema.name: schema.id for schema in schemas}
    channels = [
        Channel(id=number, topic=topic.name, message_encoding='cdr',
                schema_id=numbers[topic.type_name],
                metadata={'offered_qos_profiles': topic.profiles,
                          'topic_type_hash': topic.type_hash})
        for number, topic in enumerate(topics, 1)]
    return schemas, channels
