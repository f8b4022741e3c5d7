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
The separating axis test for two boxes: 3 + 3 face normals and the 9 products of an edge of each.

Gottschalk, Lin, Manocha 1996 (OBBTree). Different here: the projections of b on a product of
edges are taken from that product, not from the entry of the rotation matrix which they equal in
exact arithmetic, so that the distances stay right to rounding however close to parallel the edges
are.
"""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.engine.rotation import cross, dot, matrix, transform_transposed

PARALLEL = 1e-7
"""Edges with a smaller sine of the angle between them are not tried: their product is noise."""

_NEXT = np.array((1, 2, 0))
_AFTER = np.array((2, 0, 1))


@dataclass
class Axes:
    """Signed distances of p pairs of boxes along all axes, and what they were made from."""

    rotation_a: np.ndarray
    """(3, 3, p): body a to world."""

    rotation_b: np.ndarray
    """(3, 3, p): body b to world."""

    relative: np.ndarray
    """(3, 3, p): axes of b in axes of a, [i, j] = a_i . b_j."""

    offset_a: np.ndarray
    """(3, p) [m]: from the centre of a to that of b, in axes of a."""

    offset_b: np.ndarray
    """(3, p) [m]: the same vector in axes of b."""

    faces_a: np.ndarray
    """(3, p) [m]: distance along each face normal of a."""

    faces_b: np.ndarray
    """(3, p) [m]: distance along each face normal of b."""

    edges: np.ndarray
    """(9, p) [m]: distance along a_i x b_j, row 3 i + j; -inf where parallel."""

    def separation(self):
        """Return the largest of all 15 distances [m], (p,)."""
        return np.maximum(np.maximum(self.faces_a.max(axis=0), self.faces_b.max(axis=0)),
                          self.edges.max(axis=0))

    def best(self):
        """Return the `Direction` of the largest distance."""
        best = np.concatenate((self.faces_a, self.faces_b, self.edges)).argmax(axis=0)
        column = np.arange(len(best))
        of_face_a, of_face_b = best < 3, (best >= 3) & (best < 6)
        # rows are the faces of a, those of b, then all products, b's axis counting fastest
        axis_a = self.rotation_a[:, np.where(of_face_a, best, (best - 6) // 3), column]
        axis_b = self.rotation_b[:, best % 3, column]
        product = cross(axis_a, axis_b)
        length = np.where(of_face_a | of_face_b, 1.0, np.sqrt(dot(product, product)))
        normal = np.where(of_face_a, axis_a, np.where(of_face_b, axis_b, product / length))
        outward = dot(transform_transposed(self.rotation_a, normal), self.offset_a)
        return Direction(normal * np.copysign(1.0, outward), of_face_a, of_face_b, axis_a, axis_b)


@dataclass
class Direction:
    """The axis along which each of p pairs of boxes is apart the most."""

    normal: np.ndarray
    """(3, p) unit vectors, world axes, from a to b."""

    of_face_a: np.ndarray
    """(p,) bool: it is the normal of a face of a."""

    of_face_b: np.ndarray
    """(p,) bool: it is the normal of a face of b; otherwise the product of an edge of each."""

    edge_a: np.ndarray
    """(3, p) unit vector along the edge of a, world axes, where it is a product."""

    edge_b: np.ndarray
    """(3, p), likewise of b."""

    def rate(self, spin_a, spin_b):
        """Return how the normals turn, (3, p) [1/s], with the rates (3, p) [rad/s] of both."""
        return np.where(
            self.of_face_a, cross(spin_a, self.normal),
            np.where(self.of_face_b, cross(spin_b, self.normal),
                     product_rate(self.edge_a, self.edge_b, self.normal, spin_a, spin_b)))


def product_rate(edge_a, edge_b, normal, spin_a, spin_b):
    """Return dn/dt, (3, p), of normals n = +-(a x b)/|a x b| of edges that turn."""
    # signed so that dividing by it also turns a x b into the direction of the normal
    sine = dot(cross(edge_a, edge_b), normal)
    # (w_a x a) x b + a x (w_b x b), multiplied out
    rate = (edge_a * dot(spin_a, edge_b) - edge_b * dot(spin_b, edge_a)
            + (spin_b - spin_a) * dot(edge_a, edge_b))
    rate = rate / np.where(sine == 0, np.inf, sine)
    return rate - normal * dot(normal, rate)


def separating_axes(a, b):
    """Return the `Axes` of boxes a and b (`Solids`, placed)."""
    count = len(a.index)
    both = matrix(np.concatenate((a.orientation, b.orientation), axis=1))
    rotation_a, rotation_b = both[:, :, :count], both[:, :, count:]
    between = b.center - a.center
    offset_a = transform_transposed(rotation_a, between)
    offset_b = transform_transposed(rotation_b, between)
    relative = (rotation_a[:, :, np.newaxis] * rotation_b[:, np.newaxis]).sum(axis=0)
    size = np.abs(relative)
    half_a, half_b = a.half_extents, b.half_extents
    faces_a = np.abs(offset_a) - half_a - (size * half_b).sum(axis=1)
    faces_b = np.abs(offset_b) - half_b - (size * half_a[:, np.newaxis]).sum(axis=0)
    return Axes(rotation_a, rotation_b, relative, offset_a, offset_b, faces_a, faces_b,
                _edge_distances(relative, offset_a, half_a, half_b))


def _edge_distances(relative, offset, half_a, half_b):
    """Return the distances [m], (9, p), along a_i x b_j = -r2 a_(i+1) + r1 a_(i+2)."""
    r1, r2 = relative.take(_NEXT, axis=0), relative.take(_AFTER, axis=0)
    between = np.abs(offset.take(_AFTER, axis=0)[:, np.newaxis] * r1
                     - offset.take(_NEXT, axis=0)[:, np.newaxis] * r2)
    reach_a = (half_a.take(_NEXT, axis=0)[:, np.newaxis] * np.abs(r2)
               + half_a.take(_AFTER, axis=0)[:, np.newaxis] * np.abs(r1))
    reach_b = 0
    for other in (_NEXT, _AFTER):
        along = r1 * r2.take(other, axis=1) - r2 * r1.take(other, axis=1)
        reach_b = reach_b + half_b.take(other, axis=0) * np.abs(along)
    sine = np.sqrt(r1 * r1 + r2 * r2)
    parallel = sine < PARALLEL
    distances = (between - reach_a - reach_b) / np.where(parallel, 1.0, sine)
    distances[parallel] = -np.inf
    return distances.reshape(9, -1)
