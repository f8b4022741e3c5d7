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

"""Where the bodies are at the times that are to be drawn: simulated, or read from a recording."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigid_sim_ros import recording
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.bodies import ordered
from rigid_sim_ros.engine.events import END, IMPACT
from rigid_sim_ros.scene import load_scene
from rigid_sim_ros.view.errors import ViewError

CONTACT_SHOWN = 0.1
"""How long a contact is drawn [s]: an instant would be in no film."""

SEARCH_STEP = 0.05
SEARCH_LIMIT = 60.0
"""How far a scene is simulated in search of its first collision [s]."""


@dataclass
class States:
    """Poses of n bodies at T times, and the contacts just before each."""

    time: np.ndarray
    """[s], (T,)."""

    position: np.ndarray
    """[m], (T, n, 3): moving bodies in scene order, then fixed ones."""

    orientation: np.ndarray
    """Quaternions x, y, z, w, body to world, (T, n, 4)."""

    contacts: list
    """T arrays of collision events of the last `CONTACT_SHOWN` seconds."""


class Motion:
    """The bodies and planes of a scene; how they move is up to the subclass."""

    begin, end = 0.0, np.inf
    """Times [s] before and after which nothing is known."""

    def __init__(self, scene):
        self.bodies = ordered(scene)
        self.planes = scene.planes
        self.moving_count = sum(not body.fixed for body in self.bodies)

    def states(self, times, progress=iter):
        """
        Return the `States` at ascending times, (T,) [s].

        `progress` is given the times and gives them back one by one, to show how far it got.
        """
        raise NotImplementedError

    def first_collision(self):
        """Return the time [s] of the first collision; refuse motion without one."""
        raise NotImplementedError

    def _states(self, times, position, orientation, contacts):
        """Return `States` with the fixed bodies after the moving ones."""
        fixed = self.bodies[self.moving_count:]
        count = len(times)
        poses = [np.empty((count, len(self.bodies), size)) for size in (3, 4)]
        for pose, moving, name in zip(poses, (position, orientation),
                                      ('position', 'orientation')):
            pose[:, :self.moving_count] = moving
            for index, body in enumerate(fixed, self.moving_count):
                pose[:, index] = getattr(body, name)
        return States(np.asarray(times, dtype=float), *poses, contacts)


class SimulatedMotion(Motion):
    """A scene, simulated as far as it is asked for."""

    def __init__(self, scene):
        super().__init__(scene)
        self._simulation = Simulation(scene)

    def states(self, times, progress=iter):
        """Simulate to the times, (T,) [s]."""
        simulation = self._simulation
        simulation.reset()
        recent = simulation.collisions
        rows = []
        for time in progress(times):
            simulation.advance(max(0.0, time - simulation.time))
            recent = _recent(np.concatenate((recent, simulation.collisions)), time)
            rows.append((simulation.position, simulation.orientation, recent))
        position, orientation, contacts = zip(*rows)
        return self._states(times, position, orientation, contacts)

    def first_collision(self):
        """Simulate in search of the first collision."""
        simulation = self._simulation
        simulation.reset()
        while simulation.time < SEARCH_LIMIT:
            simulation.advance(SEARCH_STEP, until_collision=True)
            impacts = _impacts(simulation.collisions)
            if len(impacts):
                return float(impacts['time'][0])
        raise ViewError(f'nothing collides within {SEARCH_LIMIT:g} s')


class RecordedMotion(Motion):
    """
    The longest run of a recording; a run ends where simulated time was reset.

    States with other bodies than those the recording began with are left out.
    """

    def __init__(self, path):
        recorded = recording.read(path)
        if not len(recorded.time):
            raise ViewError(f'{path}: holds no poses')
        if not recorded.scene:
            raise ViewError(f'{path}: holds no scene, which says what shapes the bodies have')
        super().__init__(load_scene(recorded.scene + '\n'))
        there = ~np.isnan(recorded.position[:, :, 0])
        # if bodies came and went, the states with those of the scene
        whole = there[:, :self.moving_count].all(axis=1) & (there.sum(axis=1) == self.moving_count)
        if not whole.any():
            raise ViewError(f'{path}: has poses of {there[0].sum()} bodies, but its scene has '
                            f'{self.moving_count} that move')
        run = np.argmax(np.bincount(recorded.run[whole]))
        chosen = whole & (recorded.run == run)
        self._time = recorded.time[chosen]
        self._position = recorded.position[chosen, :self.moving_count]
        self._orientation = recorded.orientation[chosen, :self.moving_count]
        self._collisions = recorded.collisions[recorded.collision_run == run]
        self.begin, self.end = float(self._time[0]), float(self._time[-1])

    def states(self, times, progress=iter):
        """Return what was recorded nearest to the times, (T,) [s]."""
        # each state is the nearest up to half way to the next
        limits = (self._time[1:] + self._time[:-1]) / 2
        index = np.searchsorted(limits, times)
        contacts = [_recent(self._collisions, time) for time in self._time[index]]
        return self._states(self._time[index], self._position[index], self._orientation[index],
                            contacts)

    def first_collision(self):
        """Look the first collision up."""
        impacts = _impacts(self._collisions)
        if not len(impacts):
            raise ViewError('the recording holds no collision')
        return float(impacts['time'].min())


def _impacts(collisions):
    """Return those of collisions that are impacts: neither begin nor end of lasting contact."""
    return collisions[collisions['kind'] == IMPACT]


def open_motion(source):
    """
    Return the `Motion` of a recording (a folder, or an .mcap file) or else of a scene.

    Raises `ViewError`, `SceneError` or `RecordingError`, all of one line.
    """
    if Path(source).is_dir() or source.endswith('.mcap'):
        return RecordedMotion(source)
    return SimulatedMotion(load_scene(source))


def _recent(collisions, time):
    """Return the events that are shown at a time [s]; where contact ends nothing is."""
    age = time - collisions['time']
    # recorded times are rounded to nanoseconds
    return collisions[(age > -1e-8) & (age < CONTACT_SHOWN) & (collisions['kind'] != END)]
