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

"""Few pairs, tested one by one in plain floats where arrays would be mostly overhead."""

from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine.bodies import PLANE
from rigid_sim_ros.engine.contacts import Contacts, FACE_B
from rigid_sim_ros.engine.narrow_phase.box_plane import VERTEX_SIGNS
from rigid_sim_ros.engine.narrow_phase.plain_box_box import (
    box_with_box, PlainBox, separation_of_boxes)
from rigid_sim_ros.engine.plain_vectors import corners, dot, to_world

_SIGNS = VERTEX_SIGNS.T.tolist()
_NOTHING = (0.0, 0.0, 0.0)


def box_with_plane(box, plane, margin):
    """Return the contacts of a `PlainBox` with a `PlainPlane`, as `box_with_box` does."""
    normal = plane.normal
    height = dot(normal, box.center) - plane.offset
    found = []
    for signs, above in zip(_SIGNS, corners(box.axes, box.half, normal)):
        gap = height + above
        if gap < margin:
            arm = to_world(box.axes, [sign * half for sign, half in zip(signs, box.half)])
            found.append(([x + r - 0.5 * gap * n for x, r, n in zip(box.center, arm, normal)],
                          plane.inward, gap, FACE_B, _NOTHING, _NOTHING))
    return found


class PlainPlane:
    """One plane: its normal out of the solid, the opposite, and its offset [m]."""

    __slots__ = ('normal', 'inward', 'offset')

    def __init__(self, normal, offset):
        """Take three floats and one."""
        self.normal = normal
        self.inward = [-x for x in normal]
        self.offset = offset


def separation_from_plane(box, plane):
    """Return the distance [m] of the lowest vertex from a plane: `box_plane.separation`."""
    normal = plane.normal
    reach = sum(half * abs(dot(normal, axis)) for half, axis in zip(box.half, box.axes))
    return dot(normal, box.center) - plane.offset - reach


class PlainTest(NamedTuple):
    """How two solids of given kinds meet, one pair in plain floats."""

    contacts: callable
    separation: callable


PLAIN_TESTS = {('box', 'box'): PlainTest(box_with_box, separation_of_boxes),
               ('box', PLANE): PlainTest(box_with_plane, separation_from_plane)}
"""Pairs of kinds that can be tested one by one, in the order of the table."""


class PlainPairs:
    """
    Pairs of one kind, ready to be tested one by one.

    Parameters
    ----------
    test : PlainTest
        How they are tested.
    a, b : Solids
        Their sides; only b may be planes.

    """

    def __init__(self, test, a, b):
        """See the class."""
        self._test = test
        self._index_a, self._index_b = a.index.tolist(), b.index.tolist()
        self._planes = {}
        boxes = [a]
        if test.contacts is box_with_plane:
            self._planes = {index: PlainPlane(normal, offset) for index, normal, offset in zip(
                self._index_b, b.plane_normal.T.tolist(), b.plane_offset.tolist())}
        else:
            boxes.append(b)
        self._boxes = {
            index: (half, radius) for side in boxes for index, half, radius in zip(
                side.index.tolist(), side.half_extents.T.tolist(), side.bounding_radius.tolist())}
        self._index = np.array(list(self._boxes))

    def find_contacts(self, position, orientation, margin):
        """Return `Contacts` as `PairGroups.find_contacts` does; the margin is (p,) [m]."""
        solids = self._placed(position, orientation)
        return _joined((a, b, self._test.contacts(solids[a], solids[b], limit))
                       for a, b, limit in zip(self._index_a, self._index_b, margin.tolist()))

    def separations(self, position, orientation):
        """Return the signed distances [m], a list, as `PairGroups.separations` does."""
        solids = self._placed(position, orientation)
        return [self._test.separation(solids[a], solids[b])
                for a, b in zip(self._index_a, self._index_b)]

    def _placed(self, position, orientation):
        """Return all solids by index."""
        solids = dict(self._planes)
        for (index, side), center, turn in zip(
                self._boxes.items(), position.take(self._index, axis=1).T.tolist(),
                orientation.take(self._index, axis=1).T.tolist()):
            solids[index] = PlainBox(center, turn, *side)
        return solids


def contacts_of_one(bodies, a, b, position, orientation, margin):
    """
    Return `Contacts` of bodies a and b, whose kinds are a row of `PLAIN_TESTS`, looked at once.

    Positions (3, n) and orientations (4, n) are those of all bodies, the margin is in m.
    """
    solids = [
        PlainPlane(bodies.plane_normal[:, index].tolist(), bodies.plane_offset.item(index))
        if bodies.kinds[index] == PLANE else
        PlainBox(position[:, index].tolist(), orientation[:, index].tolist(),
                 bodies.half_extents[:, index].tolist(), bodies.bounding_radius.item(index))
        for index in (a, b)]
    test = PLAIN_TESTS[bodies.kinds[a], bodies.kinds[b]]
    return _joined([(a, b, test.contacts(*solids, margin))])


def _joined(found):
    """Return as `Contacts` what was found of bodies: (a, b, list of contacts as tuples)."""
    values, indices = [], []
    for a, b, contacts in found:
        for point, normal, gap, feature, edge_a, edge_b in contacts:
            values.append((*point, *normal, *edge_a, *edge_b, gap))
            indices.append((a, b, feature))
    if not values:
        return Contacts.none()
    values = np.ascontiguousarray(np.array(values).T)
    body_a, body_b, feature = np.ascontiguousarray(np.array(indices).T)
    return Contacts(body_a, body_b, values[:3], values[3:6], values[12], feature, values[6:9],
                    values[9:12])
