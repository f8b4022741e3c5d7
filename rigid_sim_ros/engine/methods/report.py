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
The engine of the student report this project grew from, as the report has it: the baseline.

All of it is explicit and first order: dv = F/m dt, dx = v dt, dw = I^-1 tau dt without a
gyroscopic term, dR = W R dt with W the cross-product matrix of w and R never made orthonormal
again. Two boxes collide if no face of the first has all vertices of the second outside: faces of
one only, so that edge against edge is misjudged. The response is one impulse along the normal of
the face, at the vertex deepest below it. Friction, resting contact and sleep are not in it.

The report has cubes only. Boxes are treated alike, and a plane as a body with a single face.
"""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.bodies import PLANE
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.friction import mixed_restitution
from rigid_sim_ros.engine.methods.stepping import Stepping

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float).T
"""The vertices of a box as multiples of its half extents, (3, 8)."""


class Report(Stepping):
    """The report's engine: every body and every pair, every step."""

    def __init__(self, world, state, time):
        others = sorted(set(world.bodies.kinds) - {'box', PLANE})
        if others:
            raise ValueError(f"method 'report' was given the shape {others[0]!r}; "
                             'it knows boxes (cubes) and planes')
        super().__init__(world, state, time)
        self._turn = rotation.matrix(state.orientation)
        self._pairs = _pairs(world.bodies)

    def set_motion(self, indices, **values):
        """See `Stepping`; a new orientation starts an orthonormal matrix."""
        super().set_motion(indices, **values)
        if 'orientation' in values:
            self._turn[:, :, indices] = rotation.matrix(self.state.orientation[:, indices])

    def advance(self, duration, until_collision=False):
        """See `Stepping`; attitudes are told as the rotations nearest to the matrices."""
        super().advance(duration, until_collision)
        self.state.orientation = _quaternions(_nearest_rotations(self._turn))

    def step(self, dt):
        """Integrate, detect, handle: one step of the report, of `dt` [s]."""
        self._integrate(dt)
        for a, b in self._pairs:
            self._world.work.narrow_phases += 1
            touch = self._detect(a, b)
            if touch is not None:
                self._handle(a, b, *touch)

    def _integrate(self, dt):
        """Take one explicit Euler step."""
        bodies, state = self._world.bodies, self.state
        acceleration = self._world.acceleration(state.force)
        turn = self._turn
        angular_acceleration = rotation.transform(
            turn, bodies.inverse_inertia * rotation.transform_transposed(turn, state.torque))
        spin = np.stack([rotation.cross(state.angular_velocity, turn[:, axis])
                         for axis in range(3)], axis=1)
        state.position = state.position + dt * state.linear_velocity
        self._turn = turn + dt * spin
        state.linear_velocity = state.linear_velocity + dt * acceleration
        state.angular_velocity = state.angular_velocity + dt * angular_acceleration

    def _detect(self, a, b):
        """Return the normal out of a face of a (3,) and the point of b below it, or None."""
        vertices = self._vertices(b)
        normals, offsets = self._faces(a)
        outside = normals @ vertices - offsets[:, None]
        nearest = outside.min(axis=1)
        if nearest.max() > 0:
            return None
        face = int(np.argmax(nearest))
        return normals[face], vertices[:, int(np.argmin(outside[face]))]

    def _handle(self, a, b, normal, point):
        """Apply the report's impulse if the bodies approach each other at the point."""
        bodies, state = self._world.bodies, self.state
        arm_a, arm_b = point - state.position[:, a], point - state.position[:, b]
        relative = (state.linear_velocity[:, b] + np.cross(state.angular_velocity[:, b], arm_b)
                    - state.linear_velocity[:, a] - np.cross(state.angular_velocity[:, a], arm_a))
        speed = normal @ relative
        if speed >= 0:
            return
        inverse_a, inverse_b = self._inverse_inertia(a), self._inverse_inertia(b)
        turn_a, turn_b = inverse_a @ np.cross(arm_a, normal), inverse_b @ np.cross(arm_b, normal)
        response = (bodies.inverse_mass[a] + bodies.inverse_mass[b]
                    + normal @ np.cross(turn_a, arm_a) + normal @ np.cross(turn_b, arm_b))
        restitution = mixed_restitution(bodies, a, b)
        size = -(1 + restitution) * speed / response
        for body, sign, turn in ((a, -1, turn_a), (b, 1, turn_b)):
            state.linear_velocity[:, body] += sign * size * bodies.inverse_mass[body] * normal
            state.angular_velocity[:, body] += sign * size * turn
        self._world.work.impacts += 1
        self._note_impact(a, b, point, normal, size, speed)

    def _note_impact(self, a, b, point, normal, size, speed):
        """Log an impact; a plane, first here to be the face, is second in every event."""
        impulse = size * normal
        if self._world.bodies.kinds[a] == PLANE:
            a, b, normal, impulse = b, a, -normal, -impulse
        self._world.events.append(self.time, a, b, IMPACT, point, normal, impulse, -speed)

    def _vertices(self, body):
        """Return the vertices (3, 8) of a box [m], world axes."""
        local = self._world.bodies.half_extents[:, body, None] * CORNERS
        return self.state.position[:, body, None] + self._turn[:, :, body] @ local

    def _faces(self, body):
        """Return the outward normals (f, 3) and offsets (f,) of a box's or plane's faces."""
        bodies = self._world.bodies
        if bodies.kinds[body] == PLANE:
            return bodies.plane_normal[:, body][None], bodies.plane_offset[body:body + 1]
        axes = self._turn[:, :, body].T
        normals = np.concatenate((axes, -axes))
        extents = np.tile(bodies.half_extents[:, body], 2)
        return normals, normals @ self.state.position[:, body] + extents

    def _inverse_inertia(self, body):
        """Return R I^-1 R^T (3, 3) [1/(kg m^2)]."""
        turn = self._turn[:, :, body]
        return turn * self._world.bodies.inverse_inertia[:, body] @ turn.T


