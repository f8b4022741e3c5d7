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
The bodies and planes of a scene as arrays: what does not change while it is simulated.

One column a body in the order moving bodies, fixed bodies, planes: the index used everywhere.
A plane is a fixed body at the origin, so that no stage needs a branch for it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

PLANE = 'plane'
"""The kind of collision geometry of a plane; bodies have the kinds of `shapes`."""


@dataclass(frozen=True)
class Bodies:
    """Constants of all bodies; n columns, of which the first `moving_count` move."""

    names: tuple
    """All names, (n,) of str."""

    moving_count: int
    body_count: int
    """Moving and fixed bodies; the planes follow."""

    kinds: tuple
    """Collision geometry, (n,) of str: a `kind` of `shapes` or `PLANE`."""

    half_extents: np.ndarray
    """(3, n) [m], body axes; zero for planes."""

    bounding_radius: np.ndarray
    """(n,) [m] about the centre of mass; infinite for planes."""

    turning_radius: np.ndarray
    """(n,) [m]: the same of points that turning brings elsewhere; zero for balls and planes."""

    plane_normal: np.ndarray
    """(3, n) unit vectors out of the solid, world axes; zero for bodies."""

    plane_offset: np.ndarray
    """(n,) [m]: the solid is normal . x < offset; zero for bodies."""

    inverse_mass: np.ndarray
    """(n,) [1/kg]; zero is how a body is fixed."""

    inertia: np.ndarray
    """(3, n) principal moments [kg m^2] about the body axes; one where fixed."""

    inverse_inertia: np.ndarray
    """(3, n) [1/(kg m^2)]; zero where fixed."""

    restitution: np.ndarray
    """(n,), 0 to 1."""

    friction: np.ndarray
    """(n,), 0 or more."""

    restitution_speed: np.ndarray
    """(n,) [m/s], 0 or more: below it the restitution is in proportion to the speed."""

    rolling_friction: np.ndarray
    """(n,) [m], 0 or more."""

    pivoting_friction: np.ndarray
    """(n,) [m], 0 or more."""

    @property
    def count(self):
        """Count of all columns: moving bodies, fixed bodies and planes."""
        return len(self.names)

    @cached_property
    def kind_numbers(self):
        """Return a number (n,) int for each kind; what has the same kind has the same number."""
        numbers = {kind: number for number, kind in enumerate(dict.fromkeys(self.kinds))}
        return np.array([numbers[kind] for kind in self.kinds], dtype=int)


def ordered(scene):
    """Return the scene's bodies as a list, moving ones first, in scene order otherwise."""
    return ([body for body in scene.bodies if not body.fixed]
            + [body for body in scene.bodies if body.fixed])


def names_of(scene):
    """Return the names of bodies and planes, (n,) of str, in that order."""
    return tuple(row.name for row in (*ordered(scene), *scene.planes))


def bodies_of(scene):
    """Return the constants of a `model.Scene` as `Bodies`."""
    bodies = ordered(scene)
    planes = scene.planes
    moving_count = sum(not body.fixed for body in bodies)
    fixed_count = len(bodies) + len(planes) - moving_count
    inertia = _columns([body.inertia for body in bodies[:moving_count]])
    mass = np.array([body.mass for body in bodies[:moving_count]], dtype=float)
    materials = [row.material for row in (*bodies, *planes)]
    plane_zeros = [(0.0, 0.0, 0.0)] * len(planes)
    body_zeros = [(0.0, 0.0, 0.0)] * len(bodies)
    return Bodies(
        names=names_of(scene),
        moving_count=moving_count,
        body_count=len(bodies),
        kinds=tuple(body.shape.kind for body in bodies) + (PLANE,) * len(planes),
        half_extents=_columns([body.shape.half_extents for body in bodies] + plane_zeros),
        bounding_radius=np.array(
            [body.shape.bounding_radius for body in bodies] + [np.inf] * len(planes)),
        turning_radius=np.array(
            [body.shape.turning_radius for body in bodies] + [0.0] * len(planes)),
        plane_normal=_columns(body_zeros + [plane.normal for plane in planes]),
        plane_offset=np.array([0.0] * len(bodies) + [plane.offset for plane in planes]),
        inverse_mass=np.concatenate((1 / mass, np.zeros(fixed_count))),
        inertia=np.hstack((inertia, np.ones((3, fixed_count)))),
        inverse_inertia=np.hstack((1 / inertia, np.zeros((3, fixed_count)))),
        **{name: np.array([getattr(material, name) for material in materials], dtype=float)
           for name in ('restitution', 'friction', 'restitution_speed', 'rolling_friction',
                        'pivoting_friction')})


def _columns(rows):
    """Return triples as an array (3, n), also for none."""
    return np.array(rows, dtype=float).reshape(-1, 3).T.copy()
