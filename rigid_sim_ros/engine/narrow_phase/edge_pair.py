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

"""Two boxes that meet with an edge of each: one contact point, where the edges cross."""

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts, EDGES
from rigid_sim_ros.engine.rotation import cross, dot, transform, transform_transposed


def edge_contacts(a, b, axes, pairs):
    """Return one contact for each of `pairs`, (k,), on the best product of two edges."""
    rotation_a, rotation_b = axes.rotation_a[:, :, pairs], axes.rotation_b[:, :, pairs]
    column = np.arange(len(pairs))
    best = axes.edges[:, pairs].argmax(axis=0)
    axis_a, axis_b = np.divmod(best, 3)
    edge_a, edge_b = rotation_a[:, axis_a, column], rotation_b[:, axis_b, column]
    product = cross(edge_a, edge_b)
    square = dot(product, product)
    between = b.center[:, pairs] - a.center[:, pairs]
    normal = product * np.copysign(1 / np.sqrt(square), dot(product, between))
    half_a, half_b = a.half_extents[:, pairs], b.half_extents[:, pairs]
    middle_a = a.center[:, pairs] + _middle(rotation_a, half_a, axis_a, normal)
    middle_b = b.center[:, pairs] + _middle(rotation_b, half_b, axis_b, -normal)
    # how far along both lines, from the middles, they are nearest (Ericson 2005, section 5.1.8)
    cosine, apart = dot(edge_a, edge_b), middle_b - middle_a
    ahead_a, ahead_b = dot(edge_a, apart), dot(edge_b, apart)
    along_a = _within((ahead_a - cosine * ahead_b) / square, half_a[axis_a, column])
    along_b = _within((cosine * ahead_a - ahead_b) / square, half_b[axis_b, column])
    point = 0.5 * (middle_a + along_a * edge_a + middle_b + along_b * edge_b)
    return Contacts(a.index[pairs], b.index[pairs], point, normal, axes.edges[best, pairs],
                    np.full(len(pairs), EDGES), edge_a, edge_b)


def _middle(rotation, half_extents, axis, direction):
    """Return the middle, (3, k), from the centre, of the edge along `axis` that is furthest."""
    corner = np.copysign(half_extents, transform_transposed(rotation, direction))
    corner[axis, np.arange(len(axis))] = 0.0
    return transform(rotation, corner)


def _within(along, half):
    """Return positions on edges, moved to their ends where rounding or depth put them beyond."""
    return np.minimum(np.maximum(along, -half), half)
