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


import json
import os
import shutil

import numpy as np
import pytest
from rigid_sim_ros import messages, recording
from rigid_sim_ros.recording import mcap_scan
from rigid_sim_ros.recording.journal import (
    decode_journal, encode_parameters, encode_reset)


def test_arrays_names_and_times_come_back(bag, run):
    found = recording.read(bag)
    assert found.names == run.names
    assert found.all_names == (*run.names, 'ground')
    assert found.time_ns.tolist() == [step * 10_000_000 for step in range(100)]
    assert found.time.tolist() == [step / 100 for step in range(100)]
    for step in (0, 37, 99):
        arrays = (found.position, found.orientation, found.linear_velocity,
                  found.angular_velocity, found.force, found.torque)
        for kind, (array, width) in enumerate(zip(arrays, (3, 4, 3, 3, 3, 3))):
            assert array.shape == (100, 3, width)
            assert array[step].tolist() == run.values(step, width, kind).tolist()
    assert found.collisions['speed'].tolist() == [2.5] * 10
    assert found.collisions['time'][0] == run.events(50_000_000)['time'][0]
    assert found.scene == run.scene
    assert found.options['method'] == 'exact'
    assert (found.finished, found.damage) == (True, ())


def test_a_bag_at_home_is_found(bag, monkeypatch):
    monkeypatch.setenv('HOME', str(bag.parent))
    assert recording.read(f'~/{bag.name}').path == str(bag)


def test_one_file_is_read_as_the_folder_is(bag):
    found = recording.read(bag / 'sound_0.mcap')
    assert len(found.time) == 100


def test_velocities_that_were_not_recorded_are_nan(tmp_path, run):
    with run.recorder(tmp_path / 'bag') as recorder:
        recorder.write('/rigid_sim/poses', 0, run.poses(0, 0))
        recorder.write('/rigid_sim/poses', 5, run.poses(1, 5))
        recorder.write('/rigid_sim/states', 5, run.states(1, 5))
    found = recording.read(tmp_path / 'bag')
    assert np.isnan(found.linear_velocity[0]).all()
    assert found.linear_velocity[1].tolist() == run.values(1, 3, 2).tolist()


def test_commands_and_journal_come_back_in_their_order(tmp_path, run):
    velocity = b'\0\1\0\0' + bytes(100)
    with run.recorder(tmp_path / 'bag') as recorder:
        recorder.write('/rigid_sim/journal', 0, encode_parameters('body', 0.5))
        recorder.write('/rigid_sim/cmd_vel', 7, velocity)
        recorder.write('/rigid_sim/journal', 7, encode_reset(False))
    commands = recording.read(tmp_path / 'bag').commands
    assert [(command.topic, command.time_ns) for command in commands] == [
        ('/rigid_sim/journal', 0), ('/rigid_sim/cmd_vel', 7), ('/rigid_sim/journal', 7)]
    assert decode_journal(commands[0].data) == {
        'event': 'parameters', 'command_axes': 'body', 'command_timeout': 0.5}
    assert commands[1].data == velocity
    assert decode_journal(commands[2].data) == {
        'event': 'reset', 'time_from_zero': False, 'keep_bodies': False}


@pytest.mark.parametrize('text', [
    '', '{}', '[1]', '{"event": 1}', '{"event": []}', '{"event": "reset"}',
    '{"event": "reset", "time_from_zero": 1}', '[' * 100_000])
def test_a_line_that_is_no_journal_is_refused(text):
    with pytest.raises(messages.MessageError, match='not a line of a journal'):
        decode_journal(messages.encode_string(text))


def test_a_message_with_other_bodies_is_left_out_and_told(tmp_path, run):
    other = messages.PoseArrayEncoder('world', 2).encode(5, np.ones((2, 3)), np.ones((2, 4)))
    with run.recorder(tmp_path / 'bag') as recorder:
        run.write(recorder, 0, 3)
        recorder.write('/rigid_sim/poses', 10**9, other)
        recorder.write('/rigid_sim/poses', 10**9, b'nonsense')
    found = recording.read(tmp_path / 'bag')
    assert len(found.time) == 3
    assert len(found.damage) == 2
    assert 'poses at 1.000000000 s left out: 2 bodies instead of 3' in found.damage[0]


@pytest.mark.parametrize('make, reason', [
    (lambda path: None, 'cannot read .*: No such file'),
    (lambda path: path.mkdir(), 'no MCAP file in'),
    (lambda path: path.write_bytes(b'not at all'), 'is not an MCAP file'),
    (lambda path: path.write_bytes(b''), 'is not an MCAP file'),
])
def test_what_is_no_bag_is_one_clear_error(tmp_path, make, reason):
    make(tmp_path / 'bag')
    with pytest.raises(recording.RecordingError, match=reason):
        recording.read(tmp_path / 'bag')


def test_files_are_read_in_the_order_of_their_numbers(tmp_path, bag, run):
    os.mkdir(tmp_path / 'bag')
    for name, first in (('bag_10.mcap', 20), ('bag_9.mcap', 10), ('bag_0.mcap', 0)):
        with run.recorder(tmp_path / name) as recorder:
            run.write(recorder, first, first + 10)
        shutil.move(tmp_path / name / f'{name}_0.mcap', tmp_path / 'bag' / name)
    assert recording.read(tmp_path / 'bag').time_ns.tolist() == [
        step * 10_000_000 for step in range(30)]


def test_it_works_without_ros(bag, tmp_path):
    import subprocess
    import sys
    code = ('import sys; sys.modules["rclpy"] = None; from rigid_sim_ros import recording; '
            f'print(recording.read({str(bag)!r}).position.shape); '
            'print([name for name in sys.modules if "_msgs" in name])')
    output = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,
                            timeout=60, env={**os.environ, 'PYTHONPATH': os.getcwd()}, check=True)
    assert output.stdout == '(100, 3, 3)\n[]\n'


@pytest.mark.parametrize('cut', [0, 1])
def test_an_overview_is_what_a_count_would_find(bag, tmp_path, monkeypatch, cut):
    shutil.copytree(bag, tmp_path / 'bag')
    file = tmp_path / 'bag' / 'sound_0.mcap'
    os.truncate(file, file.stat().st_size - cut)
    counted = {'/rigid_sim/poses': 100, '/rigid_sim/states': 100, '/rigid_sim/collisions': 10,
               '/rigid_sim/scene': 1}
    if not cut:
        # only a file without an end is gone through
        monkeypatch.setattr(mcap_scan.McapScan, 'messages', None)
    opened = recording.Bag(tmp_path / 'bag')
    assert opened.overviews() == [(counted, 0, 990_000_000)]
    assert set(counted) <= set(opened.topics)


def test_options_that_are_no_object_are_told(bag):
    opened = recording.Bag(bag)
    opened.attachments['run.json'] = json.dumps([1]).encode()
    assert opened.options() == {}
    assert opened.damage == ['the attachment run.json is no JSON object']
