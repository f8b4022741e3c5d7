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
Rotation about an axis that stays: what needs no more than a sine and a cosine.

A body turns about a fixed axis if its moments are equal and its torque is zero or along its rate,
if it starts from rest with equal moments, if it rests without torque, and if rate and torque are
both along the same principal axis. Its angle is a polynomial of time, and with the axis e

    q(t) = exp(e angle / 2) q(0) = cos(angle / 2) q(0) + sin(angle / 2) (e q(0)),

two products a component. q(0) and e q(0) are orthogonal unit vectors in four dimensions, so the
length stays 1 to rounding at any time.
"""

from math import cos, hypot, sin

import numpy as np

from rigid_sim_ros.engine.flight.plain_rotation import product, to_body


COSINE, SINE, HALF_RATE, QUARTER_GROWTH, RATE, GROWTH = (
    slice(0, 4), slice(4, 8), 8, 9, slice(10, 13), slice(13, 16))
"""Rows of the table; what the cosine and the sine of the half angle multiply come first."""


BLOCK = 8192
"""Bodies evaluated at a time: what they need then stays in a core's own cache."""

MANY = 256
"""From so many bodies on the tangent is faster than sine and cosine, measured."""

ROUNDING = 1 + 1e-12
"""What bounds are multiplied by, so that they also hold for what is computed."""


class FixedAxisRotations:
    """Rotations about axes that stay; one column a body, all at rest at first."""

    def __init__(self, body_count):
        """Make a table of bodies at rest, with the identity as orientation."""
        self._table = np.zeros((16, body_count))
        self._table[3] = 1.0
        self._grows = False
        self._all = tuple(self._table[rows] for rows in (
            COSINE, SINE, HALF_RATE, QUARTER_GROWTH))
        self._scratch = np.empty((5, min(body_count, BLOCK)))

    def begin_one(self, body, quaternion, rate, motion):
        """Start one rotation in plain floats; `motion` is what `fixed_axis` returns."""
        axis, speed, growth = motion
        self._table[:, body] = (
            *quaternion, *product((*axis, 0.0), quaternion), 0.5 * speed, 0.25 * growth,
            *rate, *(growth * component for component in axis))
        self._grows = self._grows or growth != 0

    def begin(self, bodies, quaternion, rate, axis, speed, growth):
        """Start rotations of bodies (k,) with what `fixed_axes` returns for them."""
        self._table[COSINE, bodies] = quaternion
        self._table[SINE, bodies] = product((*axis, 0.0), quaternion)
        self._table[HALF_RATE, bodies] = 0.5 * speed
        self._table[QUARTER_GROWTH, bodies] = 0.25 * growth
        self._table[RATE, bodies] = rate
        self._table[GROWTH, bodies] = growth * axis
        self._grows = self._grows or bool(growth.any())

    def orientations(self, elapsed, indices, out):
        """Write the quaternions of bodies (k,), a slice or None for all, to `out` (4, k)."""
        along, across, half_rate, quarter_growth = (
            self._all if indices is None else [part[..., indices] for part in self._all])
        half_angle = half_rate * elapsed
        if self._grows:
            half_angle += quarter_growth * elapsed * elapsed
        if not MANY <= len(elapsed) <= self._scratch.shape[1]:  # bodies may come twice
            np.multiply(along, np.cos(half_angle), out=out)
            out += across * np.sin(half_angle)
        else:
            self._orientations_of_many(along, across, half_angle, out)

    def rates(self, elapsed, indices):
        """Return the rates [rad/s] of bodies (k,), None for all, in world axes, (3, k)."""
        table = self._table if indices is None else self._table[:, indices]
        if self._grows:
            return table[GROWTH] * elapsed + table[RATE]
        return table[RATE].copy()

    def orientations_of_one(self, body, elapsed):
        """Return the quaternions of one body so long (K,) after its start, (4, K)."""
        column = self._table[:, body, None]
        half_angle = elapsed * (column[HALF_RATE] + elapsed * column[QUARTER_GROWTH])
        return column[COSINE] * np.cos(half_angle) + column[SINE] * np.sin(half_angle)

    def motion_of_one(self, body, elapsed):
        """Return quaternion and rate of one body in plain floats."""
        (a, b, c, d, e, f, g, h, half_rate, quarter_growth,
         x, y, z, u, v, w) = self._table[:, body].tolist()
        half_angle = elapsed * (half_rate + elapsed * quarter_growth)
        p, q = cos(half_angle), sin(half_angle)
        return ((p * a + q * e, p * b + q * f, p * c + q * g, p * d + q * h),
                (x + elapsed * u, y + elapsed * v, z + elapsed * w))

    def rate_bounds(self, indices, start, end):
        """Return the largest |w| [rad/s] of bodies (k,) so long (k,) after their starts."""
        speed = 2 * self._table[HALF_RATE, indices]
        if not self._grows:
            return np.abs(speed) * ROUNDING
        # without growth, 0 times an infinite end is to be 0
        growth = 4 * self._table[QUARTER_GROWTH, indices]
        end = np.where(growth == 0, 0.0, end)
        # the rate about the axis is linear, so its size is largest at an end
        bound = np.maximum(np.abs(speed + growth * start), np.abs(speed + growth * end))
        return bound * ROUNDING

    def rate_derivative_bounds(self, indices):
        """Return |dw/dt| [rad/s^2] of bodies (k,), (k,)."""
        return np.abs(4 * ROUNDING * self._table[QUARTER_GROWTH, indices])

    def _orientations_of_many(self, along, across, half_angle, out):
        """
        Write along cos(half_angle) + across sin(half_angle) to `out` (4, k), k up to `BLOCK`.

        From t = tan(half_angle / 2) as 2 / (1 + t^2) - 1 and 2 t / (1 + t^2), both to two units
        of rounding: NumPy's tangent is ten times faster than its sine, measured.
        """
        tangent = half_angle
        tangent *= 0.5
        np.tan(tangent, out=tangent)
        cosine, product = self._scratch[0, :len(tangent)], self._scratch[1:5, :len(tangent)]
        np.multiply(tangent, tangent, out=cosine)
        cosine += 1.0
        np.divide(2.0, cosine, out=cosine)
        tangent *= cosine
        cosine -= 1.0
        np.multiply(along, cosine, out=out)
        np.multiply(across, tangent, out=product)
        out += product


