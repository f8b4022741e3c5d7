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

"""Recordings made as the node makes them, simulated again."""

from dataclasses import replace
from pathlib import Path
import shutil
import struct

import numpy as np
import pytest
import rigid_sim_ros
from rigid_sim_ros import messages, topics
from rigid_sim_ros.bag_tools import info, recover, replay
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.nodes.command_readers import READERS
from rigid_sim_ros.nodes.session import Session
from rigid_sim_ros.recording import Bag, read, Recorder, recorder, software
from rigid_sim_ros.recording.journal import encode_parameters, encode_reset
from rigid_sim_ros.recording.software import digest_of_code
from rigid_sim_ros.scene import dump_scene, load_scene

SCENE = """
gravity: [0, 0, -9.81]
bodies:
  - {name: ball, sphere: {radius: 0.1}, mass: 2.0, position: [0, 0, 100]}
  - {name: cube, cube: {edge: 0.2}, mass: 1.0, position: [3, 0, 100], angular_velocity: [1, 2, 3]}
"""


class Recorded:
    """A session that records itself as the node does."""

    def __init__(self, path, scene=SCENE, method='exact'):
        loaded = load_scene(scene)
        simulation = Simulation(loaded, method)
        self.session = Session(simulation, 100.0, self._publish)
        self._source = topics.Source(simulation, 'world', dump_scene(loaded))
        rows = [replace(row, name=topics.resolve(row.name))
                for row in (*topics.PUBLISHED, *topics.COMMANDS, topics.JOURNAL)]
        self.recorder = Recorder(
            path, rows, scene=self._source.scene_text,
            options={'names': simulation.names, 'all_names': simulation.all_names,
                     'method': method, 'max_step': simulation.max_step})
        self._encoders = {row.name: row.encoder(self._source) for row in topics.PUBLISHED}

    def __enter__(self):
        self.write('~/journal', encode_parameters('world', 0.0))
        self.session.publish_now()
        return self

    def __exit__(self, *exception):
        self.recorder.close()

    def write(self, name, data, time=None):
        self.recorder.write(topics.resolve(name), self.session.time if time is None else time,
                            data)

    def advance(self, count):
        for _ in range(count):
            self.session.advance()

    def command(self, name, body, *vector):
        data = stamped(body, *vector)
        self.session.commands.carry_out(READERS[name]()(data)[1], self.session.time)
        self.write(name, data)

    def schedule(self, name, time, body, *vector):
        """Command something for a time before the next state."""
        data = stamped(body, *vector)
        self.session.commands.schedule(READERS[name]()(data)[1], time, 0, self.session.time)
        self.write(name, data, time)

    def _publish(self, time, collisions):
        self._source.collisions = collisions
        for name in ('~/poses', '~/states', *(['~/collisions'] if len(collisions) else [])):
            self.write(name, self._encoders[name](time), time)


def stamped(frame_id, *vector):
    name = frame_id.encode() + b'\0'
    body = struct.pack('<iII', 0, 0, len(name)) + name
    return b'\0\1\0\0' + body + bytes(-len(body) % 8) + np.array(vector, '<f8').tobytes()


@pytest.fixture
def eventful(tmp_path):
    """Return a bag with commands of all kinds, changed parameters and both kinds of reset."""
    with Recorded(tmp_path / 'bag') as run:
        run.advance(5)
        run.command('~/cmd_vel', 'cube', 1, 2, 3, 0.1, 0.2, 0.3)
        run.command('~/cmd_torque', 'cube', 0.001, 0.002, 0.003)
        run.advance(5)
        run.write('~/journal', encode_parameters('body', 0.037))
        run.session.commands.axes, run.session.commands.timeout = 'body', 0.037
        run.command('~/cmd_wrench', 'cube', 1, 0, 0, 0, 0.001, 0)
        run.schedule('~/cmd_force', run.session.time + 3_333_333, 'ball', 5, 0, 0)
        run.advance(10)
        run.write('~/journal', encode_reset(False))
        run.session.reset(False)
        run.advance(3)
        run.session.step(0.0123)
        run.write('~/journal', encode_reset(True), 0)
        run.session.reset(True)
        run.advance(5)
    return tmp_path / 'bag'


def test_a_run_with_commands_and_resets_is_identical(eventful, capsys):
    assert replay.main([str(eventful)]) == 0
    output = capsys.readouterr().out
    assert output.startswith('identical: ')
    # 5 + 5 + 10 + 3 + 2 + 5 advances, and the states at the start and after both resets
    assert f'{2 * (30 + 3)} messages up to 0.050000000 s' in output


@pytest.mark.parametrize('tool', [info, recover, replay])
def test_a_bag_may_be_told_from_home(eventful, monkeypatch, capsys, tool):
    monkeypatch.setenv('HOME', str(eventful.parent))
    assert tool.main([f'~/{eventful.name}']) == 0


