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
What groups of a pile have gained in a step by how their bodies turn is taken out of their motion.

A step balances energy with the moments of inertia as they are at its start (see `energy`). Boxes
that turn on the way end with others, and with what is more or less energy for it. Less is lost;
more is no good, and goes as `energy_balance` has it.
"""

import numpy as np

from rigid_sim_ros.engine.lasting_contact.energy_balance import Group, slowed

_ROUNDING = 1e-12
"""Of the energy of motion and of a fall by the length scale: a gain that is none."""


def without_gain(bodies, free, motion, gained, contacts, pressing, scales):
    """
    Return the motion at the end of a step without what groups of members gained in it.

    Parameters
    ----------
    bodies : Bodies
        The island's own.
    free : FreeMotion
        Of all its columns.
    motion : Motion
        At the end of the step.
    gained : (n,) [J]
        By each body, beyond the work of held forces.
    contacts : PileContacts
        In use in the step.
    pressing : (k,) bool
        Which contacts press.
    scales : Scales
        Of the island.

    """
    count = bodies.moving_count
    groups = contacts.body_groups[:count]
    fall = free.mass[:count] * scales.acceleration * scales.length
    gain, there = (np.bincount(groups, each, contacts.group_count + 1)[:-1] for each in (
        gained[:count], free.kinetic_energy(motion)[:count] + fall))
    for number in np.flatnonzero(gain > _ROUNDING * there):
        group = _group(bodies, contacts, number, pressing & (contacts.groups == number))
        motion, _ = slowed(free, motion, group, float(gain[number]))
    return motion


def _group(bodies, contacts, number, pressing):
    """Return the `Group` of that number, with those of its contacts (k,) bool that press."""
    members = np.flatnonzero(contacts.body_groups[:bodies.moving_count] == number)
    found = contacts.contacts
    fixed = pressing & (np.maximum(found.body_a, found.body_b) >= bodies.moving_count)
    rough = (bodies.friction[found.body_a[fixed]] > 0) & (bodies.friction[found.body_b[fixed]] > 0)
    return Group(members, bool(rough.any()), found.normal[:, fixed], np.inf)
