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

"""Which contacts a pile needs to know for a step."""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.contacts import Contacts

FAST = 0.005
"""Of the length scale: a way in one step beyond which other features may meet than are near."""

KEPT_WAY = 0.02
"""
Of the length scale: the way points of a pair may pass each other on before contacts are found
anew. Further on others meet than are known, and gaps are followed to first order only.
"""


def contacts_of_step(island, motion, free, scales, closing, duration):
    """
    Return the contacts near a `Motion`, points of a pair together, and their arms (2, 3, k) [m].

    Where it is fast they are looked for, besides, where the bodies would be after the step without
    contact: what would overlap then meets in it, and is often not what is near now. `closing` (p,)
    [m] bounds how far points of each pair pass each other in the step.
    """
    way = KEPT_WAY * scales.length
    found = island.find_contacts(motion, way + 2 * closing)
    arms = _arms(found, motion)
    fast = closing > FAST * scales.length
    if not fast.any():
        return found, arms
    kicked = free.kicked(motion, duration)
    ahead = kicked.moved(slice(None), duration * kicked.linear, duration * kicked.angular)
    later = island.find_contacts(ahead, np.where(fast, way, -np.inf))
    later_arms = _arms(later, ahead)
    # the gaps of now, as far as they change at the rates of then
    later.separation -= duration * rotation.dot(later.normal, _across(
        later, kicked, later_arms))
    joined = Contacts.join([found, later])
    order = np.argsort(joined.body_a * island.bodies.count + joined.body_b, kind='stable')
    return joined.select(order), np.concatenate((arms, later_arms), axis=2)[:, :, order]


def _arms(contacts, motion):
    """Return the arms (2, 3, k) [m] of contacts from the centres of their bodies."""
    return np.stack([contacts.point - motion.position[:, body]
                     for body in (contacts.body_a, contacts.body_b)])


def _across(contacts, motion, arms):
    """Return the velocities (3, k) [m/s] of b minus a at the ends of arms."""
    velocity = [motion.linear[:, body] + rotation.cross(motion.angular[:, body], arm)
                for body, arm in zip((contacts.body_a, contacts.body_b), arms)]
    return velocity[1] - velocity[0]
