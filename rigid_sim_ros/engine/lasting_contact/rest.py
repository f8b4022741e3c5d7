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
Whether an island is at rest: slow, and in equilibrium without moving.

Being slow is not enough, for what rocks or tips is slow at its turning point. The static problem
asks what contact forces can hold: forces act for a second on bodies at rest, all contacts are
solved as an impact, and what velocity is left is the acceleration they cannot hold.
"""

import numpy as np

from rigid_sim_ros.engine.friction import mixed_friction
from rigid_sim_ros.engine.lasting_contact import scales as units
from rigid_sim_ros.engine.lasting_contact.step import second_half, STATIC
from rigid_sim_ros.engine.solvers import contact_rows, ContactProblem, solve
from rigid_sim_ros.engine.solvers.sticking import Sticking

MOST_CONTACTS = 200
"""Contacts of which `stands` makes a dense matrix."""

_ACCURACY = 1e-3 * units.EQUILIBRIUM
"""Of what gravity does: many contacts add up to more."""

FEW_CONTACTS = 60
"""Contacts of which it solves the whole contact problem."""


def slow(island, scales, motion):
    """Return which members (m,) bool have no point faster than what counts as rest."""
    count = island.member_count
    radius = island.bodies.bounding_radius[:count]
    limit = units.REST * scales.speed
    return ((np.abs(motion.linear[:, :count]).max(axis=0) <= limit)
            & (np.abs(motion.angular[:, :count]).max(axis=0) * radius <= limit))


class Support:
    """
    What contacts that touch can hold of an island at rest.

    Whatever forces act the equations are the same: asked again it does little but multiply.

    Parameters
    ----------
    island : Island
    motion : Motion
        Its poses; velocities do not count.
    contacts : Contacts
        Those that may hold it, in its columns.

    """

    def __init__(self, island, motion, contacts):
        """See the class."""
        bodies = island.bodies
        self._island, self._motion = island, motion.stopped()
        self._rows = contact_rows(bodies, contacts, motion.position, motion.orientation)
        self._response = self._rows.response()
        self._friction = mixed_friction(
            bodies.friction[contacts.body_a], bodies.friction[contacts.body_b])
        self._sticking = None

    def holds(self, free, scales, members):
        """
        Return whether members (m,) int stay where they are under the forces of a `FreeMotion`.

        Where there are very many contacts that is only looked for with all of them pressing and
        sticking, and otherwise said not to be so.
        """
        pull = free.kicked(self._motion, 1.0)
        count = len(self._friction)
        problem = ContactProblem(
            self._response, self._rows.motion(pull.linear, pull.angular), self._friction,
            np.zeros(count), np.zeros((2, count)))
        if self._sticking is None:
            self._sticking = Sticking(problem)
        force = self._sticking.force(problem, _ACCURACY)
        if force is None and count <= FEW_CONTACTS:
            solution = solve(problem, accuracy=_ACCURACY)
            force = None if solution is None else solution.force
        if force is None:
            return False
        left = pull.struck(self._rows.touched, *self._rows.change(force))
        return bool(_held(self._island, scales, left)[members].all())


def stands(island, free, scales, motion, contacts, members):
    """Return whether touching contacts hold some of an island's members, (m,) int."""
    return 0 < contacts.count <= MOST_CONTACTS and Support(island, motion, contacts).holds(
        free, scales, members)


def at_rest(free, scales, motion, near, touching):
    """Return whether an island rests in a `Motion` on contacts (m,) int of those `Near` it."""
    island = near.island
    if not touching.size or not slow(island, scales, motion).all():
        return False
    return bool(_held(island, scales, second_half(
        free.kicked(motion.stopped(), 1.0), near, touching, 1.0, STATIC)[0]).all())


def _held(island, scales, left):
    """Return which members (m,) hardly move in a `Motion` left by a second of all forces."""
    count = island.member_count
    radius = island.bodies.bounding_radius[:count]
    allowed = units.EQUILIBRIUM * scales.acceleration
    return ((np.abs(left.linear[:, :count]).max(axis=0) <= allowed)
            & (np.abs(left.angular[:, :count]).max(axis=0) * radius <= allowed))
