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
from rigid_sim_ros.engine.lasting_contact.motion import FreeMotion, Motion
from rigid_sim_ros.engine.lasting_contact.near import Near
from rigid_sim_ros.engine.narrow_phase import gap_acceleration_bias
from rigid_sim_ros.engine.solvers import ContactProblem, solve

FIRST, SECOND, STATIC = range(3)
"""What impulses are for: the halves of a step, and whether it could be the last."""

_NO_TURN = 1e-15
"""Angle [rad] in a step below which turning adds less than rounding."""


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


class Trial(NamedTuple):
    """A step that is tried: its first half is solved, what comes of it is not looked at yet."""

    free: FreeMotion
    start: Motion
    kicked: Motion
    """After half of the step's forces."""

    struck: Motion
    """After the contacts' impulses in addition; the bodies drift at these velocities."""

    step: float
    """[s]"""

    near: Near
    """The contacts at its start."""

    impulse: np.ndarray = None
    """(3, k) [N s], contact axes: those of the first half; None if there are none."""

    across: np.ndarray = None
    """(3, k) [m/s], world axes: the velocities across its contacts at the start; likewise."""

    def end(self):
        """Return the motion at the end but for the impulses of the second half."""
        return self.free.drifted(self.start, self.kicked, self.struck, self.step)

    @classmethod
    def of_no_time(cls, free, motion, near):
        """Return the trial of a step in which nothing happens."""
        return cls(free, motion, motion, motion, 0.0, near)


class Push(NamedTuple):
    """How overlaps have been pushed out."""

    shift: np.ndarray
    """(2, 3, n): how far bodies have been moved [m] and turned [rad]."""

    near: Near
    """The contacts before."""

    which: np.ndarray
    """(m,) int: those of them that pushed."""


def first_half(free, start, near, step, limits):
    """Return the `Trial` of a step [s] from a `Motion` with the contacts `Near` it."""
    kicked = free.kicked(start, 0.5 * step)
    if not near.count:
        return Trial(free, start, kicked, kicked, step, near)
    contacts = near.contacts
    across = near.across(start)
    speed = rotation.dot(across, contacts.normal)
    closed = contacts.separation < limits.touch_gap
    soon = closed | (contacts.separation + step * speed < limits.arrival_gap)
    which = np.flatnonzero(soon & (speed > -limits.impact_speed))
    if not which.size:
        return Trial(free, start, kicked, kicked, step, near)
    bias = _turning(near, start, step)
    bias[0] += np.maximum(contacts.separation, 0.0) / step
    slip = _slip(near.rows.components(across).reshape(3, -1), closed, limits.slide_speed)
    struck, impulse = near.struck(kicked, which, FIRST, step, bias, slip)
    return Trial(free, start, kicked, struck, step, near, impulse, across)


def second_half(motion, near, which, step, half=SECOND):
    """
    Return (motion, impulses) at the end of a step [s], after those on contacts (m,) that touch.

    The impulses are (3, k) [N s] in contact axes, or None.
    """
    return near.struck(motion, which, half, step) if len(which) else (motion, None)


def push_out(motion, near):
    """
    Return the motion with bodies moved so that no contact overlaps, without friction.

    And the `Push` that did it.
    """
    rows, count = near.rows, near.count
    shift = np.zeros((2, *motion.linear.shape))
    zeros = np.zeros(count)
    free = np.concatenate((near.contacts.separation, zeros, zeros))
    problem = ContactProblem(rows.response(), free, zeros, zeros, np.zeros((2, count)))
    force = solve(problem).force
    shift[:, :, rows.touched] = rows.change(force)
    return (motion.moved(np.arange(shift.shape[2]), *shift),
            Push(shift, near, np.flatnonzero(force[:count] > 0.0)))


def _turning(near, motion, step):
    """
    Return what the turning of bodies and normals adds in half a step, (3, k), contact axes.

    That is at most what turning takes off a point or a normal by a radian. Edges all but parallel
    claim more: their crossing has run off them long before.
    """
    if step * float(np.abs(motion.angular).max()) < _NO_TURN:
        return np.zeros((3, near.count))
    island, contacts = near.island, near.contacts
    gamma_n, gamma_t = gap_acceleration_bias(
        contacts, island.bodies, motion.position, motion.linear, motion.angular)
    change = 0.5 * step * (gamma_t + contacts.normal * gamma_n)
    turning, across = island.turning(motion), near.across(motion)
    most = (np.sqrt(rotation.dot(across, across))
            + turning.take(contacts.body_a) + turning.take(contacts.body_b))
    change *= rotation.dot(change, change) <= most * most
    return near.rows.components(change).reshape(3, -1)


def _slip(across, closed, slide_speed):
    """
    Return the directions (2, k) of closed contacts that slide too fast to turn round in a step.

    None if none does.
    """
    _, first, second = across
    speed = np.sqrt(first * first + second * second)
    known = closed & (speed > slide_speed)
    if not known.any():
        return None
    return across[1:] * np.where(known, 1 / np.where(known, speed, 1.0), 0.0)
