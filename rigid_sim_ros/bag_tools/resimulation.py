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

"""
Simulates a recording again from its scene and commands.

The simulation is driven as the node drove it: from one recorded state to the next, with each
command carried out at the simulated time at which it took effect. What the node published is
made again from it, byte for byte, if the engine is the same. A recording that began later than
the run is simulated from the beginning of the run, and compared from its own beginning on.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.linalg import LinAlgError
from rigid_sim_ros import topics
from rigid_sim_ros.engine import CommandError, Simulation
from rigid_sim_ros.messages import decode_pose_array, MessageError
from rigid_sim_ros.nodes.command_readers import READERS
from rigid_sim_ros.nodes.commands import BODY_AXES, Refused, WORLD_AXES
from rigid_sim_ros.nodes.session import Session
from rigid_sim_ros.recording import Bag, RecordingError, software
from rigid_sim_ros.recording.history import read_history
from rigid_sim_ros.recording.journal import (
    ADD, COLLISION, decode_journal, PARAMETERS, PLACE, REMOVE, RESET)
from rigid_sim_ros.scene import load_scene, SceneError

POSES = 'poses'

COMPARED = (POSES, 'states', 'collisions')
"""Last parts of the names of the topics that are made again."""

_ROWS = {row.name.rpartition('/')[2]: row for row in topics.PUBLISHED}

_ANY_RATE = 1.0
"""Of the session; states are asked for one by one instead."""


@dataclass(frozen=True)
class Pair:
    """A recorded message, and the one made again in its place."""

    kind: str
    """One of `COMPARED`."""

    time_ns: int
    recorded: bytes
    again: bytes


class Resimulation:
    """
    A recording, simulated again.

    Parameters
    ----------
    path : str
        The bag.
    changes : dict
        Options of `Simulation` that replace those of the recording.

    Raises `RecordingError` with one line if the recording does not hold what is needed.

    """

    def __init__(self, path, changes=None):
        self._bag = Bag(path)
        self._messages = self._bag.messages()
        self._changes = changes or {}
        self._readers = {name.rpartition('/')[2]: make() for name, make in READERS.items()}
        self._lines = {PARAMETERS: self._set_parameters, RESET: self._reset, ADD: self._add,
                       REMOVE: self._remove, PLACE: self._place,
                       COLLISION: self._go_to_collision}
        self._session = None
        self._encoders = {}
        self._collisions = None
        self._frame = None
        self.on_progress = lambda time_ns: None
        """Called now and then with the simulated time [ns] before the recording's first state."""

    @property
    def names(self):
        """Names of the bodies; known once the first pair was made."""
        return self._session.simulation.names

    @property
    def damage(self):
        """Return what of the recording could not be read."""
        return self._bag.damage

    @property
    def other_software(self):
        """Return what else it was recorded with than there is here, one line each."""
        recorded = self._bag.options()
        return [f'recorded with {name} {recorded.get(name, "unknown")}, simulated with {here}'
                for name, here in software().items() if recorded.get(name) != here]

    def pairs(self):
        """
        Go through the recording, and make a `Pair` of every message of a topic in `COMPARED`.

        Raises `RecordingError` if it cannot be simulated again, now or from some moment on.
        """
        ahead = deque()
        for message in self._messages:
            kind = self._bag.kind(message.topic)
            if kind == POSES and self._session is None:
                self._begin(message, ahead)
                for earlier_kind, earlier in ahead:
                    self._take(earlier_kind, earlier)
                ahead.clear()
            if self._session is None:
                # what comes before the first state waits for the simulation to be there
                ahead.append((kind, message))
            elif kind in COMPARED:
                yield self._compared(kind, message)
            else:
                self._take(kind, message)
        if self._session is None:
            raise RecordingError(f'{self._bag.path} holds no state')

    def _check_is_beginning(self, ahead):
        """
        Refuse what lacks the line of parameters that every recording begins with.

        A later file of a bag holds scene and options too, and may begin at time zero after a
        reset; but what the reset kept, bodies and parameters, is told in the files before it.
        """
        if not any(kind == 'journal' and _event(message) == PARAMETERS
                   for kind, message in ahead):
            raise RecordingError(
                f'{self._bag.path} lacks the beginning of a recording: if it is a later file of a '
                'bag it cannot be simulated again alone, only with the folder of the bag')

    def _begin(self, message, ahead):
        scene, options = self._scene_and_options()
        self._check_is_beginning(ahead)
        history = self._bag.history()
        begin_ns, past = read_history(history) if history else (0, ())
        if message.time_ns and not history:
            raise RecordingError(
                f'{self._bag.path} begins at {message.time_ns / 1e9:.9f} s of a run, and what '
                'was before it is not in it (or too long, or damaged)')
        try:
            simulation = Simulation(load_scene(scene), **options)
            self._frame = decode_pose_array(message.data).frame_id
        except (SceneError, ValueError, TypeError) as error:
            raise RecordingError(f'{self._bag.path} cannot be simulated again: {error}') from error
        self._session = Session(simulation, _ANY_RATE, self._publish, begin_ns)
        self._session.on_bodies_changed = self._encoders.clear
        self._source = topics.Source(simulation, self._frame)
        for event in past:
            if event.topic:
                self._take(event.topic.rpartition('/')[2], event)
            else:
                self._advance_to(event.time_ns)
                self.on_progress(event.time_ns)

    def _scene_and_options(self):
        scene, recorded = self._bag.scene(), self._bag.options()
        options = {name: recorded[name] for name in ('method', 'max_step') if name in recorded}
        if not scene or len(options) < 2:
            raise RecordingError(f'{self._bag.path} holds no scene, method and max_step to '
                                 'simulate it from')
        return scene + '\n', {**options, **self._changes}

    def _publish(self, time_ns, collisions):
        self._collisions = collisions

    def _take(self, kind, message):
        """Do what a message of the recording tells to do, if it does."""
        try:
            if kind == 'journal':
                line = decode_journal(message.data)
                self._lines.get(line['event'], _for_readers)(line)
            elif kind in self._readers:
                self._carry_out(self._readers[kind](message.data)[1], message.time_ns)
        except (MessageError, Refused, CommandError, SceneError, ArithmeticError) as error:
            text = error.describe() if isinstance(error, Refused) else error
            raise RecordingError(f'{message.topic} at {message.time_ns / 1e9:.9f} s cannot be '
                                 f'carried out again: {text}') from error

    def _carry_out(self, command, time_ns):
        commands, now = self._session.commands, self._session.time
        if time_ns <= now:
            commands.carry_out(command, now)
        else:
            commands.schedule(command, time_ns, 0, now)

    def _set_parameters(self, line):
        if line['command_axes'] not in (WORLD_AXES, BODY_AXES):
            raise MessageError(f'command_axes is {line["command_axes"]!r}')
        self._session.commands.axes = line['command_axes']
        self._session.commands.timeout = line['command_timeout']

    def _reset(self, line):
        self._session.reset(line['time_from_zero'], line['keep_bodies'])

    def _add(self, line):
        for body in load_scene(line['scene'] + '\n').bodies:
            self._session.add(body)

    def _remove(self, line):
        self._session.remove(line['name'])

    def _place(self, line):
        self._session.place(line['name'], *(line[field] for field in (
            'position', 'orientation', 'velocity', 'angular_velocity')))

    def _advance_to(self, time_ns, until_collision=False):
        try:
            self._session.advance_to(time_ns, until_collision)
        except (ArithmeticError, LinAlgError) as error:
            raise RecordingError(f'{self._bag.path} cannot be simulated again beyond '
                                 f'{self._session.time / 1e9:.9f} s: {error}') from error

    def _go_to_collision(self, line):
        # with other options the first collision is another: then the stamp alone counts
        if not self._changes:
            self._advance_to(line['end_ns'], until_collision=True)

    def _compared(self, kind, message):
        session = self._session
        if message.time_ns > session.time:
            self._advance_to(message.time_ns)
        elif message.time_ns < session.time:
            raise RecordingError(
                f'{self._bag.path}: time goes back from {session.time / 1e9:.9f} s to '
                f'{message.time_ns / 1e9:.9f} s without a reset')
        if kind not in self._encoders:
            self._encoders[kind] = _ROWS[kind].encoder(self._source)
        self._source.collisions = (
            np.zeros(0, session.simulation.collisions.dtype) if self._collisions is None
            else self._collisions)
        return Pair(kind, message.time_ns, bytes(message.data),
                    bytes(self._encoders[kind](message.time_ns)))


def _event(message):
    try:
        return decode_journal(message.data)['event']
    except MessageError:
        return ''


def _for_readers(line):
    """Do nothing: the line only tells what others bring about."""
