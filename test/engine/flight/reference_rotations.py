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
Rotations of rigid bodies to thirty digits, by two methods that share nothing with the engine's.

`python3 reference_rotations.py` writes the cases of `reference_rotations.json` anew, which takes
about a minute. Near the middle axis a trajectory leaves the saddle along a component of the square
of its departure, so a stepping method in doubles loses up to all digits: hence

- Taylor series of quaternion, body rate and body torque, order 60, in fixed-point integers;
- without torque and for long times, Jacobi's elliptic functions for the momentum in the body and
  quadrature for the angle about it, by mpmath, at forty digits.
"""

from fractions import Fraction
from itertools import permutations, product as product_of
import json
from math import exp, isqrt
from operator import mul
from pathlib import Path
import random

import mpmath

BITS = 200
"""Of the fixed-point numbers' fractions."""

ORDER = 60

DATA = Path(__file__).with_suffix('.json')

BOX_1_2_3 = (13 / 12, 10 / 12, 5 / 12)
"""Moments [kg m^2] of a box of sides 1, 2, 3 m and 1 kg."""


def fixed(value):
    """Return a float or fraction as a fixed-point integer."""
    value = Fraction(value)
    return (value.numerator << BITS) // value.denominator


def floating(value):
    """Return a fixed-point integer as an mpmath number."""
    return mpmath.mpf(value) / (1 << BITS)


def convolution(a, b):
    """Return the next coefficient of the product of two series."""
    return sum(map(mul, a, reversed(b))) >> BITS


