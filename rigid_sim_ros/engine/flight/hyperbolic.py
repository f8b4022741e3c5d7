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
A free rotation as sums over multiples of a hyperbolic argument: k'^2 below 0.03.

The theta functions of `trigonometric` after the modular transformation (DLMF 20.7(viii)), whose
series converge the faster the nearer k is to 1: near the middle axis, where the momentum rests
long and then turns over, down to the separatrix k = 1 itself. With q the nome of k',
x = pi u / (4 K') within the half period j of u, p_n = q^(n(n+1)/2), c_n = p_n cos (2n+1) zeta,
d_n = p_n sin (2n+1) zeta and a constant zeta, n from 0 to 3,

    a = sum [c_n cosh (2n+1)x - i sign d_n sinh (2n+1)x]
    b = sign (-1)^j sum (-1)^n [c_n sinh (2n+1)x - i sign d_n cosh (2n+1)x].
"""

from math import cosh, pi, sinh

import numpy as np

from rigid_sim_ros.engine.flight.elliptic import complementary_nome, quarter_period
from rigid_sim_ros.engine.flight.multiple_angles import (
    interleaved, odd_cosines, odd_sines, values_of_cubics)

ROW_COUNT = 24
"""See `rows`."""

FARTHEST = 80.0
"""Where x is cut: e^-80 is nothing beside 1, and e^(7 80) is still a float."""

NEWTON_ROUNDS = 3


def rows(functions, polhode):
    """
    Return the constants of the motion, a list of `ROW_COUNT` floats or arrays.

    u at the start, du/dt, 1 / (2 K) and 2 K (0 and 0 where K is infinite), pi / (4 K'), twist
    rate, twist a unit of u within its half period, sign at the start, then four interleaved
    cubics, see `pair`.
    """
    sign = polhode.sign
    q = complementary_nome(functions, polhode.square, polhode.complementary)
    scale = pi / (4 * quarter_period(q))
    finite = q > 0
    # K = -K' ln(q) / pi, so pi / (2 K) = -(pi / 4 K') 2 pi / ln(q)
    per_period = functions.where(
        finite, -2 * scale / functions.log(functions.where(finite, q, 0.5)), 0.0)
    period = functions.where(finite, 1 / functions.where(finite, per_period, 1.0), 0.0)
    zeta, c, d = _angle(functions, q, polhode.amplitude1 / (1 + polhode.amplitude3))
    ratio = ((d[0] + 3 * d[1] + 5 * d[2] + 7 * d[3]) / (c[0] + c[1] + c[2] + c[3]))
    twist = 2 * sign * zeta * per_period
    turn = polhode.twist - twist * polhode.speed + sign * polhode.speed * scale * ratio
    return [
        functions.where(polhode.backward, -polhode.phase, polhode.phase), polhode.speed,
        per_period, period, scale, turn, twist,
        functions.where(polhode.backward, -sign, sign),
        *interleaved(
            odd_cosines(*c),
            odd_sines(*(-sign * one for one in d)),
            odd_sines(c[0], -c[1], c[2], -c[3]),
            odd_cosines(-sign * d[0], sign * d[1], -sign * d[2], sign * d[3]))]


def pair(rows, elapsed):
    """
    Return (Re a, Im a, Re b, Im b, phase) of one body in plain floats.

    The phase [rad] applies to both a and b; their length is any.
    """
    (start, speed, per_period, period, scale, turn, twist, sign, p0, q0, r0, t0, p1, q1, r1, t1,
     p2, q2, r2, t2, p3, q3, r3, t3) = rows
    u = start + speed * elapsed
    half_period = round(u * per_period)
    u -= half_period * period
    x = min(max(u * scale, -FARTHEST), FARTHEST)
    sine, cosine = sinh(x), cosh(x)
    s = sine * sine
    if half_period % 2:
        sign = -sign
    return (cosine * (p0 + s * (p1 + s * (p2 + s * p3))),
            sine * (q0 + s * (q1 + s * (q2 + s * q3))),
            sign * sine * (r0 + s * (r1 + s * (r2 + s * r3))),
            sign * cosine * (t0 + s * (t1 + s * (t2 + s * t3))), turn * elapsed + twist * u)


def pairs(rows, elapsed):
    """Return the parts as `pair` does, (4, k), and the phases (k,), of many bodies or times."""
    u = rows[0] + rows[1] * elapsed
    half_period = np.rint(u * rows[2])
    u -= half_period * rows[3]
    x = np.clip(u * rows[4], -FARTHEST, FARTHEST)
    sine, cosine = np.sinh(x), np.cosh(x)
    sign = rows[7] * (1 - 2 * (half_period % 2))
    parts = values_of_cubics(rows[8:], sine * sine)
    parts[0] *= cosine
    parts[1] *= sine
    sine *= sign
    cosine *= sign
    parts[2] *= sine
    parts[3] *= cosine
    return parts, rows[5] * elapsed + rows[6] * u


def _angle(functions, q, ratio):
    """
    Return (zeta, [c_n], [d_n]) such that b / a at u = 0 has the size of the ratio.

    The ratio is A1 / (1 + A3). Newton's method on sum (-1)^n d_n = ratio sum c_n, whose leading
    terms give zeta = atan(ratio).
    """
    zeta = functions.atan(ratio)
    weights = (1.0, q, q ** 3, q ** 6)
    for _ in range(NEWTON_ROUNDS):
        c = [weight * functions.cos((2 * n + 1) * zeta) for n, weight in enumerate(weights)]
        d = [weight * functions.sin((2 * n + 1) * zeta) for n, weight in enumerate(weights)]
        value = d[0] - d[1] + d[2] - d[3] - ratio * (c[0] + c[1] + c[2] + c[3])
        slope = (c[0] - 3 * c[1] + 5 * c[2] - 7 * c[3]
                 + ratio * (d[0] + 3 * d[1] + 5 * d[2] + 7 * d[3]))
        zeta = zeta - value / slope
    c = [weight * functions.cos((2 * n + 1) * zeta) for n, weight in enumerate(weights)]
    d = [weight * functions.sin((2 * n + 1) * zeta) for n, weight in enumerate(weights)]
    return zeta, c, d
