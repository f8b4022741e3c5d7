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
Sums over multiples of an angle as cubics.

The two forms of a free rotation, `trigonometric` and `hyperbolic`, sum theta functions with few
terms. With S = -sin^2 z the multiple-angle formulas are polynomials of S with only positive
coefficients, and the same ones hold for hyperbolic functions with S = sinh^2 x. Coefficients are
given lowest order first.
"""


def even_cosines(a, b, c):
    """Return the cubic of 1 + a cos 2z + b cos 4z + c cos 6z."""
    return 1 + a + b + c, 2 * a + 8 * b + 18 * c, 8 * b + 48 * c, 32 * c


def even_sines(a, b, c):
    """Return the cubic of (a sin 2z + b sin 4z + c sin 6z) / (sin z cos z)."""
    return 2 * a + 4 * b + 6 * c, 8 * b + 32 * c, 32 * c, 0 * c


def odd_cosines(a, b, c, d):
    """Return the cubic of (a cos z + b cos 3z + c cos 5z + d cos 7z) / cos z."""
    return a + b + c + d, 4 * b + 12 * c + 24 * d, 16 * c + 80 * d, 64 * d


def odd_sines(a, b, c, d):
    """Return the cubic of (a sin z + b sin 3z + c sin 5z + d sin 7z) / sin z."""
    return a + 3 * b + 5 * c + 7 * d, 4 * b + 20 * c + 56 * d, 16 * c + 112 * d, 64 * d


def interleaved(*cubics):
    """Return the coefficients of cubics in one list, those of order 0 first."""
    return [coefficient for order in zip(*cubics) for coefficient in order]


def values_of_cubics(coefficients, s):
    """Return the values (4, k) at s (k,) of four interleaved cubics a column, (16, k)."""
    value = coefficients[12:] * s
    value += coefficients[8:12]
    value *= s
    value += coefficients[4:8]
    value *= s
    value += coefficients[:4]
    return value
