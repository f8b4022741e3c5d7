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
The shapes a body can have: one row of the table `SHAPES` each.

A shape knows what follows from its geometry alone: its volume, its principal moments of inertia
for a given mass, its bounding radius. Body axes are the principal axes, with the origin in the
centre of mass. What happens when two shapes meet is in `narrow_phase`, one file a pair.
"""

from dataclasses import dataclass
from math import hypot, pi


class Shape:
    """What every shape provides; a new one is a subclass and a row of `SHAPES`."""

    kind = None
    """Name of the collision geometry: what the narrow phase table is indexed by."""

    @property
    def half_extents(self):
        """Half the sides [m] of the smallest box around the shape, along the body axes, (3,)."""
        raise NotImplementedError

    @property
    def bounding_radius(self):
        """Radius [m] of the smallest sphere around the centre of mass that holds the shape."""
        raise NotImplementedError

    @property
    def turning_radius(self):
        """Largest distance [m] from there of points that turning brings to another place."""
        return self.bounding_radius

    @property
    def volume(self):
        """Volume [m^3]."""
        raise NotImplementedError

    def inertia(self, mass):
        """Return the principal moments [kg m^2], (3,), of the solid shape of this mass [kg]."""
        raise NotImplementedError


@dataclass(frozen=True)
class Box(Shape):
    """A box with the given sides [m] along the body axes."""

    size: tuple

    kind = 'box'

    @property
    def half_extents(self):
        """Half the sides [m], (3,)."""
        return tuple(side / 2 for side in self.size)

    @property
    def bounding_radius(self):
        """Half the space diagonal [m]."""
        return hypot(*self.size) / 2

    @property
    def volume(self):
        """Volume [m^3]."""
        x, y, z = self.size
        return x * y * z

    def inertia(self, mass):
        """Return m/12 (y^2 + z^2, z^2 + x^2, x^2 + y^2) [kg m^2]."""
        x, y, z = self.size
        return (mass / 12 * (y * y + z * z),
                mass / 12 * (z * z + x * x),
                mass / 12 * (x * x + y * y))


class Cube(Box):
    """A box of three equal sides `edge` [m]."""

    def __init__(self, edge):
        super().__init__((edge, edge, edge))

    @property
    def edge(self):
        """Length of a side [m]."""
        return self.size[0]

    def inertia(self, mass):
        """Return three times m l^2 / 6 [kg m^2], equal to the last bit."""
        moment = mass * self.edge * self.edge / 6
        return (moment, moment, moment)


@dataclass(frozen=True)
class Sphere(Shape):
    """A ball of the given radius [m]."""

    radius: float

    kind = 'sphere'

    @property
    def half_extents(self):
        """Return the radius [m], three times."""
        return (self.radius,) * 3

    @property
    def bounding_radius(self):
        """Return the radius [m]."""
        return self.radius

    @property
    def turning_radius(self):
        """Return zero: where there was ball there is ball, however it turns."""
        return 0.0

    @property
    def volume(self):
        """Volume [m^3]."""
        return 4 / 3 * pi * self.radius ** 3

    def inertia(self, mass):
        """Return three times 2/5 m r^2 [kg m^2]."""
        moment = 0.4 * mass * self.radius * self.radius
        return (moment, moment, moment)


SHAPES = {'cube': Cube, 'box': Box, 'sphere': Sphere}
"""Every shape by the key it has in a scene file; its parameters there are the constructor's."""
