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

"""Islands stepped through time: steps cut where something hits, until bodies part or rest."""

from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts
from rigid_sim_ros.engine.lasting_contact import cut, scales as units
from rigid_sim_ros.engine.lasting_contact.automaton import OnPlane, plane_of
from rigid_sim_ros.engine.lasting_contact.pile import Pile
from rigid_sim_ros.engine.lasting_contact.rest import at_rest
from rigid_sim_ros.engine.lasting_contact.step import first_half, Limits, push_out, second_half

FEW = 3
"""Bodies that are stepped to second order; more are a pile."""

_SHORTEST = 1e-9
"""Part of a step that is not worth taking: bounds on velocities divide by it."""

_MOST_PARTS = 1000


class Outcome(NamedTuple):
    """How an island is after it has been advanced."""

    resting: bool
    """All of it is at rest and in equilibrium; its velocities have been set to zero."""

    touching: np.ndarray
    """(m,) bool: which members touch anything; those that do not are in flight."""

    contacts: Contacts
    """The closed contacts, in columns of the island."""


def advance_island(island, state, start, duration):
    """
    Advance an `Island` by `duration` [s] from time `start` [s] and return its `Outcome`.

    The members' columns of `state` (a `State` of the whole scene) are replaced. Impacts are noted
    in the world's log, at their instants. One body on one plane moves as a hybrid automaton, of
    high order (see `automaton`). For all else the duration is one step, or equal parts if
    something is so fast that it could pass through something thin.
    """
    found = None
    if island.member_count == 1:
        found = _on_plane(island, state, start, duration)
    elif island.member_count > FEW:
        found = _piled(island, state, start, duration)
    if found is None:
        found = _stepped(island, state, start, duration)
    touching, resting = found
    touched = np.zeros(island.bodies.count, dtype=bool)
    touched[touching.body_a] = touched[touching.body_b] = True
    return Outcome(resting, touched[:island.member_count], touching)


def _on_plane(island, state, start, duration):
    """Return (closed contacts, resting) of one body on one plane, or None."""
    pair = plane_of(island, state, duration)
    if pair is None:
        return None
    if pair not in island.automata:
        island.automata[pair] = OnPlane(island, pair)
    island.world.work.contact_steps += 1
    return island.automata[pair].advance(state, start, duration)


def _piled(island, state, start, duration):
    """Return (closed contacts, resting) of many bodies after a step."""
    if island.pile is None:
        island.pile = Pile(island, island.older_piles)
        island.older_piles = ()
    island.world.work.contact_steps += 1
    return island.pile.advance(state, start, duration)


def _stepped(island, state, start, duration):
    """Return (closed contacts, resting) after steps."""
    free = island.free_motion(state)
    scales = island.scales(free)
    motion = island.gather(state)
    parts = _parts(island, free, motion, duration)
    step = duration / parts
    limits = Limits.of(scales, step)
    if island.end is not None and parts == 1 and motion.same(island.end[0]):
        contacts = island.end[1]
    else:
        contacts = island.find_contacts(motion, limits.margin(step))
    for part in range(parts):
        motion, contacts = _advance(island, free, scales, limits, motion, contacts,
                                    start + part * step, step)
        island.world.work.contact_steps += 1
    touching = contacts.select(np.flatnonzero(contacts.separation < limits.touch_gap))
    resting = at_rest(island, free, scales, motion, touching)
    motion = motion.stopped() if resting else motion
    island.end = motion, contacts
    island.scatter(motion, state)
    return touching, resting


def _advance(island, free, scales, limits, motion, contacts, time, step):
    """Return (motion, contacts near it) after a step [s], cut where something hits."""
    overlap = units.OVERLAP * scales.length
    margin = limits.margin(step)
    if cut.impacts_in(motion, contacts, overlap, limits.impact_speed).count:
        motion = cut.resolve(island, motion, contacts, scales, limits, time, rebounds=True)
    left = step
    for number in range(2 * units.MAX_CUTS):
        end = first_half(island, free, motion, contacts, left, limits)
        end_contacts = island.find_contacts(end, margin)
        hits = cut.impacts_in(end, end_contacts, -overlap, 0.5 * limits.impact_speed)
        if not hits.count:
            break

        def trial(part, start=motion, near=contacts):
            if part <= _SHORTEST * step:
                return start
            return first_half(island, free, start, near, part, limits)

        gap = cut.gap_function(island, hits, end, left, 0.5 * limits.impact_speed)
        part, motion = cut.time_of_impact(trial, gap, left, scales.length)
        contacts = island.find_contacts(motion, margin)
        left -= part
        motion = cut.resolve(island, motion, contacts, scales, limits, time + step - left,
                             rebounds=number < units.MAX_CUTS)
        if left <= _SHORTEST * step:
            end, end_contacts = motion, contacts
            break
    end, end_contacts = _separated(island, end, end_contacts, overlap, margin)
    closed = end_contacts.select(np.flatnonzero(end_contacts.separation < limits.touch_gap))
    if closed.count:
        # what arrives fast just now is an impact, the first thing in the next step
        closed = closed.select(~cut.fast(end, closed, limits.impact_speed))
    return second_half(island, end, closed), end_contacts


def _separated(island, motion, contacts, overlap, margin):
    """Return (motion, contacts near it) with overlaps pushed out, which is hardly ever needed."""
    if not (contacts.separation < -overlap).any():
        return motion, contacts
    motion = push_out(island, motion, contacts)
    return motion, island.find_contacts(motion, margin)


def _parts(island, free, motion, duration):
    """Return how many parts a step needs so that nothing passes half of what is thinnest."""
    extents = island.bodies.half_extents
    # nothing passes through a plane unseen: it has no other side
    thickness = np.where(extents.any(axis=0), extents.min(axis=0), np.inf)
    reach = island.reach(free, motion, duration)
    a, b = island.pairs.pairs_a, island.pairs.pairs_b
    needed = (reach[a] + reach[b]) / np.minimum(thickness[a], thickness[b])
    return int(min(max(1.0, np.ceil(needed.max(initial=0.0))), _MOST_PARTS))
