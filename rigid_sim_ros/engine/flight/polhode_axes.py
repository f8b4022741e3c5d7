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
The axes that the polhode of a free body is described in: a permutation with signs of its own.

Axis 3 is the body axis the angular momentum circulates about, signed so that its component is not
negative; axes 1 and 2 are the middle one and the other, right-handed.
"""

from itertools import permutations
from math import frexp, ldexp

import numpy as np

from rigid_sim_ros.engine.rotation import from_matrix


def _axes_table():
    """
    Return (quaternions (4, 3, 3, 2), signs (2, 3, 3, 2)) of all axes, by axes 1, 2 and sign 3.

    A quaternion is that of the rotation matrix whose columns are the signed body axes 1, 2, 3;
    the signs are those of axes 1 and 3, axis 2 always has +. Index 1 of the last is minus.
    """
    quaternions, signs = np.zeros((4, 3, 3, 2)), np.zeros((2, 3, 3, 2))
    for i, j, k in permutations(range(3)):
        for negative, sign3 in enumerate((1.0, -1.0)):
            sign1 = sign3 if (j - i) % 3 == 1 else -sign3
            columns = np.zeros((3, 3))
            columns[i, 0], columns[j, 1], columns[k, 2] = sign1, 1.0, sign3
            quaternions[:, i, j, negative] = from_matrix(columns)
            signs[:, i, j, negative] = sign1, sign3
    return quaternions, signs


QUATERNIONS, SIGNS = _axes_table()
PLAIN_QUATERNIONS = np.moveaxis(QUATERNIONS, 0, -1).tolist()
PLAIN_SIGNS = np.moveaxis(SIGNS, 0, -1).tolist()
"""The same as nested lists, the components last."""


def axes_of_one(moments, rate):
    """
    Return (axes, momentum, direction) of one body in plain floats, its rate in body axes.

    `axes` is (order (3,), quaternion from axes 1, 2, 3 to the body's, signs of axes 1 and 3,
    sign): `order` holds the body's axes, and `sign` is +1 if that with the largest moment is the
    third. `momentum` is its size, `direction` (3,) its unit vector along axes 1, 2, 3.
    The rate is scaled by a power of two so that the squares of tiny ones do not underflow.
    """
    exponent = frexp(max(map(abs, rate)))[1]
    x, y, z = (ldexp(w, -exponent) * moment for w, moment in zip(rate, moments))
    size = (x * x + y * y + z * z) ** 0.5
    unit = x / size, y / size, z / size
    a, b, c = sorted(range(3), key=moments.__getitem__)
    side = _side([moments[axis] for axis in (a, b, c)], unit[a], unit[c])
    upward = side > 0 or (side == 0 and moments[a] == moments[b])
    order = (a, b, c) if upward else (c, b, a)
    first, second, third = order
    negative = unit[third] < 0
    sign1, sign3 = signs = PLAIN_SIGNS[first][second][negative]
    axes = order, PLAIN_QUATERNIONS[first][second][negative], signs, 1.0 if upward else -1.0
    return axes, ldexp(size, exponent), (sign1 * unit[first], unit[second], sign3 * unit[third])


def axes_of_many(moments, rate):
    """Return the same of k bodies for arrays (3, k): order (3, k), quaternion (4, k) ..."""
    exponent = np.frexp(np.abs(rate).max(axis=0))[1]
    momentum = np.ldexp(rate, -exponent) * moments
    size = np.sqrt((momentum * momentum).sum(axis=0))
    unit = momentum / size
    order = np.argsort(moments, axis=0, kind='stable')
    ordered = np.take_along_axis(moments, order, axis=0)
    first, _, last = np.take_along_axis(unit, order, axis=0)
    side = _side(ordered, first, last)
    upward = (side > 0) | ((side == 0) & (ordered[0] == ordered[1]))
    order = np.where(upward, order, order[::-1])
    direction = np.take_along_axis(unit, order, axis=0)
    key = order[0], order[1], (direction[2] < 0).astype(int)
    signs = SIGNS[(slice(None), *key)]
    direction[0] *= signs[0]
    direction[2] *= signs[1]
    axes = order, QUATERNIONS[(slice(None), *key)], signs, np.where(upward, 1.0, -1.0)
    return axes, np.ldexp(size, exponent), direction


def _side(moments, first, last):
    """
    Return (L^2 - 2 T I_b) / L^2, from the moments a <= b <= c: which axis is circled.

    Positive if it is that of the largest moment, negative if that of the smallest, zero on the
    separatrix, where either will do, and for rotation of a symmetric top in its equator, where
    the axis of symmetry is to be axis 3.
    """
    a, b, c = moments
    return last * last * (c - b) / c - first * first * (b - a) / a
