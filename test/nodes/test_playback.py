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

"""When each message of a bag is due; without ROS and without a clock."""

from dataclasses import replace

import pytest
from rigid_sim_ros import messages, topics
from rigid_sim_ros.nodes.playback import MOST_AHEAD, Playback
from rigid_sim_ros.recording import Bag, Recorder, RecordingError

TEXT, SCENE, COMMAND = '/rigid_sim/collision_text', '/rigid_sim/scene', '/rigid_sim/cmd_vel'


@pytest.fixture
def bag(tmp_path):
    """Return a bag: a scene at 0 s, texts at 1, 2 and 3 s, and after a reset at 0.5 and 1 s."""
    rows = [replace(row, name=topics.resolve(row.name))
            for row in (*topics.PUBLISHED, *topics.COMMANDS)]
    with Recorder(tmp_path / 'bag', rows) as recorder:
        recorder.write(SCENE, 0, messages.encode_string('scene'))
        for time in (1.0, 2.0, 3.0, 0.5, 1.0):
            recorder.write(TEXT, round(time * 1e9), messages.encode_string(f'at {time}'))
        recorder.write(COMMAND, 10**9, b'command')
    return tmp_path / 'bag'


def played(playback, most=100):
    """Return when each message is due and what it says."""
    found = []
    while playback.message is not None and len(found) < most:
        due = playback.due
        found.append((due, messages.decode_string(playback.take().data)))
    return found


def test_messages_are_due_as_far_apart_as_they_were(bag):
    playback = Playback(bag)
    assert playback.due == float('inf')
    playback.anchor(100.0)
    # after the reset time goes on from 3 s; each file begins with what is latched
    assert played(playback) == [
        (100.0, 'scene'), (101.0, 'at 1.0'), (102.0, 'at 2.0'), (103.0, 'at 3.0'),
        (103.0, 'scene'), (103.0, 'at 0.5'), (103.5, 'at 1.0')]
    assert (playback.message, playback.due) == (None, float('inf'))


def test_rate_makes_them_closer_and_a_new_anchor_moves_the_rest(bag):
    playback = Playback(bag, rate=4.0)
    playback.anchor(0.0)
    assert [due for due, _ in played(playback, 3)] == [0.0, 0.25, 0.5]
    playback.anchor(10.0)
    assert [due for due, _ in played(playback)] == [10.0, 10.0, 10.0, 10.125]


def test_an_offset_skips_but_keeps_what_is_latched(bag):
    playback = Playback(bag, start=1.5)
    playback.anchor(0.0)
    assert played(playback, 3) == [(0.0, 'scene'), (0.0, 'at 2.0'), (1.0, 'at 3.0')]


def test_a_loop_begins_again_at_the_end(bag):
    playback = Playback(bag, topics=[TEXT], start=1.0, loop=True)
    playback.anchor(0.0)
    assert played(playback, 7) == [
        (0.0, 'at 1.0'), (1.0, 'at 2.0'), (2.0, 'at 3.0'), (2.0, 'at 0.5'), (2.5, 'at 1.0'),
        (2.5, 'at 1.0'), (3.5, 'at 2.0')]


def test_what_is_due_together_is_read_before_it_is_due(bag, monkeypatch):
    read, of_bag = [], Bag.messages

    def counted(self):
        for message in of_bag(self):
            read.append(message)
            yield message

    monkeypatch.setattr(Bag, 'messages', counted)
    playback = Playback(bag)
    playback.anchor(0.0)
    found = []
    while playback.message is not None:
        playback.read_ahead()
        before, due = len(read), playback.due
        while playback.message is not None and playback.due == due:
            assert len(read) == before, 'read while it was due'
            found.append((due, messages.decode_string(playback.take().data)))
    monkeypatch.undo()
    again = Playback(bag)
    again.anchor(0.0)
    assert found == played(again)


def test_no_more_is_read_ahead_than_is_kept(tmp_path):
    rows = [replace(row, name=topics.resolve(row.name)) for row in topics.PUBLISHED]
    with Recorder(tmp_path / 'bag', rows) as recorder:
        for number in range(3 * MOST_AHEAD):
            recorder.write(TEXT, 0, messages.encode_string(str(number)))
    playback = Playback(tmp_path / 'bag')
    playback.anchor(0.0)
    playback.read_ahead()
    playback.read_ahead()
    assert len(playback._ahead) == MOST_AHEAD
    assert [text for _, text in played(playback, 1000)] == [
        str(number) for number in range(3 * MOST_AHEAD)]


def test_commands_are_played_only_if_asked_for(bag):
    assert COMMAND not in Playback(bag).topics
    playback = Playback(bag, topics=[COMMAND])
    assert list(playback.topics) == [COMMAND]
    assert bytes(playback.take().data) == b'command'


@pytest.mark.parametrize('options, reason', [
    ({'topics': ['/none']}, "has no messages of '/none', but of /rigid_sim/cmd_vel, "),
    ({'start': 100.0}, 'nothing to play from 100 s on')])
def test_nothing_to_play_is_an_error(bag, options, reason):
    with pytest.raises(RecordingError, match=reason):
        Playback(bag, **options)
