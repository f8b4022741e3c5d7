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

"""`rigid_sim_info`: what is in a recording."""

import argparse
from collections import Counter
import os
import sys

import numpy as np
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.messages import MessageError
from rigid_sim_ros.messages.collisions import KIND_NAMES
from rigid_sim_ros.recording import Bag, read, RecordingError
from rigid_sim_ros.recording.journal import ADD, decode_journal, PLACE, REMOVE, RESET
from rigid_sim_ros.scene import load_scene, SceneError

_MOST_COLLISIONS = 10
"""Rows of the table of collisions, unless --all is given."""

_EVENTS = {RESET: 'resets', ADD: 'bodies added', REMOVE: 'removed', PLACE: 'placed'}
"""Lines of the journal that are counted, and what they are called."""


def main(arguments=None):
    """Run the program; return its exit code."""
    parser = argparse.ArgumentParser(
        prog='rigid_sim_info', description='Tell what is in a recording: topics, bodies, '
        'collisions, and how much energy and momentum changed.')
    parser.add_argument('bag', type=os.path.expanduser,
                        help='folder of the bag, or one MCAP file of it')
    parser.add_argument('--all', action='store_true', help='list every collision')
    options = parser.parse_args(arguments)
    try:
        recording = read(options.bag)
        lines = [*_overview(recording), *_topics(options.bag), *_conserved(recording),
                 *_collisions(recording, options.all)]
    except RecordingError as error:
        print(f'rigid_sim_info: {error}', file=sys.stderr)
        return 2
    try:
        print('\n'.join(lines), flush=True)
    except BrokenPipeError:
        sys.stderr.close()  # the reader has seen enough (a pager was left)
    return 0


def _overview(recording):
    state_count = len(recording.time)
    yield f'bag         {recording.path}'
    yield f'state       {"finished" if recording.finished else "unfinished: rigid_sim_recover"}'
    if state_count:
        run_count = recording.run[-1] + 1
        yield (f'states      {state_count}, {recording.time[0]:.9g} s to '
               f'{recording.time[-1]:.9g} s' + (f', {run_count} runs' if run_count > 1 else ''))
    names = ', '.join(recording.names[:8]) + (', ...' if len(recording.names) > 8 else '')
    yield f'bodies      {len(recording.names)}: {names}'
    for name in ('method', 'max_step', 'version', 'numpy'):
        if name in recording.options:
            yield f'{name:<12}{recording.options[name]}'
    events = Counter(map(_event, recording.commands))
    yield f'commands    {events[None]}'
    changes = ', '.join(f'{what} {events[event]}' for event, what in _EVENTS.items()
                        if events[event])
    if changes:
        yield f'changes     {changes}'
    for line in recording.damage:
        yield f'damaged     {line}'


def _event(message):
    """Return which line of the journal a message is; None for a command."""
    try:
        return decode_journal(message.data)['event']
    except MessageError:
        return None


def _topics(path):
    bag = Bag(path)
    counts, sizes = Counter(), Counter()
    for message in bag.messages():
        counts[message.topic] += 1
        sizes[message.topic] += len(message.data)
    yield ''
    yield f'{"messages":>10} {"bytes":>13}  topic'
    for name, topic in sorted(bag.topics.items()):
        if counts[name]:
            yield f'{counts[name]:>10} {sizes[name]:>13}  {name} [{topic.type_name}]'


def _conserved(recording):
    """
    Tell how far energy and momentum are from where each run began.

    They are those of all moving bodies; contact with what is fixed, gravity and commands change
    them, as they should.
    """
    known = np.isfinite(recording.linear_velocity).all(axis=(1, 2))
    if not known.any():
        return
    try:
        scene = load_scene(recording.scene + '\n')
    except SceneError as error:
        yield ''
        yield f'no energy and momentum: {error}'
        return
    bodies = bodies_of(scene)
    if bodies.names[:bodies.moving_count] != recording.names:
        yield ''
        yield 'no energy and momentum: bodies were added or removed'
        return
    values = _totals(bodies, np.array(scene.gravity), recording, known)
    # the first state of the run that each state belongs to
    begin = np.searchsorted(recording.run[known], recording.run[known])
    yield ''
    yield f'{"":<18}{"at the start":>16}{"largest change":>16}{"at the end":>16}'
    for name, unit in (('energy', 'J'), ('momentum', 'N s'), ('angular momentum', 'N m s')):
        change = np.linalg.norm(values[name] - values[name][begin], axis=1)
        yield (f'{name:<18}{np.linalg.norm(values[name][0]):>16.9g}{change.max():>16.3g}'
               f'{np.linalg.norm(values[name][-1]):>16.9g}  {unit}')


def _totals(bodies, gravity, recording, known):
    """Return energy (T, 1), momentum and angular momentum (T, 3) of the known states."""
    velocity, position = recording.linear_velocity[known], recording.position[known]
    state_count, body_count = position.shape[:2]
    mass = 1 / bodies.inverse_mass[:body_count, np.newaxis]
    turn = rotation.matrix(recording.orientation[known].reshape(-1, 4).T)
    rate = recording.angular_velocity[known].reshape(-1, 3).T
    inertia = np.tile(bodies.inertia[:, :body_count], state_count)
    spin = rotation.transform(turn, inertia * rotation.transform_transposed(turn, rate))
    spin_energy = 0.5 * np.sum(spin * rate, axis=0).reshape(state_count, body_count)
    energy = np.sum(mass[:, 0] * (0.5 * np.sum(velocity ** 2, axis=2) - position @ gravity)
                    + spin_energy, axis=1)
    spin = spin.T.reshape(state_count, body_count, 3)
    return {'energy': energy[:, np.newaxis],
            'momentum': np.sum(mass * velocity, axis=1),
            'angular momentum': np.sum(np.cross(position, mass * velocity) + spin, axis=1)}


def _collisions(recording, every):
    events = recording.collisions
    kinds = Counter(KIND_NAMES[kind] for kind in events['kind'])
    yield ''
    yield 'collisions  ' + (', '.join(f'{kinds[name]} {name}' for name in KIND_NAMES
                                      if kinds[name]) or 'none')
    if not len(events):
        return
    yield f'{"time [s]":>14} {"kind":<7} {"speed [m/s]":>12} {"impulse [N s]":>13}  bodies'
    shown = events if every else events[:_MOST_COLLISIONS]
    for event in shown:
        bodies = ', '.join(_name(recording.all_names, event[key]) for key in ('body_a', 'body_b'))
        yield (f'{event["time"]:>14.9f} {KIND_NAMES[event["kind"]]:<7} {event["speed"]:>12.6g} '
               f'{np.linalg.norm(event["impulse"]):>13.6g}  {bodies}')
    if len(shown) < len(events):
        yield f'... and {len(events) - len(shown)} more; --all lists them'


def _name(names, index):
    return names[index] if 0 <= index < len(names) else f'number {index}'


if __name__ == '__main__':
    sys.exit(main())
