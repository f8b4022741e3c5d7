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

"""Where the centres of mass are: parabolas, each with its own start."""

import numpy as np

from rigid_sim_ros.engine.flight.packed_columns import columns_of

START, POSITION, VELOCITY, HALF_ACCELERATION, ACCELERATION = (
    0, slice(1, 4), slice(4, 7), slice(7, 10), slice(10, 13))
"""Rows of the table."""


class Translations:
    """Centres of mass under constant acceleration; one column a body, all at rest at first."""

    def __init__(self, body_count):
        """Make a table of bodies at rest at the origin."""
        self.__setstate__((np.zeros((13, body_count)), False))

    def __getstate__(self):
        """Return what a copy is made of."""
        return self._table, self._accelerates

    def __setstate__(self, state):
        """Be a copy: rows are to be views of its own table."""
        self._table, self._accelerates = state
        self.start = self._table[START]
        self._all = tuple(self._table[rows] for rows in (POSITION, VELOCITY, HALF_ACCELERATION))
        self.acceleration = self._table[ACCELERATION]
        self._steady = None

    def begin_one(self, body, time, position, velocity, acceleration):
        """Start a flight of one body; vectors (3,) in plain floats."""
        self._steady = None
        x, y, z = acceleration
        self._table[:, body] = (time, *position, *velocity, 0.5 * x, 0.5 * y, 0.5 * z, x, y, z)
        self._accelerates = self._accelerates or bool(x or y or z)

    def begin(self, bodies, time, position, velocity, acceleration):
        """Start a flight of bodies (k,); vectors (3, k)."""
        self._steady = None
        self.start[bodies] = time
        self._table[POSITION, bodies] = position
        self._table[VELOCITY, bodies] = velocity
        self._table[HALF_ACCELERATION, bodies] = 0.5 * acceleration
        self.acceleration[:, bodies] = acceleration
        self._accelerates = self._accelerates or bool(acceleration.any())

    def positions(self, elapsed, indices, out):
        """Write the positions [m] of bodies (k,), a slice or None for all, to `out` (3, k)."""
        if indices is None:
            position, velocity, half_acceleration = self._all
        else:
            table = columns_of(self._table, indices)
            position, velocity, half_acceleration = (
                table[POSITION], table[VELOCITY], table[HALF_ACCELERATION])
        if self._accelerates:
            np.multiply(half_acceleration, elapsed, out=out)
            out += velocity
            out *= elapsed
        else:
            np.multiply(velocity, elapsed, out=out)
        out += position

    def velocities(self, elapsed, indices):
        """
        Return the velocities [m/s] of bodies (k,), None for all, (3, k).

        Those of all, while they stay the same, are one array that cannot be written.
        """
        table = self._table if indices is None else columns_of(self._table, indices)
        if self._accelerates:
            return table[ACCELERATION] * elapsed + table[VELOCITY]
        if indices is not None:
            return table[VELOCITY].copy()
        if self._steady is None:
            self._steady = table[VELOCITY].copy()
            self._steady.setflags(write=False)
        return self._steady

    def trajectory(self, body):
        """Return position and velocity of one body as a function of the time since its start."""
        x, y, z, u, v, w, a, b, c = self._table[1:10, body].tolist()

        def motion(t):
            return ((x + t * (u + t * a), y + t * (v + t * b), z + t * (w + t * c)),
                    (u + 2 * a * t, v + 2 * b * t, w + 2 * c * t))
        return motion
