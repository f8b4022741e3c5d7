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


import os
import threading
import time

import pytest
from rigid_sim_ros import messages, recording
from rigid_sim_ros.recording import mcap_file
import yaml


def wait_until(condition, seconds=10.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, 'waited in vain'
        time.sleep(0.01)


def times(path):
    bag = recording.Bag(path)
    found = {}
    for message in bag.messages():
        found.setdefault(message.topic, []).append(message.time_ns)
    assert not bag.damage
    return found


def test_metadata_is_there_from_the_start_and_complete_at_the_end(tmp_path, run):
    recorder = run.recorder(tmp_path / 'bag')
    text = (tmp_path / 'bag' / 'metadata.yaml').read_text()
    first = yaml.safe_load(text)['rosbag2_bagfile_information']
    assert first['version'] == 9
    assert first['message_count'] == 0
    assert first['relative_file_paths'] == ['bag_0.mcap']
    run.write(recorder, 1, 5)
    recorder.close()
    text = (tmp_path / 'bag' / 'metadata.yaml').read_text()
    last = yaml.safe_load(text)['rosbag2_bagfile_information']
    assert last['message_count'] == 8
    assert last['starting_time'] == {'nanoseconds_since_epoch': 10_000_000}
    assert last['duration'] == {'nanoseconds': 30_000_000}
    assert last['files'][0]['message_count'] == 8
    assert [row['topic_metadata'] for row in last['topics_with_message_count']] == [
        row['topic_metadata'] for row in first['topics_with_message_count']]


def test_a_path_may_begin_at_home(tmp_path, run, monkeypatch):
    monkeypatch.setenv('HOME', str(tmp_path))
    assert run.recorder('~/bags/one').path == str(tmp_path / 'bags' / 'one')
    assert (tmp_path / 'bags' / 'one' / 'metadata.yaml').is_file()


def test_a_recording_never_replaces_another(tmp_path, run):
    run.recorder(tmp_path / 'bag').close()
    before = (tmp_path / 'bag' / 'bag_0.mcap').read_bytes()
    with pytest.raises(recording.RecordingError, match='bag is there already; a recording never'):
        run.recorder(tmp_path / 'bag')
    assert (tmp_path / 'bag' / 'bag_0.mcap').read_bytes() == before


def test_what_cannot_be_made_is_one_clear_error(tmp_path, run):
    (tmp_path / 'file').write_text('')
    with pytest.raises(recording.RecordingError, match='cannot record to .*file/bag: '):
        run.recorder(tmp_path / 'file' / 'bag')
    with pytest.raises(recording.RecordingError, match="'gzip'; allowed: none, lz4, zstd"):
        run.recorder(tmp_path / 'bag', compression='gzip')


@pytest.mark.skipif(os.geteuid() == 0, reason='root may write anywhere')
def test_no_permission_is_one_clear_error(tmp_path, run):
    (tmp_path / 'locked').mkdir(mode=0o500)
    with pytest.raises(recording.RecordingError, match='Permission denied'):
        run.recorder(tmp_path / 'locked' / 'bag')


def test_time_that_goes_back_begins_a_new_file(tmp_path, run):
    with run.recorder(tmp_path / 'bag') as recorder:
        recorder.write('/rigid_sim/scene', 0, messages.encode_string(run.scene))
        run.write(recorder, 0, 8)
        run.write(recorder, 0, 4)
    assert sorted(os.listdir(tmp_path / 'bag')) == ['bag_0.mcap', 'bag_1.mcap', 'metadata.yaml']
    first, second = (times(tmp_path / 'bag' / f'bag_{index}.mcap') for index in (0, 1))
    assert first['/rigid_sim/poses'] == [step * 10_000_000 for step in range(8)]
    assert second['/rigid_sim/poses'] == [step * 10_000_000 for step in range(4)]
    # each file stands alone: it has what is latched
    assert first['/rigid_sim/scene'] == second['/rigid_sim/scene'] == [0]
    assert recording.read(tmp_path / 'bag').run.tolist() == [0] * 8 + [1] * 4


def test_a_bag_goes_on_in_a_new_file_after_so_much_simulated_time(tmp_path, run):
    with run.recorder(tmp_path / 'bag', max_duration=0.1) as recorder:
        run.write(recorder, 0, 25)
    found = [times(tmp_path / 'bag' / f'bag_{index}.mcap')['/rigid_sim/poses']
             for index in range(3)]
    assert [(file[0], file[-1]) for file in found] == [
        (0, 90_000_000), (100_000_000, 190_000_000), (200_000_000, 240_000_000)]


def test_a_bag_goes_on_in_a_new_file_after_so_many_bytes(tmp_path, run):
    with run.recorder(tmp_path / 'bag', max_bytes=100_000, compression='none') as recorder:
        run.write(recorder, 0, 300)
    files = sorted((tmp_path / 'bag').glob('*.mcap'))
    assert len(files) > 2
    # the summary comes on top: definitions and indexes
    assert all(90_000 < file.stat().st_size < 150_000 for file in files[:-1])
    assert len(recording.read(tmp_path / 'bag').time) == 300


def test_a_chunk_is_on_the_disk_when_its_time_is_up(tmp_path, run):
    with run.recorder(tmp_path / 'bag', chunk_seconds=0.3) as recorder:
        started = time.monotonic()
        run.write(recorder, 0, 1)
        wait_until(lambda: recorder.state().message_count == 2)
        assert time.monotonic() - started > 0.1, 'not at once either: chunks compress better'
        bag = recording.Bag(tmp_path / 'bag')
        assert len(list(bag.messages())) == 2
        assert bag.unfinished == ['bag_0.mcap']


def test_message_records_are_the_same_bytes_every_time(tmp_path, run):
    for name in ('a', 'b'):
        with run.recorder(tmp_path / name, chunk_seconds=0.05) as recorder:
            for part in range(5):
                run.write(recorder, 10 * part, 10 * part + 10)
                time.sleep(0.03 if name == 'a' else 0)
    a, b = ([(topic, time_ns, bytes(data)) for topic, time_ns, data
             in recording.Bag(tmp_path / name).messages()] for name in ('a', 'b'))
    assert a == b
    assert len(a) == 105


class Disk:
    """Stands in for the disk below one recording: stalls, or is full after so many bytes."""

    def __init__(self, monkeypatch, stall=0.0, room=10**9):
        self.stall, self.room = stall, room
        self.written = 0
        self.stalled = threading.Event()
        write = mcap_file.McapFile._put

        def put(file, *parts):
            size = sum(map(len, parts))
            if self.stall:
                self.stalled.set()
                time.sleep(self.stall)
            if self.written + size > self.room:
                raise OSError(28, 'No space left on device')
            self.written += size
            write(file, *parts)

        monkeypatch.setattr(mcap_file.McapFile, '_put', put)


def test_a_disk_that_stalls_delays_nobody(tmp_path, run, monkeypatch):
    recorder = run.recorder(tmp_path / 'bag', chunk_seconds=0.1)
    disk = Disk(monkeypatch, stall=0.6)
    run.write(recorder, 0, 1)
    assert disk.stalled.wait(5)
    slowest = 0.0
    for step in range(1, 40):
        data = run.poses(step, step)
        started = time.perf_counter()
        recorder.write('/rigid_sim/poses', step, data)
        slowest = max(slowest, time.perf_counter() - started)
    disk.stall = 0.0
    assert slowest < 0.3
    assert recorder.close().phase == 'closed'
    assert len(times(tmp_path / 'bag')['/rigid_sim/poses']) == 40


def test_a_full_queue_drops_and_counts(tmp_path, run, monkeypatch):
    told = []
    recorder = run.recorder(tmp_path / 'bag', chunk_seconds=0.1, queue_bytes=5000,
                            on_full=lambda: told.append(1))
    disk = Disk(monkeypatch, stall=0.5)
    run.write(recorder, 0, 1)
    assert disk.stalled.wait(5)
    assert not told
    run.write(recorder, 1, 100)
    assert told == [1], 'once, not for each'
    disk.stall = 0.0
    state = recorder.close()
    assert state.phase == 'closed'
    assert state.dropped_count > 100
    assert state.message_count + state.dropped_count == 210
    assert sum(map(len, times(tmp_path / 'bag').values())) == state.message_count


def test_a_queue_that_is_full_again_is_told_again(tmp_path, run, monkeypatch):
    told = []
    with run.recorder(tmp_path / 'bag', queue_bytes=5000,
                      on_full=lambda: told.append(1)) as recorder:
        disk = Disk(monkeypatch)
        for times_full in (1, 2):
            disk.stall = 0.2
            # each beyond the last: time that goes back would begin a file
            run.write(recorder, 100 * times_full, 100 * times_full + 50)
            assert len(told) == times_full
            disk.stall = 0.0
            wait_until(lambda: not recorder.state().queued_count)


def test_a_full_queue_can_make_the_writer_wait_instead(tmp_path, run, monkeypatch):
    told = []
    recorder = run.recorder(tmp_path / 'bag', queue_bytes=5000, when_full=recording.WAIT,
                            on_full=lambda: told.append(1))
    Disk(monkeypatch, stall=0.01)
    run.write(recorder, 0, 40)
    assert told
    state = recorder.close()
    assert (state.message_count, state.dropped_count) == (84, 0)


def test_who_waits_for_a_disk_that_fails_is_let_go_and_all_is_counted(tmp_path, run, monkeypatch):
    recorder = run.recorder(tmp_path / 'bag', queue_bytes=5000, when_full=recording.WAIT)
    Disk(monkeypatch, stall=0.2, room=0)
    run.write(recorder, 0, 100)
    state = recorder.close()
    assert (state.phase, state.message_count, state.dropped_count) == ('failed', 0, 210)


def test_a_message_larger_than_the_queue_is_dropped_and_not_waited_for(tmp_path, run):
    with run.recorder(tmp_path / 'bag', queue_bytes=5000, when_full=recording.WAIT) as recorder:
        recorder.write('/rigid_sim/scene', 0, messages.encode_string('x' * 6000))
        assert recorder.state().dropped_count == 1


def test_a_full_disk_is_one_error_and_what_was_written_stays(tmp_path, run, monkeypatch):
    recorder = run.recorder(tmp_path / 'bag', chunk_seconds=0.05, compression='none')
    run.write(recorder, 0, 10)
    wait_until(lambda: recorder.state().message_count == 21)
    disk = Disk(monkeypatch, room=0)
    run.write(recorder, 10, 20)
    wait_until(lambda: recorder.error)
    assert disk.written == 0
    run.write(recorder, 20, 30)
    state = recorder.close()
    assert state.phase == 'failed'
    assert state.error == (f'recording to {tmp_path / "bag"} stopped: No space left on device')
    assert state.dropped_count >= 21
    found = recording.read(tmp_path / 'bag')
    assert len(found.time) == 10
    assert not found.finished
    monkeypatch.undo()
    recording.recover(str(tmp_path / 'bag'))
    assert recording.read(tmp_path / 'bag').finished


def test_a_write_that_fails_half_way_leaves_whole_records(tmp_path, run):
    class Half:
        """A file on which one write puts down half and the next fails."""

        def __init__(self, stream):
            self._stream, self.broken = stream, False

        def __getattr__(self, name):
            return getattr(self._stream, name)

        def write(self, data):
            if self.broken:
                raise OSError(5, 'Input/output error')
            self.broken = True
            return self._stream.write(data[:len(data) // 2])

    recorder = run.recorder(tmp_path / 'bag', chunk_seconds=0.05)
    run.write(recorder, 0, 10)
    wait_until(lambda: recorder.state().message_count == 21)
    size = recorder._bag._file.size
    recorder._bag._file._stream = Half(recorder._bag._file._stream)
    run.write(recorder, 10, 20)
    wait_until(lambda: recorder.error)
    assert 'Input/output error' in recorder.close().error
    assert (tmp_path / 'bag' / 'bag_0.mcap').stat().st_size == size
    assert len(recording.read(tmp_path / 'bag').time) == 10


def test_a_removed_folder_is_one_error(tmp_path, run):
    recorder = run.recorder(tmp_path / 'bag', chunk_seconds=0.05)
    for file in (tmp_path / 'bag').iterdir():
        file.unlink()
    (tmp_path / 'bag').rmdir()
    run.write(recorder, 0, 10)
    wait_until(lambda: recorder.error)
    assert recorder.close().error.endswith('stopped: the file was removed')


def test_close_can_be_called_again_and_takes_no_more(tmp_path, run):
    recorder = run.recorder(tmp_path / 'bag')
    run.write(recorder, 0, 10)
    state = recorder.close()
    recorder.write('/rigid_sim/poses', 0, b'late')
    again = recorder.close()
    assert (state.message_count, again.message_count) == (21, 21)
    assert again.dropped_count == 1


def test_close_takes_less_than_two_seconds_on_a_dead_disk(tmp_path, run, monkeypatch):
    recorder = run.recorder(tmp_path / 'bag')
    Disk(monkeypatch, stall=4.0)
    run.write(recorder, 0, 10)
    started = time.monotonic()
    state = recorder.close()
    assert time.monotonic() - started < 2.0
    assert 'rigid_sim_recover' in state.error


def test_a_topic_that_was_not_given_is_an_error(tmp_path, run):
    with run.recorder(tmp_path / 'bag') as recorder:
        with pytest.raises(KeyError):
            recorder.write('/other', 0, b'')
