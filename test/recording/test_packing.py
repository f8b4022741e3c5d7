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
"""Messages become chunks, and chunks files: without threads or a disk."""

from io import BytesIO
import random
import struct
import zlib

from mcap.opcode import Opcode
from mcap.reader import make_reader
import pytest
from rigid_sim_ros import topics
from rigid_sim_ros.recording import checksum, chunk, packing
from rigid_sim_ros.recording.bag_metadata import bag_topic
from rigid_sim_ros.recording.mcap_file import declarations, McapFile

SECOND = 10**9
RECORD = struct.Struct('<BQHIQQ')


def records(packed):
    """Return channel, number, time and data of the messages of a chunk."""
    found, data = [], packed.data()
    while data:
        opcode, length, channel, number, time_ns, publish_ns = RECORD.unpack_from(data)
        assert opcode == Opcode.MESSAGE and time_ns == publish_ns
        found.append((channel, number, time_ns, bytes(data[RECORD.size:9 + length])))
        data = data[9 + length:]
    return found


def packed(messages, latched=(), **limits):
    """Return the messages of each file that they become, chunk by chunk."""
    work = packing.Packing(set(latched), b'', 0, **limits)
    for message in messages:
        work.add(*message)
    work.close_chunk()
    files = {}
    for part in work.take():
        files.setdefault(part.file_number, []).append(records(part))
    assert sorted(files) == list(range(len(files)))
    return list(files.values())


def test_messages_come_out_as_they_went_in_numbered_by_channel():
    (chunks,) = packed([(1, 0, b'a'), (2, 0, b''), (1, 5, b'bc')])
    assert chunks == [[(1, 0, 0, b'a'), (2, 0, 0, b''), (1, 1, 5, b'bc')]]


def test_a_chunk_is_closed_when_it_is_full_and_used_again():
    work = packing.Packing(set(), b'', 0)
    size = chunk.CHUNK_BYTES // 4
    for number in range(5):
        work.add(1, number, bytes([number]) * size)
    first, = work.take()
    assert records(first) == [(1, n, n, bytes([n]) * size) for n in range(4)]
    assert (work.message_count, work.byte_count) == (5, 5 * (size + RECORD.size))
    work.give_back(first, first.size)
    assert (work.message_count, work.byte_count) == (1, size + RECORD.size)
    for number in range(5, 8):
        work.add(1, number, b'')
    work.close_chunk()
    second, = work.take()
    work.add(1, 8, b'next')
    work.close_chunk()
    third, = work.take()
    assert third is first, 'the memory of the first'
    assert [row[1] for row in records(second)] == [4, 5, 6, 7]
    assert records(third) == [(1, 8, 8, b'next')]


def test_memory_for_use_again_is_bounded():
    work = packing.Packing(set(), b'', 0)
    for number in range(3):
        work.add(1, number, bytes(chunk.CHUNK_BYTES))
        work.add(1, number, bytes(packing._MOST_SPARE_BYTES // 5))
    for part in work.take():
        work.give_back(part, part.size)
    spare = sum(part.capacity for part in work._spare)
    assert 0 < spare <= packing._MOST_SPARE_BYTES
    assert (work.message_count, work.byte_count) == (0, 0)


def test_a_message_larger_than_a_chunk_is_whole():
    data = random.Random(1).randbytes(3 * chunk.CHUNK_BYTES)
    assert packed([(1, 0, b'before'), (1, 1, data)]) == [
        [[(1, 0, 0, b'before'), (1, 1, 1, data)]]]


def test_time_that_goes_back_begins_a_file_with_what_is_latched():
    first, second = packed([(1, 7, b'old'), (3, 8, b'latched'), (1, 9, b'x'), (1, 2, b'y')],
                           latched=[3])
    assert first == [[(1, 0, 7, b'old'), (3, 0, 8, b'latched'), (1, 1, 9, b'x')]]
    assert second == [[(3, 0, 2, b'latched'), (1, 0, 2, b'y')]]


def test_what_is_latched_is_not_repeated_before_its_successor():
    _, second = packed([(3, 5, b'old'), (3, 4, b'new')], latched=[3])
    assert second == [[(3, 0, 4, b'new')]]


def test_files_end_after_so_much_time():
    files = packed([(1, second * SECOND, b'') for second in range(7)], max_ns=3 * SECOND)
    assert [[row[2] // SECOND for part in file for row in part] for file in files] == [
        [0, 1, 2], [3, 4, 5], [6]]


def test_files_end_after_so_many_bytes_on_the_disk():
    work = packing.Packing(set(), b'', 100, max_bytes=1000)
    # on the disk a chunk takes a tenth of what it does here
    for number in range(20):
        work.add(1, number, bytes(200))
        work.close_chunk()
        for part in work.take():
            work.give_back(part, part.size // 10)
            assert part.file_number == 0
    # but what is not there yet counts in full
    for number in range(20, 26):
        work.add(1, number, bytes(200))
    work.close_chunk()
    assert [part.file_number for part in work.take()] == [0, 1]


@pytest.mark.parametrize('compression', ['none', 'lz4', 'zstd'])
def test_a_chunk_of_many_channels_is_read_by_the_mcap_package(tmp_path, compression):
    rows = tuple(bag_topic(row) for row in topics.PUBLISHED)
    file = McapFile(str(tmp_path / 'a.mcap'), rows, compression, 'test')
    part = chunk.Chunk()
    part.clear(declarations(rows))
    rng, written = random.Random(2), []
    for number in range(200):
        row = (rng.randrange(1, len(rows) + 1), number, rng.randrange(10**12),
               rng.randbytes(rng.choice((0, 10, 3000))))
        part.add(*row)
        written.append(row)
        if number % 70 == 69:
            file.write(part)
            part.clear()
    file.write(part)
    file.finish()
    stream = BytesIO((tmp_path / 'a.mcap').read_bytes())
    reader = make_reader(stream, validate_crcs=True)
    found = [(rows.index(next(row for row in rows if row.name == channel.topic)) + 1,
              message.sequence, message.log_time, message.data)
             for _, channel, message in reader.iter_messages()]
    assert found == sorted(written, key=lambda row: row[2])
    # by the index too
    some = [message.sequence for _, _, message in reader.iter_messages(rows[0].name)]
    assert some == [row[1] for row in sorted(written, key=lambda row: row[2]) if row[0] == 1]


@pytest.mark.parametrize('size', [0, 1, 63, 4096, 100_003])
def test_the_checksum_is_that_of_zlib(size):
    data = random.Random(size).randbytes(size)
    assert checksum.crc32(data) == zlib.crc32(data)
    assert checksum.crc32(memoryview(data), 12345) == zlib.crc32(data, 12345)
