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
Bodies in lasting contact: who is, who may join, their steps, their sleep and their waking.

An island is a set of moving bodies that touch, or may within a few steps. Each is stepped by
itself, so that none pays for another. Fixed bodies, planes and sleeping bodies are what islands
may lie on.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine.broad_phase import candidate_pairs
from rigid_sim_ros.engine.columns import columns_of
from rigid_sim_ros.engine.graph import component_labels
from rigid_sim_ros.engine.lasting_contact import advance_island, Bearing, FEW, Island
from rigid_sim_ros.engine.narrow_phase import separations
from rigid_sim_ros.engine.reach import passed_on, Reach, REACH_FACTOR, within

SPARE_STEPS = 4
"""Pairs are looked for that may meet in so many steps: till one does, islands stay as they are."""

SKIN = 0.05
"""
Pairs of slow bodies are looked for this part of the smallest body further around, and kept until
somebody has moved so far: what rests need not look again.
"""

SKIN_STEPS = 8
"""Bodies are slow if the skin lasts for at least so many steps."""

CROWD = 24
"""Bodies in lasting contact above which all of them are one pile."""

CLOSED = 1e-6
"""Bodies nearer than this part of the smaller one touch, if nobody moves."""


class Changes(NamedTuple):
    """Whose regime a step has changed."""

    parting: np.ndarray
    """(k,) int: touch nothing any more, nor will soon."""

    resting: np.ndarray
    """(k,) int: have come to rest, and sleep."""


