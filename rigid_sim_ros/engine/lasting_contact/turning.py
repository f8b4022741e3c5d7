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
"""How bodies of unequal moments turn in a step, to fourth order."""

from math import ceil, sqrt

import numpy as np

from rigid_sim_ros.engine import rotation

STRIDE = 0.05
"""Angle [rad] turned in one go: then a stride loses less than 1e-9 of the energy."""

_NODES = 0.5 - sqrt(3.0) / 6.0, 0.5 + sqrt(3.0) / 6.0


def turned(orientation, rate, inertia, inverse_inertia, torque, time):
    """
    Return the attitudes (4, n) after a time [s] without contact.

    The exponential of a Magnus series, from the body rates at the two nodes of Gauss (Iserles,
    Munthe-Kaas, Norsett and Zanna 2000, 'Lie-group methods', section 5). The rates are Taylor
    series of Euler's equations; the angular momentum is followed in world axes, to rounding.

    Parameters
    ----------
    orientation : (4, n)
        At the start.
    rate : (3, n) [rad/s]
        At the start, world axes.
    inertia, inverse_inertia : (3, n)
        Principal moments [kg m^2]; the inverse is zero of what does not turn.
    torque : (3, n) [N m]
        Held, world axes.
    time : float
        [s]

    """
    fastest = float(np.abs(rate).max(initial=0.0))
    count = max(1, ceil(sqrt(3.0) * fastest * time / STRIDE))
    stride = time / count
    momentum = _to_world(orientation, inertia * _to_body(orientation, rate))
    pull = None
    for number in range(count):
        here = momentum + number * stride * torque
        body_rate = inverse_inertia * _to_body(orientation, here)
        if torque.any():
            pull = _to_body(orientation, torque)
        series = _derivatives(body_rate, inertia, inverse_inertia, pull)
        first, second = (body_rate + _polynomial(series, node * stride) for node in _NODES)
        vector = 0.5 * stride * (first + second) + (
            sqrt(3.0) / 12.0 * stride * stride) * rotation.cross(first, second)
        orientation = rotation.normalize(rotation.multiply(
            orientation, rotation.from_rotation_vector(vector)))
    return orientation


def _derivatives(rate, inertia, inverse_inertia, torque):
    """
    Return the first three derivatives (3, n) of body rates (3, n).

    Torques (3, n) are in body axes, or None.
    """
    cross = rotation.cross
    spin = inertia * rate
    first_change = cross(spin, rate)
    if torque is not None:
        first_change += torque
    first = inverse_inertia * first_change
    second_change = cross(first_change, rate) + cross(spin, first)
    if torque is not None:
        pull = -cross(rate, torque)
        second_change += pull
    second = inverse_inertia * second_change
    third_change = (cross(second_change, rate) + 2.0 * cross(first_change, first)
                    + cross(spin, second))
    if torque is not None:
        third_change -= cross(first, torque) + cross(rate, pull)
    return first, second, inverse_inertia * third_change


def _polynomial(series, time):
    """Return what three derivatives add to a vector in a time [s]."""
    first, second, third = series
    return time * (first + time * (second / 2.0 + time * (third / 6.0)))


def _to_body(orientation, vectors):
    return rotation.rotate(rotation.conjugate(orientation), vectors)


def _to_world(orientation, vectors):
    return rotation.rotate(orientation, vectors)
