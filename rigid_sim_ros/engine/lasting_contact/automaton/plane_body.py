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
One body over one plane, in plain floats and in the plane's own frame.

The plane is z = 0 and the body above it. A state is a list of thirteen numbers: position,
quaternion x y z w, velocity, angular velocity. What can touch are the corners of a box, or the
lowest point of a ball; both are called points.
"""

from math import sqrt

POSITION, ORIENTATION, VELOCITY, SPIN = slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)

HEIGHT = slice(2, 7)
"""What tells how high points are."""


def cross(a, b):
    """Return the vector product of triples."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    """Return the scalar product of triples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


class PlaneBody:
    """
    What does not change about a body over a plane while it moves.

    Parameters
    ----------
    corners : list of (3,) floats [m]
        Body axes; empty for a ball.
    radius : float [m]
        Of a ball; of a box half its diagonal.
    inverse_mass : float [1/kg]
    inertia : (3,) floats [kg m^2]
    acceleration, torque : (3,) floats [m/s^2], [N m]
        Without contact, in the frame of the plane.
    friction : float
    rolling, pivoting : float [m]
        Coefficients of friction against rolling and pivoting, of a ball of equal moments only.

    """

    def __init__(self, corners, radius, inverse_mass, inertia, acceleration, torque, friction,
                 rolling=0.0, pivoting=0.0):
        self.corners = corners
        self.radius = radius
        self.inverse_mass = inverse_mass
        self.inertia = inertia
        self.inverse_inertia = [1.0 / moment for moment in inertia]
        self.acceleration = acceleration
        self.torque = torque
        self.friction = friction
        self.rolling, self.pivoting = rolling, pivoting
        self.resists_spin = rolling > 0.0 or pivoting > 0.0
        self.is_ball = not corners
        self.alike = inertia[0] == inertia[1] == inertia[2]
        self.points = range(len(corners) or 1)
        self.last_forces = {}
        """What the general solver starts from, (3k,), by the count of points."""

    def turn(self, state):
        """Return the rows of the rotation matrix, body to plane frame."""
        x, y, z, w = state[ORIENTATION]
        # by the square of its length, which the stages of a step do not keep at one
        s = 2.0 / (x * x + y * y + z * z + w * w)
        xs, ys, zs = x * s, y * s, z * s
        return ((1.0 - y * ys - z * zs, x * ys - w * zs, x * zs + w * ys),
                (x * ys + w * zs, 1.0 - x * xs - z * zs, y * zs - w * xs),
                (x * zs - w * ys, y * zs + w * xs, 1.0 - x * xs - y * ys))

    def arms(self, turn, points):
        """Return the vectors from the centre to these points, in the plane's frame."""
        if self.is_ball:
            return [(0.0, 0.0, -self.radius)] * len(points)
        (a, b, c), (d, e, f), (g, h, i) = turn
        arms, corners = [], self.corners
        for point in points:
            x, y, z = corners[point]
            arms.append((a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z))
        return arms

    def gaps(self, state):
        """Return the heights [m] of all points."""
        height = state[2]
        if self.is_ball:
            return [height - self.radius]
        x, y, z, w = state[ORIENTATION]
        s = 2.0 / (x * x + y * y + z * z + w * w)
        g, h, i = s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)
        return [height + g * x + h * y + i * z for x, y, z in self.corners]

    def gap(self, height, point):
        """Return the height [m] of one point, given the `HEIGHT` numbers of a state."""
        level, x, y, z, w = height
        if self.is_ball:
            return level - self.radius
        s = 2.0 / (x * x + y * y + z * z + w * w)
        a, b, c = self.corners[point]
        return (level + s * (x * z - w * y) * a + s * (y * z + w * x) * b
                + (1.0 - s * (x * x + y * y)) * c)

    def raised(self, state, allowed):
        """
        Return a state with the lowest point on the plane if one is deeper than allowed [m].

        Only somebody from outside puts a body there, and closed points cannot all stay closed
        then: corners on the other side of the body may be below the plane too.
        """
        lowest = min(self.gaps(state))
        if lowest >= -allowed:
            return state
        return [*state[:2], state[2] - lowest, *state[3:]]

    def velocities(self, state, arms):
        """Return the velocities [m/s] of points with these arms."""
        vx, vy, vz, wx, wy, wz = state[7:]
        return [(vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x)
                for x, y, z in arms]

    def centripetal(self, state, arms):
        """Return the accelerations [m/s^2] of points at these arms due to turning."""
        if self.is_ball:
            # the lowest point is always below the centre: its velocity does not turn
            return [(0.0, 0.0, 0.0)] * len(arms)
        spin = state[SPIN]
        square = dot(spin, spin)
        result = []
        for arm in arms:
            along = dot(spin, arm)
            result.append((spin[0] * along - square * arm[0], spin[1] * along - square * arm[1],
                           spin[2] * along - square * arm[2]))
        return result

    def accelerations(self, state, arms, linear, angular):
        """Return the accelerations of points for those of the body, (3,) each."""
        a, b, c = linear
        p, q, r = angular
        return [(a + q * z - r * y + i, b + r * x - p * z + j, c + p * y - q * x + k)
                for (x, y, z), (i, j, k) in zip(arms, self.centripetal(state, arms))]

    def turned(self, turn, torque):
        """Return the angular acceleration [rad/s^2] due to a torque."""
        i1, i2, i3 = self.inverse_inertia
        if self.alike:
            return torque[0] * i1, torque[1] * i1, torque[2] * i1
        (a, b, c), (d, e, f), (g, h, i) = turn
        x, y, z = torque
        p, q, r = (i1 * (a * x + d * y + g * z), i2 * (b * x + e * y + h * z),
                   i3 * (c * x + f * y + i * z))
        return a * p + b * q + c * r, d * p + e * q + f * r, g * p + h * q + i * r

    def free_turning(self, state, turn):
        """Return the angular acceleration [rad/s^2] without contact."""
        if self.alike:
            return self.turned(turn, self.torque)
        (a, b, c), (d, e, f), (g, h, i) = turn
        x, y, z = state[SPIN]
        i1, i2, i3 = self.inertia
        p, q, r = (i1 * (a * x + d * y + g * z), i2 * (b * x + e * y + h * z),
                   i3 * (c * x + f * y + i * z))
        momentum = (a * p + b * q + c * r, d * p + e * q + f * r, g * p + h * q + i * r)
        gyroscopic = cross((x, y, z), momentum)
        return self.turned(turn, [t - m for t, m in zip(self.torque, gyroscopic)])

    def energy(self, state):
        """Return kinetic energy less the work of the held force [J]."""
        velocity, position = state[VELOCITY], state[POSITION]
        (a, b, c), (d, e, f), (g, h, i) = self.turn(state)
        x, y, z = state[SPIN]
        rates = (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z)
        turning = sum(moment * rate * rate for moment, rate in zip(self.inertia, rates))
        return (0.5 * dot(velocity, velocity) - dot(self.acceleration, position)
                ) / self.inverse_mass + 0.5 * turning


def normalized(state):
    """Return the state with a quaternion of unit length."""
    x, y, z, w = state[ORIENTATION]
    s = 1.0 / sqrt(x * x + y * y + z * z + w * w)
    return [*state[POSITION], x * s, y * s, z * s, w * s, *state[7:]]


def displaced(state, shift, turn):
    """Return the state moved against a shift [m] and a small turn [rad], (3,) each."""
    x, y, z, w = state[ORIENTATION]
    p, q, r = (0.5 * angle for angle in turn)
    return [*(a + b for a, b in zip(state[POSITION], shift)),
            x + p * w + q * z - r * y, y + q * w + r * x - p * z,
            z + r * w + p * y - q * x, w - p * x - q * y - r * z, *state[7:]]