def test_a_plot_that_cannot_be_written_takes_nothing_else_away(eventful, tmp_path, capsys):
    """A folder that is not there is told before it simulates; what else, at the end."""
    arguments = [str(eventful), '--with', 'max_step=0.001', '--plot']
    assert replay.main([*arguments, str(tmp_path / 'none' / 'plot.png')]) == 2
    assert 'there is no such folder' in capsys.readouterr().err
    assert replay.main([*arguments, str(tmp_path / 'plot.unknown')]) in (0, 1)
    assert 'no plot: ' in capsys.readouterr().out


def test_bouncing_with_the_baseline_method_is_identical_collisions_too(tmp_path, capsys):
    scene = SCENE.replace('100]', '0.3]').replace('sphere: {radius: 0.1}', 'cube: {edge: 0.2}')
    scene += 'planes: [{name: ground}]\n'
    with Recorded(tmp_path / 'bag', scene, 'report') as run:
        run.advance(60)
    assert replay.main([str(tmp_path / 'bag')]) == 0
    assert info.main([str(tmp_path / 'bag')]) == 0
    assert 'ball, ground' in capsys.readouterr().out


BLOW_UP = """
material: {restitution: 1.0, friction: 0.0}
planes: [{name: ground}]
bodies:
  - {name: a, cube: {edge: 0.2}, mass: 1.0, position: [0, 0, 3], force: [0, 0, -1.0e+8]}
"""


def test_a_state_that_is_no_number_ends_the_run_and_is_not_recorded(tmp_path, capsys):
    with Recorded(tmp_path / 'bag', BLOW_UP, 'report') as run:
        with np.errstate(all='ignore'), pytest.raises(
                FloatingPointError, match="of a is no number any more at .*'report'"):
            run.advance(1000)
        last = run.session.time
    recorded = read(tmp_path / 'bag')
    assert recorded.time_ns[-1] == last > 0
    assert np.isfinite(recorded.position).all() and np.isfinite(recorded.orientation).all()
    assert replay.main([str(tmp_path / 'bag')]) == 0
    assert capsys.readouterr().out.startswith('identical: ')


def test_settings_that_cannot_follow_a_run_are_one_line_after_what_they_could(tmp_path, capsys):
    with Recorded(tmp_path / 'bag', BLOW_UP, 'exact') as run:
        run.advance(100)
    plot = tmp_path / 'plot.png'
    with np.errstate(all='ignore'):
        assert replay.main([str(tmp_path / 'bag'), '--with', 'method=report',
                            '--plot', str(plot)]) == 2
    output = capsys.readouterr()
    assert output.out.startswith('position: largest deviation ')
    assert 'cannot be simulated again beyond ' in output.err.splitlines()[-1]


def test_pauses_on_collision_are_at_the_same_instants_again(tmp_path, capsys):
    # a cube slides all the time, so that steps are cut where the ball bounces
    scene = SCENE.replace('[0, 0, 100]', '[0, 0, 0.3]').replace('[3, 0, 100]', '[3, 0, 0.1]')
    scene = scene.replace('angular_velocity: [1, 2, 3]', 'velocity: [5, 0, 0]')
    scene += 'planes: [{name: ground}]\nmaterial: {restitution: 0.5, friction: 0.2}\n'
    with Recorded(tmp_path / 'bag', scene) as run:
        run.session.on_note = lambda line: run.write('~/journal', line)
        run.session.advance()
        run.session.pause_on_collision = True
        for _ in range(3):
            while not run.session.paused:
                run.session.advance()
            assert run.session.time % 10_000_000
            run.session.paused = False
        run.session.pause_on_collision = False
        run.advance(10)
    assert replay.main([str(tmp_path / 'bag')]) == 0
    # with other options the pauses are stamps like any other
    assert replay.main([str(tmp_path / 'bag'), '--with', 'max_step=0.001']) == 1
    assert 'cannot be simulated' not in capsys.readouterr().err


CROWD = """
gravity: [0, 0, 0]
material: {restitution: 1.0, friction: 0.0}
bodies:
""" + ''.join(
    f'  - {{name: ball_{row}_{column}, sphere: {{radius: 0.1}}, mass: 1.0, '
    f'position: [{0.5 * row}, {0.5 * column}, 0], velocity: [{1 - row}, {1 - column}, 0]}}\n'
    for row in range(3) for column in range(3))


