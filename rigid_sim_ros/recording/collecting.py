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
Collects the messages of a recording and makes arrays of them.

Bodies may come and go. Rows are collected with the number of the cast they belong to, the names
there were at the time, and take their places in arrays of all bodies at the end.
"""

from dataclasses import dataclass, field

import numpy as np
from rigid_sim_ros.messages import (
    COLLISION_TYPE, decode_collisions, decode_pose_array, decode_string, MessageError,
    MultiDOFJointStateDecoder)
from rigid_sim_ros.recording.journal import BODIES, decode_journal

COMMAND_KINDS = ('cmd_force', 'cmd_torque', 'cmd_wrench', 'cmd_vel', 'cmd_states', 'journal')
"""Kinds of topics of what was done to a simulation, not of what it published."""

_POSE, _RATES = slice(0, 7), slice(7, 19)
"""Columns of a row of a state."""

_RATE_NAMES = ('linear_velocity', 'angular_velocity', 'force', 'torque')

LOST = -1
"""Index of a body whose name is not known."""


@dataclass
class _Cast:
    """The bodies there are for a while; what is not known is None."""

    names: tuple = None
    all_names: tuple = None


@dataclass
class _States:
    """States as they are collected: lists with an element for each message."""

    time_ns: list = field(default_factory=list)
    run: list = field(default_factory=list)
    cast: list = field(default_factory=list)
    rows: list = field(default_factory=list)
    counts: dict = field(default_factory=dict)
    """How many bodies each cast has."""

    def add(self, time_ns, run, cast, names, rows):
        count = self.counts.setdefault(cast, len(rows) if names is None else len(names))
        if len(rows) != count:
            raise MessageError(f'{len(rows)} bodies instead of {count}')
        self.time_ns.append(time_ns)
        self.run.append(run)
        self.cast.append(cast)
        self.rows.append(rows)


class Collected:
    """What was found so far in a bag."""

    def __init__(self):
        self.commands = []
        """Every `BagMessage` of a command topic or the journal."""
        self.scene = ''
        """The first scene that was published."""
        self._poses, self._states = _States(), _States()
        self._collisions = []
        self._casts = [_Cast()]
        self._run = self._last_ns = 0
        self._decoder = MultiDOFJointStateDecoder()

    def take(self, kind, type_name, message):
        """
        Take one message in, given the kind of its topic (see `Bag.kind`) and its type.

        What is not known is nothing to this reader.

        Raises `MessageError` for a message that cannot be read; it is left out.
        """
        if message.time_ns < self._last_ns:
            self._run += 1
        self._last_ns = message.time_ns
        if kind in COMMAND_KINDS:
            self.commands.append(message._replace(data=bytes(message.data)))
        take = _TAKERS.get((kind, type_name))
        if take is not None:
            take(self, message)

    def arrays(self, options):
        """Return the names and arrays of a `Recording`; the options know names too."""
        source = self._poses if self._poses.rows else self._states
        partners = _partners(source, self._states)
        casts = [cast if partner is None else self._states.cast[partner]
                 for cast, partner in zip(source.cast, partners)]
        self._name_first(options, source)
        used = [self._casts[cast] for cast in sorted({0, *casts})]
        names = _union(cast.names for cast in used)
        others = _union(cast.all_names or () for cast in self._casts)
        all_names = _union((names, others))
        return {
            'names': names, 'all_names': all_names,
            'time': np.array(source.time_ns, dtype=float) / 1e9,
            'time_ns': np.array(source.time_ns, dtype=np.int64),
            'run': np.array(source.run, dtype=int),
            **self._columns(source, partners, casts, names),
            'collisions': self._events(all_names),
            'collision_run': np.repeat([run for _, run, _ in self._collisions],
                                       [len(events) for *_, events in self._collisions]
                                       ).astype(int)}

    # -- messages ------------------------------------------------------------------------------

    def _take_poses(self, message):
        poses = decode_pose_array(message.data)
        # the first cast has the names of whoever knows as many, in the end
        names = self._casts[-1].names if len(self._casts) > 1 else None
        self._poses.add(message.time_ns, self._run, len(self._casts) - 1, names,
                        np.hstack([poses.position, poses.orientation]))

    def _take_states(self, message):
        state = self._decoder.decode(message.data)
        if {len(state.transforms), len(state.twists), len(state.wrenches)} != {len(state.names)}:
            raise MessageError('MultiDOFJointState: not every body has all numbers of a state')
        rows = np.hstack([state.transforms, state.twists, state.wrenches])
        cast = self._casts[-1]
        if cast.names is None:
            cast.names = state.names
        elif cast.names is not state.names and cast.names != state.names:
            # what told of other bodies got lost
            self._casts.append(_Cast(state.names))
        self._states.add(message.time_ns, self._run, len(self._casts) - 1, state.names, rows)

    def _take_collisions(self, message):
        self._collisions.append(
            (len(self._casts) - 1, self._run, decode_collisions(message.data)))

    def _take_scene(self, message):
        self.scene = self.scene or decode_string(message.data)

    def _take_journal(self, message):
        line = decode_journal(message.data)
        if line['event'] == BODIES:
            names = tuple(line['all_names'])
            self._casts.append(_Cast(names[:line['moving_count']], names))

    # -- arrays --------------------------------------------------------------------------------

    def _name_first(self, options, source):
        """Name the bodies of the beginning from whoever knows as many as there are."""
        count = source.counts.get(0, 0)
        first, given = self._casts[0], options.get('names')
        if first.names is None or len(first.names) != count:
            first.names = (tuple(given) if _is_names(given) and len(given) == count
                           else tuple(f'body_{index}' for index in range(count)))
        every = options.get('all_names')
        first.all_names = tuple(every) if _is_names(every) else first.names

    def _columns(self, source, partners, casts, names):
        """Return the arrays (T, n, ...) of poses, velocities and wrenches."""
        place = {name: index for index, name in enumerate(names)}
        columns = {cast: [place[name] for name in self._casts[cast].names] for cast in set(casts)}
        poses = np.full((len(casts), len(names), 7), np.nan)
        rates = np.full((len(casts), len(names), 12), np.nan)
        for index, (cast, rows, partner) in enumerate(zip(casts, source.rows, partners)):
            poses[index, columns[cast]] = rows[:, _POSE]
            if partner is not None:
                rates[index, columns[cast]] = self._states.rows[partner][:, _RATES]
        return {'position': poses[..., :3], 'orientation': poses[..., 3:],
                **{name: rates[..., 3 * index:3 * index + 3]
                   for index, name in enumerate(_RATE_NAMES)}}

    def _events(self, all_names):
        """Return the collisions, with indices into these names."""
        place = {name: index for index, name in enumerate(all_names)}
        parts = [np.zeros(0, COLLISION_TYPE)]
        for cast, _, events in self._collisions:
            table = [place[name] for name in self._casts[cast].all_names or ()]
            if table != list(range(len(table))) or cast:
                for key in ('body_a', 'body_b'):
                    events[key] = [table[index] if 0 <= index < len(table) else LOST
                                   for index in events[key].tolist()]
            parts.append(events)
        return np.concatenate(parts)


_TAKERS = {
    ('poses', 'geometry_msgs/msg/PoseArray'): Collected._take_poses,
    ('states', 'sensor_msgs/msg/MultiDOFJointState'): Collected._take_states,
    ('collisions', 'sensor_msgs/msg/PointCloud2'): Collected._take_collisions,
    ('scene', 'std_msgs/msg/String'): Collected._take_scene,
    ('journal', 'std_msgs/msg/String'): Collected._take_journal,
}


def _partners(source, states):
    """
    Return for each state of the source which of `states` tells its velocities, or None.

    That is one of the same time and the same poses; a time may be there twice, when something
    was changed while it stood still.
    """
    at = {}
    for index, key in enumerate(zip(states.run, states.time_ns)):
        at.setdefault(key, []).append(index)
    partners = []
    for rows, *key in zip(source.rows, source.run, source.time_ns):
        pose = rows[:, _POSE].tobytes()
        waiting = at.get(tuple(key), ())
        found = next((index for index in waiting
                      if states.rows[index].shape[1] == _RATES.stop
                      and states.rows[index][:, _POSE].tobytes() == pose), None)
        if found is not None:
            waiting.remove(found)
        partners.append(found)
    return partners


def _union(sequences):
    """Return all names of some sequences, each once, in the order in which they come."""
    return tuple(dict.fromkeys(name for names in sequences for name in names))


def _is_names(value):
    return isinstance(value, (list, tuple)) and all(isinstance(name, str) for name in value)
