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
One contact of an impact in plain floats: ten times quicker than arrays of length one.

The same lines serve k contacts that share no moving body: every number is an array (k,) then.
"""

from math import sqrt

from rigid_sim_ros.engine.friction import mixed_friction, tangents, tangents_of_one
from rigid_sim_ros.engine.plain_vectors import axes_of, cross, dot, to_world


class OneContact:
    """The response of one contact, the velocity across it, and what an impulse on it does."""

    def __init__(self, axes, friction, partners):
        """Take the contact axes, the friction and one or two `Partner`s."""
        self.friction = friction
        self._axes = axes
        self._partners = partners
        self.response = tuple(map(sum, zip(*(p.response for p in partners))))
        across = tuple(map(sum, zip(*(p.point_velocity() for p in partners))))
        self.velocity = tuple(dot(axis, across) for axis in axes)

    def world(self, impulse):
        """Return the world vector (3,) of an impulse in contact axes."""
        return to_world(self._axes, impulse)

    def parting_speed(self, impulse):
        """Return how fast [m/s] the contact parts after an impulse in contact axes."""
        return self.velocity[0] + dot(self.response, impulse)

    def changes(self, impulse):
        """
        Return what an impulse in contact axes does to moving bodies.

        A list of index, change of linear and change of angular velocity, world axes.
        """
        impulse = self.world(impulse)
        return [(partner.index, *partner.change(impulse)) for partner in self._partners]


class Partner:
    """A moving body at a contact: its part of the response."""

    __slots__ = ('index', 'linear', 'angular', 'response', '_sign', '_inverse_mass',
                 '_inverse_inertia', '_arm', '_frame')

    def __init__(self, index, sign, inverse_mass, inverse_inertia, arm, axes, frame, linear,
                 angular):
        """
        Take what there is to know of the body `index` in a contact with these axes.

        The sign is -1 for body a; `arm` is from its centre to the point, `frame` its axes, or
        None where all moments are alike: then body axes may be any, those of the world are.
        """
        self.index = index
        self.linear, self.angular = linear, angular
        self._sign = sign
        self._inverse_mass, self._inverse_inertia = inverse_mass, inverse_inertia
        self._arm, self._frame = arm, frame
        i1, i2, i3 = inverse_inertia
        (nx, ny, nz), (sx, sy, sz), (tx, ty, tz) = (self._body(cross(arm, axis)) for axis in axes)
        self.response = (
            inverse_mass + i1 * nx * nx + i2 * ny * ny + i3 * nz * nz,
            i1 * nx * sx + i2 * ny * sy + i3 * nz * sz,
            i1 * nx * tx + i2 * ny * ty + i3 * nz * tz,
            inverse_mass + i1 * sx * sx + i2 * sy * sy + i3 * sz * sz,
            i1 * sx * tx + i2 * sy * ty + i3 * sz * tz,
            inverse_mass + i1 * tx * tx + i2 * ty * ty + i3 * tz * tz)

    def point_velocity(self):
        """Return how fast the material point moves, (3,), with the sign of the contact's side."""
        x, y, z = self.linear
        u, v, w = cross(self.angular, self._arm)
        sign = self._sign
        return sign * (x + u), sign * (y + v), sign * (z + w)

    def change(self, impulse):
        """Return the changes (linear, angular) of velocity by a world impulse on b."""
        sign = self._sign
        factor = sign * self._inverse_mass
        torque = self._body(cross(self._arm, impulse))
        angular = [sign * i * t for i, t in zip(self._inverse_inertia, torque)]
        if self._frame is not None:
            angular = to_world(self._frame, angular)
        return [factor * component for component in impulse], angular

    def _body(self, vector):
        """Return a world vector in body axes; unchanged where all axes are alike."""
        if self._frame is None:
            return vector
        return [dot(axis, vector) for axis in self._frame]


def one_contact(bodies, a, b, point, normal, position, orientation, linear, angular):
    """
    Return the contact of bodies a and b at a point (3,) with a normal (3,), in plain floats.

    Poses and velocities are those of all bodies, (3, n) and (4, n).
    """
    axes = normal, *tangents_of_one(*normal)
    partners = []
    for index, sign in ((a, -1.0), (b, 1.0)):
        if index < bodies.moving_count:
            inverse_inertia = i1, i2, i3 = bodies.inverse_inertia[:, index].tolist()
            arm = [u - v for u, v in zip(point, position[:, index].tolist())]
            frame = None if i1 == i2 == i3 else axes_of(orientation[:, index].tolist())
            partners.append(Partner(
                index, sign, bodies.inverse_mass.item(index), inverse_inertia, arm, axes, frame,
                linear[:, index].tolist(), angular[:, index].tolist()))
    friction = sqrt(bodies.friction.item(a) * bodies.friction.item(b))
    return OneContact(axes, friction, partners)


def separate_contacts(bodies, contacts, position, orientation, linear, angular):
    """Return `Contacts`, (k,), that share no moving body, as one of arrays (k,)."""
    axes = contacts.normal, *tangents(contacts.normal)
    partners = []
    for index, sign in ((contacts.body_a, -1.0), (contacts.body_b, 1.0)):
        inverse_inertia = bodies.inverse_inertia.take(index, axis=1)
        alike = (inverse_inertia == inverse_inertia[0]).all()
        frame = None if alike else axes_of(orientation.take(index, axis=1))
        partners.append(Partner(
            index, sign, bodies.inverse_mass.take(index), inverse_inertia,
            contacts.point - position.take(index, axis=1), axes, frame,
            linear.take(index, axis=1), angular.take(index, axis=1)))
    friction = mixed_friction(*(bodies.friction[p.index] for p in partners))
    return OneContact(axes, friction, partners)
