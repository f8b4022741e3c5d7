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
"""Which contacts a pile needs to know for a step, and what it runs into in one."""

from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.contacts import Contacts

FAST = 0.005
"""Of the length scale: a way in one step beyond which other features may meet than were near."""

KEPT_WAY = 0.02
"""
Of the length scale: the way points of a pair may pass each other on before contacts are found
anew. Further on others meet than are known, and gaps are followed to first order only.
"""


class Found(NamedTuple):
    """Contacts of a pile for a step; points of a pair are next to each other."""

    contacts: Contacts
    """In columns of the island; the separations are those at the start of the step."""

    arms: np.ndarray
    """(2, 3, k) [m]: from the centres of their bodies."""

    late: np.ndarray
    """(k,) bool: known from the end of the step, where they are not to overlap."""

    @classmethod
    def at(cls, contacts, motion):
        """Return what is found at the poses of a `Motion`."""
        arms = np.stack([contacts.point - motion.position[:, body]
                         for body in (contacts.body_a, contacts.body_b)])
        return cls(contacts, arms, np.zeros(contacts.count, dtype=bool))

    def carried(self, start, end):
        """
        Return the same contacts where they are when bodies have moved from a `Motion` to another.

        That is halfway between where the two bodies carry them, or where the one does that moves.
        """
        a, b = self.contacts.body_a, self.contacts.body_b
        turn = rotation.multiply(end.orientation, rotation.conjugate(start.orientation))
        points = [end.position[:, body] + rotation.rotate(turn[:, body], arm)
                  for body, arm in zip((a, b), self.arms)]
        moves = np.any(end.position != start.position, axis=0)
        share = np.where(moves[a] == moves[b], 0.5, moves[b])
        point = points[0] + share * (points[1] - points[0])
        arms = np.stack((point - end.position[:, a], point - end.position[:, b]))
        return Found(self.contacts, arms, self.late)

    def keys(self):
        """Return a number for each contact's pair, (k,) int."""
        return self.contacts.body_a * (1 << 24) + self.contacts.body_b

    def select(self, which):
        """Return those of a mask or of indices (l,)."""
        return Found(self.contacts.select(which), self.arms[:, :, which], self.late[which])

    def and_late(self, others):
        """Return (these and others, the order (l,) int in which they come); pairs together."""
        keys = np.concatenate((self.keys(), others.keys()))
        order = np.argsort(keys, kind='stable')
        joined = Found(Contacts.join([self.contacts, others.contacts]),
                       np.concatenate((self.arms, others.arms), axis=2),
                       np.concatenate((self.late, others.late)))
        return joined.select(order), order


def run_into(found, gap, ahead, end, duration, allowed):
    """
    Return the contacts, `late`, of pairs that overlap at the end of a step, or None if none does.

    Parameters
    ----------
    found, ahead : Found
        At the start of the step, and at its end.
    gap : (k,) [m]
        At the start, of those found then.
    end : Motion
        At whose velocities the bodies have moved.
    duration : float
        [s]
    allowed : float
        Overlap [m] that does not count; nor does what there was at the start.

    """
    pairs, of_row = np.unique(ahead.keys(), return_inverse=True)
    before = np.full(len(pairs), -allowed)
    keys = found.keys()
    known = np.isin(keys, pairs) & ~found.late
    np.minimum.at(before, np.searchsorted(pairs, keys[known]), gap[known])
    overlap = np.zeros(len(pairs), dtype=bool)
    deeper = ahead.contacts.separation - before[of_row]
    overlap[of_row[deeper < -allowed]] = True
    if not overlap.any():
        return None
    late = ahead.select(overlap[of_row])
    contacts = late.contacts
    late.arms[:] += _common_arms(contacts, end, duration)
    # as deep as it was at the start it may stay
    contacts.separation -= np.minimum(before[of_row[overlap[of_row]]] + allowed, 0.0)
    contacts.separation -= duration * rotation.dot(contacts.normal, _across(late, end))
    return Found(contacts, late.arms, np.ones(contacts.count, dtype=bool))


def _common_arms(contacts, end, duration):
    """
    Return what to add to the arms (2, 3, k) [m] from the centres at the end of a step.

    Then they come from the centres at its start to one point of both bodies, halfway between those
    that come to be the contact: equal and opposite forces there keep the angular momentum.
    """
    a, b = contacts.body_a, contacts.body_b
    moves = np.any(end.linear != 0.0, axis=0)
    apart = 0.5 * duration * (end.linear[:, b] - end.linear[:, a]) * (moves[a] & moves[b])
    return np.stack((-apart, apart))


def _across(found, motion):
    """Return the velocities (3, k) [m/s] of b minus a at the ends of arms."""
    bodies = found.contacts.body_a, found.contacts.body_b
    a, b = (motion.linear[:, body] + rotation.cross(motion.angular[:, body], arm)
            for body, arm in zip(bodies, found.arms))
    return b - a
