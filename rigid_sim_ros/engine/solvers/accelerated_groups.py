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
The accelerated projected gradient for contacts in groups that have nothing to do with each other.

Each group goes on with its own step, momentum and restarts, as if it were alone, and leaves when
it is solved: what is left costs what it is. All are taken along in the same few products of NumPy.
"""

from itertools import count

import numpy as np

from rigid_sim_ros.engine.solvers.accelerated import is_tested, SHORTER

LEFT_SHARE = 0.8
"""Contacts of groups that are solved go along until no more than this part is left to solve."""


def accelerated_groups(rows, cones, groups, step, free, force, tolerance, iterations):
    """
    Return (force, iterations used (g,), which groups (g,) bool are solved), as of `accelerated`.

    Parameters
    ----------
    rows : object
        `response(force)` gives the motion (3k,) made by forces (3k,), all normals, all first, all
        second tangents; `select(kept)` the rows of some contacts (k,) bool, whole groups.
    cones : object
        `project(force)` draws forces back onto what is allowed, in place; `select(kept)`.
    groups : (k,) int
        The group of each contact, below g.
    step : (g,)
        About the reciprocals of the largest eigenvalues.
    free, force : (3k,)
        Motion without forces, less what is asked for; forces to start from.
    tolerance : (g,)
        Changes of motion in an iteration at which to stop.
    iterations : (g,) int
        At most, to the next at which convergence is tested; where it is none the force is left.

    """
    result, used = force.copy(), np.zeros(len(step), dtype=int)
    solved = np.zeros(len(step), dtype=bool)
    places, running = np.arange(len(groups)), iterations > 0
    if not running.any():
        return result, used, solved
    race = _Race(rows, cones, groups, step, free, force)
    for iteration in count(1):
        kept = running[race.groups]
        if kept.sum() <= LEFT_SHARE * len(kept):
            places = places[kept]
            race.select(kept)
        there, change = race.projected()
        if is_tested(iteration):
            used[running] = iteration
            solved |= running & (race.residuals(change) <= tolerance)
            leaving = running & (solved | (iteration >= iterations))
            leaves = leaving[race.groups]
            result.reshape(3, -1)[:, places[leaves]] = there[:, leaves]
            running = running & ~leaving
            if not running.any():
                return result, used, solved
        race.go_on(there, change)


class _Race:
    """
    Forces of groups at an iteration, see `accelerated`; arguments of `accelerated_groups`.

    Vectors by row are kept as (3, k).
    """

    def __init__(self, rows, cones, groups, step, free, force):
        self._rows, self._cones, self._free = rows, cones, free.reshape(3, -1)
        self.groups = groups
        self._step = step.copy()
        self._steps = step[groups]
        self._theta = np.ones(len(step))
        self._here = force.reshape(3, -1).copy()
        cones.project(self._here)
        self._ahead = self._here
        self._made_here = self._made_ahead = self._response(self._here)

    def projected(self):
        """Return the forces (3, k) after a projected step, and how much they change in it."""
        there = self._made_ahead + self._free
        there *= self._steps
        np.subtract(self._ahead, there, out=there)
        self._cones.project(there)
        return there, there - self._ahead

    def residuals(self, change):
        """Return the largest change of motion in each group, (g,)."""
        largest = np.zeros(len(self._step))
        np.maximum.at(largest, self.groups, np.abs(change).max(axis=0))
        return largest / self._step

    def select(self, kept):
        """Go on with the contacts (k,) bool only."""
        self.groups, self._steps = self.groups[kept], self._steps[kept]
        self._rows, self._cones = self._rows.select(kept), self._cones.select(kept)
        # row by row, as [:, kept] would not leave them
        self._free, self._here, self._made_here, self._ahead, self._made_ahead = (
            vector.compress(kept, axis=1) for vector in (
                self._free, self._here, self._made_here, self._ahead, self._made_ahead))

    def go_on(self, there, change):
        """Go on from projected forces, with momentum or without, or back with a shorter step."""
        made_there = self._response(there)
        moved = there - self._here
        size, curvature, way = (self._sums(change, other) for other in (
            change, made_there - self._made_ahead, moved))
        turned = way < 0.0
        too_long = (0.0 < size) & (size < curvature * self._step)
        theta = self._theta
        following = 2.0 * theta / (theta + np.sqrt(theta * theta + 4.0))
        weight = theta * (1.0 - theta) / (theta * theta + following)
        weight[turned] = 0.0
        self._theta = np.where(turned | too_long, 1.0, following)
        weights = weight[self.groups]
        moved *= weights
        moved += there
        ahead, made_ahead = moved, made_there - self._made_here
        made_ahead *= weights
        made_ahead += made_there
        if too_long.any():
            self._step[too_long] = SHORTER * size[too_long] / curvature[too_long]
            self._steps = self._step[self.groups]
            back = too_long[self.groups]
            ahead, there = np.where(back, self._here, (ahead, there))
            made_ahead, made_there = np.where(back, self._made_here, (made_ahead, made_there))
        self._here, self._made_here = there, made_there
        self._ahead, self._made_ahead = ahead, made_ahead

    def _response(self, force):
        """Return the motion (3, k) that forces (3, k) make."""
        return self._rows.response(force.ravel()).reshape(3, -1)

    def _sums(self, one, other):
        """Return the sums (g,) of products (3, k) over the rows of groups."""
        return np.bincount(self.groups, np.einsum('ik,ik->k', one, other), len(self._step))


def largest_eigenvalues(response, vector, groups, group_count, rounds):
    """
    Return (estimates (g,), vector (n,)) as of `largest_eigenvalue`, for each group.

    Of a response that joins no entries (n,) of different `groups` (n,) int below `group_count`.
    """
    for _ in range(rounds):
        size = np.sqrt(np.bincount(groups, vector * vector, group_count))
        vector = response(vector / np.where(size > 0, size, 1.0)[groups])
    return np.sqrt(np.bincount(groups, vector * vector, group_count)), vector
