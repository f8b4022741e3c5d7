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
Vectors of one body in plain floats, where NumPy's overhead would be most of the time.

Vectors are sequences of three floats, results are tuples. Body axes are three unit vectors in
world axes, the columns of the rotation matrix.
"""

from math import sqrt


def dot(a, b):
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    """Return the vector product."""
    x, y, z = a
    u, v, w = b
    return y * w - z * v, z * u - x * w, x * v - y * u


def length(a):
    """Return the length."""
    x, y, z = a
    return sqrt(x * x + y * y + z * z)


def difference(a, b):
    """Return b - a."""
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


def axes_of(quaternion):
    """Return the three body axes in world axes: the columns of the rotation matrix."""
    x, y, z, w = quaternion
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz, xy, xz, yz = x * x2, y * y2, z * z2, x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    return ((1 - yy - zz, xy + wz, xz - wy), (xy - wz, 1 - xx - zz, yz + wx),
            (xz + wy, yz - wx, 1 - xx - yy))


def to_world(axes, vector):
    """Return a vector in body axes turned to world axes."""
    x, y, z = vector
    (a, b, c), (d, e, f), (g, h, i) = axes
    return x * a + y * d + z * g, x * b + y * e + z * h, x * c + y * f + z * i


def corners(axes, half, direction, middle=0.0):
    """
    Return where the 8 vertices of a box are along `direction` if its centre is at `middle`.

    In the order of `box_plane.VERTEX_SIGNS`; `half` holds half its sides.
    """
    a, b, c = half
    x, y, z = direction
    (p, q, r), (s, t, u), (v, w, o) = axes
    x, y, z = (a * (x * p + y * q + z * r), b * (x * s + y * t + z * u),
               c * (x * v + y * w + z * o))
    left, right, far, near = middle - x, middle + x, y + z, y - z
    return (left - far, right - far, left + near, right + near,
            left - near, right - near, left + far, right + far)
