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
A tumbling cube that bounces on the plane z = 0 without friction, to 30 digits.

In flight a cube turns at a constant rate about a fixed axis, so that the height of a corner is

    z + v t - g t^2 / 2 + along + (c_z - along) cos(w t) + across sin(w t)

with c the corner's place relative to the centre, `along` the vertical part of its component along
the axis, and `across` that of axis x c. The first root is bracketed by sampling each of the eight
in double precision and found by bisection and secants with 40 digits; the impulse is the closed
form of one contact. Written for this package's benchmark, with nothing in common with its engine.
"""

from itertools import product

import mpmath
import numpy as np

DIGITS = 40

SAMPLE_SPACING = 2e-4
"""[s]; far finer than any corner's dip below the plane in the scenes used."""


class BouncingCube:
    """A cube in one flight: the state at its start, advanced from impact to impact."""

    def __init__(self, edge, mass, height, spin, gravity, velocity, restitution):
        """Start with the centre at a height [m], unturned, with a velocity and a spin, (3,)."""
        with mpmath.workdps(DIGITS):
            self.half = mpmath.mpf(edge) / 2
            self.mass = mpmath.mpf(mass)
            self.moment = self.mass * mpmath.mpf(edge) ** 2 / 6
            self.gravity = mpmath.mpf(gravity)
            self.restitution = mpmath.mpf(restitution)
            self.time = mpmath.mpf(0)
            self.position = mpmath.matrix([0, 0, height])
            self.velocity = mpmath.matrix(velocity)
            self.rotation = mpmath.eye(3)
            self.spin = mpmath.matrix(spin)

    def pose_at(self, time):
        """Return the position (3,) and the rotation matrix (3, 3) at a time [s], as arrays."""
        with mpmath.workdps(DIGITS):
            span = mpmath.mpf(time) - self.time
            return _array(self._place(span)), _array(_turn(self.spin, span) * self.rotation)

    def next_impact(self):
        """Return the time [s] of the next impact and the number of the corner."""
        with mpmath.workdps(DIGITS):
            heights = [self._height(corner) for corner in self._corners()]
            bracket, number = _first_crossing(heights)
            span = mpmath.findroot(_exact_height(*heights[number]), bracket, solver='anderson')
            return self.time + span, number

    def bounce(self):
        """Go on to the next impact and through it; return its time [s]."""
        time, number = self.next_impact()
        with mpmath.workdps(DIGITS):
            span = time - self.time
            self.position = self._place(span)
            self.velocity[2] -= self.gravity * span
            self.rotation = _turn(self.spin, span) * self.rotation
            self.time = time
            x, y, _ = self._corners()[number]
            # r x n with n upwards; the plane pushes up with j
            arm = mpmath.matrix([y, -x, 0])
            approach = self.velocity[2] + self.spin[0] * y - self.spin[1] * x
            size = (-(1 + self.restitution) * approach
                    / (1 / self.mass + (x * x + y * y) / self.moment))
            self.velocity[2] += size / self.mass
            self.spin = self.spin + size / self.moment * arm
        return float(time)

    def _corners(self):
        return [self.rotation * mpmath.matrix([sign * self.half for sign in signs])
                for signs in product((-1, 1), repeat=3)]

    def _place(self, span):
        place = self.position + span * self.velocity
        place[2] -= self.gravity * span * span / 2
        return place

    def _height(self, corner):
        """Return what the height of a corner is made of: z, v, g, rate, along, rest, across."""
        rate = mpmath.norm(self.spin)
        axis = self.spin / rate
        along = sum(a * c for a, c in zip(axis, corner)) * axis[2]
        across = axis[0] * corner[1] - axis[1] * corner[0]
        return (self.position[2], self.velocity[2], self.gravity, rate, along,
                corner[2] - along, across)


def _exact_height(z, v, g, rate, along, rest, across):
    return lambda t: (z + v * t - g * t * t / 2 + along
                      + rest * mpmath.cos(rate * t) + across * mpmath.sin(rate * t))


def _first_crossing(heights):
    """Return the bracket [s] of the first corner through the plane, and its number."""
    z, v, g, rate, along, rest, across = np.array(heights, dtype=float).T[:, :, None]
    t = np.arange(1, 20_000) * SAMPLE_SPACING
    values = (z + v * t - g * t * t / 2 + along
              + rest * np.cos(rate * t) + across * np.sin(rate * t))
    below = values < 0
    first = np.where(below.any(axis=1), below.argmax(axis=1), t.size)
    number = int(first.argmin())
    end = float(t[first[number]])
    return (end - SAMPLE_SPACING, end), number


def _turn(spin, span):
    """Return the rotation by spin times span (Rodrigues)."""
    rate = mpmath.norm(spin)
    x, y, z = spin / rate
    cross = mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = rate * span
    return mpmath.eye(3) + mpmath.sin(angle) * cross + (1 - mpmath.cos(angle)) * cross * cross


def _array(matrix):
    values = np.array(matrix.tolist(), dtype=float)
    return values[:, 0] if values.shape[1] == 1 else values
