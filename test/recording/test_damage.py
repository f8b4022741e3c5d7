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

"""Killed, cut and damaged recordings: the readable part or a clear error, never wrong numbers."""

import os
import shutil
import signal
import struct
import subprocess
import sys
import time

from mcap.reader import make_reader
import numpy as np
import pytest
from rigid_sim_ros import recording
from rigid_sim_ros.recording import mcap_file

FEW = 12
MANY = 1000
FEW_OR_MANY = pytest.mark.parametrize(
    'count', [FEW, pytest.param(MANY, marks=pytest.mark.stress)])


def copy_of(bag, tmp_path):
    if (tmp_path / 'sound').exists():
        shutil.rmtree(tmp_path / 'sound')
    shutil.copytree(bag, tmp_path / 'sound')
    return tmp_path / 'sound' / 'sound_0.mcap'


def check_numbers(found, run):
    """Every state that was read is the one that was recorded."""
    steps = found.time_ns // 10_000_000
    assert np.all(np.diff(steps) > 0)
    for row, step in enumerate(steps):
        assert found.position[row].tolist() == run.values(step, 3, 0).tolist()
        assert found.orientation[row].tolist() == run.values(step, 4, 1).tolist()
        if not np.isnan(found.torque[row]).any():
            assert found.torque[row].tolist() == run.values(step, 3, 5).tolist()
    for event in found.collisions:
        time_ns = round((event['time'] + 0.001) * 1e9)
        assert event == run.events(time_ns)[0]


def read_or_error(path, run):
    """Return what could be read, checked, or None after one clear error."""
    try:
        found = recording.read(path)
    except recording.RecordingError as error:
        assert '\n' not in str(error)
        return None
    check_numbers(found, run)
    return found


