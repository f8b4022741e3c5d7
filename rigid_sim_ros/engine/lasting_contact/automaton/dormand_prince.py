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
Dormand and Prince's Runge-Kutta step of order 5(4) with its interpolant, on lists of floats.

J. R. Dormand and P. J. Prince 1980, 'A family of embedded Runge-Kutta formulae'; the interpolant
of order 4 is that of Hairer, Norsett and Wanner 1993, section II.6. Plain lists are five times
faster than arrays for the thirteen numbers of a rigid body.
"""

from copy import copy
from functools import cached_property, partial

_A = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
)
_B1, _B3, _B4, _B5, _B6 = 35 / 384, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84
_E1, _E3, _E4, _E5, _E6, _E7 = (
    71 / 57600, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
_D1, _D3, _D4, _D5, _D6, _D7 = (
    -12715105075 / 11282082432, 87487479700 / 32700410799, -10690763975 / 1880347072,
    701980252875 / 199316789632, -1453857185 / 822651844, 69997945 / 29380423)

ALL = slice(None)
"""Of the numbers of a state."""


class Step:
    """One step of an autonomous system: its end, its error and what lies between."""

    def __init__(self, rates, start, first, size):
        """Step from `start` by `size`, where `first` is `rates(start)`."""
        self.start = start
        self.size = size
        h = size
        a1, = (h * a for a in _A[0])
        k1 = first
        k2 = rates([y + a1 * u for y, u in zip(start, k1)])
        a1, a2 = (h * a for a in _A[1])
        k3 = rates([y + a1 * u + a2 * v for y, u, v in zip(start, k1, k2)])
        a1, a2, a3 = (h * a for a in _A[2])
        k4 = rates([y + a1 * u + a2 * v + a3 * w for y, u, v, w in zip(start, k1, k2, k3)])
        a1, a2, a3, a4 = (h * a for a in _A[3])
        k5 = rates([y + a1 * u + a2 * v + a3 * w + a4 * p
                    for y, u, v, w, p in zip(start, k1, k2, k3, k4)])
        a1, a2, a3, a4, a5 = (h * a for a in _A[4])
        k6 = rates([y + a1 * u + a2 * v + a3 * w + a4 * p + a5 * q
                    for y, u, v, w, p, q in zip(start, k1, k2, k3, k4, k5)])
        b1, b3, b4, b5, b6 = h * _B1, h * _B3, h * _B4, h * _B5, h * _B6
        self.end = [y + b1 * u + b3 * w + b4 * p + b5 * q + b6 * r
                    for y, u, w, p, q, r in zip(start, k1, k3, k4, k5, k6)]
        self.last = rates(self.end)
        self._stages = (k1, k3, k4, k5, k6, self.last)

    def error(self):
        """Return the estimated error of each number at the end."""
        h = self.size
        return [h * (_E1 * a + _E3 * c + _E4 * d + _E5 * e + _E6 * f + _E7 * g)
                for a, c, d, e, f, g in zip(*self._stages)]

    @cached_property
    def between(self):
        """
        Return a function of the time since the start that gives the state there.

        Or a slice of its numbers, if that is its second argument.
        """
        h = self.size
        rows = []
        for y, z, a, c, d, e, f, g in zip(self.start, self.end, *self._stages):
            change = z - y
            bump = h * a - change
            rows.append((y, change, bump, change - h * g - bump, h * (
                _D1 * a + _D3 * c + _D4 * d + _D5 * e + _D6 * f + _D7 * g)))
        return partial(_interpolated, h, rows)

    def ended(self, time):
        """
        Return the step with its end at a time since the start close to where it was.

        That end is the interpolant's, which differs from a step's own by the square of how far it
        is moved. Its rates stay those of the end before.
        """
        step = copy(self)
        step.end = self.between(time)
        step.size = time
        return step


def _interpolated(size, rows, time, part=ALL):
    """Return the state a time after the start of a step of this size with these coefficients."""
    # what ends at once takes a step of no size
    s = time / size if size else 0.0
    t = 1.0 - s
    return [r1 + s * (r2 + t * (r3 + s * (r4 + t * r5))) for r1, r2, r3, r4, r5 in rows[part]]
