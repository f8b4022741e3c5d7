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
"""One step of a pile: velocities by contact forces, poses by velocities, rebounds."""

from dataclasses import replace

import numpy as np

from rigid_sim_ros.engine.friction import mixed_friction
from rigid_sim_ros.engine.lasting_contact.motion import Motion
from rigid_sim_ros.engine.lasting_contact.pile.energy import kept_part, rebound_part
from rigid_sim_ros.engine.lasting_contact.pile.pile_contacts import PileContacts
from rigid_sim_ros.engine.lasting_contact.pile.solver_limits import ACCURACY, solver_limits
from rigid_sim_ros.engine.lasting_contact.pile.turning_gain import without_gain
from rigid_sim_ros.engine.spin_friction import Resistance

HIT_ROUNDS = 4
"""So many times at most; once where it is only to be seen what else is run into."""

OVERLAP = 5e-4
"""Of the length scale: sinking in by more is worth more work."""

SLACK = 1e-6
"""
Of the length scale: gap that need not be closed. Of the corners of a face some would ask for
motion and some for none otherwise, by what the solver has left of their gaps; which of them then
hold it all takes the solver long to find out, step after step.
"""

NEVER = 1e9
"""What is asked for of points that are not there."""

EVEN_OVERLAP = 1e-7
"""Of the length scale: what a body that moves evenly may close contacts by more, in a step."""

EVEN_ROUNDS = 3
"""Of finding out who moves evenly, as it depends on who else does; after so many nobody does."""

_PRESSED = 1e-50
"""Normal force that is none: the solver never lets it be zero."""


