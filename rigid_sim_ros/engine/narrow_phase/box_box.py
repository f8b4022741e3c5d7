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
Two boxes: separating axes, then a clipped face or a pair of edges.

A face is preferred to an edge pair that is better by less than the margin (and 1e-4 of the size):
then the normals agree to margin over size, and the face has all the points within the margin where
the edges have one.
"""

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts
from rigid_sim_ros.engine.narrow_phase.edge_pair import edge_contacts
from rigid_sim_ros.engine.narrow_phase.face_clipping import face_contacts
from rigid_sim_ros.engine.narrow_phase.separating_axes import separating_axes
from rigid_sim_ros.engine.narrow_phase.solids import smaller_size

TIE = 1e-9
"""Distances along two axes that differ by less than this of the size count as equal."""

EDGE_PREFERENCE = 1e-4
"""However large the margin, an edge pair wins if it is better by this much of the size."""


def separation(a, b):
    """
    Return the signed distances [m], (p,), along the best of all 15 axes.

    Apart, a lower bound of the distance; overlapping, minus the shortest way out.
    """
    return separating_axes(a, b).separation()


def contacts(a, b, margin):
    """Return all contact points with a separation below `margin` [m], (p,)."""
    axes = separating_axes(a, b)
    best_a, best_b = axes.faces_a.max(axis=0), axes.faces_b.max(axis=0)
    best_edge = axes.edges.max(axis=0)
    size = smaller_size(a, b)
    of_b = best_b > best_a + TIE * size
    best_face = np.where(of_b, best_b, best_a)
    lead = np.maximum(np.minimum(margin, EDGE_PREFERENCE * size), TIE * size)
    with_edges = best_edge > best_face + lead
    near = np.maximum(best_face, best_edge) < margin
    parts = []
    on_face = np.flatnonzero(near & ~with_edges)
    if len(on_face):
        parts.append(face_contacts(a, b, axes, on_face, of_b[on_face], margin, size))
    on_edges = np.flatnonzero(near & with_edges)
    if len(on_edges):
        parts.append(edge_contacts(a, b, axes, on_edges))
    return Contacts.join(parts)
