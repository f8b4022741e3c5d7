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
Rotations of one body in plain floats, where NumPy's overhead would be most of the time.

The same conventions as `rotation`: quaternions are x, y, z, w and turn body vectors into world
vectors. The arguments are sequences whose elements may also be arrays; results are tuples.
"""


def product(p, q):
    """Return p q: the rotation q followed by the rotation p."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw,
            pw * qw - px * qx - py * qy - pz * qz)


def to_world(quaternion, vector):
    """Return the vector turned from body to world axes."""
    x, y, z, w = quaternion
    a, b, c = vector
    tx = 2 * (y * c - z * b)
    ty = 2 * (z * a - x * c)
    tz = 2 * (x * b - y * a)
    return (a + w * tx + y * tz - z * ty,
            b + w * ty + z * tx - x * tz,
            c + w * tz + x * ty - y * tx)


def to_body(quaternion, vector):
    """Return the vector turned from world to body axes."""
    x, y, z, w = quaternion
    return to_world((-x, -y, -z, w), vector)


def normalized(functions, quaternion):
    """Return the quaternion at unit length, with the square root of `functions`."""
    x, y, z, w = quaternion
    scale = 1 / functions.sqrt(x * x + y * y + z * z + w * w)
    return x * scale, y * scale, z * scale, w * scale


def to_unit_length(quaternion):
    """
    Return a quaternion of nearly unit length at unit length, a tuple or an array as given.

    One Newton step for 1 / length, right to rounding up to departures of 1e-8.
    """
    x, y, z, w = quaternion
    scale = 1.5 - 0.5 * (x * x + y * y + z * z + w * w)
    if isinstance(quaternion, tuple):
        return x * scale, y * scale, z * scale, w * scale
    return quaternion * scale
