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

"""The command writes what it is asked for, or one line and exit code 2."""

from pathlib import Path
import shlex
import stat
import sys

import numpy as np
from PIL import Image, ImageSequence
import pytest
from rigid_sim_ros.view import command_line, show
from rigid_sim_ros.view.command_line import main
from rigid_sim_ros.view.labels import CONTACT_COLOR

SMALL = ['--size', '96x64']


def test_a_picture(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv('HOME', str(tmp_path))
    assert main(['ten_cubes', '-o', '~/start.png', *SMALL]) == 0
    with Image.open(tmp_path / 'start.png') as image:
        assert image.size == (96, 64)
        # bodies of seven colours, ground and sky
        assert len(image.getcolors(96 * 64)) > 100
    assert capsys.readouterr() == ('', '')


def test_times_are_columns_and_views_are_rows(tmp_path):
    path = tmp_path / 'panels.png'
    assert main(['report_collision', '-o', str(path), '--time', 'collision-0.5,0.1,collision+1',
                 '--view', '300,20', '--view', '-60,20', *SMALL]) == 0
    with Image.open(path) as image:
        picture = np.asarray(image).astype(int)
    assert picture.shape == (2 * 64 + 4, 3 * 96 + 2 * 4, 3)
    columns = [picture[:64, start:start + 96] for start in (0, 100, 200)]
    assert (columns[0] != columns[1]).any() and (columns[1] != columns[2]).any()
    # 300 and -60 degrees are the same view
    assert (picture[:64] == picture[68:]).all()


def test_exposures_show_where_bodies_were(tmp_path):
    def drawn(name, *more):
        path = tmp_path / name
        assert main(['report_dynamics', '-o', str(path), '--view', '290,40', *SMALL, *more]) == 0
        with Image.open(path) as image:
            return np.asarray(image).astype(int)

    panels = drawn('panels.png', '--time', '0,10')
    first, last = panels[:, :96], panels[:, 100:]
    both = drawn('both.png', '--time', '10', '--exposures', '2')
    moved = np.abs(first - last).sum(axis=2) > 60
    assert (np.abs(both - last).sum(axis=2)[moved] > 10).any()
    # the last one is on top: where it shows a body (the only strong colours) nothing is changed
    body = np.ptp(last, axis=2) > 130
    assert body.sum() > 50
    assert (both == last)[body].all()


def test_a_gif_shows_real_time(tmp_path):
    path = tmp_path / 'film.gif'
    assert main(['report_collision', '-o', str(path), '--time', '1', '--duration', '0.6',
                 '--fps', '15', *SMALL]) == 0
    with Image.open(path) as film:
        frames = [(frame.info['duration'], frame.convert('RGB'))
                  for frame in ImageSequence.Iterator(film)]
        assert film.info['loop'] == 0
    # 15 a second are 0.07 s in a format that counts hundredths
    assert [duration for duration, _ in frames] == [70] * 9
    assert frames[0][1].size == (96, 64)
    assert frames[0][1].tobytes() != frames[-1][1].tobytes()
    # the first frame, which gives the colours, has no contact; those of 1.35 and 1.42 s do
    shown = [CONTACT_COLOR in {color for _, color in frame.getcolors(96 * 64)}
             for _, frame in frames]
    assert shown == [False] * 5 + [True] * 2 + [False] * 2


def fake_ffmpeg(folder, script):
    program = folder / 'ffmpeg'
    program.write_text('#!/bin/sh\n' + script)
    program.chmod(program.stat().st_mode | stat.S_IXUSR)


def test_an_mp4_is_piped_through_ffmpeg(tmp_path, monkeypatch):
    # the last argument is the output; the others are kept to look at
    fake_ffmpeg(tmp_path, f'echo "$@" > {tmp_path}/arguments; for last; do :; done; '
                          'cat > "$last"\n')
    monkeypatch.setenv('PATH', str(tmp_path), prepend=':')
    path = tmp_path / 'film.mp4'
    assert main(['report_collision', '-o', str(path), '--duration', '0.2', '--fps', '10',
                 *SMALL]) == 0
    raw = path.read_bytes()
    assert len(raw) == 3 * 96 * 64 * 3
    picture = tmp_path / 'picture.png'
    # the same camera: all that is shown in the film has to fit in the picture as well
    assert main(['report_collision', '-o', str(picture), '--time', '0,0.1,0.2', *SMALL]) == 0
    with Image.open(picture) as image:
        assert raw[:96 * 64 * 3] == image.crop((0, 0, 96, 64)).tobytes()
    arguments = (tmp_path / 'arguments').read_text()
    assert '-s 96x64' in arguments and '-r 10' in arguments


def test_ffmpeg_fails(tmp_path, monkeypatch, capsys):
    fake_ffmpeg(tmp_path, 'echo "Unknown encoder libx264" >&2; exit 1\n')
    monkeypatch.setenv('PATH', str(tmp_path), prepend=':')
    path = tmp_path / 'film.mp4'
    assert main(['report_collision', '-o', str(path), '--duration', '0.2', *SMALL]) == 2
    assert capsys.readouterr().err == (
        f'rigid_sim_view: {path}: ffmpeg failed: Unknown encoder libx264\n')
    assert [each.name for each in tmp_path.iterdir()] == ['ffmpeg']


def test_no_ffmpeg(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv('PATH', str(tmp_path))
    assert main(['ten_cubes', '-o', str(tmp_path / 'film.mp4')]) == 2
    assert '.mp4 needs ffmpeg, which is not installed' in capsys.readouterr().err


@pytest.mark.parametrize('arguments, expected', [
    ('ten_cube -o a.png', 'did you mean ten_cubes'),
    ('missing.yaml -o a.png', 'missing.yaml: no such file'),
    ('missing.mcap -o a.png', 'missing.mcap'),
    ('. -o a.png', 'no MCAP file'),
    ('ten_cubes -o missing/a.png', 'missing/a.png: the folder missing is not there'),
    ('ten_cubes -o folder.png', 'folder.png: cannot be written: Is a directory'),
    ('empty.yaml -o a.png', 'empty.yaml: has no bodies'),
    ('report_dynamics -o a.png --time collision', 'nothing collides within 60 s'),
    ('ten_cubes -o a.png --time -0.5', '--time -0.5 is not allowed; must be 0 or more'),
    ('ten_cubes -o a.gif --time 1,2', 'for pictures, not films'),
    ('ten_cubes -o a.gif --exposures 2', 'for pictures, not films'),
    ('ten_cubes -o a.gif --duration 1e5', 'must be at most 20000'),
])
def test_refusals(tmp_path, monkeypatch, capsys, arguments, expected):
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'folder.png').mkdir()
    (tmp_path / 'empty.yaml').write_text('bodies: []')
    before = sorted(tmp_path.iterdir())
    assert main([*arguments.split(), *SMALL]) == 2
    output, message = capsys.readouterr()
    assert output == ''
    assert message.startswith('rigid_sim_view: ') and expected in message
    assert len(message.splitlines()) == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize('arguments, expected', [
    ('', 'required: SCENE_OR_RECORDING, -o/--output'),
    ('ten_cubes', 'required: -o/--output'),
    ('ten_cubes -o a.jpg', "'a.jpg' must end in .png, .gif or .mp4"),
    ('ten_cubes -o a.png --time now', "'now' must be a time in seconds, or collision"),
    ('ten_cubes -o a.png --time 1,,2', "'' must be a time in seconds"),
    ('ten_cubes -o a.png --view 30', "'30' must be AZIMUTH,ELEVATION"),
    ('ten_cubes -o a.png --view 30,nan', "'30,nan' must be AZIMUTH,ELEVATION"),
    ('ten_cubes -o a.png --view 30,91', "'30,91' must be AZIMUTH,ELEVATION"),
    ('ten_cubes -o a.png --size 80', "'80' must be WIDTHxHEIGHT"),
    ('ten_cubes -o a.png --size 10x9999', "'10x9999' must be WIDTHxHEIGHT, each from 64 to 4096"),
    ('ten_cubes -o a.gif --fps 0', "'0' must be a number from 0.1 to 240"),
    ('ten_cubes -o a.gif --duration nan', "'nan' must be a number from 0"),
    ('ten_cubes -o a.png --exposures 0', "'0' must be an integer from 1 to 100"),
    ('ten_cubes -o a.png --colour red', 'unrecognized arguments: --colour'),
])
def test_wrong_arguments(capsys, arguments, expected):
    with pytest.raises(SystemExit) as ended:
        main(arguments.split())
    assert ended.value.code == 2
    message = capsys.readouterr().err
    assert expected in message
    assert len(message.splitlines()) == 1


def test_help_has_examples_that_are_understood(capsys):
    with pytest.raises(SystemExit) as ended:
        main(['--help'])
    assert ended.value.code == 0
    assert command_line.EXAMPLES in capsys.readouterr().out
    for line in command_line.EXAMPLES.splitlines()[1:]:
        program, *arguments = shlex.split(line)
        assert program == 'rigid_sim_view'
        assert command_line.read_arguments(arguments).source


def test_without_the_extra_it_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.delitem(sys.modules, 'rigid_sim_ros.view.show')
    # None is how Python notes a module that cannot be imported
    monkeypatch.setitem(sys.modules, 'tqdm', None)
    assert main(['ten_cubes', '-o', str(tmp_path / 'a.png')]) == 2
    assert "needs tqdm: pip install 'rigid_sim_ros[view]'" in capsys.readouterr().err


def test_interrupted_leaves_nothing_behind(tmp_path, monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(show.Panel, 'picture', interrupted)
    assert main(['ten_cubes', '-o', str(tmp_path / 'a.gif'), '--duration', '0.1', *SMALL]) == 130
    assert list(Path(tmp_path).iterdir()) == []
