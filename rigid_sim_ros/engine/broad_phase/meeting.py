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

"""How long bounding spheres stay apart in flight."""

from math import inf, sqrt

import numpy as np

from rigid_sim_ros.engine.plain_vectors import difference
from rigid_sim_ros.engine.plain_vectors import dot as dot_of_one
from rigid_sim_ros.engine.rotation import cross, dot

FEW = 4
"""Up to so many pairs are looked at one by one in plain floats, which is faster (measured)."""

MARCH_COUNT = 6
"""Refinements of the time at which two bodies with different accelerations meet."""

_LATEST = 1e100
"""Time [s] beyond which a march goes no further: squares of it are numbers."""

_CLOSER = 1e-12
"""Spheres count as wider by this part of their distance: rounding must not lose a meeting."""


def meeting_times(bodies, pairs_a, pairs_b, position, velocity, acceleration, later=inf):
    """
    Return how long [s], (p,), the bounding spheres of each pair stay apart.

    Zero where they overlap now, infinite where they never meet. Exact for a body and a plane, and
    for two bodies with the same acceleration; otherwise a lower bound, found by marching along
    the line between the centres.

    Parameters
    ----------
    bodies : Bodies
        Which bodies there are.
    pairs_a, pairs_b : (p,) int
        Not two planes.
    position : (3, n) [m]
        Of all bodies and planes.
    velocity : (3, n) [m/s]
        Of the same, zero of what is fixed.
    acceleration : (3, n) [m/s^2]
        Of the same, constant, zero of what is fixed.
    later : float [s]
        What is later need not be looked at closer.

    """
    if len(pairs_a) <= FEW:
        def motion(index):
            return [values[:, index].tolist() for values in (position, velocity, acceleration)]
        return np.array([meeting_time(bodies, int(a), int(b), motion)
                         for a, b in zip(pairs_a, pairs_b)])
    result = np.empty(len(pairs_a))
    body_count = bodies.body_count
    with_plane = (pairs_a >= body_count) | (pairs_b >= body_count)
    rows = np.flatnonzero(with_plane)
    if len(rows):
        body = np.minimum(pairs_a[rows], pairs_b[rows])
        plane = np.maximum(pairs_a[rows], pairs_b[rows])
        normal, offset = bodies.plane_normal[:, plane], bodies.plane_offset[plane]
        height = dot(normal, position[:, body]) - offset
        result[rows] = first_falls(
            height - bodies.bounding_radius[body] - _CLOSER * (np.abs(height) + np.abs(offset)),
            dot(normal, velocity[:, body]), dot(normal, acceleration[:, body]))
    rows = np.flatnonzero(~with_plane)
    a, b = pairs_a[rows], pairs_b[rows]
    result[rows] = sphere_meeting_times(
        bodies.bounding_radius.take(a) + bodies.bounding_radius.take(b),
        *(values.take(b, axis=1) - values.take(a, axis=1)
          for values in (position, velocity, acceleration)), later)
    return result


def first_falls(height, speed, acceleration):
    """Return when, (p,) [s], height + speed t + acceleration t^2 / 2 first is not positive."""
    square = speed * speed - 2 * acceleration * height
    root = np.sqrt(np.maximum(square, 0.0))
    # two forms of the same root: what rises from next to nothing has one in which nothing cancels
    above, below = np.where(speed > 0, (speed + root, -acceleration), (2 * height, root - speed))
    reaches = (square >= 0) & (below > 0)
    time = np.where(reaches, above / np.where(reaches, below, 1.0), np.inf)
    return np.where(height <= 0, 0.0, time)


def sphere_meeting_times(reach, between, velocity, acceleration, later=inf):
    """Return when centres `between` (3, p), in relative motion, are within `reach` [m], (p,)."""
    distance = np.sqrt(dot(between, between))
    reach = reach + _CLOSER * (distance + reach)
    ahead = (distance - reach) * (distance + reach)
    curved = acceleration.any(axis=0)
    if curved.all():
        time = _march(reach, between, velocity, acceleration, later)
    else:
        time = _straight(reach, ahead, between, velocity)
        rows = np.flatnonzero(curved)
        if len(rows):
            time[rows] = _march(reach[rows], between[:, rows], velocity[:, rows],
                                acceleration[:, rows], later)
    return np.where(ahead <= 0, 0.0, time)


