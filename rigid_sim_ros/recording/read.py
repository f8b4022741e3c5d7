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

from dataclasses import dataclass

import numpy as np
from rigid_sim_ros.messages import MessageError
from rigid_sim_ros.recording.bag import Bag
from rigid_sim_ros.recording.collecting import Collected
from rigid_sim_ros.recording.errors import RecordingError


@dataclass
class Recording:
    """
    What a bag holds.

    There are T states of n bodies. Simulated time goes forward within a run; a reset to time zero
    begins another one. If bodies were added or removed, n counts all there ever were, and the
    numbers of a body that is not there are NaN.
    """

    path: str
    names: tuple
    """Of the moving bodies, in the order of the arrays."""

    all_names: tuple
    """The names, then those of fixed bodies and planes: what collisions index."""

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
    """
    Events, an array of `messages.COLLISION_TYPE`: time, body_a, body_b, kind, point, ...

    A body that is -1 is one whose name got lost with a damaged part of the bag.
    """

    collision_run: np.ndarray
    """How often time had gone back before each event, (E,)."""

    commands: list
    """Every `BagMessage` of a command topic or the journal, in the order they took effect."""

    scene: str
    """The scene the recording began with, YAML; empty if it was not recorded."""

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
    collected = Collected()
    for message in bag.messages():
        try:
            collected.take(
                bag.kind(message.topic), bag.topics[message.topic].type_name, message)
        except MessageError as error:
            bag.damage.append(f'message of {message.topic} at {message.time_ns / 1e9:.9f} s left '
                              f'out: {error}')
    options = bag.options()
    return Recording(
        path=bag.path, **collected.arrays(options), commands=collected.commands,
        scene=collected.scene or bag.scene(), options=options, finished=not bag.unfinished,
        damage=tuple(bag.damage))


__all__ = ['read', 'Recording', 'RecordingError']