def taylor(moments, q, w, g):
    """Return the series of q' = q w / 2, w' = Euler's equations with torque g, g' = g x w."""
    inverse = [fixed(1 / moment) for moment in moments]
    i1, i2, i3 = moments
    ratios = [fixed((i2 - i3) / i1), fixed((i3 - i1) / i2), fixed((i1 - i2) / i3)]
    q, w, g = [[x] for x in q], [[x] for x in w], [[x] for x in g]
    times = convolution
    for order in range(1, ORDER + 1):
        x, y, z, s = q
        a, b, c = w
        e, f, h = g
        turned = (times(s, a) + times(y, c) - times(z, b), times(s, b) + times(z, a) - times(x, c),
                  times(s, c) + times(x, b) - times(y, a),
                  -times(x, a) - times(y, b) - times(z, c))
        spun = times(b, c), times(c, a), times(a, b)
        carried = (times(f, c) - times(h, b), times(h, a) - times(e, c), times(e, b) - times(f, a))
        pushed = [one[-1] * factor >> BITS for one, factor in zip(g, inverse)]
        for one, value in zip(q, turned):
            one.append(value // (2 * order))
        for axis in range(3):
            w[axis].append(((ratios[axis] * spun[axis] >> BITS) + pushed[axis]) // order)
            g[axis].append(carried[axis] // order)
    return q + w + g


def by_taylor(moments, quaternion, rate, torque, time):
    """
    Return quaternion and body rate, 7 mpmath numbers, at a time.

    All arguments are floats taken as exact, except that the quaternion is normalised; rate and
    torque are in world axes.
    """
    moments = [Fraction(moment) for moment in moments]
    q = [fixed(x) for x in quaternion]
    length = isqrt(sum(x * x for x in q))
    q = [(x << BITS) // length for x in q]
    state = q + to_body(q, [fixed(x) for x in rate]) + to_body(q, [fixed(x) for x in torque])
    now = Fraction(0)
    while now < time:
        series = taylor(moments, state[:4], state[4:7], state[7:])
        step = min(reach(series), Fraction(time) - now)
        state = [value_at(one, fixed(step)) for one in series]
        now += step
    return [floating(value) for value in state[:7]]


def reach(series):
    """Return the step whose last terms are below 2^-160, of few digits so that sums are exact."""
    bits = min((BITS - 160 - abs(one[order]).bit_length()) / order
               for one in series for order in (ORDER - 1, ORDER))
    return Fraction(int(2 ** bits * 2 ** 30), 2 ** 30)


def value_at(series, step):
    """Return the value of a series by Horner's rule."""
    value = 0
    for coefficient in reversed(series):
        value = (value * step >> BITS) + coefficient
    return value


def to_body(q, v):
    """Return a world vector in body axes."""
    x, y, z, w = (-q[0], -q[1], -q[2], q[3])
    a, b, c = v
    t = [2 * (y * c - z * b) >> BITS, 2 * (z * a - x * c) >> BITS, 2 * (x * b - y * a) >> BITS]
    return [a + (w * t[0] + y * t[2] - z * t[1] >> BITS),
            b + (w * t[1] + z * t[0] - x * t[2] >> BITS),
            c + (w * t[2] + x * t[1] - y * t[0] >> BITS)]


def by_quadrature(moments, quaternion, rate, torque, time):
    """
    Return quaternion and body rate, 7 mpmath numbers, at a time; no torque.

    For moments I1 > I2 > I3 or I1 < I2 < I3, rotation about axis 3 (textbooks' case), identity
    quaternion. With m the unit momentum in the body, the body's attitude to the frame of the
    momentum is the shortest turn of m onto z after a turn by phi about z, where
    phi' = L / I3 + (2 T / L - L / I3) / (1 + m3).
    """
    assert not any(torque) and list(quaternion) == [0, 0, 0, 1]
    i1, i2, i3 = (mpmath.mpf(moment) for moment in moments)
    w1, w2, w3 = (mpmath.mpf(component) for component in rate)
    energy = i1 * w1 ** 2 + i2 * w2 ** 2 + i3 * w3 ** 2
    square = (i1 * w1) ** 2 + (i2 * w2) ** 2 + (i3 * w3) ** 2
    size = mpmath.sqrt(square)
    a1 = mpmath.sqrt((square - energy * i3) / (i1 * (i1 - i3)))
    a2 = mpmath.sqrt((square - energy * i3) / (i2 * (i2 - i3)))
    a3 = mpmath.sqrt((square - energy * i1) / (i3 * (i3 - i1)))
    speed = mpmath.sqrt((square - energy * i1) * (i3 - i2) / (i1 * i2 * i3))
    m = (i2 - i1) * (energy * i3 - square) / ((i3 - i2) * (square - energy * i1))
    # w1 = a1 cn u, w2 = -+ a2 sn u, w3 = +- a3 dn u, signs so that Euler's equations hold
    sign3 = mpmath.sign(w3)
    sign2 = sign3 if i1 < i2 else -sign3
    u = mpmath.ellipf(mpmath.atan2(sign2 * w2 / a2, w1 / a1), m)

    def rates(elapsed):
        sn, cn, dn = (mpmath.ellipfun(kind, u + speed * elapsed, m=m)
                      for kind in ('sn', 'cn', 'dn'))
        return a1 * cn, sign2 * a2 * sn, sign3 * a3 * dn

    def turning(elapsed):
        x, y, z = rates(elapsed)
        return size / i3 + (energy / size - size / i3) / (1 + i3 * z / size)

    def swing(elapsed):
        x, y, z = rates(elapsed)
        q = [i2 * y / size, -i1 * x / size, mpmath.mpf(0), 1 + i3 * z / size]
        length = mpmath.sqrt(sum(component ** 2 for component in q))
        return [component / length for component in q]

    period = 2 * mpmath.ellipk(m) / speed
    count, rest = divmod(mpmath.mpf(time), period)
    first, second = mpmath.quad(turning, [0, rest]), mpmath.quad(turning, [rest, period])
    phi = (count + 1) * first + count * second
    turn = [mpmath.mpf(0), mpmath.mpf(0), mpmath.sin(phi / 2), mpmath.cos(phi / 2)]
    x, y, z, w = swing(mpmath.mpf(0))
    return product(product((-x, -y, -z, w), turn), swing(mpmath.mpf(time))) + list(
        rates(mpmath.mpf(time)))


def product(p, q):
    """Return the quaternion p q as a list."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return [pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz]


IDENTITY = (0.0, 0.0, 0.0, 1.0)
STILL = (0.0, 0.0, 0.0)


def cases():
    """Yield (name, method, moments, quaternion, rate, torque, time)."""
    draw = random.Random(1).gauss
    for exponent in range(1, 13):
        departure = 10.0 ** -exponent
        yield (f'departure 1e-{exponent} from the middle axis', by_taylor, BOX_1_2_3, IDENTITY,
               (5 * departure, 5.0, 3.5 * departure), STILL, 30.0)
    for number in range(8):
        yield (f'any box {number}', by_taylor, tuple(exp(draw(0, 1)) for _ in range(3)),
               tuple(draw(0, 1) for _ in range(4)), tuple(draw(0, 3) for _ in range(3)), STILL,
               (1.0, 30.0)[number % 2])
    for number, moments in enumerate((BOX_1_2_3, BOX_1_2_3[::-1])):
        for rate in ((1.0, 2.0, -4.0), (0.9, 0.8, 2.0)):
            yield (f'long flight {number} {rate[0]}', by_quadrature, moments, IDENTITY, rate,
                   STILL, 1e4)
    for order in permutations((1.0, 2.0, 2.6)):
        for signs in product_of((1, -1), repeat=3):
            rate = tuple(s * w for s, w in zip(signs, (1.1, 0.7, 1.3)))
            yield (f'order {order} signs {signs}', by_taylor, order, (0.5, -0.1, 0.7, 0.3), rate,
                   STILL, 3.0)
    for name, moments, rate in (
            ('prolate top', (1.0, 3.0, 3.0), (2.0, 1.0, -1.0)),
            ('oblate top', (3.0, 2.0, 2.0), (2.0, 1.0, -1.0)),
            ('prolate top in its equator', (3.0, 1.0, 3.0), (2.0, 0.0, 1.0)),
            ('oblate top in its equator', (2.0, 2.0, 3.0), (2.0, 1.0, 0.0)),
            ('nearly prolate top', (1.0, 3.0, 3.0 * (1 + 1e-9)), (2.0, 1.0, -1.0)),
            ('nearly prolate top in its equator', (1.0, 3.0, 3.0 * (1 + 1e-9)), (0.0, 1.0, -1.0)),
            ('nearly oblate top', (2.0, 2.0 * (1 + 1e-15), 3.0), (2.0, 1.0, -1.0)),
            ('nearly a sphere', (1.0, 1.0 + 1e-12, 1.0 - 1e-12), (2.0, 1.0, -1.0)),
            ('next to a sphere', (1.0, 1.0 + 2.0 ** -52, 1.0), (2.0, 1.0, -1.0)),
            ('thin rod', (1e-8, 1.0, 1.0), (2.0, 1.0, -1.0)),
            ('flat plate', (1.0, 2.0, 3.0), (2.0, 1.0, -1.0)),
            ('separatrix', (9.0, 5.0, 1.0), (1.0, 2.0, 3.0)),
            ('separatrix backward', (9.0, 5.0, 1.0), (-1.0, 2.0, 3.0)),
            ('near the largest axis', (1.0, 2.0, 2.6), (1e-9, 1e-8, 4.0)),
            ('near the smallest axis', (1.0, 2.0, 2.6), (4.0, 1e-9, -1e-8))):
        yield name, by_taylor, moments, IDENTITY, rate, STILL, 4.0
    for name, moments, rate, torque in (
            ('driven cube', (1 / 150,) * 3, (1.2, -1.0, 1.25), (0.001, 0.0024, -0.0015)),
            ('driven cube, torque down', (1 / 150,) * 3, (0.3, 0.0, 0.1), (0.0, 0.0, -0.01)),
            ('driven cube, fast', (0.25,) * 3, (12.0, -10.0, 12.5), (1.0, 2.0, -1.0)),
            ('driven box', BOX_1_2_3, (1.2, -1.0, 1.25), (0.25, 0.67, -0.44)),
            ('driven box, weak', BOX_1_2_3, (6.0, -5.0, 6.3), (0.025, 0.067, -0.044)),
            ('driven box from rest', BOX_1_2_3, STILL, (0.3, 0.8, -0.52)),
            ('driven rod', (1e-3, 1.0, 1.0005), (3.0, 1.0, -0.5), (1e-4, 2e-3, 1e-3))):
        yield name, by_taylor, moments, (0.1, 0.2, 0.3, 0.9), rate, torque, 10.0


def write():
    """Write `DATA`: for each case its arguments and the result to 30 digits."""
    mpmath.mp.dps = 40
    rows = []
    for name, method, *arguments in cases():
        print(name, flush=True)
        result = method(*arguments)
        moments, quaternion, rate, torque, time = arguments
        rows.append({'name': name, 'moments': moments, 'quaternion': quaternion, 'rate': rate,
                     'torque': torque, 'time': time,
                     'result': [mpmath.nstr(value, 30) for value in result]})
    DATA.write_text('[\n' + ',\n'.join(json.dumps(row) for row in rows) + '\n]\n')


if __name__ == '__main__':
    write()
