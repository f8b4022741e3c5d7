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

"""Contact points: where two bodies touch, as arrays with one column a point."""

from dataclasses import dataclass, fields

import numpy as np

FACE_A, FACE_B, EDGES, ROUND = range(4)
"""
Which features meet: a vertex of b on a face of a, a vertex of a on a face of b (a plane is a face
of b), an edge of each, or a sphere with anything. They differ in how the normal turns.
"""


@dataclass
class Contacts:
    """
    Contact points, k of them.

    The normal points from a to b and the separation is negative in penetration. Velocities across
    a contact are those of b minus those of a.
    """

    body_a: np.ndarray
    """(k,) int: index of the body, fixed body or plane."""

    body_b: np.ndarray
    """(k,) int."""

    point: np.ndarray
    """(3, k) [m], world axes: midway between the two surfaces."""

    normal: np.ndarray
    """(3, k) unit vectors, world axes, from a to b."""

    separation: np.ndarray
    """(k,) [m], negative in penetration."""

    feature: np.ndarray
    """(k,) int: FACE_A, FACE_B, EDGES or ROUND."""

    edge_a: np.ndarray
    """
    (3, k) unit vector along the edge of a, world axes; zero elsewhere.

    Where EDGES, and where a sphere (ROUND) meets an edge of a.
    """

    edge_b: np.ndarray
    """(3, k), likewise of b."""

    @property
    def count(self):
        """Count of contact points."""
        return len(self.body_a)

    def select(self, which):
        """Return the contacts of a mask (k,) or of indices, in that order."""
        places = np.flatnonzero(which) if which.dtype == bool else which
        return Contacts(*(getattr(self, name).take(places, axis=-1) for name in _FIELDS))

    @staticmethod
    def join(parts):
        """Return all contacts of a list of `Contacts`, in its order; the list may be empty."""
        if not parts:
            return Contacts.none()
        return Contacts(*(
            np.concatenate([getattr(part, name) for part in parts], axis=-1)
            for name in _FIELDS))

    @staticmethod
    def none():
        """Return no contacts."""
        integers = np.empty(0, dtype=int)
        vectors = np.empty((3, 0))
        return Contacts(integers, integers, vectors, vectors, np.empty(0), integers,
                        vectors, vectors)


_FIELDS = tuple(field.name for field in fields(Contacts))