class Islands:
    """The moving bodies in lasting contact, awake (`touching`) or not (`asleep`)."""

    def __init__(self, world, flights):
        self._world = world
        self._flights = flights
        count = world.bodies.moving_count
        self.active = False
        """Whether any body is in lasting contact and awake."""
        self.touching = np.zeros(count, dtype=bool)
        self.asleep = np.zeros(count, dtype=bool)
        self._mates = np.full(count, -1)
        """(n,): bodies asleep under the same number wake together; -1 of those awake."""
        self._bearings = {}
        """What holds those asleep, by that number."""
        self._islands = []
        self._members = np.zeros(0, dtype=int)
        """(k,): the bodies in these islands."""
        self._spare = 0.0
        """How far they may still come nearer to anything [m] before islands are made again."""
        self._pairs = world.lasting_pairs
        self._reach = Reach(world.bodies, flights)

    def step_end(self, time, end):
        """Return how far to go at once [s], at most to `end`: steps are equal and short enough."""
        steps = np.ceil((end - time) / self._world.max_step * (1 - 1e-9))
        return end if steps <= 1 else time + (end - time) / steps

    def add(self, indices):
        """From now on these bodies (k,) are in lasting contact."""
        if not len(indices):
            return
        if self._spare < inf and not self.touching[indices].all():
            # who comes back from flight may have come anywhere
            self._spare = -inf
        self.touching[indices] = self.active = True

    def wake(self, indices):
        """
        Wake those of bodies (k,) that sleep and all their mates; return who woke (m,).

        Something has happened to all of them: that they have not moved so far says nothing.
        """
        woken = indices[:0]
        if not len(indices):
            return woken
        if self.asleep[indices].any():
            woken = np.flatnonzero(self.asleep & np.isin(self._mates, self._mates[indices]))
            self.asleep[woken] = False
            for number in {*self._mates[woken].tolist()}:
                del self._bearings[number]
            self._mates[woken] = -1
            self.add(woken)
        disturbed = np.concatenate((indices, woken))
        for island in self._islands:
            island.disturb(disturbed)
        return woken

    def bear(self, indices, state):
        """
        Return which of bodies (k,) sleep on under the forces of a `State`, (k,) bool.

        Who is awake does not. If there are very many, nobody is asked.
        """
        mates = self._mates[indices].tolist()
        numbers = self._bearings.keys() & mates
        if len(numbers) > CROWD:
            return np.zeros(len(indices), dtype=bool)
        held = {number for number in numbers if self._bearings[number].holds(state)}
        return np.array([number in held for number in mates], dtype=bool)

    def displace(self):
        """Note that bodies have been put elsewhere: pairs are to be looked for again."""
        self._spare = -inf
        for island in self._islands:
            island.displace()

    def reached(self, start, end, state, deflected):
        """
        Return who may be touched by `end` [s] and is not in lasting contact yet.

        Bodies in flight (k,) that may meet a touching one, and sleeping bodies (m,) that one
        leans on or comes upon. `state` is that of all bodies at `start`. Of bodies `deflected`
        (d,), which may hit something else before, nobody knows in what direction they go on.
        """
        nobody = np.zeros(0, dtype=int)
        if self.touching.all():
            return nobody, nobody
        bodies = self._world.bodies
        reach = self._reach.until(state, start, end)
        reach[deflected] = REACH_FACTOR * reach.max()
        a, b = candidate_pairs(bodies, state.position, 2 * reach.max())
        both = b < bodies.moving_count
        a, b = a[both], b[both]
        mixed = self.touching[a] != self.touching[b]
        a, b = within(bodies, state.position, a[mixed], b[mixed], reach)
        if not a.size:
            return nobody, nobody
        gap = separations(bodies, a, b, state.position, state.orientation)
        near = gap < reach[a] + reach[b] + CLOSED * bodies.bounding_radius[a]
        there = np.where(self.touching[a], b, a)[near]
        sleeps = self.asleep[there]
        return np.unique(there[~sleeps]), np.unique(there[sleeps])

    def advance(self, members, start, end, state):
        """
        Step these bodies (k,) from `start` to `end` [s], island by island; return `Changes`.

        `state` is that of all bodies at `start`; its columns of `members` are replaced.
        """
        parting, resting = [], []
        islands = self._current(members, start, end, state)
        if self._spare < inf:
            columns = columns_of(members)
            before = state.position[:, columns], state.orientation[:, columns]
        for island in islands:
            outcome = advance_island(island, state, start, end - start)
            self._pairs.update(end, island, outcome.contacts)
            if outcome.resting.any():
                resting.append(island.members[outcome.resting])
                self._lay_down(island, outcome)
            if not outcome.touching.all():
                parting.append(_alone(island, outcome.touching | outcome.resting))
        if self._spare < inf:
            self._spare -= 2 * self._reach.way(members, *before, state)
        if not parting and not resting:
            return Changes(members[:0], members[:0])
        changes = Changes(np.concatenate((members[:0], *parting)),
                          np.concatenate((members[:0], *resting)))
        self.touching[changes.parting] = self.touching[changes.resting] = False
        self.asleep[changes.resting] = True
        self.active = bool(self.touching.any())
        return changes

    def _lay_down(self, island, outcome):
        """Note who of an island sleeps on whom after an `Outcome`."""
        places = np.flatnonzero(outcome.resting)
        labels = _groups(island, outcome.contacts)[places]
        numbers = island.members[labels]
        self._mates[island.members[places]] = numbers
        for number in {*numbers.tolist()}:
            self._bearings[number] = Bearing(
                island, places[numbers == number], outcome.contacts)

    def _current(self, members, start, end, state):
        """Return the islands of these bodies (k,), made again if they may not be complete."""
        same = np.array_equal(members, self._members)
        if same and self._spare == inf:
            return self._islands
        motion = 2 * self._reach.most(members, state, start, end)
        if self._spare < motion or not same:
            self._members = members
            self._islands, self._spare = self._found(
                members, state, self._reach.until(state, start, end), motion)
            self._pairs.keep(self._islands)
        return self._islands

    def _found(self, members, state, reach, motion):
        """
        Return the islands of bodies (k,), and how far [m] any may move until there are others.

        `reach` (n,) [m] is how far each may come in this step, `motion` [m] the most of two.
        """
        bodies = self._world.bodies
        is_member = np.zeros(bodies.count, dtype=bool)
        is_member[members] = True
        solid = is_member.copy()
        solid[:bodies.moving_count] |= self.asleep
        solid[bodies.moving_count:] = True
        skin = SKIN * bodies.bounding_radius[members].min()
        skin = skin if skin > SKIN_STEPS * motion else 0.0
        crowd = len(members) > CROWD
        margin = skin if crowd else max(skin, SPARE_STEPS * motion)
        a, b = candidate_pairs(bodies, state.position, 2 * reach.max() + margin)
        ours = (is_member[a] | is_member[b]) & solid[a] & solid[b]
        a, b = a[ours], b[ours]
        reach = passed_on(bodies, state.position, a, b, reach)
        a, b = within(bodies, state.position, a, b, reach + 0.5 * margin)
        if crowd:
            return [self._island(members, a, b)], margin
        gap = separations(bodies, a, b, state.position, state.orientation) - reach[a] - reach[b]
        # what touches is hit by whoever hits the other, and reach is passed on but once
        near = gap <= max(skin, CLOSED * bodies.bounding_radius[members].min())
        a, b = a[near], b[near]
        both = is_member[a] & is_member[b]
        labels = _with_the_many(component_labels(bodies.count, a[both], b[both]), members)
        of_pair, of_member = labels[np.where(is_member[a], a, b)], labels[members]
        islands = [self._island(members[of_member == label], a[of_pair == label],
                                b[of_pair == label])
                   for label in sorted({*of_member.tolist()})]
        if len(members) == 1 == len(a) == int(solid.sum()) - 1:
            # there is nobody else to come near, nor anything to tell apart
            return islands, inf
        return islands, float(gap[~near].min(initial=margin))

    def _island(self, members, body_a, body_b):
        """Return the island there was of these members (m,) and pairs (p,), or a new one."""
        for island in self._islands:
            if (np.array_equal(island.members, members) and island.covers(body_a, body_b)
                    and self.asleep[island.others(self._world.bodies.moving_count)].all()):
                return island
        return Island(self._world, members, body_a, body_b, self._islands)


def _with_the_many(labels, members):
    """
    Return the labels (n,) with those of all groups of several members made one, if they are many.

    One pile of all of them costs less than as many islands of few.
    """
    sizes = np.bincount(labels[members], minlength=len(labels))
    if sizes[sizes > 1].sum() <= FEW:
        return labels
    several = sizes[labels] > 1
    return np.where(several, labels[several][0], labels)


def _groups(island, contacts):
    """Return the first of the members (m,) each member touches, by way of any."""
    count = island.member_count
    a, b = contacts.body_a, contacts.body_b
    both = (a < count) & (b < count)
    return component_labels(count, a[both], b[both])


def _alone(island, touching):
    """Return the members of an island that touch nothing and have no member near, (k,)."""
    count = island.member_count
    a, b = island.pairs.pairs_a, island.pairs.pairs_b
    both = (a < count) & (b < count)
    beside = np.zeros(count, dtype=bool)
    beside[a[both]] = beside[b[both]] = True
    return island.members[~touching & ~beside]
