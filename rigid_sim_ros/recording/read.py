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

"""Reads a recording into NumPy arrays, in one pass, without ROS."""

from dataclasses import dataclass, field

import numpy as np
from rigid_sim_ros.messages import (
    COLLISION_TYPE, decode_collisions, decode_pose_array, decode_string, MessageError,
    MultiDOFJointStateDecoder)
from rigid_sim_ros.recording.bag import Bag
from rigid_sim_ros.recording.errors import RecordingError

COMMAND_TOPICS = ('cmd_force', 'cmd_torque', 'cmd_wrench', 'cmd_vel', 'cmd_states', 'journal')


@dataclass
class Recording:
    """
    What a bag holds.

    There are T states of n bodies. Simulated time goes forward within a run; a reset to time zero
    begins another one, and so does a scene with other bodies, of which only as many states are
    kept as have the number of bodies of the first.
    """

    path: str
    names: tuple
    """Of the moving bodies, in the order of the arrays."""

    all_names: tuple
    """The names, then those of fixed bodies and planes: what collisions index; may be empty."""

    time: np.ndarray
    """Simulated time [s], (T,)."""

    time_ns: np.ndarray
    """The same in nanoseconds, (T,), as recorded."""

    run: np.ndarray
    """How often time had gone back before each state, (T,)."""

    position: np.ndarray
    """Centres of mass [m], (T, n, 3)."""

    orientation: np.ndarray
    """Quaternions x, y, z, w, body to world, (T, n, 4)."""

    linear_velocity: np.ndarray
    """[m/s], (T, n, 3); NaN where velocities were not recorded, as in the arrays below."""

    angular_velocity: np.ndarray
    """[rad/s], (T, n, 3), world axes."""

    force: np.ndarray
    """Held on the bodies [N], (T, n, 3)."""

    torque: np.ndarray
    """[N m], (T, n, 3)."""

    collisions: np.ndarray
    """Events, an array of `messages.COLLISION_TYPE`: time, body_a, body_b, kind, point, ..."""

    commands: list
    """Every `BagMessage` of a command topic or the journal, in the order they took effect."""

    scene: str
    """The scene as loaded, YAML; empty if it was not recorded."""

    options: dict
    """What else the run was started with."""

    finished: bool
    """Whether the bag was closed; if not, the last second may be missing."""

    damage: tuple = ()
    """What could not be read, one line each; empty for a sound bag."""


def read(path):
    """
    Return the `Recording` in a bag (a folder, or one MCAP file), as far as it can be read.

    Raises `RecordingError` if nothing can. What is damaged is left out and told in `damage`.
    """
    bag = Bag(path)
    collected = _Collected()
    for message in bag.messages():
        try:
            collected.take(bag.topics[message.topic], message)
        except MessageError as error:
            bag.damage.append(f'message of {message.topic} at {message.time_ns / 1e9:.9f} s left '
                              f'out: {error}')
    return collected.recording(bag)


@dataclass
class _States:
    """States as they are collected: lists with an element for each message."""

    time_ns: list = field(default_factory=list)
    run: list = field(default_factory=list)
    rows: list = field(default_factory=list)

    def add(self, time_ns, run, rows):
        if self.rows and rows.shape != self.rows[0].shape:
            raise MessageError(f'{len(rows)} bodies instead of {len(self.rows[0])}')
        self.time_ns.append(time_ns)
        self.run.append(run)
        self.rows.append(rows)


@dataclass
class _Collected:
    poses: _States = field(default_factory=_States)
    states: _States = field(default_factory=_States)
    collisions: list = field(default_factory=list)
    commands: list = field(default_factory=list)
    names: tuple = ()
    scene: str = ''
    run: int = 0
    last_ns: int = 0
    decoder: MultiDOFJointStateDecoder = field(default_factory=MultiDOFJointStateDecoder)

    def take(self, topic, message):
        """Take one message in; other topics are nothing to this reader."""
        if message.time_ns < self.last_ns:
            self.run += 1
        self.last_ns = message.time_ns
        last_part = topic.name.rpartition('/')[2]
        take = _TAKERS.get((last_part, topic.type_name))
        if take is not None:
            take(self, message)
        elif last_part in COMMAND_TOPICS:
            self.commands.append(message._replace(data=bytes(message.data)))

    def take_poses(self, message):
        poses = decode_pose_array(message.data)
        self.poses.add(message.time_ns, self.run,
                       np.hstack([poses.position, poses.orientation]))

    def take_states(self, message):
        state = self.decoder.decode(message.data)
        self.states.add(message.time_ns, self.run,
                        np.hstack([state.transforms, state.twists, state.wrenches]))
        self.names = self.names or state.names

    def take_collisions(self, message):
        self.collisions.append(decode_collisions(message.data))

    def take_scene(self, message):
        self.scene = self.scene or decode_string(message.data)

    def recording(self, bag):
        """Return the `Recording`."""
        options = bag.options()
        source = self.poses if self.poses.rows else self.states
        rows = np.array(source.rows) if source.rows else np.empty((0, 0, 7))
        names = _names(options.get('names'), self.names, rows.shape[1])
        return Recording(
            path=bag.path, names=names, all_names=_all_names(options, names),
            time=np.array(source.time_ns, dtype=float) / 1e9,
            time_ns=np.array(source.time_ns, dtype=np.int64), run=np.array(source.run, dtype=int),
            position=rows[..., :3], orientation=rows[..., 3:7],
            **_rates(self.states, source, rows.shape[1]),
            collisions=np.concatenate([np.zeros(0, COLLISION_TYPE), *self.collisions]),
            commands=self.commands,
            scene=bag.scene() or self.scene, options=options, finished=not bag.unfinished,
            damage=tuple(bag.damage))


_TAKERS = {
    ('poses', 'geometry_msgs/msg/PoseArray'): _Collected.take_poses,
    ('states', 'sensor_msgs/msg/MultiDOFJointState'): _Collected.take_states,
    ('collisions', 'sensor_msgs/msg/PointCloud2'): _Collected.take_collisions,
    ('scene', 'std_msgs/msg/String'): _Collected.take_scene,
}


def _names(recorded, in_states, body_count):
    """Return the names of the bodies from whoever knows as many as there are."""
    for names in (in_states, recorded):
        if _is_names(names) and len(names) == body_count:
            return tuple(names)
    return tuple(f'body_{index}' for index in range(body_count))


def _all_names(options, names):
    every = options.get('all_names')
    return tuple(every) if _is_names(every) else names


def _is_names(value):
    return isinstance(value, (list, tuple)) and all(isinstance(name, str) for name in value)


def _rates(states, source, body_count):
    """Return velocities and wrenches at the times of the source, NaN where there are none."""
    rows = np.full((len(source.rows), body_count, 12), np.nan)
    at = {key: index for index, key in enumerate(zip(states.run, states.time_ns))}
    found = [(row, at[key]) for row, key in enumerate(zip(source.run, source.time_ns))
             if key in at]
    if found and states.rows[0].shape == (body_count, 19):
        to, origin = np.array(found).T
        rows[to] = np.array(states.rows)[origin][..., 7:]
    names = ('linear_velocity', 'angular_velocity', 'force', 'torque')
    return {name: rows[..., 3 * index:3 * index + 3] for index, name in enumerate(names)}


__all__ = ['read', 'Recording', 'RecordingError']