def _pairs(bodies):
    """Return all pairs (a, b) of which one moves; planes are first, for theirs is the face."""
    count = bodies.body_count
    return ([(plane, body) for body in range(bodies.moving_count)
             for plane in range(count, bodies.count)]
            + [(a, b) for a in range(bodies.moving_count) for b in range(a + 1, count)])


def _nearest_rotations(m):
    """
    Return the rotations nearest to matrices (3, 3, n): their orthogonal polar factors.

    Newton's iteration m <- (m + m^-T) / 2, Higham 1986, 'Computing the polar decomposition - with
    applications', section 3; m^-T is the matrix of cofactors over the determinant.
    """
    for _ in range(20):
        cofactors = np.stack([rotation.cross(m[:, (axis + 1) % 3], m[:, (axis + 2) % 3])
                              for axis in range(3)], axis=1)
        following = 0.5 * (m + cofactors / rotation.dot(m[:, 0], cofactors[:, 0]))
        if np.abs(following - m).max(initial=0.0) < 1e-14:
            break
        m = following
    return following


def _quaternions(m):
    """Return the unit quaternions (4, n) of rotation matrices (3, 3, n), Shepperd 1978."""
    xx, yy, zz = m[0, 0], m[1, 1], m[2, 2]
    # four ways to the same quaternion, each exact but for a small divisor: take the largest
    candidates = np.stack((
        np.stack((1 + xx - yy - zz, m[1, 0] + m[0, 1], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2])),
        np.stack((m[1, 0] + m[0, 1], 1 - xx + yy - zz, m[2, 1] + m[1, 2], m[0, 2] - m[2, 0])),
        np.stack((m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], 1 - xx - yy + zz, m[1, 0] - m[0, 1])),
        np.stack((m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + xx + yy + zz))))
    best = np.argmax(np.stack((xx, yy, zz, xx + yy + zz)), axis=0)
    return rotation.normalize(np.take_along_axis(candidates, best[None, None], axis=0)[0])
