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
Rotations, many at a time and one at a time.

Quaternions are x, y, z, w and turn body vectors into world vectors. Arrays are component-major:
vectors (3, n), quaternions (4, n), matrices (3, 3, n) with v_world[i] = sum_j m[i, j] v_body[j].
All functions broadcast over trailing axes, so they also take one vector (3,) with many
quaternions (4, n) if it is given as (3, 1).
"""

from math import cos, sin, sqrt

import numpy as np

_NEXT, _AFTER = np.array((1, 2, 0)), np.array((2, 0, 1))
"""The axes that follow x, y, z, and those after them."""


def multiply(p, q):
    """Return the product p q, (4, n): the rotation q followed by the rotation p."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return np.stack((
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
        pw * qw - px * qx - py * qy - pz * qz))


def conjugate(q):
    """Return the inverse rotation, (4, n), of unit quaternions (4, n)."""
    return np.stack((-q[0], -q[1], -q[2], q[3]))


def normalize(q):
    """Return quaternions of unit length, (4, n)."""
    return q / np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])


def rotate(q, v):
    """Return the vectors v, (3, n), turned from body to world axes by unit quaternions (4, n)."""
    x, y, z, w = q
    tx = 2 * (y * v[2] - z * v[1])
    ty = 2 * (z * v[0] - x * v[2])
    tz = 2 * (x * v[1] - y * v[0])
    return np.stack((
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx))


def matrix(q):
    """Return rotation matrices, (3, 3, n), body to world, of unit quaternions (4, n)."""
    x, y, z, w = q
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz = x * x2, y * y2, z * z2
    xy, xz, yz = x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    result = np.empty((3,) + np.shape(q))[:, :3]
    result[0, 0] = 1 - (yy + zz)
    result[0, 1] = xy - wz
    result[0, 2] = xz + wy
    result[1, 0] = xy + wz
    result[1, 1] = 1 - (xx + zz)
    result[1, 2] = yz - wx
    result[2, 0] = xz - wy
    result[2, 1] = yz + wx
    result[2, 2] = 1 - (xx + yy)
    return result


def from_rotation_vector(v):
    """Return the quaternions, (4, n), of turns by |v| [rad] about v, (3, n); exact at v = 0."""
    v = np.asarray(v, dtype=float)
    half = 0.5 * np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    # np.sinc is sin(pi x) / (pi x), and 1 at 0
    scale = 0.5 * np.sinc(half / np.pi)
    return np.stack((v[0] * scale, v[1] * scale, v[2] * scale, np.cos(half)))


def from_rpy(roll, pitch, yaw):
    """Return the quaternion x, y, z, w (floats) of fixed-axis roll, pitch, yaw [rad] (REP 103)."""
    cr, sr = cos(roll / 2), sin(roll / 2)
    cp, sp = cos(pitch / 2), sin(pitch / 2)
    cy, sy = cos(yaw / 2), sin(yaw / 2)
    return (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy)


def from_matrix(m):
    """Return the unit quaternion, (4,), w >= 0, of one rotation matrix (3, 3) (Shepperd 1978)."""
    m = np.asarray(m, dtype=float)
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    squares = np.array((m[0, 0], m[1, 1], m[2, 2], trace))
    largest = int(np.argmax(squares))
    q = np.empty(4)
    if largest == 3:
        q[:] = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + trace)
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        q[i] = 1 - trace + 2 * m[i, i]
        q[j] = m[j, i] + m[i, j]
        q[k] = m[k, i] + m[i, k]
        q[3] = m[k, j] - m[j, k]
    q /= sqrt(q @ q)
    return -q if q[3] < 0 else q


def angle_between(p, q):
    """Return the angle [rad], (n,), of the rotation from p to q, accurate also when tiny."""
    x, y, z, w = multiply(conjugate(p), q)
    return 2 * np.arctan2(np.sqrt(x * x + y * y + z * z), np.abs(w))


def cross(a, b):
    """Return the vector product, (3, n)."""
    # whole rows at once: a third of the time of nine products put together
    return (a.take(_NEXT, axis=0) * b.take(_AFTER, axis=0)
            - a.take(_AFTER, axis=0) * b.take(_NEXT, axis=0))


def dot(a, b):
    """Return the scalar product, (n,), of vectors (3, n)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def transform(m, v):
    """Return m v, (3, n): matrices (3, 3, n) times vectors (3, n)."""
    return m[:, 0] * v[0] + m[:, 1] * v[1] + m[:, 2] * v[2]


def transform_transposed(m, v):
    """Return m^T v, (3, n): for a rotation matrix, world axes to body axes."""
    return m[0] * v[0] + m[1] * v[1] + m[2] * v[2]
