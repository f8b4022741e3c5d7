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
What a pair of surfaces does: the mixing rules of materials, and Coulomb's friction disc.

Every other module asks here, so that a rule of the pair is stated once.
"""

from math import copysign, inf

import numpy as np


_NO_SPEED = 1e-270
"""[m/s]: added where a speed is divided by that may be zero; what is fast does not overflow."""


def mixed_restitution(bodies, body_a, body_b, speed=inf):
    """
    Return the restitution of pairs (k,) of columns that approach at speeds (k,) [m/s].

    It is the larger of the two surfaces' own at that speed, see `model.Material`.
    """
    with_a, with_b = (
        bodies.restitution[body] * np.clip(
            speed / (bodies.restitution_speed[body] + _NO_SPEED), 0.0, 1.0)
        for body in (body_a, body_b))
    return np.maximum(with_a, with_b)


def surfaces_of(bodies, *indices):
    """Return (restitution, its speed) of each body, as `restitution_of_one` takes them."""
    return [(bodies.restitution.item(index), bodies.restitution_speed.item(index))
            for index in indices]


def restitution_of_one(surfaces, speed):
    """Return `mixed_restitution` of one pair in plain floats, for a positive speed [m/s]."""
    return max(restitution if speed >= full else restitution * speed / full
               for restitution, full in surfaces)


def mixed_friction(friction_a, friction_b):
    """Return the friction coefficient of a pair, or of (k,) pairs: the geometric mean."""
    return np.sqrt(friction_a * friction_b)


def tangents(normal):
    """
    Return two unit vectors, (3, k) each, that complete unit normals (3, k) to right-handed bases.

    Duff et al. 2017, 'Building an orthonormal basis, revisited', Journal of Computer Graphics
    Techniques 6(1): no branch, and no loss of digits for any direction.
    """
    x, y, z = normal
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return (np.stack((1.0 + sign * x * x * a, sign * b, -sign * x)),
            np.stack((b, sign + y * y * a, -y)))


def tangents_of_one(x, y, z):
    """Return `tangents` of one unit normal, as tuples of plain floats."""
    sign = copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return (1.0 + sign * x * x * a, sign * b, -sign * x), (b, sign + y * y * a, -y)


def project_on_disc(first, second, radius):
    """Return two components, each (k,), drawn back radially to discs of `radius` (k,) >= 0."""
    length = np.sqrt(first * first + second * second)
    # where the length is within the radius the factor is 1, also for 0 / 0
    factor = np.minimum(1.0, radius / np.maximum(length, np.finfo(float).tiny))
    return first * factor, second * factor
