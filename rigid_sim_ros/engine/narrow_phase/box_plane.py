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

"""A box and a plane: every vertex of the box that is near enough is a contact point."""

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts, FACE_B
from rigid_sim_ros.engine.rotation import dot, transform_transposed

VERTEX_SIGNS = np.array([[1 if vertex >> axis & 1 else -1 for vertex in range(8)]
                         for axis in range(3)], dtype=float)
"""(3, 8): the vertices of a box are these times its half extents, in body axes."""


def separation(a, b):
    """Return the distances [m], (p,), of the lowest vertex; negative in penetration."""
    normal = transform_transposed(a.rotation(), b.plane_normal)
    return (dot(b.plane_normal, a.center) - b.plane_offset
            - dot(np.abs(normal), a.half_extents))


def contacts(a, b, margin):
    """Return every vertex with a separation below `margin` [m], (p,)."""
    matrix = a.rotation()
    height = dot(b.plane_normal, a.center) - b.plane_offset
    step = transform_transposed(matrix, b.plane_normal) * a.half_extents
    gaps = height[:, np.newaxis] + step.T @ VERTEX_SIGNS
    pair, vertex = np.nonzero(gaps < margin[:, np.newaxis])
    gap = gaps[pair, vertex]
    local = VERTEX_SIGNS[:, vertex] * a.half_extents[:, pair]
    normal = -b.plane_normal[:, pair]
    point = (a.center[:, pair] + (matrix[:, :, pair] * local).sum(axis=1)
             + normal * (0.5 * gap))
    zeros = np.zeros_like(normal)
    return Contacts(a.index[pair], b.index[pair], point, normal, gap,
                    np.full(len(pair), FACE_B), zeros, zeros)
