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
A sphere and a box: the point of the box nearest to the centre of the sphere.

With the centre inside the box the nearest point of the surface takes its place, so the sphere is
pushed out the shortest way.
"""

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts, ROUND
from rigid_sim_ros.engine.rotation import dot, transform, transform_transposed


def separation(a, b):
    """Return the distances [m], (p,), of the surfaces; negative in penetration."""
    return nearest(b.rotation(), a, b)[1]


def contacts(a, b, margin):
    """
    Return one contact for every pair with a separation below `margin` [m], (p,).

    Where the sphere meets an edge of the box, `edge_b` is along it.
    """
    matrix = b.rotation()
    outward, gap, beyond = nearest(matrix, a, b)
    near = np.flatnonzero(gap < margin)
    matrix, gap, beyond = matrix[:, :, near], gap[near], beyond[:, near]
    normal = -transform(matrix, outward[:, near])
    point = a.center[:, near] + normal * (a.radius[near] + 0.5 * gap)
    on_edge = beyond.sum(axis=0) == 2
    # beyond two pairs of faces: the edge is along the third axis
    edge = transform(matrix, np.where(on_edge & ~beyond, 1.0, 0.0))
    return Contacts(a.index[near], b.index[near], point, normal, gap,
                    np.full(len(near), ROUND), np.zeros_like(normal), edge)


def nearest(matrix, a, b):
    """
    Return where the sphere is, seen from the box.

    The direction out of the box, (3, p), in its axes; the separation [m], (p,); and along which
    axes the centre lies beyond the box, (3, p) bool.
    """
    center = transform_transposed(matrix, a.center - b.center)
    outside = np.abs(center) - b.half_extents
    beyond = outside > 0
    excess = np.where(beyond, outside, 0.0)
    distance = np.sqrt(dot(excess, excess))
    inside = distance == 0
    least = outside.argmax(axis=0)
    face = (least == np.arange(3)[:, np.newaxis]).astype(float)
    direction = np.where(inside, face, excess / np.where(inside, 1.0, distance))
    depth = outside.max(axis=0)
    return (np.copysign(direction, center),
            np.where(inside, depth, distance) - a.radius, beyond)
