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
Steps of piles: islands of many bodies, of first order, with an iterative solver.

A step is semi-implicit: velocities by forces and contact impulses, poses by the new velocities,
overlaps pushed out apart from that. Contacts are found anew when something has moved enough; until
then their gaps are followed along. Contacts ask u_n >= -gap / h, so that they close softly within
a step, or u_n >= e u if they approach faster than a limit and close in it. Redundant forces are
shared out as the solver comes upon them, which is not the canonical choice of small islands.
"""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.lasting_contact.motion import Motion
from rigid_sim_ros.engine.lasting_contact.pile.finding import contacts_of_step, KEPT_WAY
from rigid_sim_ros.engine.lasting_contact.pile.groups import resting_members
from rigid_sim_ros.engine.lasting_contact.pile.memory import Impulses, MATCH, Quiet
from rigid_sim_ros.engine.lasting_contact.pile.pile_contacts import PileContacts
from rigid_sim_ros.engine.lasting_contact.stepping import parts_of
from rigid_sim_ros.engine.solvers.accelerated import accelerated

ITERATIONS = 60
"""Of the solver in a step, at most; what hardly moves needs a few."""

ACCURACY = 1e-5
"""Of what the acceleration scale does to velocities in a step: where the solver stops."""

HIT_ITERATIONS = 25
"""Of the solver in a step in which something hits; twice as many leave a third less overlap."""

HIT_ACCURACY = 1e-3
"""Of the speed of what hits: where the solver stops then."""

PUSH_ITERATIONS = 15
"""Of the solver to push overlaps out, at most; the rest is left to the next time."""

OVERLAP = 3e-4
"""Of the length scale: overlap that is left; it keeps contacts closed."""

TESTED_STEPS = 12
"""Of so many steps one begins with a test of who rests."""

_NEVER = 1e9
"""What is asked for of points that are not there."""

_PRESSED = 1e-50
"""Normal force that is none: the solver never lets it be zero."""


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
        for pile in older:
            self.quiet.take_over(pile.quiet)
            self.steps = max(self.steps, pile.steps)
            self._vector = pile.vector_for(island.members, self._vector)
        self.contacts = None
        """The `PileContacts` in use."""
        self._forces = None
        self._way = None
        """(p,) [m]: how far points of each pair may have passed each other since then."""

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
        resting = np.zeros(island.member_count, dtype=bool)
        if self.steps % TESTED_STEPS == 0:
            resting, contacts = resting_members(
                island, self.quiet, motion, free, scales, start, 2 * OVERLAP * scales.length)
            if resting.all():
                island.scatter(motion.stopped(), state)
                return contacts, resting
        self.steps += 1
        parts = parts_of(island, free, motion, duration)
        for part in range(parts):
            motion, closed = self._step(
                motion, free, scales, start + part * duration / parts, duration / parts)
        island.scatter(motion.stopped(resting), state)
        return closed, resting

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

    def _renew(self, motion, free, scales, closing, duration):
        """Find the contacts of a `Motion` and return it with overlaps pushed out."""
        island = self._island
        vector = self._vector
        if self.contacts is not None:
            self._sources = [self.impulses()]
            vector = self.contacts.vector
        self._way = np.zeros_like(closing)
        found, arms = contacts_of_step(island, motion, free, scales, closing, duration)
        self.contacts = contacts = PileContacts(
            island.bodies, found, arms, motion.orientation, vector)
        self._forces = contacts.row_forces(self._remembered(found, MATCH * scales.length))
        allowed = OVERLAP * scales.length
        if (contacts.gap < -3 * allowed).any():
            motion = self._pushed_out(motion, allowed)
        return motion

    def _remembered(self, found, reach):
        """Return impulses (3, k) in contact axes to start from."""
        columns, count = self._island.columns, self._island.world.bodies.count
        keys = columns[found.body_a] * count + columns[found.body_b]
        world = np.zeros((3, found.count))
        for source in self._sources:
            if len(source[0]):
                world += Impulses(*source).at(keys, found.point, reach)
        axes = self.contacts.axes
        return axes[:, 0] * world[0] + axes[:, 1] * world[1] + axes[:, 2] * world[2]

    def _pushed_out(self, motion, allowed):
        """Return the motion with overlaps of more than `allowed` [m] undone, nearly."""
        contacts = self.contacts
        rows = np.zeros((3, len(contacts.gap)))
        rows[0] = contacts.gap + allowed
        force, _, _ = accelerated(
            contacts.rows.response, contacts.step, contacts.without_friction(),
            contacts.row_motion(rows, _NEVER), np.zeros(3 * contacts.rows.count), 0.3 * allowed,
            PUSH_ITERATIONS)
        contacts.gap = contacts.gap + contacts.motion(contacts.rows.response(force))[0]
        moved = contacts.velocities(contacts.rows.momentum(force))
        return motion.moved(np.arange(self._island.member_count), *moved)

    def _step(self, motion, free, scales, start, duration):
        """Return (motion, closed contacts) after a step of `duration` [s]."""
        island = self._island
        closing = duration * island.closing(motion)
        if self.contacts is None or (self._way > KEPT_WAY * scales.length).any():
            motion = self._renew(motion, free, scales, closing, duration)
        self._way += closing
        contacts = self.contacts
        rows = contacts.rows
        kicked = free.kicked(motion, duration)
        speed = contacts.motion(rows.motion(contacts.scaled(motion)))[0]
        limit = scales.impact_speed(duration)
        hits = (speed < -limit) & (contacts.gap + duration * speed < 0)
        bias = np.zeros((3, len(speed)))
        bias[0] = np.where(hits, contacts.restitution * speed,
                           np.maximum(contacts.gap, 0.0) / duration)
        velocity = contacts.scaled(kicked)
        free_motion = rows.motion(velocity)
        tolerance, iterations = ACCURACY * scales.acceleration * duration, ITERATIONS
        if hits.any():
            tolerance, iterations = HIT_ACCURACY * -float(speed.min()), HIT_ITERATIONS
        self._forces, used, _ = accelerated(
            rows.response, contacts.step, contacts.cones,
            free_motion + contacts.row_motion(bias, _NEVER), self._forces, tolerance, iterations)
        island.world.work.solver_iterations += used
        velocity = dissipating(velocity, rows.momentum(self._forces))
        contacts.gap = contacts.gap + duration * contacts.motion(rows.motion(velocity))[0]
        motion = self._drifted(motion, kicked, velocity, free, duration)
        force = contacts.forces(self._forces)
        closed = force[0] > _PRESSED
        if hits.any():
            self._note(hits & closed, force, -speed, start + duration)
        return motion, contacts.contacts.select(closed)

    def _drifted(self, motion, kicked, scaled, free, duration):
        """Return the motion after a step at the velocities that are given scaled."""
        count = self._island.member_count
        linear, angular = kicked.linear.copy(), kicked.angular.copy()
        linear[:, :count], angular[:, :count] = self.contacts.velocities(scaled)
        struck = Motion(motion.position, motion.orientation, linear, angular)
        turn = rotation.from_rotation_vector(duration * angular)
        orientation = rotation.normalize(rotation.multiply(turn, motion.orientation))
        return Motion(motion.position + duration * linear, orientation, linear,
                      free.carried(motion, kicked, struck, orientation, duration))

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


def dissipating(velocity, change):
    """
    Return scaled velocities after contact impulses, which never add energy.

    Impulses that have not converged may: then only so much of the change is made that the energy
    stays. Momenta are kept either way.
    """
    along, size = velocity @ change, change @ change
    if 2.0 * along + size <= 0.0 or size == 0.0:
        return velocity + change
    return velocity + max(0.0, -2.0 * along / size) * change
