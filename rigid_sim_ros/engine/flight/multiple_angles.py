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
Sums over multiples of an angle as polynomials.

The two forms of a free rotation, `trigonometric` and `hyperbolic`, sum theta functions with few
terms. With S = -sin^2 z the multiple-angle formulas are polynomials of S with only positive
coefficients, and the same ones hold for hyperbolic functions with S = sinh^2 x.
"""

EVEN_COSINE = ((1,), (1, 2), (1, 8, 8), (1, 18, 48, 32))
"""cos 2nz, n = 0 to 3; lowest order first."""

EVEN_SINE = ((2,), (4, 8), (6, 32, 32))
"""sin 2nz / (sin z cos z), n = 1 to 3."""

ODD_COSINE = ((1,), (1, 4), (1, 12, 16), (1, 24, 80, 64))
"""cos (2n+1)z / cos z, n = 0 to 3."""

ODD_SINE = ((1,), (3, 4), (5, 20, 16), (7, 56, 112, 64))
"""sin (2n+1)z / sin z, n = 0 to 3."""


def combined(table, weights):
    """Return the cubic, lowest order first, of the weighted sum of a table's rows."""
    return [sum(row[order] * weight for row, weight in zip(table, weights) if order < len(row))
            for order in range(4)]


def interleaved(*polynomials):
    """Return coefficients in one list, those of order 0 first, as `cubics` wants them."""
    return [coefficient for order in zip(*polynomials) for coefficient in order]


def cubics(coefficients, s):
    """Return the values (4, k) at s (k,) of four cubics a column, interleaved (16, k)."""
    value = coefficients[12:] * s
    value += coefficients[8:12]
    value *= s
    value += coefficients[4:8]
    value *= s
    value += coefficients[:4]
    return value