class PileStep:
    """
    A step that may be tried again with more contacts.

    Parameters
    ----------
    island : Island
    free : FreeMotion
    scales : Scales
    motion : Motion
        At the start.
    duration : float
        [s]
    contacts : PileContacts
        At the start.
    forces : (3n,)
        To start from, by row.
    budget : Budget
        Of iterations.
    patience : Patience
        With Newton's method.

    """

    def __init__(self, island, free, scales, motion, duration, contacts, forces, budget, patience):
        """See the class."""
        self._budget, self._patience = budget, patience
        self._island, self._free, self._scales = island, free, scales
        self._start, self._duration = motion, duration
        self._kicked = free.kicked(motion, duration)
        self.contacts, self.forces = contacts, forces
        """What is known so far."""
        self._pressed = contacts.forces(forces)[0] > _PRESSED
        self.end = self.hits = self.speed = None
        """The `Motion` at the end; which contacts hit (k,) bool, and the speeds [m/s] before."""
        self.passage = None
        """The poses of `end` with the velocities at which the bodies have come there."""
        self.lost = 0.0
        """Energy [J] lost."""
        self.sinks = False
        """Whether something hits and still gets deeper, as not enough rounds were solved."""

    @property
    def closed(self):
        """Return which contacts (k,) bool press."""
        return self.contacts.forces(self.forces)[0] > _PRESSED

    def attempt(self, rounds=HIT_ROUNDS):
        """Solve for the forces, in so many rounds at most where something hits; move to `end`."""
        contacts, duration = self.contacts, self._duration
        rows = contacts.rows
        before, kicked = contacts.scaled(self._start), contacts.scaled(self._kicked)
        limit = self._scales.impact_speed(duration)
        self.speed = contacts.motion(rows.motion(before))[0]
        self.hits = (self.speed < -limit) & (contacts.gap + duration * self.speed < 0)
        asked = np.zeros((3, len(self.speed)))
        slack = SLACK * self._scales.length
        # what is closed is closed by more than need be, and asks for nothing the next time
        early = np.where(contacts.gap > slack, contacts.gap - 0.5 * slack, 0.0)
        asked[0] = np.where(contacts.found.late, contacts.gap, early) / duration
        for _ in range(rounds):
            self.forces, change = self._solved(kicked, asked, self.forces)
            self.sinks = bool(self.hits.any()) and self._sinks(kicked + change)
            if not self.sinks:
                break
        kick = kicked - before
        share = self._shares(before, kick + change)
        part, self.lost = kept_part(before, kick, change, share)
        self._pass(kicked + part * change, share)

    def _shares(self, before, gained):
        """
        Return how much of what it has gained in the step each body moves at, flat (6 slots,).

        Half of it, as what is accelerated evenly does, so that poses are of second order; all of
        it if something hits it, or if it would close a contact further than the solver has seen
        to: what arrives is stopped within the step and not at its end.
        """
        contacts = self.contacts
        found = contacts.contacts
        gap = contacts.gap
        allowed = np.minimum(gap, 0.0) - EVEN_OVERLAP * self._scales.length
        # and what the velocities at both ends may be wrong by
        allowed -= 2.0 * ACCURACY * self._scales.acceleration * self._duration ** 2
        allowed = np.minimum(allowed, self._followed(before + gained))
        strict = self.hits | contacts.found.late
        share = np.full((len(before) // 6, 6), 0.5)
        for _ in range(EVEN_ROUNDS):
            for bodies in (found.body_a[strict], found.body_b[strict]):
                share[np.minimum(bodies, len(share) - 1)] = 1.0
            flat = share.ravel()
            strict = self._followed(before + flat * gained) < allowed
            if not strict.any():
                return flat
        return np.ones_like(before)

    def _followed(self, velocity):
        """Return the gaps (k,) [m] after a step at scaled velocities."""
        contacts = self.contacts
        return contacts.gap + self._duration * contacts.motion(contacts.rows.motion(velocity))[0]

    def _sinks(self, velocity):
        """Return whether anything gets deeper by what counts as overlap, at scaled velocities."""
        contacts = self.contacts
        way = self._duration * contacts.motion(contacts.rows.motion(velocity))[0]
        return bool((np.minimum(contacts.gap, 0.0) - contacts.gap - way
                     > OVERLAP * self._scales.length).any())

    def learn(self, late):
        """
        Know of contacts `Found` at the end in addition.

        Of those that were found at former ends too: without them the next end goes back there.
        """
        contacts = self.contacts
        found = contacts.found
        found.contacts.separation = contacts.gap
        joined, order = found.and_late(late)
        more = late.contacts.count
        force = np.concatenate((contacts.forces(self.forces), np.zeros((3, more))), axis=1)
        self.contacts = PileContacts(self._island.bodies, joined, self._start.orientation,
                                     contacts.vector)
        self.forces = self.contacts.row_forces(force[:, order])
        self._pressed = np.concatenate((self._pressed, np.zeros(more, dtype=bool)))[order]

    def finish(self):
        """
        Follow the gaps, and let what has hit rebound.

        Return which contacts (k,) bool have hit that did not press before, and their impulses
        (3, k) in contact axes.
        """
        contacts = self.contacts
        contacts.gap = self._followed(contacts.scaled(self.passage))
        impulse, closed = contacts.forces(self.forces), self.closed
        rebound = np.where(self.hits & closed,
                           contacts.restitution(-self.speed) * self.speed, 0.0)
        gained = self._gained()
        self.lost = min(self.lost, max(0.0, -float(gained.sum())))
        self.end = without_gain(self._island.bodies, self._free, self.end, gained, contacts,
                                closed, self._scales)
        if rebound.any():
            impulse = impulse + self._rebound(closed, rebound)
        return self.hits & closed & ~self._pressed, impulse

    def _gained(self):
        """Return the energy (n,) [J] gained, also by how bodies of unequal moments turn."""
        free, start, end = self._free, self._start, self.end
        return (free.kinetic_energy(end) - free.kinetic_energy(start)
                - free.work(start, end, self._duration, self.passage.angular))

    def _rebound(self, closed, rebound):
        """
        Change the velocities at the end and return the impulses (3, k) that do it.

        Of closed contacts (k,) bool and the velocities (k,) [m/s], negative, they rebound from.
        """
        contacts = self.contacts
        asked = np.zeros((3, len(closed)))
        asked[0] = np.where(closed, rebound, NEVER)
        self.contacts = PileContacts(
            self._island.bodies, contacts.found.carried(self._start, self.end),
            self.end.orientation, contacts.vector)
        velocity = self.contacts.scaled(self.end)
        forces, change = self._solved(velocity, asked, np.zeros(3 * self.contacts.rows.count))
        part = rebound_part(velocity, change, self.lost)
        # what rounding would take below zero would be shared out where overlaps are pushed out
        self.lost = max(0.0, self.lost - part * float(
            change @ velocity + 0.5 * part * (change @ change)))
        self.end = self.end.struck(np.arange(self._island.member_count),
                                   *self.contacts.velocities(part * change))
        impulse = part * self.contacts.forces(forces)
        self.contacts = contacts
        return impulse

    def _solved(self, velocity, asked, forces):
        """Return (forces by row, the change of scaled velocities they make)."""
        contacts = self.contacts
        limits = solver_limits(self._island, self._scales, contacts, self._start, self._duration,
                               np.where(self.hits, -self.speed, 0.0))
        groups = contacts.body_groups[:-1]
        forces, used, tried, solved = contacts.solved(
            contacts.rows.motion(velocity) + contacts.row_motion(asked, NEVER), forces,
            limits.tolerance, limits.share + self._budget.saved,
            limits.thorough & self._patience.allows(groups, contacts.group_count))
        self._patience.note(groups, tried, solved)
        self._budget.spend(used, limits.share)
        self._island.world.work.solver_iterations += int(used.max())
        return forces, contacts.rows.momentum(forces)

    def _resisted(self, linear, angular):
        """Return velocities (3, n) after friction against rolling and pivoting."""
        contacts, bodies = self.contacts, self._island.bodies
        # points were found some steps ago and have gone along with what moves since
        found, arms = contacts.contacts, contacts.found.arms
        mobile = found.body_a < bodies.moving_count
        found = replace(found, point=np.where(
            mobile, self._start.position[:, found.body_a] + arms[0],
            self._start.position[:, found.body_b] + arms[1]))
        return Resistance(
            bodies, found, self._start.position, self._start.orientation,
            contacts.forces(self.forces),
            mixed_friction(bodies.friction[found.body_a], bodies.friction[found.body_b]),
        ).applied(linear, angular)

    def _pass(self, scaled, share):
        """Move to the end of the step with velocities that are given scaled; see `_shares`."""
        start, kicked, duration = self._start, self._kicked, self._duration
        count = self._island.member_count
        linear, angular = kicked.linear.copy(), kicked.angular.copy()
        linear[:, :count], angular[:, :count] = self.contacts.velocities(scaled)
        if self._island.resists_spin:
            linear, angular = self._resisted(linear, angular)
        left = np.zeros(linear.shape[1])
        left[:count] = 1.0 - share.reshape(-1, 6)[:count, 0]
        struck = Motion(start.position, start.orientation, linear, angular)
        passing = Motion(start.position, start.orientation,
                         linear - left * (linear - start.linear),
                         angular - left * (angular - start.angular))
        orientation, angular = self._free.turned(start, kicked, struck, duration, passing)
        position = start.position + duration * passing.linear
        self.end = Motion(position, orientation, linear, angular)
        self.passage = Motion(position, orientation, passing.linear, passing.angular)
