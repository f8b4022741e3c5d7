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
Friction against rolling and pivoting: torques that resist the spin of touching bodies.

A contact of a real body has a width, over which the pressure of what rolls is a little in front of
the middle: up to a length, the coefficient, times the normal force as a torque against rolling.
Likewise up to another length times that force against turning about the normal. Both act on the
relative spin as Coulomb's friction does on sliding: as much as stops it, and no more than that.

Each contact is solved by itself with the forces that keep it as it is, so that what rolls goes on
rolling; where a body has several, each sees a share of its mass (Tonge, Benevolenski and
Voroshilov 2012, 'Mass splitting for jitter-free parallel rigid body simulation').
"""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.friction import tangents

_SWEEPS = 30
_ENOUGH = 1e-12
"""Of the largest relative spin: a change of it that ends the sweeps."""

_STICKS = 1 - 1e-9
"""Of the largest friction: a contact that needs less sticks."""


class Resistance:
    """
    What resists the relative spin at k contacts of a set of bodies.

    Parameters
    ----------
    bodies : Bodies
    contacts : Contacts
    position, orientation : (3, n) [m], (4, n)
        Of all columns.
    force : (3, k) [N s]
        Impulses that hold the contacts: normal, and friction in two directions.
    friction : (k,)
        Coefficients.

    """

    def __init__(self, bodies, contacts, position, orientation, force, friction):
        """See the class."""
        self._both = np.stack((contacts.body_a, contacts.body_b))
        self._normal = contacts.normal
        pressing = np.maximum(force[0], 0.0)
        self._rolling, self._pivoting = (
            pressing * coefficient[self._both].max(axis=0)
            for coefficient in (bodies.rolling_friction, bodies.pivoting_friction))
        resists = (self._rolling > 0.0) | (self._pivoting > 0.0)
        shares = np.bincount(self._both[:, resists].ravel(), minlength=bodies.count)
        turn = rotation.matrix(orientation)
        self._inverse_mass = bodies.inverse_mass
        self._mobility = np.einsum('ijn,jn,kjn->nik', turn, bodies.inverse_inertia, turn)
        self._arms = _cross_matrices(contacts.point[:, None] - position[:, self._both])
        sticks = np.hypot(force[1], force[2]) < _STICKS * friction * force[0]
        self._reaction, self._response = self._held(sticks, np.maximum(shares, 1))
        self._across = np.stack(tangents(self._normal)).transpose(2, 0, 1)

    def _held(self, sticks, shares):
        """Return the forces (k, 3, 3) that hold contacts per torque, and the spin it makes."""
        mobility = (self._mobility * shares[:, None, None])[self._both]
        inverse_mass = (self._inverse_mass * shares)[self._both].sum(axis=0)
        point_by_torque = -(self._arms @ mobility)
        point_by_force = (inverse_mass[:, None, None] * np.eye(3)
                          + (point_by_torque @ self._arms).sum(axis=0))
        point_by_torque = point_by_torque.sum(axis=0)
        normal = self._normal.T[:, :, None]
        along = normal @ (normal.transpose(0, 2, 1) @ point_by_torque)
        along /= normal.transpose(0, 2, 1) @ point_by_force @ normal
        reaction = -np.where(sticks[:, None, None],
                             np.linalg.solve(point_by_force, point_by_torque), along)
        return reaction, mobility.sum(axis=0) + point_by_torque.transpose(0, 2, 1) @ reaction

    def applied(self, linear, angular):
        """
        Return velocities (3, n) of all columns after the torques have acted on those given.

        With the forces that keep each contact as it is by itself.
        """
        return self._found(linear, angular)[:2]

    def turned(self, linear, angular):
        """Return the changes (3, n) [rad/s] of spins by the same torques without those forces."""
        _, _, torque = self._found(linear, angular)
        change = np.zeros_like(angular)
        for sign, bodies in zip((-1.0, 1.0), self._both):
            np.add.at(change.T, bodies, sign * np.einsum(
                'kij,kj->ki', self._mobility[bodies], torque))
        return change

    def _found(self, linear, angular):
        """Return (velocities (3, n), (3, n) after the torques, these (k, 3) [N m s])."""
        first, second = self._across.transpose(1, 0, 2)
        normal, response = self._normal.T, self._response
        g_n = np.maximum(_form(normal, response, normal), 1e-300)
        g_t = _largest(_form(first, response, first), _form(first, response, second),
                       _form(second, response, second))
        torque = np.zeros_like(normal)
        for _ in range(_SWEEPS):
            spin = (angular[:, self._both[1]] - angular[:, self._both[0]]).T
            about = (spin * normal).sum(axis=1)
            pivot = np.clip((torque * normal).sum(axis=1) - about / g_n,
                            -self._pivoting, self._pivoting)
            rolling = torque - (spin - about[:, None] * normal) / g_t[:, None]
            rolling -= (rolling * normal).sum(axis=1)[:, None] * normal
            size = np.sqrt((rolling * rolling).sum(axis=1))
            rolling *= np.minimum(1.0, self._rolling / np.maximum(size, 1e-300))[:, None]
            before, torque = torque, rolling + pivot[:, None] * normal
            change = torque - before
            linear, angular = self._changed(linear, angular, change)
            if np.abs(change * g_t[:, None]).max() <= _ENOUGH * np.abs(spin).max():
                break
        return linear, angular, torque

    def _changed(self, linear, angular, torque):
        """Return the velocities after torques (k, 3) and the forces that go with them."""
        force = np.einsum('kij,kj->ki', self._reaction, torque)
        linear, angular = linear.copy(), angular.copy()
        for sign, bodies, arms in zip((-1.0, 1.0), self._both, self._arms):
            turning = torque + np.einsum('kij,kj->ki', arms, force)
            np.add.at(linear.T, bodies, sign * self._inverse_mass[bodies][:, None] * force)
            np.add.at(angular.T, bodies, sign * np.einsum(
                'kij,kj->ki', self._mobility[bodies], turning))
        return linear, angular


def resists_spin(bodies):
    """Return whether anything about these `Bodies` resists rolling or pivoting."""
    return bool(bodies.rolling_friction.any() or bodies.pivoting_friction.any())


def _cross_matrices(arms):
    """Return the matrices (2, k, 3, 3) of the vector products with arms (3, 2, k)."""
    x, y, z = arms
    zero = np.zeros_like(x)
    return np.stack((zero, -z, y, z, zero, -x, -y, x, zero), axis=-1).reshape(*x.shape, 3, 3)


def _form(left, matrix, right):
    """Return left . matrix right, (k,), of vectors (k, 3) and matrices (k, 3, 3)."""
    return np.einsum('ki,kij,kj->k', left, matrix, right)


def _largest(first, mixed, second):
    """Return the larger eigenvalues (k,) of symmetric matrices, positive."""
    middle = 0.5 * (first + second)
    return np.maximum(middle + np.hypot(0.5 * (first - second), mixed), 1e-300)
