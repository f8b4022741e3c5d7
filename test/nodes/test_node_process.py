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

"""The node as a process: how it starts, what it says, how it ends."""

import os
import random
import shlex
import signal
import subprocess
import sys
import time

import pytest

pytest.importorskip('rclpy')

from node_harness import Client, NodeProcess, ROOT  # noqa: E402, I100
from rigid_sim_ros.nodes.parameters import PARAMETERS  # noqa: E402
from rigid_sim_ros.nodes.running import run  # noqa: E402
from rigid_sim_ros.nodes.signals import StopRequest  # noqa: E402
from rigid_sim_ros.recording import Bag  # noqa: E402
from rigid_sim_ros.topics import COMMANDS, PUBLISHED, SERVICES  # noqa: E402
import yaml  # noqa: E402

LONGEST_END = 2.0
"""Wall time [s] in which a process has to end after a signal."""


@pytest.mark.parametrize('signals', [
    (signal.SIGINT,), (signal.SIGTERM,), (signal.SIGINT, signal.SIGINT),
    (signal.SIGINT, signal.SIGTERM, signal.SIGINT)])
def test_signals_end_it_in_order(tmp_path, signals):
    with NodeProcess(tmp_path, scene='ten_cubes', record=False) as process:
        process.wait_for_text('try, in another terminal')
        time.sleep(random.uniform(0, 0.1))
        code, duration = process.stop(*signals, gap=random.uniform(0.0, 0.05))
        assert (code, duration < LONGEST_END) == (0, True), process.error
        assert 'Traceback' not in process.error


def test_signal_breaks_off_what_takes_too_long(tmp_path):
    # ten simulated seconds of ten cubes that meet and come to rest, in one advance
    with NodeProcess(tmp_path, scene='ten_cubes', publish_rate=0.1, real_time_factor=0,
                     record=True, record_path=tmp_path / 'bag') as process:
        process.wait_for_text('try, in another terminal')
        code, duration = process.stop(signal.SIGINT, signal.SIGINT, gap=0.2)
        assert (code, duration < LONGEST_END) == (0, True), process.error
        assert 'Traceback' not in process.error
    assert [message.time_ns for message in Bag(tmp_path / 'bag').messages()
            if message.topic.endswith('/poses')][0] == 0


@pytest.mark.parametrize('given, used', [(None, '1'), ('3', '3')])
def test_one_thread_computes_unless_told_otherwise(given, used):
    """The others that OpenBLAS would start are for matrices a hundred times as large."""
    script = ('import os, sys; from rigid_sim_ros.nodes import simulation_node; '
              'assert "numpy" not in sys.modules; simulation_node.main(["node", "--help"]); '
              'print(os.environ["OPENBLAS_NUM_THREADS"])')
    environment = {key: value for key, value in os.environ.items()
                   if key != 'OPENBLAS_NUM_THREADS'}
    environment.update({} if given is None else {'OPENBLAS_NUM_THREADS': given})
    shown = subprocess.run([sys.executable, '-c', script], env=environment, cwd=ROOT, timeout=60,
                           check=True, capture_output=True, text=True)
    assert shown.stdout.splitlines()[-1] == used


def test_signal_while_it_starts(tmp_path):
    for number, delay in enumerate((0.15, 0.4, 0.8)):
        with NodeProcess(tmp_path / str(number), scene='ten_cubes') as process:
            # not before Python itself is up: until then nobody can catch a signal
            time.sleep(delay)
            process.process.send_signal(signal.SIGTERM)
            code = process.wait()
            assert code in (0, -signal.SIGTERM), process.error
            assert 'Traceback' not in process.error


@pytest.mark.parametrize('module', ['simulation_node', 'ros2_command'])
def test_signal_while_a_c_extension_is_loaded(module):
    """What is raised meanwhile comes out as an ImportError; the end is as quiet all the same."""
    code = f"""
import os, signal, sys
class Extension:
    def find_spec(self, name, *_):
        if name == 'rclpy':
            try:
                os.kill(os.getpid(), signal.SIGTERM)
                sys.stdout.flush()
            except BaseException as error:
                raise ImportError('initialization failed') from error
sys.meta_path.insert(0, Extension())
sys.argv = ['x', 'topic', 'list']
from rigid_sim_ros.nodes.{module} import main
sys.exit(main())
"""
    ended = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,
                           timeout=30, cwd=ROOT)
    assert (ended.returncode, ended.stderr) == (0, '')


def test_start_tells_where_everything_is(tmp_path):
    with NodeProcess(tmp_path, scene='report_dynamics') as process, Client(process) as client:
        process.wait_for_text('try, in another terminal')
        process.wait_for_text('cmd_vel geometry_msgs')
        for row in (*PUBLISHED, *COMMANDS, *SERVICES):
            assert client.topic(row.name) in process.error
        # whole lines that can be copied: a shell takes them apart into a program and its words
        commands = process.output.splitlines()[1:]
        assert len(commands) == 3
        assert {tuple(shlex.split(line)[1:4]) for line in commands} == {
            ('topic', 'pub', '--once')}
        scene = client.listen('~/scene', durability='transient_local')
        text = client.spin_until(lambda: scene and scene[0].data, 'the latched scene')
        names = [body['name'] for body in yaml.safe_load(text)['bodies']]
        for line in commands:
            assert line.split('frame_id: ')[1].split('}')[0] in names


