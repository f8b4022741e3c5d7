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
A free rotation as sums over multiples of a uniformly growing angle: k'^2 of at least 0.03.

The attitude in the frame of the momentum is a swing, the shortest turn of the momentum's direction
in the body onto axis 3, and then a twist phi about it, whose rate is bounded and smooth:

    phi' = L / I3 + (2 T / L - L / I3) / (1 + m3).

Solved, the pair (a, b) = (w + i z, x + i y) of the quaternion x, y, z, w is two theta functions,

    a ~ e^(i turn t) theta4(zeta - i sign eta | Q)
    b ~ sign e^(i turn t) theta1(zeta - i sign eta | Q),

where zeta grows uniformly and Q is the square of the nome s of the modulus k; dividing by
sqrt(|a|^2 + |b|^2) removes their common factor. R. van Zon and J. Schofield, Numerical
implementation of the exact dynamics of free rigid bodies, J. Comput. Phys. 225 (2007), compute the
rates by Jacobi functions and the twist by a sum of its own; here both come from the two series,
with no elliptic integral of the third kind, and length and momentum hold to rounding.
With g = s^(1/2) e^eta and v = s / g the series (DLMF 20.2) are, n from 0 or 1 to 3,

    a = 1 + sum (-1)^n [(P_n + R_n) cos 2n zeta + i sign (P_n - R_n) sin 2n zeta]
    b = sum (-1)^n [sign (B_n + C_n) sin (2n+1) zeta - i (B_n - C_n) cos (2n+1) zeta]

    P_n = s^(2n^2 - n) g^2n,    B_n = s^(2n^2 + n) g^(2n + 1),    R_n, C_n the same with v.
"""

from math import cos, pi, sin

import numpy as np

from rigid_sim_ros.engine.flight.elliptic import nome, quarter_period
from rigid_sim_ros.engine.flight.functions import cosine_and_sine
from rigid_sim_ros.engine.flight.multiple_angles import (
    even_cosines, even_sines, interleaved, odd_cosines, odd_sines, values_of_cubics)

ROW_COUNT = 19
"""Angle at the start, its rate, twist rate, then four interleaved cubics, see `pair`."""

SMALLEST_FACTOR = 1e-100
"""What g is at least: spin exactly about the axis of a symmetric top has g = 0."""

NEWTON_ROUNDS = 4


def rows(functions, polhode):
    """Return the constants of the motion, a list of `ROW_COUNT` floats or arrays."""
    sign = polhode.sign
    s = nome(functions, polhode.square, polhode.complementary)
    period = quarter_period(s)
    start = functions.where(
        polhode.backward,
        functions.where(polhode.phase < 0, -2 * period, 2 * period) - polhode.phase,
        polhode.phase)
    rate = pi / (2 * period) * polhode.speed
    g, v = _factor(functions, s, polhode.amplitude1 / (1 + polhode.amplitude3))
    s3, s6, s10, s15 = s ** 3, s ** 6, s ** 10, s ** 15
    p = (s * g ** 2, s6 * g ** 4, s15 * g ** 6)
    r = (s * v ** 2, s6 * v ** 4, s15 * v ** 6)
    b = (g, s3 * g ** 3, s10 * g ** 5, s15 * s6 * g ** 7)
    c = (v, s3 * v ** 3, s10 * v ** 5, s15 * s6 * v ** 7)
    # twist rate: the logarithmic derivative of theta4 at -i sign eta takes the place of Pi
    slope = -2 * (p[0] - r[0]) + 4 * (p[1] - r[1]) - 6 * (p[2] - r[2])
    value = 1 - (p[0] + r[0]) + (p[1] + r[1]) - (p[2] + r[2])
    turn = polhode.twist - sign * rate * slope / value
    return [
        pi / (2 * period) * start, rate, turn,
        *interleaved(
            even_cosines(-(p[0] + r[0]), p[1] + r[1], -(p[2] + r[2])),
            even_sines(sign * (r[0] - p[0]), sign * (p[1] - r[1]), sign * (r[2] - p[2])),
            odd_sines(sign * (b[0] + c[0]), -sign * (b[1] + c[1]), sign * (b[2] + c[2]),
                      -sign * (b[3] + c[3])),
            odd_cosines(c[0] - b[0], b[1] - c[1], c[2] - b[2], b[3] - c[3]))]


def pair(rows, elapsed):
    """
    Return (Re a, Im a, Re b, Im b, phase) of one body in plain floats.

    The phase [rad] applies to both a and b; their length is any.
    """
    (start, rate, turn, p0, q0, r0, t0, p1, q1, r1, t1, p2, q2, r2, t2,
     p3, _, r3, t3) = rows
    zeta = start + rate * elapsed
    sine, cosine = sin(zeta), cos(zeta)
    s = -sine * sine
    return (p0 + s * (p1 + s * (p2 + s * p3)), sine * cosine * (q0 + s * (q1 + s * q2)),
            sine * (r0 + s * (r1 + s * (r2 + s * r3))),
            cosine * (t0 + s * (t1 + s * (t2 + s * t3))), turn * elapsed)


def pairs(rows, elapsed):
    """Return the parts as `pair` does, (4, k), and the phases (k,), of many bodies or times."""
    zeta = rows[0] + rows[1] * elapsed
    waves = np.empty((2,) + zeta.shape)
    cosine, sine = waves
    cosine_and_sine(zeta, waves)
    parts = values_of_cubics(rows[3:], -sine * sine)
    parts[2] *= sine
    sine *= cosine
    parts[1] *= sine
    parts[3] *= cosine
    return parts, rows[2] * elapsed


def _factor(functions, s, ratio):
    """
    Return g and v = s / g such that theta1 / theta4 at the start of a period is the ratio.

    The ratio is A1 / (1 + A3) = tan of half the angle between momentum and axis 3. Newton's
    method on N(g) = ratio D(g) from the root of the leading terms g - s / g = ratio.
    """
    g = functions.maximum(0.5 * (ratio + functions.sqrt(ratio * ratio + 4 * s)), SMALLEST_FACTOR)
    s3, s6, s10, s15, s21 = s ** 3, s ** 6, s ** 10, s ** 15, s ** 21
    for _ in range(NEWTON_ROUNDS):
        v = s / g
        g2, v2 = g * g, v * v
        g4, v4 = g2 * g2, v2 * v2
        g3, v3 = g * g2, v * v2
        numerator = (g - v - s3 * (g3 - v3) + s10 * (g * g4 - v * v4)
                     - s21 * (g3 * g4 - v3 * v4))
        denominator = 1 - s * (g2 + v2) + s6 * (g4 + v4) - s15 * (g2 * g4 + v2 * v4)
        # derivatives with respect to log g
        rise = g + v - 3 * s3 * (g3 + v3) + 5 * s10 * (g * g4 + v * v4)
        fall = -2 * s * (g2 - v2) + 4 * s6 * (g4 - v4) - 6 * s15 * (g2 * g4 - v2 * v4)
        slope = rise - ratio * fall
        g = g - g * (numerator - ratio * denominator) / slope
    return functions.maximum(g, SMALLEST_FACTOR), s / functions.maximum(g, SMALLEST_FACTOR)
