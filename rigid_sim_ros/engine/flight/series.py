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
Power series of a rotation in the fraction of a stride, and what to do with them.

Rotations are pairs of complex numbers (a, b) = (w + i z, x + i y) of the quaternion x, y, z, w
(Cayley-Klein parameters), in world axes turned so that the torque is along the z axis: the frame.
Everything here takes floats and arrays alike, see `functions`.
"""

import numpy as np

from rigid_sim_ros.engine.flight.plain_rotation import product, to_world


def frame_of(functions, torque):
    """
    Return (frame, magnitude): the shortest turn of the z axis onto the torque, or its opposite.

    The torque (3,) [N m] is then `frame` applied to (0, 0, magnitude), with a negative magnitude
    where the torque points down, so that no direction is special.
    """
    x, y, z = torque
    magnitude = functions.copysign(functions.hypot(functions.hypot(x, y), z), z)
    x, y, z = x / magnitude, y / magnitude, z / magnitude
    # half way between the z axis and (x, y, z), whose z is now positive
    scale = 1 / functions.sqrt(2 * (1 + z))
    return (-y * scale, x * scale, 0 * z, (1 + z) * scale), magnitude


def into_frame(frame, quaternion, vector):
    """Return the pair (a, b) of a quaternion and a world vector (3,) as seen from the frame."""
    x, y, z, w = frame
    inverse = (-x, -y, -z, w)
    x, y, z, w = product(inverse, quaternion)
    return w + 1j * z, x + 1j * y, to_world(inverse, vector)


def out_of_frame(functions, frame, a, b):
    """Return the unit quaternion, a tuple, of a pair (a, b) of nearly unit length."""
    w, z, x, y = a.real, a.imag, b.real, b.imag
    scale = 1 / functions.sqrt(w * w + z * z + x * x + y * y)
    return product(frame, (x * scale, y * scale, z * scale, w * scale))


def polynomial(coefficients, fraction):
    """Return the value of a series, lowest order first, by Horner's rule."""
    value = 0.0
    for coefficient in reversed(coefficients):
        value = value * fraction + coefficient
    return value


def coefficient_rows(series, order):
    """
    Return the coefficients of series as a list of real rows, all of order 0 first.

    Every series makes two rows an order, its real and its imaginary part, up to `order`.
    """
    rows = [part for coefficients in zip(*series) for value in coefficients
            for part in (value.real, value.imag)]
    return rows + [0.0 * rows[0]] * (2 * len(series) * (order + 1) - len(rows))


def from_rows(rows, width, fraction):
    """Return the values, (width, k) complex, of series kept as rows, (rows, k), each its own."""
    rows = rows.reshape(-1, 2 * width, rows.shape[-1])
    powers = np.empty((len(rows), 1, len(fraction)))
    powers[0] = 1.0
    powers[1:] = fraction
    np.multiply.accumulate(powers, axis=0, out=powers)
    value = (rows * powers).sum(axis=0)
    return value[0::2] + 1j * value[1::2]
