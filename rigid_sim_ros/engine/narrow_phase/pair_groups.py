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

"""A list of pairs, sorted once by what kinds of shape meet, to be tested at many poses."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts, FACE_A, FACE_B
from rigid_sim_ros.engine.graph import alike
from rigid_sim_ros.engine.narrow_phase.plain_pairs import PLAIN_TESTS, PlainPairs
from rigid_sim_ros.engine.narrow_phase.solids import Solids
from rigid_sim_ros.engine.narrow_phase.table import PairOfShapes, PAIRS

CHUNK = 1024
"""Pairs handled at once: more no longer fit the second-level cache (a third slower, measured)."""

FEW, FEW_DISTANCES = 10, 4
"""Up to so many pairs of a kind plain floats are quicker for contacts, and for distances alone."""

_SWAPPED_FEATURE = np.arange(4)
_SWAPPED_FEATURE[[FACE_A, FACE_B]] = FACE_B, FACE_A


@dataclass
class Group:
    """Pairs of the same kinds: a row of the table and the two sides, in its order."""

    kinds: tuple
    row: PairOfShapes
    swapped: bool
    """Whether the caller's a is the row's b."""

    where: np.ndarray
    """(p,) int: which of the caller's pairs these are."""

    a: Solids
    b: Solids

    @cached_property
    def plain(self):
        """Return the same as `PlainPairs` if they are so few that it saves time, or None."""
        test = PLAIN_TESTS.get(self.kinds)
        if test is None or len(self.where) > FEW or self.swapped:
            return None
        return PlainPairs(test, self.a, self.b)


class PairGroups:
    """
    Pairs of bodies and planes, ready to be tested.

    Parameters
    ----------
    bodies : Bodies
    pairs_a, pairs_b : (p,) int
        Indices of bodies, fixed bodies or planes. A pair of two planes is refused with a
        ValueError.

    """

    def __init__(self, bodies, pairs_a, pairs_b):
        self.pairs_a = np.asarray(pairs_a, dtype=int)
        self.pairs_b = np.asarray(pairs_b, dtype=int)
        self.groups = []
        for kinds, where in _by_kinds(bodies, self.pairs_a, self.pairs_b):
            swapped = kinds not in PAIRS
            kinds = kinds[::-1] if swapped else kinds
            row = PAIRS.get(kinds)
            if row is None:
                raise ValueError(f'{kinds[1]} and {kinds[0]} cannot meet; allowed: {list(PAIRS)}')
            for start in range(0, len(where), CHUNK):
                part = where[start:start + CHUNK]
                a = Solids.gather(bodies, self.pairs_a[part])
                b = Solids.gather(bodies, self.pairs_b[part])
                sides = (b, a) if swapped else (a, b)
                self.groups.append(Group(kinds, row, swapped, part, *sides))

    def find_contacts(self, position, orientation, margin):
        """
        Return all contact points with a separation below `margin`, as `Contacts`.

        The points of a pair are next to each other; pairs come in no particular order.

        Parameters
        ----------
        position : (3, n) [m]
            Of all bodies and planes.
        orientation : (4, n)
            Of the same, x y z w, body to world.
        margin : float or (p,) [m]
            Of all pairs, or of each.

        """
        margin = np.broadcast_to(np.asarray(margin, dtype=float), self.pairs_a.shape)
        parts = []
        for group in self.groups:
            if group.plain is not None:
                parts.append(group.plain.find_contacts(position, orientation,
                                                       margin[group.where]))
                continue
            contacts = group.row.contacts(group.a.placed(position, orientation),
                                          group.b.placed(position, orientation),
                                          margin[group.where])
            parts.append(swap(contacts) if group.swapped else contacts)
        return Contacts.join(parts)

    def separations(self, position, orientation):
        """
        Return the signed distances [m], (p,), at these poses (as in `find_contacts`).

        Apart: a positive lower bound of the distance, exact where a sphere or a plane is involved.
        Overlapping: minus the shortest way out.
        """
        result = np.empty(len(self.pairs_a))
        for group in self.groups:
            if len(group.where) <= FEW_DISTANCES and group.plain is not None:
                result[group.where] = group.plain.separations(position, orientation)
                continue
            result[group.where] = group.row.separation(group.a.placed(position, orientation),
                                                       group.b.placed(position, orientation))
        return result


def swap(contacts):
    """Return the same contacts with a and b exchanged."""
    return Contacts(contacts.body_b, contacts.body_a, contacts.point, -contacts.normal,
                    contacts.separation, _SWAPPED_FEATURE[contacts.feature],
                    contacts.edge_b, contacts.edge_a)


def _by_kinds(bodies, pairs_a, pairs_b):
    """Return (kinds of a and b, which pairs (p,) int have them) for each two kinds that occur."""
    numbers, kinds = bodies.kind_numbers, bodies.kinds
    combinations = numbers[pairs_a] * bodies.count + numbers[pairs_b]
    return [((kinds[pairs_a[pairs[0]]], kinds[pairs_b[pairs[0]]]), pairs)
            for _, pairs in alike(combinations)]
