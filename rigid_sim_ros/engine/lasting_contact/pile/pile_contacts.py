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

"""The contacts of a pile, kept for a few steps: their Jacobian, gaps that are followed."""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.friction import mixed_friction, mixed_restitution, tangents
from rigid_sim_ros.engine.graph import group_numbers
from rigid_sim_ros.engine.lasting_contact.pile.group_newton import GroupNewton, MOST_BODIES
from rigid_sim_ros.engine.lasting_contact.pile.pile_rows import DenseRows, PointRows
from rigid_sim_ros.engine.solvers.accelerated import accelerated, Cones
from rigid_sim_ros.engine.solvers.accelerated_groups import (
    accelerated_groups, largest_eigenvalues)
from rigid_sim_ros.engine.solvers.blocks import Block, BlockRows, MANY_PAIRS, POINTS
from rigid_sim_ros.engine.solvers.rows import mass_scale, scaled_rows

DENSE = 500
"""Contact points times bodies up to which a dense response is quicker than blocks."""

APART = 500
"""Contacts from which on the gradient takes each group by itself: fewer are quicker together."""

FIRST_ITERATIONS, FIRST_OF_FEW, FIRST_APART = 40, 100, 24
"""
Of the gradient, before Newton's method is tried; of few contacts they are cheap. Of groups by
themselves that takes many together, and needs forces that are less close.
"""

PARTING = 1e6
"""Motion of contacts that cannot close in a step: they are not there."""

_MARGIN = 1.15
"""What the estimate of the largest eigenvalue is raised by, to be a bound."""

_ROUNDS = 3
"""Of the power method, from the vector of the contacts before."""