def test_nobody_has_to_read_what_it_prints():
    process = subprocess.Popen(
        [sys.executable, '-m', 'rigid_sim_ros.nodes.simulation_node', '--ros-args', '-p',
         'scene:=ten_cubes'], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT)
    process.stdout.close()
    lines = iter(process.stderr.readline, '')
    assert any('services' in line for line in lines)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, rest = process.communicate(timeout=30)
    assert (process.returncode, rest) == (0, '')


BAD_SCENES = {
    'no such name': (None, 'no_such_scene', ['no_such_scene', 'ten_cubes']),
    'no such file': (None, '/nowhere/scene.yaml', ['/nowhere/scene.yaml']),
    'unknown key': ('bodies:\n  - {name: a, cube: {edge: 1}, mass: 1, colour: red}\n', None,
                    ['a', 'colour']),
    'NaN': ('bodies:\n  - {name: a, cube: {edge: .nan}, mass: 1}\n', None, ['a', 'edge', 'nan']),
    'negative mass': ('bodies:\n  - {name: a, cube: {edge: 1}, mass: -1}\n', None,
                      ['a', 'mass', '-1']),
    'wrong shape': ('bodies:\n  - {name: a, cube: {edge: 1}, mass: 1, position: [1, 2]}\n', None,
                    ['a', 'position']),
    'duplicate name': ('bodies:\n' + 2 * '  - {name: a, cube: {edge: 1}, mass: 1}\n', None,
                       ['a']),
    'not YAML': ('bodies: [}', None, ['scene.yaml']),
}


def run_here(capfd, *arguments):
    """Run the executable's code in this process; return exit code, stdout and stderr."""
    code = run(['rigid_sim_node', *arguments], StopRequest())
    return (code, *capfd.readouterr())


@pytest.mark.parametrize('text, scene, expected', BAD_SCENES.values(), ids=BAD_SCENES)
def test_bad_scene_is_one_line_and_exit_code_2(tmp_path, capfd, text, scene, expected):
    if text is not None:
        scene = tmp_path / 'scene.yaml'
        scene.write_text(text)
    code, out, error = run_here(capfd, '--ros-args', '-p', f'scene:={scene}')
    assert (code, out) == (2, '')
    assert len(error.splitlines()) == 1, error
    assert all(word in error for word in expected), error


def test_bad_scene_ends_the_process_with_exit_code_2(tmp_path):
    with NodeProcess(tmp_path, scene='/nowhere/scene.yaml') as process:
        assert process.wait() == 2
        assert len(process.error.splitlines()) == 1, process.error
        assert process.output == ''


@pytest.mark.parametrize('name, value, expected', [
    ('publish_rate', -5.0, 'parameter publish_rate is -5.0; allowed: 0.1 to 10000 Hz'),
    ('publish_rate', 'fast', "parameter publish_rate is 'fast'; allowed: 0.1 to 10000 Hz"),
    ('real_time_factor', '.nan', 'parameter real_time_factor is nan; allowed: 0 to 100'),
    ('command_axes', 'bodies', "parameter command_axes is 'bodies'; allowed: world, body"),
    ('start_paused', 3, 'parameter start_paused is 3; allowed: true, false'),
    ('scene', 7, 'parameter scene is 7; allowed: text')])
def test_bad_parameter_is_one_line_and_exit_code_2(capfd, name, value, expected):
    code, out, error = run_here(capfd, '--ros-args', '-p', f'{name}:={value}')
    assert (code, out, error) == (2, '', f'rigid_sim_node: {expected}\n')


@pytest.mark.parametrize('arguments, word', [
    (['--ros-args', '-p', 'nonsense'], 'nonsense'),
    (['--ros-args', '--params-file', '/nowhere.yaml'], '/nowhere.yaml'),
    (['ten_cubes'], 'ten_cubes')])
def test_bad_arguments_are_one_line_and_exit_code_2(capfd, arguments, word):
    code, out, error = run_here(capfd, *arguments)
    assert (code, out) == (2, '')
    assert word in error
    assert len(error.splitlines()) == 1, error


def test_unknown_parameter_is_warned_of(tmp_path):
    with NodeProcess(tmp_path, publish_rat=5.0, publish_rate=50) as process:
        process.wait_for_text('try, in another terminal')
        assert "no parameter 'publish_rat'" in process.error
        assert 'near names: publish_rate' in process.error
        assert 'states at 50 Hz' in process.error
        assert process.stop()[0] == 0


def test_help_lists_every_parameter(capfd):
    code, out, error = run_here(capfd, '--help')
    assert (code, error) == (0, '')
    assert out.startswith('usage: rigid_sim_node')
    for row in PARAMETERS:
        assert f'  {row.name} = ' in out