def test_impacts_of_the_exact_method_are_identical_and_two_runs_are_the_same_bytes(
        tmp_path, capsys):
    for name in ('a', 'b'):
        with Recorded(tmp_path / name, CROWD) as run:
            run.advance(30)
            run.command('~/cmd_vel', 'ball_1_1', 0.1, 0.2, 0.3, 4, 5, 6)
            run.advance(70)
        assert replay.main([str(tmp_path / name)]) == 0
    assert capsys.readouterr().out.count('identical') == 2
    a, b = ([(topic, time, bytes(data)) for topic, time, data in Bag(tmp_path / name).messages()]
            for name in ('a', 'b'))
    assert a == b
    assert len(read(tmp_path / 'a').collisions) >= 4


def test_a_command_that_was_not_recorded_shows_as_the_first_difference(tmp_path, capsys):
    with Recorded(tmp_path / 'bag') as run:
        run.advance(3)
        run.session.simulation.set_velocity('cube', linear=(0.5, 0, 0))
        run.advance(1)
    assert replay.main([str(tmp_path / 'bag')]) == 1
    output = capsys.readouterr().out
    assert len(output.splitlines()) == 1
    # from x = 3 m with 0.5 m/s for 10 ms, as recorded; at rest, as simulated
    assert output.startswith('different: 0.040000000 s: cube: position [3.005, 0.0, ')
    assert ' recorded, [3.0, 0.0, ' in output


def test_a_later_file_alone_is_refused_and_not_taken_for_different(tmp_path, capsys):
    with Recorded(tmp_path / 'bag') as run:
        run.write('~/journal', encode_parameters('body', 0.0))
        run.session.commands.axes = 'body'
        run.advance(3)
        run.write('~/journal', encode_reset(True))
        run.session.reset(True)
        run.advance(10)
        # in axes that only the first file tells
        run.command('~/cmd_force', 'cube', 5, 0, 0)
        run.advance(3)
    assert replay.main([str(tmp_path / 'bag')]) == 0
    assert replay.main([str(tmp_path / 'bag' / 'bag_0.mcap')]) == 0
    capsys.readouterr()
    assert replay.main([str(tmp_path / 'bag' / 'bag_1.mcap')]) == 2
    output = capsys.readouterr()
    assert not output.out
    line, = output.err.strip().splitlines()
    assert line.endswith('bag_1.mcap lacks the beginning of a recording: if it is a later file of '
                         'a bag it cannot be simulated again alone, only with the folder of the '
                         'bag')


