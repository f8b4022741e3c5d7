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
What is simulated: a scene of bodies and planes, as plain values.

A scene never changes while it is simulated. It is made by `rigid_sim_ros.scene.load_scene`,
which checks every value; nothing is checked here a second time.
"""

from dataclasses import dataclass, field

from rigid_sim_ros.engine.shapes import Shape


@dataclass(frozen=True)
class Material:
    """Surface of a body or plane."""

    restitution: float = 0.3
    """Rebound speed over approach speed, 0 to 1. A pair has the larger of its two."""

    friction: float = 0.5
    """Coulomb friction coefficient, 0 or more. A pair has the geometric mean of its two."""

    restitution_speed: float = 0.0
    """
    Approach speed [m/s], 0 or more, from which on the restitution is as given; what comes slower
    rebounds in proportion: restitution times speed over this.
    """

    rolling_friction: float = 0.0
    """Length [m], 0 or more: this times the normal force is the largest torque against rolling."""

    pivoting_friction: float = 0.0
    """Likewise against turning about the normal. A pair has the larger of its two, of both."""


@dataclass(frozen=True)
class Plane:
    """A fixed half space: everything with normal . x < offset is solid."""

    name: str
    normal: tuple = (0.0, 0.0, 1.0)
    """Unit vector (3,), world axes, out of the solid."""

    offset: float = 0.0
    """Distance [m] of the surface from the origin, along the normal."""

    material: Material = field(default_factory=Material)


@dataclass(frozen=True)
class Body:
    """A rigid body and the motion it starts with; vectors are (3,) in world axes."""

    name: str
    shape: Shape
    mass: float
    """[kg]; what a fixed body has is not used."""

    inertia: tuple
    """Principal moments [kg m^2], (3,), about the body axes."""

    position: tuple = (0.0, 0.0, 0.0)
    """Centre of mass [m]."""

    orientation: tuple = (0.0, 0.0, 0.0, 1.0)
    """Unit quaternion x, y, z, w, body to world."""

    velocity: tuple = (0.0, 0.0, 0.0)
    """Of the centre of mass [m/s]."""

    angular_velocity: tuple = (0.0, 0.0, 0.0)
    """[rad/s]."""

    force: tuple = (0.0, 0.0, 0.0)
    """Held on the centre of mass [N], besides gravity."""

    torque: tuple = (0.0, 0.0, 0.0)
    """Held [N m]."""

    fixed: bool = False
    material: Material = field(default_factory=Material)


@dataclass(frozen=True)
class Scene:
    """Everything a simulation starts from."""

    bodies: tuple = ()
    planes: tuple = ()
    gravity: tuple = (0.0, 0.0, -9.81)
    """[m/s^2], (3,), world axes."""

    impact_law: str = 'poisson'
    """What restitution means in an impact: a key of `impacts.IMPACT_LAWS`."""

    def __deepcopy__(self, memo):
        """Return itself, as nothing in it changes: it would be most of a copied simulation."""
        return self
