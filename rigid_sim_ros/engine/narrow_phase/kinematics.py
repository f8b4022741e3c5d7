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
How contacts accelerate because what touches turns and curves.

With u the velocity of b minus that of a at a contact and r the arms from the centres of mass,

    gap'' = n . [a_b + alpha_b x r_b - a_a - alpha_a x r_a] + gamma_n
    (du/dt)_t = ([the same bracket] + gamma_t)_t.

The bracket is linear in the accelerations of the bodies; the gammas are quadratic in their
velocities and are computed here. Derivation: let x_a, x_b be points fixed to the bodies where
gap + const = n . (x_b - x_a) holds for ever (on a face, on an edge, a vertex, a sphere's centre)
and x_b - x_a = d n now. As n . n' = 0, differentiating twice leaves

    gamma_n = n . [w x (w x r)]_(b - a) + 2 n' . u - d |n'|^2,

and only the rate n' of the normal depends on which features meet. For gamma_t, u is followed
along the contact point x(t), the vertex, the crossing of the edges or the nearest point of the
sphere: du/dt = bracket + [w x (x' - v)]_(b - a).
"""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.engine.contacts import EDGES, FACE_A, ROUND
from rigid_sim_ros.engine.narrow_phase.separating_axes import product_rate
from rigid_sim_ros.engine.rotation import cross, dot


def gap_acceleration_bias(contacts, bodies, position, linear_velocity, angular_velocity):
    """
    Return the part of the accelerations at contacts that is quadratic in the velocities.

    gamma_n is exact as long as the same features meet, at any gap and velocity; gamma_t is that of
    a closed gap.

    Parameters
    ----------
    contacts : Contacts
        k of them.
    bodies : Bodies
        Which bodies there are.
    position : (3, n) [m]
        Of the centres of mass, as all below of all bodies and planes.
    linear_velocity : (3, n) [m/s]
        Of the centres of mass, zero of what is fixed.
    angular_velocity : (3, n) [rad/s]
        In world axes, zero of what is fixed.

    Returns
    -------
    gamma_n : (k,) [m/s^2]
        Along the normal.
    gamma_t : (3, k) [m/s^2]
        Across the normal, in world axes.

    """
    if not (contacts.feature == ROUND).any():
        return _bias_of_flat(contacts, position, linear_velocity, angular_velocity)
    normal = contacts.normal
    state = (bodies, position, linear_velocity, angular_velocity)
    a = _side(contacts, contacts.body_a, -0.5, *state)
    b = _side(contacts, contacts.body_b, 0.5, *state)
    slip = b.point_velocity() - a.point_velocity()
    between = b.point - a.point
    rate = _normal_rate(contacts, bodies, a, b, slip, between)
    centripetal = cross(b.spin, cross(b.spin, b.arm())) - cross(a.spin, cross(a.spin, a.arm()))
    gamma_n = (dot(normal, centripetal) + 2 * dot(rate, slip)
               - dot(normal, between) * dot(rate, rate))
    follow = _contact_point_velocity(contacts, a, b, slip, rate)
    drift = cross(b.spin, follow - b.velocity) - cross(a.spin, follow - a.velocity)
    return gamma_n, drift - normal * dot(normal, drift)


def _bias_of_flat(contacts, position, linear_velocity, angular_velocity):
    """Return `gap_acceleration_bias` where nothing is round, both sides in the same arrays."""
    normal, feature, count = contacts.normal, contacts.feature, contacts.count
    both = np.concatenate((contacts.body_a, contacts.body_b))
    spin, velocity = angular_velocity.take(both, axis=1), linear_velocity.take(both, axis=1)
    half = 0.5 * contacts.separation * normal
    arm = (np.concatenate((contacts.point - half, contacts.point + half), axis=1)
           - position.take(both, axis=1))
    turning = cross(spin, arm)
    centripetal = cross(spin, turning)
    points = velocity + turning
    slip = points[:, count:] - points[:, :count]
    spin_a, spin_b = spin[:, :count], spin[:, count:]
    with_a = feature == FACE_A
    rate = cross(np.where(with_a, spin_a, spin_b), normal)
    follow = np.where(with_a, points[:, count:], points[:, :count])
    crossing = np.flatnonzero(feature == EDGES)
    if len(crossing):
        edge_a, edge_b = contacts.edge_a[:, crossing], contacts.edge_b[:, crossing]
        rate[:, crossing] = product_rate(edge_a, edge_b, normal[:, crossing],
                                         spin_a[:, crossing], spin_b[:, crossing])
        follow[:, crossing] += _along(edge_a, edge_b, slip[:, crossing]) * edge_a
    gamma_n = (dot(normal, centripetal[:, count:] - centripetal[:, :count]) + 2 * dot(rate, slip)
               - contacts.separation * dot(rate, rate))
    drifts = cross(spin, np.concatenate((follow, follow), axis=1) - velocity)
    drift = drifts[:, count:] - drifts[:, :count]
    return gamma_n, drift - normal * dot(normal, drift)


def _along(edge_a, edge_b, slip):
    """Return how fast [m/s], (k,), the crossing of two edges runs along that of a."""
    cosine = dot(edge_a, edge_b)
    return (dot(slip, edge_a) - cosine * dot(slip, edge_b)) / (1 - cosine * cosine)


@dataclass
class _Side:
    """One body of every contact; vectors are (3, k) in world axes."""

    center: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    point: np.ndarray
    """The point fixed to the body: of a sphere its centre."""

    is_round: np.ndarray
    """(k,) bool: a sphere."""

    radius: np.ndarray
    """(k,) [m] of a sphere, else zero."""

    def arm(self):
        return self.point - self.center

    def point_velocity(self):
        return self.velocity + cross(self.spin, self.arm())


def _side(contacts, index, towards, bodies, position, linear_velocity, angular_velocity):
    """Return the bodies `index`, whose surface is `towards` gaps along the normal."""
    center = position[:, index]
    surface = contacts.point + towards * contacts.separation * contacts.normal
    is_round = contacts.feature == ROUND
    if is_round.any():
        is_round &= np.array([bodies.kinds[body] == 'sphere' for body in index])
    return _Side(center, linear_velocity[:, index], angular_velocity[:, index],
                 np.where(is_round, center, surface), is_round,
                 np.where(is_round, bodies.bounding_radius[index], 0.0))


def _normal_rate(contacts, bodies, a, b, slip, between):
    """Return dn/dt [1/s], (3, k)."""
    normal = contacts.normal
    with_a = (contacts.feature == FACE_A) | (b.is_round & ~a.is_round)
    spin = np.where(with_a, a.spin, b.spin)
    rate = cross(spin, normal)
    crossing = np.flatnonzero(contacts.feature == EDGES)
    if len(crossing):
        rate[:, crossing] = product_rate(*(values[:, crossing] for values in (
            contacts.edge_a, contacts.edge_b, normal, a.spin, b.spin)))
    curved = np.flatnonzero(_curved(contacts, bodies, a, b))
    if len(curved):
        normal, between, spin = normal[:, curved], between[:, curved], spin[:, curved]
        # seen from the body with the edge or vertex, the sphere's centre goes around it
        around = slip[:, curved] - cross(spin, between)
        around -= normal * dot(normal, around)
        edge = contacts.edge_a[:, curved] + contacts.edge_b[:, curved]
        around -= edge * dot(edge, around)
        rate[:, curved] += around / dot(normal, between)
    return rate


def _curved(contacts, bodies, a, b):
    """Return where, (k,) bool, a sphere meets an edge, a vertex or a sphere."""
    is_round = contacts.feature == ROUND
    if not is_round.any():
        return is_round
    on_edge = (contacts.edge_a + contacts.edge_b).any(axis=0)
    on_vertex = np.zeros_like(is_round)
    for side, index in ((a, contacts.body_a), (b, contacts.body_b)):
        # only vertices are as far from the centre as the bounding radius
        reach = np.sqrt(dot(side.arm(), side.arm()))
        on_vertex |= reach > (1 - 1e-9) * bodies.bounding_radius[index]
    return is_round & (on_edge | on_vertex | (a.is_round & b.is_round))


def _contact_point_velocity(contacts, a, b, slip, rate):
    """Return the velocity [m/s], (3, k), of the contact point: of what defines where it is."""
    follow = np.where(contacts.feature == FACE_A, b.point_velocity(), a.point_velocity())
    along = _along(contacts.edge_a, contacts.edge_b, slip)
    follow += np.where(contacts.feature == EDGES, along, 0.0) * contacts.edge_a
    follow = np.where(a.is_round, a.velocity + a.radius * rate, follow)
    return np.where(b.is_round, b.velocity - b.radius * rate, follow)
