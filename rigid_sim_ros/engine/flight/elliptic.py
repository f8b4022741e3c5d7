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
Elliptic integrals and nomes, from the complementary modulus so that no digits cancel.

Both ends are needed to full relative accuracy, k near 0 (nearly symmetric bodies) and k near 1
(rotation near the middle axis), so functions take k'^2 = 1 - k^2 beside or instead of k^2.
"""

from math import pi

SPREAD = 0.012
"""Relative distance of the arguments from their mean at which a series ends the duplication."""

SMALLEST = 1e-300
"""What an argument of `carlson_rf` is at least, so that two zeros, an infinite value, end."""


def carlson_rf(functions, x, y):
    """
    Return Carlson's R_F(x, y, 1), for x and y in [0, 1].

    By duplication and then the series of degree 7 in the distances from the mean, B. C. Carlson,
    Numerical computation of real or complex elliptic integrals, 1995 (DLMF 19.36.1).
    """
    x, y, z = functions.maximum(x, SMALLEST), functions.maximum(y, SMALLEST), 0 * x + 1.0
    spread = 1.0
    while spread > SPREAD:
        a, b, c = functions.sqrt(x), functions.sqrt(y), functions.sqrt(z)
        shift = a * b + b * c + c * a
        x, y, z = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4
        mean = (x + y + z) / 3
        p, q = 1 - x / mean, 1 - y / mean
        spread = functions.largest(
            functions.maximum(abs(p), functions.maximum(abs(q), abs(p + q))))
    r = -p - q
    e2, e3 = p * q - r * r, p * q * r
    return (1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44 - 5 * e2 ** 3 / 208
            + 3 * e3 * e3 / 104 + e2 * e2 * e3 / 16) / functions.sqrt(mean)


def nome_from_epsilon(epsilon):
    """Return the nome q of epsilon = (1 - sqrt k') / (2 (1 + sqrt k')), DLMF 20.9(ii)."""
    e4 = epsilon ** 4
    return epsilon * (1 + e4 * (2 + e4 * (15 + e4 * 150)))


def nome(functions, square, complementary):
    """
    Return the nome of the modulus k, from k^2 and k'^2 >= 0.03.

    As the root of the nome of the modulus (1 - k') / (1 + k'), whose epsilon is so small that
    four terms do (descending Landen transformation, DLMF 22.7(i)).
    """
    prime = functions.sqrt(complementary)
    root = functions.sqrt(prime)
    # 1 - sqrt k', then epsilon of k1' = 2 sqrt k' / (1 + k'), both without cancellation
    gap = square / ((1 + prime) * (1 + root))
    epsilon = 0.5 * gap * gap / (1 + prime) / (
        1 + functions.sqrt(2 * root / (1 + prime))) ** 2
    return functions.sqrt(nome_from_epsilon(epsilon))


def complementary_nome(functions, square, complementary):
    """Return the nome of the modulus k', from k^2 and k'^2 < 0.03."""
    modulus = functions.sqrt(square)
    return nome_from_epsilon(
        0.5 * complementary / ((1 + modulus) * (1 + functions.sqrt(modulus)) ** 2))


def quarter_period(q):
    """Return K(k) = (pi / 2) theta3(0, q)^2 from the nome q <= 0.21 of k, DLMF 20.9.2."""
    q4 = q ** 4
    return pi / 2 * (1 + 2 * q * (1 + q * q * q * (1 + q4 * q * (1 + q4 * q * q * q)))) ** 2
