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
from rigid_sim_ros.engine.lasting_contact.automaton import OnPlane, plane_of
from rigid_sim_ros.engine.lasting_contact.loose import advance_loose, is_loose
from rigid_sim_ros.engine.lasting_contact.pile import Pile
from rigid_sim_ros.engine.lasting_contact.stepping import advance_in_steps

FEW = 6
"""Bodies that are stepped to second order; more are a pile."""


class Outcome(NamedTuple):
    """How an island is after it has been advanced."""

    resting: np.ndarray
    """(m,) bool: which members are at rest, with all they touch; they have no velocity left."""

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
    something is so fast that it could pass through something thin; what is clear of that is
    stepped by itself (see `loose`).
    """
    if is_loose(island, state, duration):
        touching, resting = advance_loose(island, state, start, duration, _advance)
    else:
        touching, resting = _advance(island, state, start, duration)
    touched = np.zeros(island.bodies.count, dtype=bool)
    touched[touching.body_a] = touched[touching.body_b] = True
    return Outcome(np.full(island.member_count, resting), touched[:island.member_count],
                   touching)


def _advance(island, state, start, duration):
    """Return (closed contacts, which rest, bool) after a step of an island as one [s]."""
    found = None
    if island.member_count == 1:
        found = _on_plane(island, state, start, duration)
    elif island.member_count > FEW:
        found = _piled(island, state, start, duration)
    return found or advance_in_steps(island, state, start, duration)


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
