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
The engines that are compared: one adapter each, one row each in `ENGINES`.

An adapter is imported by its name and only in the process that runs it, so that no engine needs
another, and an engine that is not installed is skipped.
"""

from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

import numpy as np


class Engine:
    """
    One simulation in one engine, with the settings an expert of that engine would choose.

    Rows of all arrays are the moving bodies in scene order; vectors are in world axes.
    """

    def build(self, scene, step, sleeping):
        """
        Make the simulation of a `model.Scene` with a step [s], ready to advance.

        Bodies may fall asleep only if `sleeping`, where the engine lets one choose.
        """
        raise NotImplementedError

    def expect(self, times):
        """Take the times [s] up to which it will be advanced and then read, if they help."""

    def advance(self, duration):
        """Advance by a duration [s], a whole number of steps."""
        raise NotImplementedError

    def read_poses(self):
        """Return positions [m], (n, 3), and orientations x, y, z, w, (n, 4), body to world."""
        raise NotImplementedError

    def read_velocities(self):
        """Return linear [m/s] and angular [rad/s] velocities, each (n, 3)."""
        raise NotImplementedError

    def asleep(self):
        """Return which bodies sleep, (n,) bool."""
        return np.zeros(len(self.read_poses()[0]), dtype=bool)


@dataclass(frozen=True)
class EngineRow:
    """Where an engine's adapter is, and what it needs."""

    title: str
    """As in tables and legends."""

    adapter: str
    """module:class."""

    distribution: str
    """The installed distribution, whose version is noted with each result."""

    module: str
    """What is imported."""

    most_bodies: int = 1_000_000
    """
    Problems with more are left out: hours of waiting that would tell nothing. The report's engine
    tests all pairs in each step, and MuJoCo's set-up takes the square of the count.
    """

    def installed(self):
        """Return whether the engine can be run here."""
        return find_spec(self.module) is not None

    def version(self):
        """Return the installed version, or 'source' when run without being installed."""
        try:
            return version(self.distribution)
        except PackageNotFoundError:
            return 'source'

    def load(self):
        """Import the adapter and return a new `Engine`."""
        module, name = self.adapter.split(':')
        return getattr(import_module(f'rigid_sim_ros.benchmark.engines.{module}'), name)()


ENGINES = {
    'exact': EngineRow('rigid_sim exact', 'ours:Exact', 'rigid_sim_ros', 'rigid_sim_ros'),
    'stepped': EngineRow('rigid_sim stepped', 'ours:Stepped', 'rigid_sim_ros', 'rigid_sim_ros'),
    'report': EngineRow('rigid_sim report', 'ours:Report', 'rigid_sim_ros', 'rigid_sim_ros',
                        most_bodies=20),
    'mujoco': EngineRow('MuJoCo', 'mujoco:Mujoco', 'mujoco', 'mujoco', most_bodies=20_000),
    'mujoco_rk4': EngineRow('MuJoCo RK4', 'mujoco:MujocoRungeKutta', 'mujoco', 'mujoco',
                            most_bodies=20_000),
    'rapier': EngineRow('Rapier', 'rapier:Rapier', 'rapier3d', 'rapier3d'),
    'bullet': EngineRow('Bullet', 'bullet:Bullet', 'pybullet', 'pybullet'),
}
"""Every engine by the name it has on the command line."""


def installed_engines():
    """Return the names of the engines that can be run here, in the order of the table."""
    return [name for name, row in ENGINES.items() if row.installed()]
