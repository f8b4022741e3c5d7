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

"""The history that recordings begun in the middle of a run carry with them."""

import os
import tempfile

import numpy as np
import pytest
from rigid_sim_ros import recording
from rigid_sim_ros.recording.history import History, PastMessage, read_history

TOPICS = ('~/cmd_force', '~/journal')


def filled(steps, largest=2**28):
    """Return a history of states at 1 kHz, each with a command of noise, and its messages."""
    history, past = History(TOPICS, largest), []
    history.begin(7)
    for step in range(1, steps + 1):
        time_ns = 7 + 1_000_000 * step
        data = os.urandom(24) + b'cube_1' * 6
        past += [PastMessage('', time_ns, b''), PastMessage(TOPICS[step % 2], time_ns, data)]
        history.add_state(time_ns)
        history.add_state(time_ns)
        history.add_message(TOPICS[step % 2], time_ns, data)
    return history, past


@pytest.mark.parametrize('steps', [0, 1, 5000])
def test_what_went_in_comes_out(steps):
    history, past = filled(steps)
    begin_ns, found = read_history(b''.join(history.pieces()))
    assert begin_ns == 7
    assert list(found) == past


def test_beginning_again_forgets():
    history, _ = filled(5000)
    history.begin(3)
    history.add_message('~/journal', 5, b'x')
    begin_ns, found = read_history(b''.join(history.pieces()))
    assert (begin_ns, list(found)) == (3, [PastMessage('~/journal', 5, b'x')])
    assert history.byte_count < 100


def test_states_cost_next_to_nothing_and_commands_what_is_new_in_them():
    history = History(TOPICS)
    for step in range(100_000):
        history.add_state(round(step * 1e9 / 240))
    assert len(b''.join(history.pieces())) < 0.3 * 100_000
    history, _ = filled(10_000)
    assert 24 < len(b''.join(history.pieces())) / 10_000 < 24 + 12


def test_it_is_given_up_when_it_is_too_long_until_the_next_beginning():
    history, _ = filled(10_000, largest=100_000)
    assert (history.complete, history.pieces()) == (False, [])
    assert history.byte_count <= 2**17
    history.begin(0)
    assert history.complete and history.pieces()


@pytest.mark.parametrize('call', ['write', 'seek'])
def test_it_is_given_up_when_there_is_no_place_for_it(monkeypatch, call):
    def refuse(*arguments):
        raise OSError(28, 'No space left on device')

    class Full:
        write = seek = read = staticmethod(lambda *arguments: None)

    monkeypatch.setattr(Full, call, refuse)
    monkeypatch.setattr(tempfile, 'TemporaryFile', lambda **options: Full())
    history, _ = filled(5000)
    assert history.pieces() == []
    assert not history.complete
    history.begin(0)
    history.add_state(5)
    assert history.complete and history.pieces()


def test_other_readers_find_it_attached_and_ours_before_the_first_message(tmp_path, run):
    reader = pytest.importorskip('mcap.reader')
    history, past = filled(5000)
    pieces = history.pieces()
    assert history.byte_count > 2**17
    with run.recorder(tmp_path / 'bag', history=pieces, max_bytes=2**16) as recorder:
        # files of noise, so that there is more than one
        for step in range(300):
            recorder.write('/rigid_sim/journal', step, np.random.default_rng(step).bytes(1000))
    bag = recording.Bag(tmp_path / 'bag')
    next(bag.messages())
    assert list(read_history(bag.history())[1]) == past
    for name, attached in (('bag_0.mcap', 3), ('bag_1.mcap', 2)):
        with open(tmp_path / 'bag' / name, 'rb') as stream:
            opened = reader.make_reader(stream, validate_crcs=True)
            found = {item.name: item.data for item in opened.iter_attachments()}
            assert len(found) == attached == opened.get_summary().statistics.attachment_count
        assert found.get('history', b''.join(pieces)) == b''.join(pieces)


def test_recovery_keeps_it(tmp_path, run):
    history, past = filled(100)
    with run.recorder(tmp_path / 'bag', history=history.pieces()) as recorder:
        run.write(recorder, 0, 10)
    file = tmp_path / 'bag' / 'bag_0.mcap'
    os.truncate(file, file.stat().st_size - 50)
    recording.recover(tmp_path / 'bag')
    bag = recording.Bag(tmp_path / 'bag')
    assert len(list(bag.messages())) == 21
    assert list(read_history(bag.history())[1]) == past


def test_damage_is_an_error_of_one_line():
    history, past = filled(2000)
    data = b''.join(history.pieces())
    generator = np.random.default_rng(5)
    for number in range(300):
        damaged = bytearray(data[:int(generator.integers(0, len(data)))]) if number % 2 else (
            bytearray(data))
        for offset in generator.integers(0, max(1, len(damaged)), 3):
            damaged[offset:offset + 1] = generator.bytes(1)
        try:
            found = list(read_history(damaged)[1])
        except recording.RecordingError as error:
            assert '\n' not in str(error)
        else:
            assert len(found) <= len(past)