class PileContacts:
    """
    Contacts of an island with their Jacobian, at the poses of one instant.

    Vectors by row are flat, (3n,): all normals, all first, all second tangents, in units that make
    all rows of the same size. Of the n points some may be there only to fill up a block.

    Parameters
    ----------
    bodies : Bodies
        The island's own.
    found : Found
        Of a pair at most `POINTS[-1]` points.
    orientation : (4, n)
        Of the island's bodies.
    vector : (6 slots,) or None
        Scaled velocities close to the fastest way to move the contacts, from those before.

    """

    def __init__(self, bodies, found, orientation, vector):
        """See the class."""
        self.found = found
        self.contacts = contacts = found.contacts
        a, b = contacts.body_a, contacts.body_b
        self._members = members = bodies.moving_count
        self._frames = rotation.matrix(orientation)
        self.axes = np.stack((contacts.normal, *tangents(contacts.normal)))
        scale = mass_scale(bodies, np.arange(bodies.count))
        self._scale = scale[:, :members]
        rows = np.stack([
            scaled_rows(self.axes, arm, self._frames[:, :, body], sign * scale[:, body])
            for body, arm, sign in ((a, found.arms[0], -1.0), (b, found.arms[1], 1.0))], axis=2)
        # rows of equal size: half the error of the solver
        size = np.sqrt((rows * rows).sum(axis=(2, 3)))
        np.maximum(size[1], size[2], out=size[1])
        size[2] = size[1]
        self._units = size.min(initial=np.inf) / size
        rows *= self._units[:, :, None, None]
        self.gap = contacts.separation
        self._bodies = bodies
        self._scaled_rows, self._slots = rows, np.minimum(np.stack((a, b)), members)
        self._places = np.arange(len(a))
        few = len(a) * (members + 1) <= DENSE
        self.groups = group_numbers(bodies, contacts)
        """(k,) int: contacts that hang together, by what moves, have the same number."""
        self.group_count = 1 + self.groups.max(initial=0).item()
        self.body_groups = np.full(members + 1, self.group_count)
        """(m + 1,) int: the same of the bodies that move; one more of what is in no group."""
        self.body_groups[self._slots] = self.groups
        self.body_groups[members] = self.group_count
        self._apart = len(a) >= APART and self.group_count > 1
        self._first = FIRST_OF_FEW if few else FIRST_APART if self._apart else FIRST_ITERATIONS
        self._point_groups = self.groups
        self.rows = self._dense(rows, self._slots) if few else self._many(
            rows, self._slots, a * bodies.count + b)
        self._friction = np.zeros(self.rows.count)
        self._friction[self._places] = (
            mixed_friction(bodies.friction[a], bodies.friction[b])
            * self._units[0] / self._units[1])
        self.vector, self._step = self._bound(vector)

    def solved(self, free, forces, tolerance, iterations, thorough):
        """
        Return (forces by row, iterations used (g,), groups tried, solved by Newton (g,) bool).

        It is an approximate solution, group by group: of motion without forces, less what is
        asked for, and forces to start from, by row, to tolerances (g,) of motion in at most so
        many iterations (g,). `thorough` groups (g,) bool that the gradient does not solve at once
        are tried by Newton's method.
        """
        sizes = np.bincount(self.body_groups, minlength=self.group_count)[:self.group_count]
        thorough = thorough & (sizes <= MOST_BODIES)
        # together, each waits for all
        early = thorough if self._apart else np.full(self.group_count, thorough.any())
        first = np.where(early, np.minimum(iterations, self._first), iterations)
        forces, used, solved = self._by_gradient(free, forces, tolerance, first)
        more, by_newton = self._by_newton(~solved & thorough, free, forces, tolerance)
        # what Newton's method has solved in its norm, too
        rest = np.where(solved, 0, iterations - first)
        if rest.any():
            forces, again, _ = self._by_gradient(free, forces, tolerance, rest)
            used += again
        return forces, used + more, more > 0, by_newton

    def frictionless(self, free, forces, tolerance, iterations):
        """Return forces by row as `solved` does, without friction, for one limit for all."""
        return self._by_gradient(free, forces, np.full(self.group_count, tolerance),
                                 np.full(self.group_count, iterations), friction=0.0)[0]

    def _by_gradient(self, free, forces, tolerance, iterations, friction=1.0):
        """Return (forces by row, iterations used (g,), which groups (g,) bool are solved)."""
        cones = Cones(friction * self._friction)
        if self._apart:
            return accelerated_groups(self.rows, cones, self._point_groups, self._step, free,
                                      forces, tolerance, iterations)
        forces, used, residual = accelerated(
            self.rows.response, self._step.item(), cones, free, forces,
            tolerance[iterations > 0].max(), iterations.max())
        left = np.zeros(self.group_count)
        np.maximum.at(left, self._point_groups, residual.reshape(3, -1).max(axis=0))
        return forces, np.full(self.group_count, used), left <= tolerance

    def _by_newton(self, groups, free, forces, tolerance):
        """
        Put the forces of groups (g,) bool into those by row.

        Return (iterations used (g,), which groups (g,) bool are solved).
        """
        used = np.zeros(self.group_count, dtype=int)
        solved = np.zeros(self.group_count, dtype=bool)
        if not groups.any():
            return used, solved
        may_close = free[self._places] < PARTING
        newton = GroupNewton(
            self._scaled_rows, self._slots, np.where(groups[self.groups] & may_close,
                                                     self.groups, -1),
            self.body_groups, self._friction[self._places])
        found = forces.reshape(3, -1)[:, self._places]
        used, solved = newton.solve(free.reshape(3, -1)[:, self._places], found, tolerance)
        forces.reshape(3, -1)[:, self._places] = found
        return used, solved

    def _dense(self, rows, slots):
        """Return the rows as a matrix."""
        count = len(self.gap)
        dense = np.zeros((3, count, self._members + 1, 6))
        index = np.arange(count)
        for side in range(2):
            dense[:, index, slots[side]] = rows[:, :, side]
        # what does not move has no columns that count
        dense[:, :, -1] = 0.0
        return DenseRows(dense.reshape(3 * count, 6 * (self._members + 1)))

    def _many(self, rows, slots, keys):
        """Return rows (3, k, 2, 6) in the form that is quickest for so many pairs."""
        starts = np.flatnonzero(np.diff(keys, prepend=-1))
        if len(starts) < MANY_PAIRS:
            return PointRows(rows.reshape(3, len(keys), 12).transpose(0, 2, 1), slots,
                             self._members + 1)
        return self._blocks(rows, slots, starts)

    def _blocks(self, rows, slots, starts):
        """Return the rows as blocks, and note which flat point each contact is."""
        sizes = np.diff(starts, append=slots.shape[1])
        blocks, groups, begin, low = [], [], 0, 0
        for room in POINTS:
            fits = np.flatnonzero((sizes > low) & (sizes <= room))
            low = room
            if not len(fits):
                continue
            places = np.arange(room)
            real = places < sizes[fits, None]
            contacts = np.where(real, starts[fits, None] + places, 0)
            taken = (rows[:, contacts] * real[..., None, None]).transpose(1, 0, 2, 3, 4)
            blocks.append(Block(slots[:, starts[fits]].T,
                                taken.reshape(len(fits), 3 * room, 12), begin))
            self._places[contacts[real]] = begin + np.flatnonzero(real.ravel())
            groups.append(np.repeat(self.groups[starts[fits]], room))
            begin += real.size
        self._point_groups = np.concatenate(groups)
        return BlockRows(blocks, self._members + 1)

    def _bound(self, vector):
        """Return the scaled velocities of the fastest motions, and steps (g,) for the solver."""
        rounds, length = _ROUNDS, 6 * (self._members + 1)
        vector = np.zeros(length) if vector is None else vector
        groups, count = np.zeros(length, dtype=int), 1
        if self._apart:
            groups, count = np.repeat(self.body_groups, 6), self.group_count + 1
        still = np.bincount(groups, vector * vector, count) == 0.0
        if still[:self.group_count].any():
            # of members that touched nothing before, say: from zero it stays zero
            vector = np.where(still[groups], np.random.default_rng(0).normal(size=length), vector)
            rounds += 7
        largest, vector = largest_eigenvalues(
            lambda velocity: self.rows.momentum(self.rows.motion(velocity)), vector, groups,
            count, rounds)
        largest = largest[:self.group_count]
        return vector, 1 / (_MARGIN * np.where(largest > 0, largest, 1 / _MARGIN))

    # -- vectors by row --------------------------------------------------------------------------

    def restitution(self, speed):
        """Return the restitution of points (n,) that approach at speeds (n,) [m/s]."""
        contacts = self.contacts
        return mixed_restitution(self._bodies, contacts.body_a, contacts.body_b, speed)

    def row_motion(self, values, missing=0.0):
        """Return motions (3, k) by axis and contact as a vector by row."""
        return self._flat(values * self._units, missing)

    def row_forces(self, values):
        """Return forces (3, k) by axis and contact as a vector by row."""
        return self._flat(values / self._units, 0.0)

    def motion(self, vector):
        """Return motions (3, k) by axis and contact of a vector by row."""
        return vector.reshape(3, -1)[:, self._places] / self._units

    def forces(self, vector):
        """Return a vector by row as one by axis and contact, (3, k)."""
        return vector.reshape(3, -1)[:, self._places] * self._units

    def _flat(self, values, missing):
        result = np.full((3, self.rows.count), missing)
        result[:, self._places] = values
        return result.ravel()

    # -- velocities and scaled ones --------------------------------------------------------------

    def scaled(self, motion):
        """Return the scaled velocities, flat (6 slots,), of a `Motion`."""
        members = self._members
        rates = rotation.transform_transposed(
            self._frames[:, :, :members], motion.angular[:, :members])
        result = np.zeros((members + 1, 6))
        result[:-1] = (np.concatenate((motion.linear[:, :members], rates)) / self._scale).T
        return result.ravel()

    def velocities(self, scaled):
        """Return the linear and angular velocity, (3, m) each, of scaled ones."""
        unscaled = scaled.reshape(-1, 6)[:-1].T * self._scale
        return unscaled[:3], rotation.transform(
            self._frames[:, :, :self._members], unscaled[3:])
