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
Steps of piles: islands of many bodies, with an iterative solver.

A step takes velocities on by forces and contact impulses, and poses by the mean of the velocities
before and after: to second order, as long as what touches what stays the same. Bodies that arrive
somewhere in the step go by the velocities after it, as contacts are closed by those. Contacts are
found anew when something has moved enough; until then their gaps are followed along.
Contacts ask u_n >= -gap / h, so that they close in the step. What hits turns and may run into
things by other features than were near: where a step ends with an overlap, the features that
overlap are added, as they are there, and the step is taken again (Newton's method on the poses at
the end). What approached faster than a limit rebounds at the end of the step. Overlaps that are
left are pushed out apart from that. Nothing of it adds energy, see `energy`. Redundant forces are
shared out as the solver comes upon them, which is not the canonical choice of small islands.
"""

from math import inf

import numpy as np

from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.lasting_contact.near import same_poses
from rigid_sim_ros.engine.lasting_contact.pile.budget import Budget
from rigid_sim_ros.engine.lasting_contact.pile.finding import FAST, Found, KEPT_WAY, run_into
from rigid_sim_ros.engine.lasting_contact.pile.groups import resting_members, undisturbed
from rigid_sim_ros.engine.lasting_contact.pile.memory import Impulses, MATCH, Quiet
from rigid_sim_ros.engine.lasting_contact.pile.patience import Patience
from rigid_sim_ros.engine.lasting_contact.pile.pile_contacts import PileContacts
from rigid_sim_ros.engine.lasting_contact.pile.pile_step import (
    HIT_ROUNDS, NEVER, OVERLAP, PileStep)
from rigid_sim_ros.engine.lasting_contact.stepping import parts_of

PUSH_ITERATIONS = 15
"""Of the solver to push overlaps out, at most; the rest is left to the next time."""

PUSHED = 3e-6
"""Of the length scale: overlap that is pushed out, to a third."""

PUSHED_QUICK = 5e-4
"""The same while something is quick, but for the steps before a test of who rests."""

CLOSED = 6e-4
"""Of the length scale: gap of contacts that may hold what rests."""

TRIES = 4
"""
Of a step, at most, each with what those before ran into: eight points of a pair each, and
`solvers.blocks` has room for 32.
"""

DEEP = 0.02
"""
Of the length scale: overlap that is pushed out whatever energy that takes; steps leave less, so
somebody else has made it.
"""

TESTED_STEPS = 12
"""Of so many steps one begins with a test of who rests."""


class Pile:
    """
    What an `Island` of many bodies keeps from step to step.

    Parameters
    ----------
    island : Island
    older : list of Pile
        Of the islands it was made of, for a warm start.

    """

    def __init__(self, island, older):
        """See the class."""
        self._island = island
        self._sources = [pile.impulses() for pile in older if pile.contacts is not None]
        self.quiet = Quiet(island.members)
        self.steps = 0
        """Steps taken, also as part of older ones."""
        self._vector = None
        self.budget = Budget([pile.budget for pile in older])
        """Of iterations of the solver."""
        self.patience = Patience(island.members)
        """With Newton's method."""
        for pile in older:
            self.quiet.take_over(pile.quiet)
            self.patience.take_over(pile.patience)
            self.steps = max(self.steps, pile.steps)
            self._vector = pile.vector_for(island.members, self._vector)
        self.contacts = None
        """The `PileContacts` in use."""
        self._forces = None
        self._way = None
        """(p,) [m]: how far points of each pair may have passed each other since then."""
        self._ahead = None
        """The `Motion` at the end of the last step and what was `Found` there, or None."""
        self._end = None
        """The `Motion` to which the contacts in use have been followed."""

    def advance(self, state, start, duration):
        """
        Take a step of `duration` [s] from time `start` [s].

        Returns (closed contacts in columns of the island, which members rest (m,) bool) and puts
        the members' columns into the `State`.
        """
        island = self._island
        free = island.free_motion(state)
        scales = island.scales(free)
        motion = island.gather(state)
        if self.contacts is not None and not same_poses(self._end, motion):
            # not where gaps were followed to: parts have been stepped by themselves meanwhile, or
            # somebody was put elsewhere, perhaps into others
            motion = self._renew(motion, free, scales, duration, inf if island.displaced else 0.0)
            self._end = motion
        island.displaced = False
        groups = np.full(island.member_count, -1)
        if self._rest_is_next():
            groups, contacts = resting_members(
                island, self.quiet, motion, free, scales, start, CLOSED * scales.length)
            if (groups >= 0).all():
                island.scatter(motion.stopped(), state)
                return contacts, groups >= 0
        self.steps += 1
        parts = parts_of(island, free, motion, duration)
        before = motion
        for part in range(parts):
            motion, closed = self._step(
                motion, free, scales, start + part * duration / parts, duration / parts)
        resting = undisturbed(island, scales, before, motion, groups)
        island.scatter(motion.stopped(resting), state)
        return closed, resting

    def _rest_is_next(self):
        """Return whether the next step begins with a test of who rests."""
        return self.steps % TESTED_STEPS == 0

    def impulses(self):
        """Return keys (of the scene), points and impulses, (3, k) each, of the last step."""
        found, columns = self.contacts.contacts, self._island.columns
        force, axes = self.contacts.forces(self._forces), self.contacts.axes
        world = axes[0] * force[0] + axes[1] * force[1] + axes[2] * force[2]
        count = self._island.world.bodies.count
        return columns[found.body_a] * count + columns[found.body_b], found.point, world

    def vector_for(self, members, vector):
        """Return the fastest motion for other members (m,), flat (6 (m + 1),); fills one given."""
        vector = np.zeros(6 * (len(members) + 1)) if vector is None else vector
        if self.contacts is not None:
            _, theirs, mine = np.intersect1d(members, self._island.members, return_indices=True)
            vector.reshape(-1, 6)[theirs] = self.contacts.vector.reshape(-1, 6)[mine]
        return vector

    def _renew(self, motion, free, scales, duration, lost):
        """
        Find the contacts of a `Motion` and return it with overlaps pushed out.

        As far as the energy goes that the step to it has lost [J], or all of those that are deep.
        """
        island = self._island
        vector = self._vector
        way = duration * island.closing(motion)
        if self.contacts is not None:
            self._sources = [self.impulses()]
            vector = self.contacts.vector
        if self._ahead is not None and same_poses(self._ahead[0], motion):
            found = self._ahead[1]
        else:
            found = self._found(motion, scales, way)
        self._way = np.zeros(len(island.pairs.pairs_a))
        self.contacts = contacts = PileContacts(island.bodies, found, motion.orientation, vector)
        self._forces = contacts.row_forces(
            self._remembered(found.contacts, MATCH * scales.length))
        quick = (way > FAST * scales.length).any() and not self._rest_is_next()
        pushed = PUSHED_QUICK if quick else PUSHED
        if (contacts.gap < -pushed * scales.length).any():
            motion = self._pushed_out(motion, free, scales, lost)
        return motion

    def _found(self, motion, scales, way):
        """
        Return what is `Found` near a `Motion` whose pairs go a way (p,) [m] in a step at most.

        Half of it is enough, as what it is that closes by more is found late.
        """
        return Found.at(self._island.find_contacts(
            motion, KEPT_WAY * scales.length + 0.5 * way), motion)

    def _remembered(self, contacts, reach):
        """Return impulses (3, k) in contact axes to start from."""
        columns, count = self._island.columns, self._island.world.bodies.count
        keys = columns[contacts.body_a] * count + columns[contacts.body_b]
        world = np.zeros((3, contacts.count))
        for source in self._sources:
            if len(source[0]):
                world += Impulses(*source).at(keys, contacts.point, reach)
        axes = self.contacts.axes
        return axes[:, 0] * world[0] + axes[:, 1] * world[1] + axes[:, 2] * world[2]

    def _pushed_out(self, motion, free, scales, lost):
        """Return the motion with overlaps undone, to a third of `PUSHED`; see `_renew`."""
        contacts, island = self.contacts, self._island
        allowed = PUSHED / 3 * scales.length
        rows = np.zeros((3, len(contacts.gap)))
        rows[0] = contacts.gap + allowed
        force = contacts.frictionless(
            contacts.row_motion(rows, NEVER), np.zeros(3 * contacts.rows.count), 0.3 * allowed,
            PUSH_ITERATIONS)
        count = island.member_count
        linear, angular = contacts.velocities(contacts.rows.momentum(force))
        raised = -((free.acceleration[:, :count] * linear).sum(axis=0)
                   / island.bodies.inverse_mass[:count]).sum()
        part = 1.0
        if raised > lost and contacts.gap.min() > -DEEP * scales.length:
            part = lost / raised
        contacts.gap = contacts.gap + part * contacts.motion(contacts.rows.response(force))[0]
        return free.displaced(motion, part * linear, part * angular)

    def _step(self, motion, free, scales, start, duration):
        """Return (motion, closed contacts) after a step of `duration` [s]."""
        if self.contacts is None:
            motion = self._renew(motion, free, scales, duration, 0.0)
        step = PileStep(self._island, free, scales, motion, duration, self.contacts, self._forces,
                        self.budget, self.patience)
        quick = (duration * self._island.closing(motion) > FAST * scales.length).any()
        for attempt in range(TRIES):
            step.attempt(1 if quick else HIT_ROUNDS)
            way = duration * self._island.closing(step.passage)
            late = self._late(step, scales, way, duration)
            if late is not None and attempt < TRIES - 1:
                step.learn(late)
            elif not (quick and step.sinks):
                break
            quick = False
        self._way += way
        self.contacts, self._forces = step.contacts, step.forces
        hit, impulse = step.finish()
        if hit.any():
            self._note(hit, impulse, -step.speed, start + duration)
        end, closed = step.end, self.contacts.contacts.select(step.closed)
        if (self._way > KEPT_WAY * scales.length).any() or (
                self._rest_is_next() and (self.contacts.gap < -PUSHED * scales.length).any()):
            end = self._renew(end, free, scales, duration, step.lost)
        self._end = end
        return end, closed

    def _late(self, step, scales, way, duration):
        """Return what the end of a step overlaps with, or None; pairs went a way (p,) [m]."""
        self._ahead = None
        if not (way > FAST * scales.length).any():
            return None
        ahead = self._found(step.end, scales, way)
        self._ahead = step.end, ahead
        return run_into(step.contacts.found, step.contacts.gap, ahead, step.passage, duration,
                        OVERLAP * scales.length)

    def _note(self, which, force, speed, time):
        """Note rebounds (k,) bool as impacts, at the end of the step they are in."""
        found, axes = self.contacts.contacts, self.contacts.axes
        columns, world = self._island.columns, self._island.world
        for row in np.flatnonzero(which):
            impulse = axes[:, :, row].T @ force[:, row]
            world.events.append(time, columns[found.body_a[row]], columns[found.body_b[row]],
                                IMPACT, found.point[:, row], found.normal[:, row], impulse,
                                speed[row])
        world.work.impacts += bool(which.any())