def test_another_numpy_is_told_where_results_differ(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(np, '__version__', '0.1')
    with Recorded(tmp_path / 'bag') as run:
        run.session.simulation.set_velocity('cube', linear=(0.5, 0, 0))
        run.advance(1)
    monkeypatch.undo()
    assert replay.main([str(tmp_path / 'bag')]) == 1
    assert capsys.readouterr().out.splitlines()[1] == (
        f'recorded with numpy 0.1, simulated with {np.__version__}')


@pytest.mark.parametrize('recorded_with', ['0123456789ab', None])
def test_other_code_of_the_same_version_is_told_where_results_differ(
        tmp_path, capsys, monkeypatch, recorded_with):
    with monkeypatch.context() as patch:
        run = {**software(), 'code': recorded_with}
        if recorded_with is None:
            del run['code']
        patch.setattr(recorder, 'software', lambda: run)
        with Recorded(tmp_path / 'bag') as run:
            run.session.simulation.set_velocity('cube', linear=(0.5, 0, 0))
            run.advance(1)
    assert replay.main([str(tmp_path / 'bag')]) == 1
    here = software()['code']
    assert capsys.readouterr().out.splitlines()[1:] == [
        f'recorded with code {recorded_with or "unknown"}, simulated with {here}']


def test_every_source_that_results_depend_on_is_in_the_number_of_the_code(tmp_path):
    package = Path(rigid_sim_ros.__file__).parent
    changed = (None, 'engine/flight/series.py', 'messages/cdr.py', 'nodes/session.py',
               'scene/values.py', 'view/camera.py')
    digests = []
    for number, name in enumerate(changed):
        copy = shutil.copytree(package, tmp_path / str(number))
        if name:
            (copy / name).write_text((copy / name).read_text() + '\n')
        digests.append(digest_of_code(copy))
    # how it is looked at does not count
    assert digests[0] == digests[-1] == software()['code']
    assert len(set(digests)) == len(changed) - 1


@pytest.mark.filterwarnings('error')
def test_the_plot_of_equal_motions_is_drawn_without_a_warning(tmp_path, capsys):
    with Recorded(tmp_path / 'bag') as run:
        run.advance(3)
    plot = tmp_path / 'plot.png'
    assert replay.main([str(tmp_path / 'bag'), '--with', 'method=exact',
                        '--plot', str(plot)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].startswith('attitude: largest deviation 0 rad ')
    assert plot.stat().st_size > 1000 or 'no plot' in lines[-1]


def test_the_difference_to_another_method_is_that_of_theory(tmp_path, capsys):
    with Recorded(tmp_path / 'bag') as run:
        run.advance(100)
    plot = tmp_path / 'plot.png'
    code = replay.main([str(tmp_path / 'bag'), '--with', 'method=stepped,max_step=0.01',
                        '--plot', str(plot)])
    assert code == 1
    lines = capsys.readouterr().out.splitlines()
    deviation = float(lines[0].split('largest deviation ')[1].split()[0])
    # semi-implicit Euler falls too far by g h t / 2 (sum of h^2 g n)
    assert deviation == pytest.approx(9.81 * 0.01 * 1.0 / 2, rel=1e-5)
    assert 'at 1.000000000 s' in lines[0]
    assert plot.stat().st_size > 1000 or 'no plot' in lines[-1]


@pytest.mark.parametrize('text, reason', [
    ('step=1', "--with 'step=1'; allowed: method=..., max_step=..."),
    ('max_step=x', "--with 'max_step=x'; allowed: a number"),
    ('method=none', "method is 'none'; allowed: exact"),
    ('max_step=-1', 'max_step is -1.0 s; allowed: a positive number')])
def test_settings_that_do_not_exist_are_one_line(eventful, capsys, text, reason):
    assert replay.main([str(eventful), '--with', text]) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith('rigid_sim_replay: ') and reason in error


def test_a_recording_from_the_middle_of_a_run_cannot_be_simulated_again(tmp_path, capsys):
    run = Recorded(tmp_path / 'bag')
    run.session._time = 10_000_000
    with run:
        pass
    assert replay.main([str(tmp_path / 'bag')]) == 2
    assert 'begins at 0.010000000 s of a run' in capsys.readouterr().err


def test_a_recording_without_a_scene_cannot_be_simulated_again(tmp_path, capsys):
    with Recorder(tmp_path / 'bag', [replace(topics.PUBLISHED[0], name='/poses')]) as recorder:
        encoder = messages.PoseArrayEncoder('world', 1)
        recorder.write('/poses', 0, encoder.encode(0, np.zeros((1, 3)), np.ones((1, 4))))
    assert replay.main([str(tmp_path / 'bag')]) == 2
    assert 'holds no scene, method and max_step' in capsys.readouterr().err


def test_info_tells_topics_and_what_is_conserved(tmp_path, capsys):
    with Recorded(tmp_path / 'bag', SCENE.replace('-9.81', '0')) as run:
        run.advance(100)
    assert info.main([str(tmp_path / 'bag')]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any('/rigid_sim/poses [geometry_msgs/msg/PoseArray]' in line for line in lines)
    start, change, end = map(float, next(
        line for line in lines if line.startswith('energy')).split()[1:4])
    # a free cube: m l^2 / 6 w^2 / 2 = 0.04 / 6 * 14 / 2 J, and it stays
    assert start == end == pytest.approx(0.04 / 6 * 14 / 2, rel=1e-8)
    assert change < 1e-15
    start = float(next(line for line in lines if line.startswith('angular')).split()[2])
    assert start == pytest.approx(0.04 / 6 * np.sqrt(14), rel=1e-8)


def test_info_shows_some_collisions_and_counts_the_rest(tmp_path, capsys):
    scene = CROWD.replace('0.5 *', '0.21 *')
    with Recorded(tmp_path / 'bag', scene) as run:
        run.advance(300)
        run.write('~/journal', encode_reset(False))
        run.session.reset(False)
    count = len(read(tmp_path / 'bag').collisions)
    assert count >= 12
    rows = {}
    for arguments in ((), ('--all',)):
        assert info.main([str(tmp_path / 'bag'), *arguments]) == 0
        lines = capsys.readouterr().out.splitlines()
        rows[arguments] = sum(' impact ' in line and ', ball_' in line for line in lines)
        assert 'changes     resets 1' in lines
        assert 'commands    0' in lines
        if not arguments:
            assert lines[-1] == f'... and {count - 10} more; --all lists them'
    assert list(rows.values()) == [10, count]


@pytest.mark.parametrize('program', [info, recover, replay])
def test_no_bag_is_one_line_and_exit_code_2(program, tmp_path, capsys):
    assert program.main([str(tmp_path / 'none')]) == 2
    output = capsys.readouterr()
    assert len(output.err.strip().splitlines()) == 1
    assert 'none' in output.err


def test_recover_says_what_it_did(eventful, capsys):
    file = sorted(eventful.glob('*.mcap'))[-1]
    file.write_bytes(file.read_bytes()[:-100])
    assert recover.main([str(eventful)]) == 0
    assert f'{file.name} finished with ' in capsys.readouterr().out
    assert replay.main([str(eventful)]) == 0
