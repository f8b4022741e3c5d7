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

"""The geometry of one side of many pairs, gathered: one column a pair."""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.engine import rotation


@dataclass
class Solids:
    """One side of p pairs; which fields mean something depends on the kind of shape."""

    index: np.ndarray
    """(p,) int: of the body, fixed body or plane."""

    half_extents: np.ndarray
    """(3, p) [m], body axes: of a box; of a sphere the radius, three times."""

    bounding_radius: np.ndarray
    """(p,) [m]."""

    plane_normal: np.ndarray
    """(3, p), out of the solid: of a plane."""

    plane_offset: np.ndarray
    """(p,) [m]: of a plane."""

    center: np.ndarray = None
    """(3, p) [m], world axes."""

    orientation: np.ndarray = None
    """(4, p) x y z w, body to world."""

    @staticmethod
    def gather(bodies, index):
        """Return what does not change of the bodies `index`, (p,)."""
        return Solids(index, bodies.half_extents.take(index, axis=1),
                      bodies.bounding_radius.take(index),
                      bodies.plane_normal.take(index, axis=1),
                      bodies.plane_offset.take(index))

    def placed(self, position, orientation):
        """Return the same at these poses of all bodies, (3, n) [m] and (4, n)."""
        return self.at(position.take(self.index, axis=1), orientation.take(self.index, axis=1))

    def at(self, center, orientation):
        """Return the same at these poses, (3, p) [m] and (4, p)."""
        return Solids(self.index, self.half_extents, self.bounding_radius, self.plane_normal,
                      self.plane_offset, center, orientation)

    def select(self, pairs):
        """Return some of the pairs, (q,) int, without poses."""
        return Solids(self.index.take(pairs), self.half_extents.take(pairs, axis=1),
                      self.bounding_radius.take(pairs), self.plane_normal.take(pairs, axis=1),
                      self.plane_offset.take(pairs))

    @property
    def radius(self):
        """Radius [m], (p,), of spheres."""
        return self.half_extents[0]

    def rotation(self):
        """Return the rotation matrices, (3, 3, p), body to world."""
        return rotation.matrix(self.orientation)


def smaller_size(a, b):
    """Return the smaller of the bounding radii [m], (p,): what tolerances are relative to."""
    return np.minimum(a.bounding_radius, b.bounding_radius)
