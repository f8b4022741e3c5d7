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

"""Which members of a pile rest: groups that touch each other, by themselves."""

import numpy as np

from rigid_sim_ros.engine.graph import alike, component_labels
from rigid_sim_ros.engine.lasting_contact.pile.lone_members import lone_members, standing
from rigid_sim_ros.engine.lasting_contact.rest import slow, stands
from rigid_sim_ros.engine.lasting_contact.scales import REST

QUIET_TIME = 0.25
"""Time [s] all bodies must have been where they are to rest, times the root of their length."""

QUIET_WAY = 2e-3
"""Of the length scale: moves that do not count."""


def resting_members(island, quiet_bodies, motion, free, scales, time, gap):
    """
    Return (the group of each member that rests (m,) int or -1, contacts closed in a `Motion`).

    A group of members that touch rests if all of them are slow and held by their contacts, or if
    none of them has moved for a while, as `Quiet` knows. Contacts below a gap [m] are closed.
    """
    count = island.member_count
    radius = island.bodies.bounding_radius[:count]
    still = quiet_bodies.durations(time, motion, radius, QUIET_WAY * scales.length)
    quiet = still > QUIET_TIME * scales.length ** 0.5
    calm = quiet | slow(island, scales, motion)
    contacts = island.find_contacts(motion, gap)
    resting = np.full(count, -1)
    if not calm.any():
        return resting, contacts
    a, b = contacts.body_a, contacts.body_b
    both = (a < count) & (b < count)
    labels = component_labels(count, a[both], b[both])
    of_contact = labels[np.where(a < count, a, b)]
    moved = np.zeros(count, dtype=bool)
    np.logical_or.at(moved, labels, ~calm)
    for members, places in lone_members(labels, of_contact, calm):
        held = standing(island, free, scales, motion, contacts.select(places.ravel()), members)
        resting[members[held]] = members[held]
    contacts_of = dict(alike(of_contact))
    for label, members in alike(labels):
        if resting[members[0]] >= 0 or moved[label] or label not in contacts_of:
            continue
        if quiet[members].all() or stands(
                island, free, scales, motion, contacts.select(contacts_of[label]), members):
            resting[members] = label
    return resting, contacts


def undisturbed(island, scales, before, after, groups):
    """
    Return which members (m,) bool rest on after a step from one `Motion` to another.

    That is of those in groups (m,) int, not -1, that nobody has hit in it.
    """
    limit = REST * scales.speed
    radius = island.bodies.bounding_radius[:island.member_count]
    faster = _speed(after, radius) > _speed(before, radius) + limit
    return (groups >= 0) & ~np.isin(groups, groups[faster])


def _speed(motion, radius):
    """Return the speeds (m,) [m/s] of the first bodies, turning counted at radii (m,) [m]."""
    linear, angular = motion.linear[:, :len(radius)], motion.angular[:, :len(radius)]
    return np.abs(linear).max(axis=0) + radius * np.abs(angular).max(axis=0)
