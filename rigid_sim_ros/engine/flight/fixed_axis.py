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

Which bodies do is in `staying_axes`. The angle is a polynomial of time, and with the axis e

    q(t) = exp(e angle / 2) q(0) = cos(angle / 2) q(0) + sin(angle / 2) (e q(0)),

two products a component. q(0) and e q(0) are orthogonal unit vectors in four dimensions, so the
length stays 1 to rounding at any time.
"""

from math import cos, sin

import numpy as np

from rigid_sim_ros.engine.flight.functions import cosine_and_sine, MANY
from rigid_sim_ros.engine.flight.packed_columns import columns_of
from rigid_sim_ros.engine.flight.plain_rotation import product


COSINE, SINE, HALF_RATE, QUARTER_GROWTH, RATE, GROWTH = (
    slice(0, 4), slice(4, 8), 8, 9, slice(10, 13), slice(13, 16))
"""Rows of the table; what the cosine and the sine of the half angle multiply come first."""


BLOCK = 16384
"""
Poses evaluated at a time: what they need then stays in the processor's cache. Parts that fit the
cache of a core cost more in calls of NumPy than they gain: 4096 at a time take a third longer.
"""

ROUNDING = 1 + 1e-12
"""What bounds are multiplied by, so that they also hold for what is computed."""


class FixedAxisRotations:
    """Rotations about axes that stay; one column a body, all at rest at first."""

    def __init__(self, body_count):
        """Make a table of bodies at rest, with the identity as orientation."""
        table = np.zeros((16, body_count))
        table[3] = 1.0
        self.__setstate__((table, False))

    def __getstate__(self):
        """Return what a copy is made of."""
        return self._table, self._grows

    def __setstate__(self, state):
        """Be a copy: rows are to be views of its own table."""
        self._table, self._grows = state
        self._all = tuple(self._table[rows] for rows in (
            COSINE, SINE, HALF_RATE, QUARTER_GROWTH))
        self._scratch = np.empty(6 * BLOCK)
        self._steady = None

    def begin_one(self, body, quaternion, rate, motion):
        """Start one rotation in plain floats; `motion` is what `staying_axis` returns."""
        self._steady = None
        axis, speed, growth = motion
        self._table[:, body] = (
            *quaternion, *product((*axis, 0.0), quaternion), 0.5 * speed, 0.25 * growth,
            *rate, *(growth * component for component in axis))
        self._grows = self._grows or growth != 0

    def begin(self, bodies, quaternion, rate, axis, speed, growth):
        """Start rotations of bodies (k,) with what `staying_axes` returns for them."""
        self._steady = None
        self._table[COSINE, bodies] = quaternion
        self._table[SINE, bodies] = product((*axis, 0.0), quaternion)
        self._table[HALF_RATE, bodies] = 0.5 * speed
        self._table[QUARTER_GROWTH, bodies] = 0.25 * growth
        self._table[RATE, bodies] = rate
        self._table[GROWTH, bodies] = growth * axis
        self._grows = self._grows or bool(growth.any())

    def hold(self, bodies, quaternion, rate):
        """Let bodies (k,) have orientations (4, k) and rates (3, k) that do not change."""
        self._steady = None
        self._table[:, bodies] = 0.0
        self._table[COSINE, bodies] = quaternion
        self._table[RATE, bodies] = rate

    def orientations(self, elapsed, indices, out):
        """
        Write the quaternions of bodies (k,), a slice or None for all, to `out` (4, k).

        Or of all at several times, elapsed (K, 1, n), to `out` (K, 4, n): the same to the bit.
        """
        if indices is None:
            along, across, half_rate, quarter_growth = self._all
        else:
            table = columns_of(self._table, indices)
            along, across, half_rate, quarter_growth = (
                table[COSINE], table[SINE], table[HALF_RATE], table[QUARTER_GROWTH])
        half_angle = half_rate * elapsed
        if self._grows:
            half_angle += quarter_growth * elapsed * elapsed
        if half_angle.shape[-1] < MANY:
            np.multiply(along, np.cos(half_angle), out=out)
            out += across * np.sin(half_angle)
            return
        waves, product = self._scratch_like(half_angle, out)
        cosine_and_sine(half_angle, waves)
        np.multiply(along, waves[0], out=out)
        np.multiply(across, waves[1], out=product)
        out += product

    def _scratch_like(self, angle, out):
        """Return room for the cosine and the sine of the angles, and one like `out`."""
        waves, size = 2 * angle.size, 6 * angle.size
        # bodies may be listed twice, so there may be more than there are
        scratch = self._scratch if size <= 6 * BLOCK else np.empty(size)
        return (scratch[:waves].reshape(2, *angle.shape),
                scratch[waves:size].reshape(out.shape))

    def rates(self, elapsed, indices):
        """
        Return the rates [rad/s] of bodies (k,), None for all, in world axes, (3, k).

        Those of all, while they stay the same, are one array that cannot be written.
        """
        table = self._table if indices is None else columns_of(self._table, indices)
        if self._grows:
            return table[GROWTH] * elapsed + table[RATE]
        if indices is not None:
            return table[RATE].copy()
        if self._steady is None:
            self._steady = table[RATE].copy()
            self._steady.setflags(write=False)
        return self._steady

    def trajectory(self, body):
        """Return quaternion and rate of one body as a function of the time since its start."""
        (a, b, c, d, e, f, g, h, half_rate, quarter_growth,
         x, y, z, u, v, w) = self._table[:, body].tolist()

        def motion(elapsed):
            half_angle = elapsed * (half_rate + elapsed * quarter_growth)
            p, q = cos(half_angle), sin(half_angle)
            return ((p * a + q * e, p * b + q * f, p * c + q * g, p * d + q * h),
                    (x + elapsed * u, y + elapsed * v, z + elapsed * w))
        return motion

    def bounds_of_one(self, body, start, end):
        """Return `bounds` of one body in plain floats."""
        speed = ROUNDING * 2 * self._table.item(HALF_RATE, body)
        growth = ROUNDING * 4 * self._table.item(QUARTER_GROWTH, body)
        if growth == 0:
            return abs(speed), 0.0
        return max(abs(speed + growth * max(start, 0.0)), abs(speed + growth * end)), abs(growth)

    def bounds(self, indices, start, end):
        """
        Return the largest |w| [rad/s] and |dw/dt| [rad/s^2], (k,) each, of bodies (k,).

        Between `start` and `end` (k,), times [s] since the bodies' own starts.
        """
        speed = (2 * ROUNDING) * self._table[HALF_RATE, indices]
        if not self._grows:
            return np.abs(speed, out=speed), np.zeros(len(speed))
        growth = (4 * ROUNDING) * self._table[QUARTER_GROWTH, indices]
        # without growth, 0 times an infinite end is to be 0
        end = np.where(growth == 0, 0.0, end)
        # the rate about the axis is linear, so its size is largest at an end
        return np.maximum(abs(speed + growth * np.maximum(start, 0.0)),
                          abs(speed + growth * end)), abs(growth)
