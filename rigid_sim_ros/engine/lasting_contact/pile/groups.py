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

from rigid_sim_ros.engine.graph import component_labels
from rigid_sim_ros.engine.lasting_contact.rest import slow, stands

QUIET_TIME = 0.25
"""Time [s] all bodies must have been where they are to rest, times the root of their length."""

QUIET_WAY = 2e-3
"""Of the length scale: moves that do not count."""


def resting_members(island, quiet_bodies, motion, free, scales, time, gap):
    """
    Return (which members rest (m,) bool, the contacts that are closed in a `Motion`).

    A group of members that touch rests if all of them are slow and held by their contacts, or if
    none of them has moved for a while, as `Quiet` knows. Contacts below a gap [m] are closed.
    """
    count = island.member_count
    radius = island.bodies.bounding_radius[:count]
    still = quiet_bodies.durations(time, motion, radius, QUIET_WAY * scales.length)
    quiet = still > QUIET_TIME * scales.length ** 0.5
    calm = quiet | slow(island, scales, motion)
    contacts = island.find_contacts(motion, gap)
    resting = np.zeros(count, dtype=bool)
    if not calm.any():
        return resting, contacts
    a, b = contacts.body_a, contacts.body_b
    both = (a < count) & (b < count)
    labels = component_labels(count, a[both], b[both])
    of_contact = labels[np.where(a < count, a, b)]
    moved = np.zeros(count, dtype=bool)
    np.logical_or.at(moved, labels, ~calm)
    touched = np.isin(labels, of_contact)
    for label in np.unique(labels[~moved[labels] & touched]):
        members = labels == label
        resting[members] = quiet[members].all() or stands(
            island, free, scales, motion, contacts.select(of_contact == label), members)
    return resting, contacts
