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

"""The contacts near the poses of one instant, and what is worked out of them when it is needed."""

from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.friction import mixed_friction
from rigid_sim_ros.engine.graph import connected
from rigid_sim_ros.engine.solvers import canonical, contact_rows, ContactProblem, solve
from rigid_sim_ros.engine.spin_friction import Resistance


_FEW = 8
"""Contacts of whose response no factor is needed."""

_ROUNDING = 5e-16
"""What a unit quaternion loses when it is put away and taken out again."""


class Near:
    """
    The contacts (k) near a pose of an island's bodies; velocities do not matter for it.

    Both halves of a step ask it, the second of one step and the first of the next, and impacts
    between them: its Jacobian is made once.

    Parameters
    ----------
    island : Island
    motion : Motion
        Whose poses these are.
    contacts : Contacts
        In columns of the island.

    """

    def __init__(self, island, motion, contacts):
        """See the class."""
        self.island = island
        self.contacts = contacts
        self._across = None, None
        """The last `Motion` that it was asked about, and the velocities across."""
        self.position, self.orientation = motion.position, motion.orientation
        self.body_pairs = list(zip(contacts.body_a.tolist(), contacts.body_b.tolist()))
        """(k,): the bodies of each contact, as plain numbers."""
        columns = island.columns
        self.scene_pairs = list(zip(columns[contacts.body_a].tolist(),
                                    columns[contacts.body_b].tolist()))
        """(k,): the same, as they are numbered in the scene."""

    @property
    def count(self):
        """Count of contacts."""
        return len(self.body_pairs)

    @cached_property
    def rows(self):
        """Return the `ContactRows`."""
        return contact_rows(self.island.bodies, self.contacts, self.position, self.orientation)

    @cached_property
    def _response(self):
        return self.rows.response()

    @cached_property
    def _friction(self):
        friction = self.island.bodies.friction
        return mixed_friction(friction[self.contacts.body_a], friction[self.contacts.body_b])

    def is_at(self, motion):
        """Return whether these are the poses of a `Motion`, but for rounding."""
        return same_poses(self, motion)

    def across(self, motion):
        """Return the velocity [m/s] of b minus that of a at the contacts, (3, k), world axes."""
        if self._across[0] is not motion:
            self._across = motion, self.rows.across(motion.linear, motion.angular)
        return self._across[1]

    def approach(self, motion):
        """Return how fast [m/s] contacts approach, (k,)."""
        if not self.count:
            return np.zeros(0)
        return -rotation.dot(self.contacts.normal, self.across(motion))

    def closed(self, gap):
        """Return the contacts (m,) int with gaps below one [m]."""
        return np.flatnonzero(self.contacts.separation < gap)

    def groups(self, which):
        """Return contacts (m,) int as a list of (l,) int, of which none acts on another."""
        moving = self.island.bodies.moving_count
        pairs = [self.body_pairs[contact] for contact in which]
        return [which[group] for group in connected(pairs, moving)]

    def struck(self, motion, which, half, time, bias=None, slip=None):
        """
        Return (the motion after the impulses that keep contacts (m,) int from closing, these).

        That is velocities across them, plus `bias` (3, k) in contact axes, of no approach, with
        friction; `slip` (2, k) are directions known, see `ContactProblem`. `half` names what they
        are for, `time` [s] is that of the step: the last forces of the same name are what the
        solver starts from. The impulses (3, k) are in contact axes. What resists spin does so by
        as much as it would at each contact by itself.
        """
        struck, impulse = self._kept(motion, which, half, time, bias, slip)
        if self.island.resists_spin and impulse.any():
            resistance = Resistance(self.island.bodies, self.contacts, self.position,
                                    self.orientation, impulse, self._friction)
            turned = motion.angular + resistance.turned(struck.linear, struck.angular)
            return self._kept(replace(motion, angular=turned), which, half, time, bias, slip)
        return struck, impulse

    def _kept(self, motion, which, half, time, bias, slip):
        """Return what `struck` does, without friction against rolling and pivoting."""
        count = self.count
        free = self.rows.components(self.across(motion)).reshape(3, count)
        if bias is not None:
            free += bias
        guess = self._remembered(half, time)
        impulse, start = np.zeros((2, 3, count))
        closing = free[0, which] < 0.0
        if guess is not None:
            closing |= guess[0, which] > 0.0
        rounding = -canonical.ACCURACY * float(np.abs(free[:, which]).max())
        joining = set(which[closing].tolist())
        while joining:
            for group in self.groups(which[closing]):
                # whom nobody joins has been solved
                if not joining.isdisjoint(group.tolist()):
                    impulse[:, group], start[:, group] = self._solved(free, group, slip, guess)
            # many contacts are not reached: who is left out has to open by itself
            after = free[0] + self._response[:count] @ impulse.ravel()
            overlooked = ~closing & (after[which] < rounding)
            closing |= overlooked
            joining = set(which[overlooked].tolist())
            guess = start
        if time > 0.0:
            self.island.forces[half] = (self.scene_pairs, self.contacts.point,
                                        self.rows.world(start.ravel()) / time)
        return motion.struck(self.rows.touched, *self.rows.change(impulse.ravel())), impulse

    def shifted(self, motion, linear, angular):
        """
        Return the contacts near a `Motion` that is hardly anywhere else, gaps to first order.

        Away are its bodies (n,) by (3, n) [m] and turned by (3, n) [rad], so little that their
        Jacobian can stay.
        """
        # with all that has been worked out
        near = copy(self)
        near.position, near.orientation = motion.position, motion.orientation
        if self.count:
            near.contacts = replace(
                self.contacts, separation=self.contacts.separation + rotation.dot(
                    self.contacts.normal, self.rows.across(linear, angular)))
        return near

    def _remembered(self, half, time):
        """
        Return the last forces of that name for a time [s] in contact axes, (3, k), or None.

        Each is that of the nearest point of the same pair, if that has no nearer one now: which
        points there are, and in what order, changes as bodies turn. It matters: where there is
        more than one solution, as friction may have, the one nearby is that which goes on.
        """
        last = self.island.forces.get(half)
        if last is None or not last[0]:
            return None
        pairs, points, forces = last
        world = np.zeros((3, self.count))
        away = self.contacts.point[:, :, None] - points[:, None, :]
        square = (away * away).sum(axis=0)
        mine, theirs = np.array(self.scene_pairs), np.array(pairs)
        square[(mine[:, None] != theirs).any(axis=2)] = np.inf
        nearest, rows = square.argmin(axis=1), np.arange(self.count)
        known = (square.argmin(axis=0)[nearest] == rows) & (square[rows, nearest] < np.inf)
        world[:, known] = time * forces[:, nearest[known]]
        return self.rows.components(world).reshape(3, -1)

    def _solved(self, free, group, slip, guess):
        """Return (impulses (3, l), what to start from) of contacts that act on each other."""
        count = self.count
        rows = np.concatenate((group, group + count, group + 2 * count))
        response = self._response
        if len(group) < count:
            response = response.take(rows, axis=0).take(rows, axis=1)
        problem = ContactProblem(
            response, free.take(group, axis=1).ravel(), self._friction.take(group),
            np.zeros(len(group)),
            np.zeros((2, len(group))) if slip is None else slip.take(group, axis=1),
            self._factor(group, rows))
        if guess is not None:
            guess = guess[:, group].ravel()
            guess = guess if guess.any() else None
        solution = solve(problem, guess)
        self.island.world.work.solver_iterations += solution.iterations
        return solution.force.reshape(3, -1), solution.start.reshape(3, -1)

    def _factor(self, group, rows):
        """Return the `factor` of the problem of contacts (l,) int with rows (3l,) int, or None."""
        if len(group) <= _FEW:
            return None
        touched = self.rows.touched
        bodies = {body for contact in group for body in self.body_pairs[contact]}
        slots = np.flatnonzero(np.isin(touched, list(bodies)))
        columns = (6 * slots[:, None] + np.arange(6)).ravel()
        return self.rows.scaled[rows[:, None], columns]


def same_poses(one, other):
    """Return whether two with `position` and `orientation` are the same, but for rounding."""
    return (np.array_equal(one.position, other.position)
            and float(np.abs(one.orientation - other.orientation).max()) <= _ROUNDING)


def memory_of(islands, pairs_a, pairs_b):
    """
    Return what islands have in their `forces` of these pairs (p,) int, together.

    Of these only: an island that also kept the others' would hand them on, and all memory would
    double whenever islands are found anew.
    """
    together = {}
    islands = [island for island in islands if island.forces]
    if not islands:
        return together
    wanted = set(zip(pairs_a.tolist(), pairs_b.tolist()))
    for island in islands:
        for half, (pairs, points, world) in island.forces.items():
            kept = [place for place, (a, b) in enumerate(pairs)
                    if (a, b) in wanted or (b, a) in wanted]
            before = together.get(half, ([], np.zeros((3, 0)), np.zeros((3, 0))))
            together[half] = (before[0] + [pairs[place] for place in kept],
                              np.concatenate((before[1], points.take(kept, axis=1)), axis=1),
                              np.concatenate((before[2], world.take(kept, axis=1)), axis=1))
    return together
