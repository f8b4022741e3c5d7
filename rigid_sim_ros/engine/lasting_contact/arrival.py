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
When features of two bodies meet within a step that was tried, in plain floats.

Contact forces are taken as constant in the step: after a part of it each velocity has changed by
that part of its change, and the body has drifted at it. Features are those of contacts at the end
of the step, fixed to their bodies: a point and a face, or two edges.
"""

from math import inf, sin, sqrt

from rigid_sim_ros.engine.contacts import EDGES, FACE_A, ROUND
from rigid_sim_ros.engine.plain_vectors import cross, dot

_ROUNDS = 40
_ROUNDING = 1e-14
"""Of the step: where the search ends."""


def meeting_time(trial, end, contacts, rows, overlap):
    """
    Return the first time [s] at which one of some contacts closes, or None.

    Features that touch from the start on, or are round, do not tell; None means that none does.

    Parameters
    ----------
    trial : step.Trial
        The step.
    end : Motion
        At its end.
    contacts : Contacts
        There; those asked for overlap.
    rows : (m,) int
        Which are asked for.
    overlap : float [m]
        Gap, positive or negative, that counts as none.

    """
    first = inf
    for row in rows:
        gap = _gap(trial, end, contacts, row)
        if gap is not None:
            time = _root(gap, trial.step, contacts.separation.item(row), overlap)
            first = min(first, time)
    return None if first == inf else first


def dipping_time(trial, end, contacts, rows, parting, overlap, speed):
    """
    Return the first time [s] at which one of some contacts closed that is open again, or None.

    Parameters
    ----------
    trial, end, contacts, rows, overlap :
        As for `meeting_time`; those asked for part at the end.
    parting : (k,) [m/s]
        How fast each contact parts then.
    speed : float [m/s]
        What closes slower is not meant.

    """
    first = inf
    for row in rows:
        gap = _gap(trial, end, contacts, row)
        if gap is not None:
            lowest = _lowest(gap, trial.step, contacts.separation.item(row), parting.item(row))
            depth = -gap(lowest)
            if depth > overlap:
                time = _root(gap, lowest, -depth, overlap)
                # a parabola falls at twice its mean speed
                if time < lowest and 2.0 * depth > speed * (lowest - time):
                    first = min(first, time)
    return None if first == inf else first


def _lowest(gap, step, gap_high, rate_high):
    """Return when a gap is least that grows at a rate after the step, if it is a parabola."""
    growth = rate_high * step
    curvature = gap(0.0) - gap_high + growth
    return step * (1.0 - 0.5 * growth / curvature) if curvature > 0.5 * growth else 0.0


def _root(gap, step, gap_high, closed):
    """Return when a gap closes that is negative after the step, inf if `closed` at its start."""
    low, gap_low, high = 0.0, gap(0.0), step
    # what touches has a gap of rounding, and its sign may not decide
    if gap_low <= closed:
        return inf
    side, time = 0, low
    for _ in range(_ROUNDS):
        before, time = time, (low * gap_high - high * gap_low) / (gap_high - gap_low)
        found = gap(time)
        # Illinois: Dowell and Jarratt 1971
        if found > 0.0:
            low, gap_low = time, found
            gap_high *= 0.5 if side == 1 else 1.0
            side = 1
        elif found < 0.0:
            high, gap_high = time, found
            gap_low *= 0.5 if side == -1 else 1.0
            side = -1
        if found == 0.0 or abs(time - before) <= _ROUNDING * step:
            break
    return time


class _Body:
    """How one body moves in a trial."""

    def __init__(self, trial, column):
        """See the class."""
        start, struck = trial.start, trial.struck
        self.position = start.position[:, column].tolist()
        self.linear = start.linear[:, column].tolist()
        self.angular = start.angular[:, column].tolist()
        scale = 1 / trial.step
        self.linear_change = ((struck.linear[:, column] - self.linear) * scale).tolist()
        self.angular_change = ((struck.angular[:, column] - self.angular) * scale).tolist()

    def moved(self, time):
        """Return the position after a time [s]."""
        return [x + time * (v + time * c)
                for x, v, c in zip(self.position, self.linear, self.linear_change)]

    def turned(self, vector, time, direction=1.0):
        """Return a vector of the body at the start as it is after a time [s], or -1: back."""
        time *= direction
        x, y, z = [time * (w + abs(time) * c)
                   for w, c in zip(self.angular, self.angular_change)]
        square = x * x + y * y + z * z
        if square < 1e-300:
            return vector
        angle = sqrt(square)
        across, half = sin(angle) / angle, sin(0.5 * angle)
        along = 2.0 * half * half / square
        u, v, w = vector
        share = along * (x * u + y * v + z * w)
        cosine = 1.0 - along * square
        return (cosine * u + across * (y * w - z * v) + share * x,
                cosine * v + across * (z * u - x * w) + share * y,
                cosine * w + across * (x * v - y * u) + share * z)


def _gap(trial, end, contacts, row):
    """Return a function of time [s]: the gap [m] of the features of a contact at the end."""
    feature = contacts.feature.item(row)
    if feature == ROUND:
        return None
    a, b = (_Body(trial, index[row]) for index in (contacts.body_a, contacts.body_b))
    normal = contacts.normal[:, row]
    half = 0.5 * contacts.separation[row] * normal
    point = contacts.point[:, row]
    step = trial.step
    arm_a = a.turned((point - half - end.position[:, contacts.body_a[row]]).tolist(), step, -1.0)
    arm_b = b.turned((point + half - end.position[:, contacts.body_b[row]]).tolist(), step, -1.0)

    def between(time):
        return [(q + s) - (p + r) for p, q, r, s in zip(
            a.moved(time), b.moved(time), a.turned(arm_a, time), b.turned(arm_b, time))]

    if feature == EDGES:
        edge_a = a.turned(contacts.edge_a[:, row].tolist(), step, -1.0)
        edge_b = b.turned(contacts.edge_b[:, row].tolist(), step, -1.0)
        product = cross(contacts.edge_a[:, row].tolist(), contacts.edge_b[:, row].tolist())
        sign = 1.0 if dot(product, normal.tolist()) > 0 else -1.0

        def gap(time):
            across = cross(a.turned(edge_a, time), b.turned(edge_b, time))
            return sign * dot(across, between(time)) / sqrt(dot(across, across))
        return gap
    face = a if feature == FACE_A else b
    outward = face.turned(normal.tolist(), step, -1.0)
    return lambda time: dot(face.turned(outward, time), between(time))