def _straight(reach, ahead, between, velocity):
    """Return the same where there is no relative acceleration; `ahead` is |d|^2 - R^2."""
    # |d + u t|^2 = R^2; the discriminant by the vector product, which does not cancel
    closing = -dot(between, velocity)
    speed = dot(velocity, velocity)
    aside = cross(between, velocity)
    square = speed * reach * reach - dot(aside, aside)
    meets = (square >= 0) & (closing > 0)
    return np.where(meets, ahead / np.where(
        meets, closing + np.sqrt(np.maximum(square, 0.0)), 1.0), np.inf)


def _march(reach, between, velocity, acceleration, later):
    """Return a lower bound of the same where there is; one beyond `later` [s] is good enough."""
    columns = reach, between, velocity, acceleration
    result = _further(*columns, np.zeros(len(reach)))
    soon = np.flatnonzero(result <= later)
    if len(soon) <= FEW:
        for row in soon.tolist():
            result[row] = _march_of_one(*(values[..., row].tolist() for values in columns))
        return result
    if len(soon) < len(result):
        columns = [values.take(soon, axis=-1) for values in columns]
    time = result[soon]
    for _ in range(MARCH_COUNT - 1):
        time = _further(*columns, time)
    result[soon] = time
    return result


def _further(reach, between, velocity, acceleration, time):
    """Return bounds no earlier than those there are, `time` (p,) [s]."""
    # a direction held fixed: the distance is never less than what is seen along it
    now = np.where(time < _LATEST, time, 0.0)
    there = between + now * (velocity + 0.5 * now * acceleration)
    distance = np.sqrt(dot(there, there))
    direction = there / np.where(distance > 0, distance, 1.0)
    speed = dot(direction, velocity + now * acceleration)
    return time + first_falls(distance - reach, speed, dot(direction, acceleration))


def meeting_time(bodies, a, b, motion):
    """
    Return the meeting time [s] of one pair.

    `motion(index)` returns position, velocity and acceleration of a body, (3,) each.
    """
    if max(a, b) < bodies.body_count:
        reach = bodies.bounding_radius.item(a) + bodies.bounding_radius.item(b)
        return sphere_meeting_time(reach, *map(difference, motion(a), motion(b)))
    body, plane = min(a, b), max(a, b)
    normal, offset = bodies.plane_normal[:, plane].tolist(), bodies.plane_offset.item(plane)
    height, speed, pull = (dot_of_one(normal, vector) for vector in motion(body))
    height -= offset
    gap = height - bodies.bounding_radius.item(body) - _CLOSER * (abs(height) + abs(offset))
    return first_fall(gap, speed, pull)


def first_fall(height, speed, acceleration):
    """Return `first_falls` of plain floats."""
    if height <= 0:
        return 0.0
    square = speed * speed - 2 * acceleration * height
    if square < 0:
        return inf
    if speed > 0:
        return (speed + sqrt(square)) / -acceleration if acceleration < 0 else inf
    run = sqrt(square) - speed
    return 2 * height / run if run > 0 else inf


def sphere_meeting_time(reach, between, velocity, acceleration):
    """Return `sphere_meeting_times` of one pair in plain floats, vectors (3,)."""
    x, y, z = between
    u, v, w = velocity
    distance = sqrt(x * x + y * y + z * z)
    reach += _CLOSER * (distance + reach)
    if distance <= reach:
        return 0.0
    if any(acceleration):
        return _march_of_one(reach, between, velocity, acceleration)
    closing = -(x * u + y * v + z * w)
    p, q, r = y * w - z * v, z * u - x * w, x * v - y * u
    square = (u * u + v * v + w * w) * reach * reach - (p * p + q * q + r * r)
    if square < 0 or closing <= 0:
        return inf
    return (distance - reach) * (distance + reach) / (closing + sqrt(square))


def _march_of_one(reach, between, velocity, acceleration):
    """Return `_march` of one pair in plain floats."""
    x, y, z = between
    u, v, w = velocity
    p, q, r = acceleration
    time = 0.0
    for _ in range(MARCH_COUNT):
        half = 0.5 * time
        i, j, k = (x + time * (u + half * p), y + time * (v + half * q), z + time * (w + half * r))
        distance = sqrt(i * i + j * j + k * k)
        part = 1.0 / (distance or 1.0)
        i, j, k = i * part, j * part, k * part
        time += first_fall(distance - reach, i * (u + time * p) + j * (v + time * q)
                           + k * (w + time * r), i * p + j * q + k * r)
        if time > _LATEST:
            break
    return time
