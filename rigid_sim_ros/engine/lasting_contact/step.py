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
The step of bodies in lasting contact: two half steps of forces around a drift, second order.

Both halves solve the whole contact problem, friction and all. The first, at the poses of the
start, asks that no gap is negative at the end:

    u_n >= -gap / h - h gamma_n / 2,    friction against u_t + h gamma_t / 2,

with gamma the part of the contacts' accelerations that the turning of bodies and normals makes
(see `narrow_phase.kinematics`). The second, at the poses of the end, asks u_n >= 0. Where a
contact slides fast, friction has the direction of the start in the first half and is implicit in
the second: a trapezoid, without which friction is first order. It is a RATTLE scheme (Andersen
1983) with inequalities. Contacts that approach faster than a limit are left out: they are impacts.
"""

from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.friction import mixed_friction
from rigid_sim_ros.engine.narrow_phase import gap_acceleration_bias
from rigid_sim_ros.engine.solvers import contact_rows, ContactProblem, solve


_ACCURACY = 1e-11
"""Of the change of velocities in a step, to which it is solved: far less than the step's error."""


class Limits(NamedTuple):
    """The `Scales` of an island for one step; parts of a step use those of the whole."""

    touch_gap: float
    """[m]"""

    arrival_gap: float
    """[m]"""

    impact_speed: float
    """[m/s]"""

    slide_speed: float
    """[m/s]"""

    @classmethod
    def of(cls, scales, step):
        """Return the limits for a step [s]."""
        return cls(scales.touch_gap(step), scales.arrival_gap(step), scales.impact_speed(step),
                   scales.slide_speed(step))

    def margin(self, step):
        """Return the gap [m] up to which the contacts of a step [s] must be known."""
        return self.arrival_gap + step * self.impact_speed


def velocity_across(contacts, motion):
    """Return the velocity [m/s] of b minus that of a at contact points, (3, k), world axes."""
    velocity = [motion.linear[:, body] + rotation.cross(
        motion.angular[:, body], contacts.point - motion.position[:, body])
        for body in (contacts.body_a, contacts.body_b)]
    return velocity[1] - velocity[0]


def first_half(island, free, start, contacts, step, limits):
    """
    Return the motion at the end of a step [s] but for the impulses of its second half.

    `start` is the `Motion` at the beginning and `contacts` are those near it.
    """
    kicked = free.kicked(start, 0.5 * step)
    across = velocity_across(contacts, start)
    speed = rotation.dot(across, contacts.normal)
    near = ((contacts.separation < limits.touch_gap)
            | (contacts.separation + step * speed < limits.arrival_gap))
    which = np.flatnonzero(near & (speed > -limits.impact_speed))
    if not which.size:
        return free.drifted(start, kicked, kicked, step)
    contacts, across = contacts.select(which), across[:, which]
    rows = contact_rows(island.bodies, contacts, start.position, start.orientation)
    gamma_n, gamma_t = gap_acceleration_bias(
        contacts, island.bodies, start.position, start.linear, start.angular)
    gap = np.maximum(contacts.separation, 0.0)
    bias = rows.components(0.5 * step * (gamma_t + contacts.normal * gamma_n))
    bias[:contacts.count] += gap / step
    slip = _slip(rows, contacts, across, limits)
    struck = _strike(island, kicked, contacts, rows, bias, slip)
    return free.drifted(start, kicked, struck, step)


def second_half(island, motion, contacts):
    """Return the motion with the impulses that end a step on its touching contacts (k)."""
    if not contacts.count:
        return motion
    rows = contact_rows(island.bodies, contacts, motion.position, motion.orientation)
    zeros = np.zeros(3 * contacts.count)
    return _strike(island, motion, contacts, rows, zeros, zeros.reshape(3, -1)[:2])


def push_out(island, motion, contacts):
    """Return the motion with bodies moved so that no contact overlaps, without friction."""
    rows = contact_rows(island.bodies, contacts, motion.position, motion.orientation)
    zeros = np.zeros(contacts.count)
    free = np.concatenate((contacts.separation, zeros, zeros))
    problem = ContactProblem(rows.response(), free, zeros, zeros, np.zeros((2, contacts.count)))
    return motion.moved(rows.touched, *rows.change(solve(problem).force))


def _slip(rows, contacts, across, limits):
    """Return the directions (2, k) of contacts that slide too fast to turn round in a step."""
    _, first, second = rows.components(across).reshape(3, -1)
    speed = np.sqrt(first * first + second * second)
    known = (speed > limits.slide_speed) & (contacts.separation < limits.touch_gap)
    return np.stack((first, second)) * np.where(known, 1 / np.where(known, speed, 1.0), 0.0)


def _strike(island, motion, contacts, rows, bias, slip):
    """Return the motion after the impulses that keep velocities plus `bias` (3k,) apart."""
    bodies = island.bodies
    free = rows.motion(motion.linear, motion.angular) + bias
    friction = mixed_friction(bodies.friction[contacts.body_a], bodies.friction[contacts.body_b])
    solution = solve(ContactProblem(rows.response(), free, friction, np.zeros(contacts.count),
                                    slip), accuracy=_ACCURACY)
    island.world.work.solver_iterations += solution.iterations
    return motion.struck(rows.touched, *rows.change(solution.force))
