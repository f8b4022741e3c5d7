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

The records are those of the `mcap` package. Only chunks and their indexes are put together here:
it takes a fraction of the time of that package's own writer, compresses at a speed that
floating-point data is worth, and lets a chunk end when its time is up.
"""

from functools import lru_cache, reduce
import os
import struct

import lz4.frame
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment, AttachmentIndex, Channel, ChunkIndex, DataEnd, Footer, Header, Metadata,
    MetadataIndex, Schema, Statistics, SummaryOffset)
from rigid_sim_ros.recording.bag_metadata import FileSummary
from rigid_sim_ros.recording.checksum import crc32
from rigid_sim_ros.recording.disk import lock
import zstandard

MAGIC = b'\x89MCAP0\r\n'

_LEAST_STRIDE, _MOST_STRIDE = 3, 50
_STRIDES = 1500


def _plain(data, _):
    return data


def _lz4(data, _):
    # blocks as large as a chunk: a third faster than the usual small ones
    return lz4.frame.compress(data, block_size=lz4.frame.BLOCKSIZE_MAX1MB)


def _zstd(data, message_size):
    """
    Compress at a negative level, that is, looking for repetitions at so many bytes from another.

    Poses in motion are noise to a compressor: level 3 makes chunks of them 4 % smaller in fourteen
    times the time. What rests or repeats shrinks as much at these levels, if the stride is small
    beside what a message repeats: names, the poses of `~/poses` in `~/states`, bodies at rest. For
    1000 bodies in motion the longest stride takes half the time of the shortest and a tenth more
    bytes.
    """
    stride = min(max(message_size // _STRIDES, _LEAST_STRIDE), _MOST_STRIDE)
    return _zstd_compressor(stride).compress(data)


@lru_cache(maxsize=None)
def _zstd_compressor(stride):
    return zstandard.ZstdCompressor(level=-stride)


COMPRESSIONS = {'none': ('', _plain), 'lz4': ('lz4', _lz4), 'zstd': ('zstd', _zstd)}
"""
The name in the file and the function, by the name users give. It takes the data of a chunk and the
mean size [bytes] of its messages.
"""

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
        self._format, self._compress = COMPRESSIONS[compression]
        self._stream = open(path, 'xb', buffering=0)
        lock(self._stream)
        self.path = path
        self.size = self._synced = 0
        self.summary = FileSummary(os.path.basename(path))
        self._schemas, self._channels = _declare(topics)
        self._index = {code: [] for code in (
            Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX)}
        self._put(MAGIC + _packed([Header('ros2', library)]))
        for name, media_type, data in attachments:
            self.attach(name, media_type, [data])

    def write(self, chunk):
        """Write a chunk, if it holds a message, with its index; it may be used again then."""
        if not chunk.message_count:
            return
        data = chunk.data()
        compressed = self._compress(data, len(data) // chunk.message_count)
        head = self._chunk_head(chunk, len(compressed))
        length = len(head) + len(compressed)
        indexes = chunk.indexes()
        offsets, end = {}, self.size + length
        for channel, index in indexes.items():
            offsets[channel] = end
            end += len(index)
        index = ChunkIndex(
            message_start_time=chunk.start_ns, message_end_time=chunk.end_ns,
            chunk_start_offset=self.size, chunk_length=length, message_index_offsets=offsets,
            message_index_length=end - self.size - length, compression=self._format,
            compressed_size=len(compressed), uncompressed_size=chunk.size)
        self._put(head, compressed, b''.join(indexes.values()))
        self._index[Opcode.CHUNK_INDEX].append(index)
        for channel, count in chunk.counts().items():
            self.summary.add(self._channels[channel - 1].topic, chunk.start_ns, count)
        self.summary.end_ns = max(self.summary.end_ns, chunk.end_ns)

    def sync(self):
        """Hand what is written to the disk, so that a power cut does not take it."""
        number, size = self._stream.fileno(), self.size
        os.fdatasync(number)
        # memory that is at hand is used again: a long recording does not push out what others
        # read, and fresh memory takes a virtual machine longer than the writing
        os.posix_fadvise(number, self._synced, size - self._synced, os.POSIX_FADV_DONTNEED)
        self._synced = size

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
        """Write the summary and the footer, and close the file."""
        try:
            self._put(self._ending())
        finally:
            self._stream.close()

    def abandon(self):
        """Close the file as it is."""
        self._stream.close()

    def _chunk_head(self, chunk, compressed_size):
        """Return the chunk record up to its last field, the compressed data."""
        name = self._format.encode()
        length = _CHUNK.size - 9 + 4 + len(name) + 8 + compressed_size
        return (_CHUNK.pack(Opcode.CHUNK, length, chunk.start_ns, chunk.end_ns, chunk.size,
                            crc32(chunk.data()))
                + struct.pack('<I', len(name)) + name + struct.pack('<Q', compressed_size))

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


def declarations(topics):
    """
    Return the records that declare topics, whose channels are their numbers from 1.

    They belong at the beginning of the first chunk: from there whoever reads a file without a
    summary learns what the channels are.
    """
    schemas, channels = _declare(topics)
    return _packed([*schemas, *channels])


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
