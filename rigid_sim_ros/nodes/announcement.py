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

"""What users are told: usage, and at the start where things are and what can be tried."""

import json
import os
from pathlib import Path
import re
import shlex
import shutil
import sys

from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.nodes.pacing import NANOSECONDS
from rigid_sim_ros.nodes.parameters import PARAMETERS
from rigid_sim_ros.topics import COMMANDS, SERVICES
import yaml

EXECUTABLE = 'rigid_sim_node'


def usage():
    """Return the text of --help."""
    rows = [(f'{row.name} = {_literal(row.default)}',
             f'{row.description}; {row.allowed}{", at the start only" if row.read_only else ""}')
            for row in PARAMETERS]
    width = max(len(left) for left, _ in rows)
    lines = '\n'.join(f'  {left:{width}}  {right}' for left, right in rows)
    return (
        f'usage: {EXECUTABLE} [--help] [--ros-args [-p NAME:=VALUE] ... '
        '[--params-file FILE] [-r FROM:=TO] ...]\n\n'
        'Simulates rigid bodies, takes commands from topics, publishes their motion and '
        'records it.\n\n'
        f'parameters and their defaults:\n{lines}\n\n'
        'example:\n'
        f'  {EXECUTABLE} --ros-args -p scene:=ten_cubes -p record:=true\n')


def paused_text(simulation, time):
    """Return the line to log when a collision paused the simulation at `time` [ns]."""
    collisions = simulation.collisions
    first = collisions[collisions['kind'] == IMPACT][0]
    names = simulation.all_names
    return (f'paused at {time / NANOSECONDS:.9f} s: {names[first["body_a"]]} and '
            f'{names[first["body_b"]]} collided (parameter pause_on_collision)')


def show(lines):
    """Print lines, unless nobody reads them any more."""
    try:
        print(*lines, sep='\n', flush=True)
    except BrokenPipeError:
        # what is left in the buffer would fail again at the end of the process
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _literal(value):
    return str(value).lower() if isinstance(value, bool) else repr(value)


def welcome(node, simulation, parameters, publications, recording_text):
    """Return the lines to log when a node is ready; names are those after remapping."""
    return [
        f'scene {parameters.scene!r}: {_count(simulation)}; method {simulation.method}, '
        f'states at {parameters.publish_rate:g} Hz, real-time factor '
        f'{parameters.real_time_factor:g}{", paused" if parameters.start_paused else ""}',
        recording_text,
        'publishes ' + ' '.join(publication.topic for publication in publications),
        'takes     ' + ' '.join(node.resolve_topic_name(row.name) for row in COMMANDS),
        'services  ' + ' '.join(node.resolve_service_name(row.name) for row in SERVICES)]


def invitation(node, simulation):
    """Return the lines to print when a node is ready: commands to try, a line each."""
    if not simulation.names:
        return []
    command = ros2_command()
    folder = os.path.dirname(command)
    here = ', in this folder' if folder and not os.path.isabs(folder) else ''
    return [f'try, in another terminal{here}:',
            *examples(command, node.resolve_topic_name, simulation.names)]


def examples(command, resolve, names):
    """Return three shell commands: push, let go, throw; `resolve` gives a topic's full name."""
    first, last = (f'frame_id: {_quoted(name)}' for name in (names[0], names[-1]))
    publish = f'{shlex.quote(command)} topic pub --once'
    push = f"{publish} {resolve('~/cmd_force')} geometry_msgs/msg/Vector3Stamped"
    # a force holds, so the second ends the first: nobody is left with a body that flies for ever
    thrown = f'{{header: {{{first}}}, twist: {{linear: {{z: 3.0}}, angular: {{x: 5.0}}}}}}'
    return (
        f"{push} {shlex.quote(f'{{header: {{{last}}}, vector: {{x: 8.0}}}}')}",
        f"{push} {shlex.quote(f'{{header: {{{last}}}}}')}",
        f"{publish} {resolve('~/cmd_vel')} geometry_msgs/msg/TwistStamped {shlex.quote(thrown)}")


def _quoted(name):
    """Return a name as YAML: as it is if it is a word, and not one like yes or null."""
    is_word = re.fullmatch('[A-Za-z_][A-Za-z_0-9]*', name)
    return name if is_word and yaml.safe_load(name) == name else json.dumps(
        name, ensure_ascii=False)


def ros2_command():
    """Return what to type for `ros2`: that, or our stand-in for it where there is none."""
    own = Path(sys.executable).with_name('rigid_sim_ros2')
    if shutil.which('ros2') or not own.is_file():
        return 'ros2'
    return min(os.path.relpath(own), str(own), key=len)


def _count(simulation):
    moving = len(simulation.names)
    fixed = len(simulation.all_names) - moving
    return f'{moving} moving {"body" if moving == 1 else "bodies"}, {fixed} fixed'
