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
The attitude of a turning rigid body to 30 digits and more.

Taylor series of the quaternion q, the rate w and the torque g, both in body axes,

    q' = q w / 2,    w1' = ((I2 - I3) w2 w3 + g1) / I1 and so on,    g' = g x w,

for a torque that is constant in world axes. Numbers are integers, scaled by 2^128: Python's
integers are exact and several times faster than a multiple-precision library, and nothing
overflows as every coefficient is taken times the stride's power. Works for any inertia and any
torque, near unstable axes too, where double precision loses eight digits.
"""

from fractions import Fraction
from functools import lru_cache
from math import ceil, hypot, sqrt
from operator import mul

SCALE_BITS = 128
ONE = 1 << SCALE_BITS

TERMS = 28
"""Of the series: 50 terms and half the stride give the same to 1e-27 after 10 s of tumbling."""

STRIDE_ANGLE = 0.75
"""Largest turn [rad] in a stride, at a bound of the rate that motion can reach."""


@lru_cache(maxsize=64)
def attitudes(inertia, rate, times, torque=(0.0, 0.0, 0.0)):
    """
    Return orientations x, y, z, w, a tuple of tuples, at increasing times [s].

    The body has these principal moments [kg m^2] and starts unturned, so that the rate [rad/s] is
    in body and in world axes; the torque [N m] is in world axes. All arguments are tuples of
    floats (or of `Fraction`s, as torque / inertia might not be a float), taken exactly.
    """
    moments = [Fraction(moment) for moment in inertia]
    inverse = [_fixed(1 / moment) for moment in moments]
    coupling = [_fixed((moments[(i + 1) % 3] - moments[(i + 2) % 3]) / moments[i])
                for i in range(3)]
    state = ([ONE, 0, 0, 0], [_fixed(Fraction(component)) for component in rate],
             [_fixed(Fraction(component)) for component in torque])
    result = []
    now = Fraction(0)
    for time in times:
        span = Fraction(time) - now
        count = max(1, ceil(float(span) * _largest_rate(inertia, rate, torque, time)
                            / STRIDE_ANGLE))
        for _ in range(count):
            state = _stride(state, inverse, coupling, _fixed(span / count), any(torque))
        now = Fraction(time)
        w, x, y, z = (component / ONE for component in state[0])
        result.append((x, y, z, w))
    return tuple(result)


def _fixed(value):
    """Return a number as an integer multiple of 2^-128."""
    return round(value * ONE)


def _largest_rate(inertia, rate, torque, time):
    """Return a bound [rad/s] of the rate up to a time [s], from energy or from |L0| + |g| t."""
    moments, rates = list(map(float, inertia)), list(map(float, rate))
    if not any(torque):
        return sqrt(sum(i * w * w for i, w in zip(moments, rates)) / min(moments))
    momentum = hypot(*(i * w for i, w in zip(moments, rates)))
    return (momentum + hypot(*map(float, torque)) * float(time)) / min(moments)


def _product(a, b):
    """Return the newest coefficient of the product of two series of equal length."""
    return sum(map(mul, a, reversed(b))) >> SCALE_BITS


def _stride(state, inverse, coupling, span, with_torque):
    """Return the state one stride later; the span is its length, scaled."""
    q, w, g = ([[value] for value in part] for part in state)
    for k in range(TERMS):
        w_rates = [_product(w[(i + 1) % 3], w[(i + 2) % 3]) * coupling[i] >> SCALE_BITS
                   for i in range(3)]
        rates = [*zip(q, _quaternion_rates(q, w))]
        if with_torque:
            w_rates = [value + (torque[-1] * factor >> SCALE_BITS)
                       for value, torque, factor in zip(w_rates, g, inverse)]
            rates += zip(g, _cross(g, w))
        for series, value in (*rates, *zip(w, w_rates)):
            series.append((value * span >> SCALE_BITS) // (k + 1))
    return tuple([sum(series) for series in part] for part in (q, w, g))


def _cross(a, w):
    """Return the newest coefficients of a x w."""
    return [_product(a[(i + 1) % 3], w[(i + 2) % 3]) - _product(a[(i + 2) % 3], w[(i + 1) % 3])
            for i in range(3)]


def _quaternion_rates(q, w):
    """Return the newest coefficients of q w / 2, scalar first."""
    a, b, c, d = q
    x, y, z = w
    return [(-_product(b, x) - _product(c, y) - _product(d, z)) >> 1,
            (_product(a, x) + _product(c, z) - _product(d, y)) >> 1,
            (_product(a, y) + _product(d, x) - _product(b, z)) >> 1,
            (_product(a, z) + _product(b, y) - _product(c, x)) >> 1]
