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
Islands that hang together loosely: something is so fast that it may meet others within a step.

Nobody knows which way it goes on after an impact, so whatever it may come to in a step is one
island with it, and what is thinnest in there tells how short the parts of a step must be. Such an
island is taken through a step in parts as long as its members stay clear of each other, in which
those who cannot meet are stepped by themselves and one does not pay for another.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts
from rigid_sim_ros.engine.graph import alike, component_labels
from rigid_sim_ros.engine.lasting_contact.stepping import MOST_PARTS, parts_of_pairs
from rigid_sim_ros.engine.reach import REACH_FACTOR

HURRY = 4.0
"""Parts that a step must need at least for it to be worth while to look who is clear of whom."""

STRETCH = 16
"""Of such parts: after so many those who are not clear are looked at again, then twice as many."""


class Stretch(NamedTuple):
    """Who stays clear of whom, and for how long."""

    duration: float
    """[s]."""

    groups: list
    """Of (places of members (k,), pairs (q,) int): what is stepped by itself."""


def is_loose(island, state, duration):
    """Return whether members may pass others so fast that a step [s] is to be divided."""
    thinnest = island.thickness.min(initial=np.inf)
    if thinnest == np.inf:
        return False
    members, bodies = island.members, island.bodies
    # a bound in a few sums first: most islands are slow
    speed = (np.abs(state.linear_velocity[:, members]).max()
             + bodies.turning_radius.max() * np.abs(state.angular_velocity[:, members]).max()
             + duration * bodies.inverse_mass.max() * np.abs(state.force[:, members]).max()
             + duration * np.abs(island.world.gravity).max())
    if 4 * duration * speed <= HURRY * thinnest:
        return False
    return bool(parts_of_pairs(island, island.free_motion(state), island.gather(state),
                               duration).max() > HURRY)


def advance_loose(island, state, start, duration, advance):
    """
    Advance an `Island` by `duration` [s] from `start` [s] in stretches, and return who and what.

    `advance(island, state, start, duration)` advances one group of it and returns (closed
    contacts in its columns, which of its members rest, bool). So does this.
    """
    left, resting = duration, np.zeros(island.member_count, dtype=bool)
    while left > 0.0:
        stretch = _next_stretch(island, state, duration, left)
        time, contacts = start + duration - left, []
        for members, pairs in stretch.groups:
            group = island.part(members, pairs)
            found, resting[members] = advance(group, state, time, stretch.duration)
            contacts.append(_in_columns(found, group, island))
        left -= stretch.duration
    return Contacts.join(contacts), resting


def _next_stretch(island, state, duration, left):
    """Return the `Stretch` that is next, of what is left [s] of a duration [s]."""
    free, motion = island.free_motion(state), island.gather(state)
    count, a, b = island.member_count, island.pairs.pairs_a, island.pairs.pairs_b
    parts = np.maximum(parts_of_pairs(island, free, motion, left), 1e-300)
    part = np.maximum(left / parts, duration / MOST_PARTS)
    gap = island.pairs.separations(motion.position, motion.orientation)
    speed, pull = island.speeds(free, motion)
    # a plane, which nothing can pass, is no reason to divide a step
    bound = np.isinf(part) | (_meeting_times(gap, a, b, speed, pull) <= HURRY * part)
    both = (a < count) & (b < count)
    labels = component_labels(len(island.columns), a[bound & both], b[bound & both])
    # who is in a group may be hit by the fastest of it
    np.maximum.at(speed, labels, speed.copy())
    np.maximum.at(pull, labels, pull.copy())
    kept = bound | (both & (labels[a] == labels[b]))
    clear = _meeting_times(gap, a, b, speed[labels], pull[labels])[~kept].min(initial=np.inf)
    if clear < HURRY * part.min():
        kept[:], labels[:], clear = True, 0, np.inf
    looked = max(STRETCH * part[kept].min(initial=np.inf), duration - left)
    return Stretch(float(min(left, looked, clear)), _groups(count, labels, a, b, kept))


def _groups(count, labels, a, b, kept):
    """Return the `Stretch.groups` of nodes with these labels, of which `count` are members."""
    of_pair = np.where(a < count, labels[a], labels[b])
    return [(members, np.flatnonzero(kept & (of_pair == label)))
            for label, members in alike(labels[:count])]


def _meeting_times(gap, a, b, speed, pull):
    """Return before when, (p,) [s], pairs with a gap [m] do not meet at up to these speeds."""
    speed = REACH_FACTOR * (speed[a] + speed[b])
    pull = REACH_FACTOR * (pull[a] + pull[b])
    gap = np.maximum(gap, 0.0)
    slower = speed + np.sqrt(speed * speed + 4 * pull * gap)
    return 2 * gap / np.maximum(slower, 1e-300)


def _in_columns(contacts, group, island):
    """Return `Contacts` of one island as those of another with all of its columns."""
    places = np.zeros(island.world.bodies.count, dtype=int)
    places[island.columns] = np.arange(len(island.columns))
    places = places[group.columns]
    return replace(contacts, body_a=places[contacts.body_a], body_b=places[contacts.body_b])
