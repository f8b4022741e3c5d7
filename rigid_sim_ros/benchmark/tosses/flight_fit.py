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
The start of a toss, fitted to its flight: a ballistic arc and a turn at a constant rate.

A cube turns at a constant rate about a fixed axis while nothing touches it, so position and
attitude of all samples in flight follow from the start's; the fit averages their noise.
"""

from dataclasses import dataclass

import numpy as np

CLEARANCE = 0.002
"""[m]. Samples with all corners higher than this are flight: the noise of the board's height."""

ROUNDS = 8
"""Of Gauss and Newton; the turn between two samples, where it starts, is a small angle."""


@dataclass(frozen=True)
class Start:
    """Where a toss starts, and how it moves there."""

    position: np.ndarray
    """(3,) [m]"""

    orientation: np.ndarray
    """(4,) x, y, z, w"""

    velocity: np.ndarray
    """(3,) [m/s]"""

    spin: np.ndarray
    """(3,) [rad/s], world axes"""


def fitted_start(toss):
    """Return the `Start` of a toss that fits its flight best, by least squares."""
    count = flight_sample_count(toss)
    times = toss.times[:count]
    fall = np.outer(times ** 2, (0.0, 0.0, -toss.gravity / 2))
    arc = np.stack((np.ones(count), times), axis=1)
    position, velocity = np.linalg.lstsq(arc, toss.position[:count] - fall, rcond=None)[0]
    orientation, spin = fitted_turn(times, toss.orientation[:count])
    return Start(position, orientation, velocity, spin)


def flight_sample_count(toss):
    """Return how many samples at the start are flight, at least two."""
    heights = lowest_corner(toss.position, toss.orientation, toss.edge)
    touching = np.flatnonzero(heights < CLEARANCE)
    return max(2, touching[0] if touching.size else len(heights))


def lowest_corner(position, orientation, edge):
    """Return the height [m], (k,), of the lowest corner of a cube in the poses given."""
    x, y, z, w = orientation.T
    row = np.stack((2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    return position[:, 2] - edge / 2 * np.abs(row).sum(axis=0)


def fitted_turn(times, orientation):
    """Return the attitude at time zero, (4,), and the constant rate [rad/s], (3,)."""
    start = orientation[0]
    rate = rotation_vector(product(orientation[1], inverse(start))) / (times[1] - times[0])
    for _ in range(ROUNDS):
        turned = rate * times[:, None]
        expected = product(quaternion(turned), start)
        residual = rotation_vector(product(orientation, inverse(expected)))
        # left of exp(rate t) start, small turns of the rate and of the start come as J t d and R d
        by_rate = left_jacobian(turned) * times[:, None, None]
        by_start = rotation_matrix(turned)
        columns = np.concatenate((by_start, by_rate), axis=2).reshape(-1, 6)
        step = np.linalg.lstsq(columns, residual.reshape(-1), rcond=None)[0]
        start = product(quaternion(step[:3]), start)
        rate = rate + step[3:]
    return start / np.linalg.norm(start), rate


def product(p, q):
    """Return the quaternion products p q, (..., 4) x, y, z, w."""
    p, q = np.broadcast_arrays(p, q)
    vector = (p[..., 3:] * q[..., :3] + q[..., 3:] * p[..., :3]
              + np.cross(p[..., :3], q[..., :3]))
    scalar = p[..., 3:] * q[..., 3:] - (p[..., :3] * q[..., :3]).sum(axis=-1, keepdims=True)
    return np.concatenate((vector, scalar), axis=-1)


def inverse(q):
    """Return the inverse of unit quaternions."""
    return q * np.array([-1.0, -1.0, -1.0, 1.0])


def quaternion(vector):
    """Return the quaternion of rotation vectors (..., 3)."""
    half = np.linalg.norm(vector, axis=-1, keepdims=True) / 2
    return np.concatenate((vector / 2 * np.sinc(half / np.pi), np.cos(half)), axis=-1)


def rotation_vector(q):
    """Return the rotation vectors, (..., 3), of unit quaternions, of length pi at most."""
    q = np.where(q[..., 3:] < 0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, q[..., 3:])
    return q[..., :3] * np.where(sine > 0, angle / np.where(sine > 0, sine, 1.0), 2.0)


def cross_matrix(vector):
    """Return the matrices (..., 3, 3) of the vector product from the left."""
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    return np.stack((np.stack((zero, -z, y), -1), np.stack((z, zero, -x), -1),
                     np.stack((-y, x, zero), -1)), -2)


def rotation_matrix(vector):
    """Return the matrices (..., 3, 3) of rotation vectors (Rodrigues)."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    k = cross_matrix(vector)
    return np.eye(3) + np.sinc(angle / np.pi) * k + np.sinc(angle / 2 / np.pi) ** 2 / 2 * k @ k


def left_jacobian(vector):
    """Return J with exp(v + d) = exp(J d) exp(v) to first order (Chirikjian 2012, 10.86)."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    k = cross_matrix(vector)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    third = np.where(small, 1 / 6, (safe - np.sin(safe)) / safe ** 3)
    return np.eye(3) + np.sinc(angle / 2 / np.pi) ** 2 / 2 * k + third * k @ k