def check_with_others(path, found, run):
    """After recovery, a reader that is not ours finds the same states."""
    rosbag2 = pytest.importorskip('rosbags.rosbag2')
    with rosbag2.Reader(path) as opened:
        poses = [(time_ns, raw) for connection, time_ns, raw in opened.messages()
                 if connection.topic == '/rigid_sim/poses']
    assert [time_ns for time_ns, _ in poses] == found.time_ns.tolist()
    for time_ns, raw in poses:
        assert raw == run.poses(time_ns // 10_000_000, time_ns)


@FEW_OR_MANY
def test_a_file_cut_anywhere_gives_its_beginning(bag, tmp_path, run, count):
    size = (bag / 'sound_0.mcap').stat().st_size
    generator = np.random.default_rng(1)
    lengths = [0, 5, 8, size - 1, *generator.integers(0, size, count)]
    most = 0
    for length in sorted(map(int, lengths)):
        file = copy_of(bag, tmp_path)
        os.truncate(file, length)
        found = read_or_error(tmp_path / 'sound', run)
        assert (found is None) == (length < 8)
        if found is None:
            continue
        assert not found.finished and found.damage
        assert most <= len(found.time), 'a longer piece holds no less'
        most = len(found.time)
        assert found.time_ns.tolist() == [step * 10_000_000 for step in range(most)]
    assert most == 100


@FEW_OR_MANY
def test_damage_anywhere_is_noticed_or_harmless(bag, tmp_path, run, count):
    data = (bag / 'sound_0.mcap').read_bytes()
    generator = np.random.default_rng(2)
    noticed = 0
    for offset in map(int, generator.integers(0, len(data), count)):
        file = copy_of(bag, tmp_path)
        damaged = bytearray(data)
        damaged[offset] ^= int(generator.integers(1, 256))
        file.write_bytes(damaged)
        found = read_or_error(tmp_path / 'sound', run)
        assert found is None or found.damage or len(found.time) == 100
        noticed += found is None or bool(found.damage)
    assert noticed > count / 2


@FEW_OR_MANY
def test_zeros_and_noise_in_the_middle_leave_the_rest(bag, tmp_path, run, count):
    data = (bag / 'sound_0.mcap').read_bytes()
    generator = np.random.default_rng(3)
    for number in range(count):
        file = copy_of(bag, tmp_path)
        start, end = sorted(map(int, generator.integers(8, len(data) - 8, 2)))
        noise = generator.integers(0, 256, end - start, dtype=np.uint8).tobytes()
        file.write_bytes(data[:start] + (noise if number % 2 else bytes(end - start)) + data[end:])
        found = read_or_error(tmp_path / 'sound', run)
        assert found is None or found.damage or len(found.time) == 100


def test_an_attachment_longer_than_memory_can_be_is_left_out(bag, tmp_path, run):
    file = copy_of(bag, tmp_path)
    data = bytearray(file.read_bytes())
    place = data.index(b'application/')
    type_length, = struct.unpack_from('<I', data, place - 4)
    struct.pack_into('<Q', data, place + type_length, 2 ** 63)
    file.write_bytes(data)
    found = read_or_error(tmp_path / 'sound', run)
    assert len(found.time) == 100
    assert any('attachment' in line for line in found.damage)


@FEW_OR_MANY
def test_recovery_of_any_piece_satisfies_others(bag, tmp_path, run, count):
    size = (bag / 'sound_0.mcap').stat().st_size
    generator = np.random.default_rng(4)
    for length in map(int, generator.integers(size // 3, size, count // 6)):
        file = copy_of(bag, tmp_path)
        os.truncate(file, length)
        before = recording.read(tmp_path / 'sound')
        assert any('finished with' in line for line in recording.recover(tmp_path / 'sound'))
        after = recording.read(tmp_path / 'sound')
        assert after.finished and not after.damage
        assert after.time_ns.tolist() == before.time_ns.tolist()
        assert after.scene == run.scene
        check_with_others(tmp_path / 'sound', after, run)


def test_recovery_leaves_a_sound_bag_as_it_is(bag, tmp_path):
    file = copy_of(bag, tmp_path)
    before = file.read_bytes()
    assert 'whole already: 211 messages' in recording.recover(tmp_path / 'sound')[0]
    assert file.read_bytes() == before


def test_recovery_keeps_a_damaged_file_beside_the_new_one(bag, tmp_path, run):
    file = copy_of(bag, tmp_path)
    data = bytearray(file.read_bytes())
    with open(file, 'rb') as stream:
        index = make_reader(stream).get_summary().chunk_indexes[-1]
    # in the compressed messages: what is damaged elsewhere, in an index say, loses nothing
    data[index.chunk_start_offset + index.chunk_length - index.compressed_size // 2] ^= 1
    file.write_bytes(data)
    found = recording.read(tmp_path / 'sound')
    assert any('left out' in line for line in found.damage)
    recording.recover(tmp_path / 'sound')
    assert (tmp_path / 'sound' / 'sound_0.mcap.damaged').read_bytes() == data
    after = recording.read(tmp_path / 'sound')
    assert after.time_ns.tolist() == found.time_ns.tolist()
    check_with_others(tmp_path / 'sound', after, run)


def test_recovery_that_fails_leaves_nothing_behind(bag, tmp_path, monkeypatch):
    file = copy_of(bag, tmp_path)
    os.truncate(file, file.stat().st_size // 2)
    before = {path.name: path.read_bytes() for path in file.parent.iterdir()}
    write = mcap_file.McapFile._put

    def put(written, *parts):
        if written.size > 5000:
            raise OSError(28, 'No space left on device')
        write(written, *parts)

    monkeypatch.setattr(mcap_file.McapFile, '_put', put)
    with pytest.raises(recording.RecordingError, match='No space left on device'):
        recording.recover(tmp_path / 'sound')
    assert {path.name: path.read_bytes() for path in file.parent.iterdir()} == before


def test_a_bag_that_is_being_recorded_is_not_recovered(tmp_path, run):
    with run.recorder(tmp_path / 'bag') as recorder:
        run.write(recorder, 0, 3)
        with pytest.raises(recording.RecordingError, match='is being recorded now'):
            recording.recover(tmp_path / 'bag')


def test_a_recording_of_others_is_left_to_their_tools(tmp_path):
    writer = pytest.importorskip('mcap.writer')
    (tmp_path / 'bag').mkdir()
    with open(tmp_path / 'bag' / 'bag_0.mcap', 'wb') as stream:
        writer.Writer(stream).start('ros2', 'another')
    with pytest.raises(recording.RecordingError, match="but by 'another'"):
        recording.recover(tmp_path / 'bag')


def test_a_claim_to_be_huge_is_not_believed(bag, tmp_path, run):
    file = copy_of(bag, tmp_path)
    data = file.read_bytes()
    chunk = data.index(b'\x06', 8 + 9)
    while int.from_bytes(data[chunk + 1:chunk + 9], 'little') > len(data) - chunk:
        chunk = data.index(b'\x06', chunk + 1)
    for offset, width in ((1, 8), (9 + 16, 8), (9 + 32, 4)):
        damaged = bytearray(data)
        damaged[chunk + offset:chunk + offset + width] = b'\xfe' * width
        file.write_bytes(damaged)
        assert read_or_error(tmp_path / 'sound', run).damage


WRITER = """
import sys, time
sys.path.insert(0, sys.argv[2])
from conftest import Run
run = Run()
recorder = run.recorder(sys.argv[1], chunk_seconds=float(sys.argv[3]))
started = time.monotonic()
print('begun', flush=True)
step = 0
while True:
    run.write(recorder, step, step + 1)
    step += 1
    print(step, flush=True)
    time.sleep(max(0.0, started + step * 0.01 - time.monotonic()))
"""


@pytest.mark.parametrize('count', [5, pytest.param(100, marks=pytest.mark.stress)])
def test_kill_at_any_moment_loses_no_more_than_the_last_chunk(tmp_path, run, count):
    generator = np.random.default_rng(6)
    for number in range(count):
        path = tmp_path / f'bag_{number}'
        process = subprocess.Popen(
            [sys.executable, '-c', WRITER, str(path), os.path.dirname(__file__), '0.3'],
            stdout=subprocess.PIPE, text=True, env={**os.environ, 'PYTHONPATH': os.getcwd()})
        assert process.stdout.readline() == 'begun\n'
        time.sleep(0.05 + float(generator.uniform(0, 0.9)))
        process.send_signal(signal.SIGKILL)
        steps = len(process.communicate(timeout=20)[0].split()) - 1
        found = read_or_error(path, run)
        # 0.3 s of states, and what a busy machine needs to write them
        assert steps - len(found.time) < 30 + 40
        assert found.time_ns.tolist() == [
            step * 10_000_000 for step in range(len(found.time))]
        recording.recover(path)
        if len(found.time):
            check_with_others(path, recording.read(path), run)
