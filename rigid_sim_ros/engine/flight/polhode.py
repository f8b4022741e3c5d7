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
The path of the angular momentum over a free body.

Along the axes of `polhode_axes`, in units of its size and with u growing uniformly,

    m1 = A1 cn u,  m2 = sign A2 sn u,  m3 = A3 dn u,   A1^2 + A3^2 = 1, A2^2 = A1^2 / f2.

(Jacobi 1850; DLMF chapter 22). Nothing divides by m1^2 + m2^2, so rotation about axis 3 is an
ordinary point, as are symmetric tops and the separatrix. Written for floats and arrays alike.
"""

from dataclasses import dataclass, fields

import numpy as np

from rigid_sim_ros.engine.flight.elliptic import carlson_rf
from rigid_sim_ros.engine.flight.functions import ARRAYS, FLOATS
from rigid_sim_ros.engine.flight.polhode_axes import axes_of_many, axes_of_one


@dataclass
class Polhode:
    """What sets the motion; floats and tuples, or arrays with one element a body last."""

    order: tuple
    """Body axis of each axis 1, 2, 3, (3,)."""

    axes: tuple
    """Quaternion from axes 1, 2, 3 to the body's, (4,)."""

    signs: tuple
    """Signs of axes 1 and 3 in the body, (2,)."""

    sign: float
    """+1 if moment 3 is the largest, else -1."""

    momentum: float
    """|L| [kg m^2/s]."""

    moments: tuple
    """Moments about axes 1, 2, 3 [kg m^2]."""

    f1: float
    f2: float
    """(1/I1 - 1/I2) and (1/I2 - 1/I3) over (1/I1 - 1/I3); they add to 1."""

    amplitude1: float
    amplitude3: float
    """A1 and A3 above."""

    square: float
    complementary: float
    """k^2 and k'^2 = 1 - k^2 of the Jacobi functions, each to full relative accuracy."""

    speed: float
    """du/dt [1/s]."""

    phase: float
    """The integral of the first kind at (|cn u|, sn u) at the start: u itself if cn u >= 0."""

    backward: bool
    """Whether cn u is negative at the start, where u = 2 K - phase."""

    twist: float
    """Half the rate [rad/s] of twist about the momentum at u = 0."""

    def chosen(self, mask):
        """Return the polhodes where `mask` (k,) is true, of arrays."""
        return Polhode(*(np.asarray(getattr(self, field.name))[..., mask]
                         for field in fields(self)))

    def body_rates(self, functions):
        """Return the matrix (3, 3), as a list of 9, from the unit momentum to the body rate."""
        scales = [self.momentum / moment for moment in self.moments]
        scales[0], scales[2] = self.signs[0] * scales[0], self.signs[1] * scales[2]
        return [functions.where(self.order[column] == row, scales[column], 0.0)
                for row in range(3) for column in range(3)]

    def rate_bounds(self, functions):
        """
        Return the largest |w| [rad/s] and |dw/dt| [rad/s^2] on the whole polhode.

        The squares of the rates are linear in x = sn^2 u, so |w|^2 is largest at an end of
        0 <= x <= 1; and |dw/dt|^2, by Euler's equations a sum of products of two of them, is a
        quadratic, largest at an end or at its vertex.
        """
        i1, i2, i3 = self.moments
        a, b, c = 1 / i1 ** 2, 1 / i2 ** 2, 1 / i3 ** 2
        middle = functions.minimum(self.amplitude1 ** 2 / self.f2, 1.0)
        # squares of the rates over |L|: u at x = 0 with slopes v; the second is v2 x
        u1, u3 = a * self.amplitude1 ** 2, c * self.amplitude3 ** 2
        v1, v2, v3 = -u1, b * middle, -c * self.f1 * middle
        rate = functions.sqrt(u1 + u3 + functions.maximum(v1 + v2 + v3, 0.0))
        p, q, r = ((i2 - i3) / i1) ** 2, ((i3 - i1) / i2) ** 2, ((i1 - i2) / i3) ** 2
        zeroth = q * u1 * u3
        first = p * v2 * u3 + q * (u3 * v1 + v3 * u1) + r * u1 * v2
        second = p * v2 * v3 + q * v3 * v1 + r * v1 * v2
        # the vertex is a maximum, and inside, only where the slope falls through zero
        inside = functions.where(first * (first + 2 * second) < 0, -0.5 * first, 0.0)
        vertex = inside / functions.where(second < 0, second, 1.0)
        largest = functions.maximum(functions.where(
            second < 0, zeroth + vertex * (first + vertex * second), 0.0),
            functions.maximum(zeroth, zeroth + first + second))
        return self.momentum * rate, self.momentum * self.momentum * functions.sqrt(largest)


def polhode_of_one(moments, rate):
    """Return the `Polhode` of one body from its moments and body rates (3,), plain floats."""
    axes, momentum, direction = axes_of_one(moments, rate)
    return _polhode(FLOATS, axes, momentum, [moments[axis] for axis in axes[0]], direction)


def polhode_of_many(moments, rate):
    """Return the `Polhode` of k bodies from arrays (3, k)."""
    axes, momentum, direction = axes_of_many(moments, rate)
    return _polhode(ARRAYS, axes, momentum, np.take_along_axis(moments, axes[0], axis=0),
                    direction)


def _polhode(functions, axes, momentum, moments, direction):
    """
    Return the `Polhode` of a momentum in a direction (3,) along the axes 1, 2, 3.

    k^2 and k'^2 come from the components, k'^2 = (f2 m3^2 - f1 m1^2) / (f2 A3^2), so that near
    the separatrix neither is a difference from 1.
    """
    order, quaternion, signs, sign = axes
    i1, i2, i3 = moments
    m1, m2, m3 = direction
    spread = abs(i3 - i1) / (i1 * i3)
    f1 = abs(i2 - i1) / (i1 * i2) / spread
    f2 = abs(i3 - i2) / (i2 * i3) / spread
    across = functions.sqrt(f2) * m2
    amplitude1 = functions.hypot(m1, across)
    amplitude3 = functions.hypot(m3, functions.sqrt(f1) * m2)
    denominator = f2 * amplitude3 * amplitude3
    degenerate = denominator == 0
    denominator = functions.where(degenerate, 1.0, denominator)
    square = functions.where(degenerate, 0.0, f1 * amplitude1 * amplitude1 / denominator)
    complementary = functions.where(
        degenerate, 1.0, (f2 * m3 * m3 - f1 * m1 * m1) / denominator)
    square = functions.minimum(functions.maximum(square, 0.0), 1.0)
    complementary = functions.minimum(functions.maximum(complementary, 0.0), 1.0)
    on_axis = amplitude1 == 0
    divisor = functions.where(on_axis, 1.0, amplitude1)
    sn = sign * across / divisor
    cn = functions.where(on_axis, 1.0, m1 / divisor)
    phase = sn * carlson_rf(functions, cn * cn, cn * cn + complementary * sn * sn)
    # 1 / i3 + sign spread (1 - A3), written without cancellation: thin rods have a huge spread
    twist = functions.where(sign > 0, 1 / i3 + spread * amplitude1 ** 2 / (1 + amplitude3),
                            1 / i1 + spread * amplitude3)
    return Polhode(
        order=order, axes=quaternion, signs=signs, sign=sign, momentum=momentum,
        moments=moments, f1=f1, f2=f2, amplitude1=amplitude1, amplitude3=amplitude3,
        square=square, complementary=complementary,
        speed=momentum * amplitude3 * spread * functions.sqrt(f2), phase=phase, backward=cn < 0,
        twist=0.5 * momentum * twist)