def fixed_axis(moments, quaternion, rate, torque):
    """
    Return (axis, speed, growth), or None if the axis does not stay.

    One body in plain floats: principal moments (3,), unit quaternion, rate [rad/s] and torque
    (3,) in world axes. `axis` is a unit vector in world axes, `speed` the rate about it and
    `growth` the change of that rate [rad/s^2], which may be negative.
    """
    if not any(rate) and not any(torque):
        return (0.0, 0.0, 1.0), 0.0, 0.0
    moment = moments[0]
    if moments[1] != moment or moments[2] != moment:
        moment = _principal_moment(moments, quaternion, rate, torque)
    elif any(torque) and not _parallel(rate, torque):
        moment = None
    if moment is None:
        return None
    direction = rate if any(rate) else torque
    length = hypot(*direction)
    axis = tuple(component / length for component in direction)
    speed = length if direction is rate else 0.0
    growth = (axis[0] * torque[0] + axis[1] * torque[1] + axis[2] * torque[2]) / moment
    return axis, speed, growth


def fixed_axes(moments, quaternion, rate, torque):
    """
    Return (axis (3, k), speed (k,), growth (k,), stays (k,) bool) of k bodies.

    As `fixed_axis`, for arrays (3, k) and (4, k); where the axis does not stay the rest is
    finite and means nothing.
    """
    isotropic = (moments[0] == moments[1]) & (moments[0] == moments[2])
    turning, driven = rate.any(axis=0), torque.any(axis=0)
    stays = isotropic & (~driven | _parallel(rate, torque)) | ~(turning | driven)
    moment = moments[0].copy()
    for column in np.flatnonzero(~isotropic & (turning | driven)).tolist():
        principal = _principal_moment(*(values[:, column].tolist() for values in
                                        (moments, quaternion, rate, torque)))
        if principal is not None:
            stays[column] = True
            moment[column] = principal
    direction = np.where(turning, rate, torque)
    length = np.hypot(np.hypot(direction[0], direction[1]), direction[2])
    axis = direction / np.where(length > 0, length, 1.0)
    growth = (axis[0] * torque[0] + axis[1] * torque[1] + axis[2] * torque[2]) / moment
    return axis, np.where(turning, length, 0.0), growth, stays


def _principal_moment(moments, quaternion, rate, torque):
    """Return the moment about the principal axis that rate and torque share, or None."""
    rate = to_body(quaternion, rate)
    torque = to_body(quaternion, torque)
    axes = [axis for axis in range(3) if rate[axis] or torque[axis]]
    return moments[axes[0]] if len(axes) == 1 else None


def _parallel(rate, torque):
    """Return whether the torques are along the rates to the last digit; zero rates count."""
    largest_rate = np.abs(rate).max(axis=0)
    largest_torque = np.abs(torque).max(axis=0)
    # by their own size and not by products, which underflow for tiny rates
    rate = rate / np.where(largest_rate > 0, largest_rate, 1.0)
    torque = torque / np.where(largest_torque > 0, largest_torque, 1.0)
    return (largest_rate == 0) | (rate == torque).all(axis=0) | (rate == -torque).all(axis=0)
