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

"""Newton's method for groups of a pile's contacts that are small enough for it."""

from math import ceil

import numpy as np

from rigid_sim_ros.engine.graph import alike
from rigid_sim_ros.engine.lasting_contact.pile.patience import newton_pays
from rigid_sim_ros.engine.solvers.canonical import compliance_of
from rigid_sim_ros.engine.solvers.newton import Newton
from rigid_sim_ros.engine.solvers.newton_together import FINER, newton_together
from rigid_sim_ros.engine.solvers.problem import ContactProblem

MOST_BODIES = 12
"""
Of a group. From what 40 iterations of the gradient leave Newton's method solves columns of ten in
a twentieth of the time in which that does, and four of five groups of up to ten tumbled cubes; of
more than 30 cubes it does one group of five, in the time of the gradient.
"""

_SAFETY = 0.1
"""Of the tolerance: what Newton's method, which has another norm, is asked for."""

_STEPS = 5
"""Of groups together, which are all whole: who needs more needs to have some of them halved."""

_ENTRIES = 100_000
"""Of the Jacobians of groups that are taken together: many more leave the cache (measured)."""


class GroupNewton:
    """
    Contacts of a pile in groups that have nothing to do with each other.

    Parameters
    ----------
    rows : (3, k, 2, 6)
        Scaled Jacobian, six columns for either body.
    slots : (2, k) int
        Of the two bodies; what does not move has rows of zeros.
    groups : (k,) int
        The group of each contact, below g; negative for those that take no part.
    body_groups : (n,) int
        Of each slot; the largest number is of those in no group, such as what does not move.
    friction : (k,)
        As in `ContactProblem`.

    """

    def __init__(self, rows, slots, groups, body_groups, friction):
        """See the class."""
        self._rows, self._slots, self._friction = rows, slots, friction
        order = np.argsort(body_groups, kind='stable')
        starts = np.searchsorted(body_groups[order], body_groups)
        self._columns = np.where(body_groups < body_groups.max(), np.argsort(order) - starts, 0)
        self._sizes = np.bincount(body_groups)
        self._members = [(group, places) for group, places in alike(groups) if group >= 0]

    def solve(self, free, forces, tolerance):
        """
        Put the forces found into those there are, (3, k), to start from.

        Return (iterations used (g,), which groups (g,) bool are solved): the motion without
        forces, less what is asked for, is `free` (3, k), and tolerances (g,) are of motion.
        """
        used = np.zeros(len(tolerance), dtype=int)
        tolerance = _SAFETY * tolerance
        for groups, places in self._shapes():
            found, used[groups] = newton_steps(
                self._factor(groups, places), free[:, places], self._friction[places],
                forces[:, places], tolerance[groups])
            done = used[groups] > 0
            forces[:, places[done]] = found[:, done]
        solved = used > 0
        for group, places in self._members:
            if solved[group]:
                continue
            if not newton_pays(np.count_nonzero(used), np.count_nonzero(solved)):
                break
            found, used[group] = newton_alone(
                self._factor([group], places[None])[:, 0], free[:, places],
                self._friction[places], forces[:, places], tolerance[group])
            if found is not None:
                solved[group] = True
                forces[:, places] = found
        return used, solved

    def _shapes(self):
        """Yield the groups (l,) of as many contacts and bodies each, and their contacts (l, m)."""
        shapes = {}
        for group, places in self._members:
            shapes.setdefault((len(places), self._sizes[group].item()), []).append((group, places))
        for (contacts, bodies), members in shapes.items():
            groups, places = map(np.array, zip(*members))
            parts = min(len(groups), ceil(18 * contacts * bodies * len(groups) / _ENTRIES))
            yield from zip(np.array_split(groups, parts), np.array_split(places, parts))

    def _factor(self, groups, places):
        """Return the factors (3, l, m, n) of groups (l,) of as many contacts (l, m) and bodies."""
        factor = np.zeros((3, *places.shape, self._sizes[groups[0]], 6))
        group, place = np.indices(places.shape, sparse=True)
        for side, slots in enumerate(self._slots):
            factor[:, group, place, self._columns[slots[places]]] += self._rows[:, places, side]
        return factor.reshape(*factor.shape[:3], -1)


def newton_steps(factor, free, friction, force, tolerance):
    """
    Return (forces (3, l, m), steps (l,), 0 where they have not led to a solution) of l groups.

    They are of m contacts each; arguments are those of `newton_together`.
    """
    used, left = np.zeros(len(tolerance), dtype=int), np.arange(len(tolerance))
    for step in range(1, 1 + _STEPS):
        if len(left) <= 1:
            # one is quicker alone, mostly in plain floats
            break
        force[:, left], done = newton_together(
            factor[:, left], free[:, left], friction[left], force[:, left], tolerance[left])
        used[left[done]] = step
        left = left[~done]
    return force, used


def newton_alone(factor, free, friction, force, tolerance):
    """
    Return (forces (3, k) of one group of contacts or None, iterations), from forces close by.

    Parameters
    ----------
    factor : (3, k, n)
        As in `ContactProblem`.
    free, force : (3, k)
        Motion without forces less what is asked for; forces to start from.
    friction : (k,)
        As in `ContactProblem`.
    tolerance : float
        Of motion.

    """
    count = len(friction)
    factor = factor.reshape(3 * count, -1)
    problem = ContactProblem(factor @ factor.T, free.ravel(), friction, np.zeros(count),
                             np.zeros((2, count)), factor)
    newton = Newton(problem, compliance_of(problem))
    # finer, as together: it takes one more pass, and makes of both the same
    found = newton.refined(force.ravel(), FINER * tolerance / np.abs(free).max())
    return None if found is None else found.reshape(3, -1), newton.iterations
