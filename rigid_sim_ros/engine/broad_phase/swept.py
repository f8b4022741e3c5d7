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

"""Pairs that can meet within a horizon, for so many bodies that not all pairs can be listed."""

import numpy as np

from rigid_sim_ros.engine.broad_phase.meeting import first_falls
from rigid_sim_ros.engine.broad_phase.sphere_grid import spheres_with_others, spheres_with_spheres
from rigid_sim_ros.engine.rotation import dot

ALL_PAIRS = 4096
"""If there are no more pairs than this, all are returned and the horizon is infinite."""

FILLING = 0.25
"""
Radius of the spheres around the paths at which the horizon ends, in mean distances of
neighbours: a body then has a neighbour whose path may cross its own every second time.
"""

LONGEST_HORIZON = 1e9
"""[s]: the horizon of bodies that do not move relative to each other; times speed, finite."""

LEAST_GROWTH = 0.1
"""These spheres grow by at least this part of the bodies' radius: crowds need a horizon too."""


def swept_pairs(bodies, flying, solid, position, velocity, acceleration):
    """
    Return pairs a < b that can meet within a horizon, and that horizon [s].

    All pairs of a flying body with another one or with anything else solid, whose bounding
    spheres meet within the horizon, are among them, and not many others. Around the path of each
    a sphere is laid; the motion that all the flying have in common is taken off before they are
    compared with each other.

    Parameters
    ----------
    bodies : Bodies
        Which bodies there are.
    flying, solid : (n,) bool
        Which move; and which can be met, among them the flying.
    position : (3, n) [m]
        Of all bodies and planes.
    velocity : (3, n) [m/s]
        Of the same, zero of what does not fly.
    acceleration : (3, n) [m/s^2]
        Of the same, constant, zero of what does not fly.

    Returns
    -------
    pairs_a, pairs_b : (p,) int
    horizon : float [s]

    """
    movers = np.flatnonzero(flying)
    still = np.flatnonzero(solid & ~flying)
    if len(movers) * (len(movers) + len(still)) <= ALL_PAIRS:
        return *_all_pairs(movers, still), np.inf
    obstacles, planes = still[still < bodies.body_count], still[still >= bodies.body_count]
    radius = bodies.bounding_radius[movers]
    motion = [values.take(movers, axis=1) for values in (position, velocity, acceleration)]
    relative = [motion[0], *(values - values.mean(axis=1, keepdims=True)
                             for values in motion[1:])]
    horizon = min(LONGEST_HORIZON, _horizon(radius, *relative, motion[0]),
                  _horizon(radius, *motion, position[:, obstacles]))
    a, b = spheres_with_spheres(*around_paths(radius, *relative, horizon))
    pairs = [(movers[a], movers[b])]
    if len(obstacles):
        a, b = spheres_with_others(*around_paths(radius, *motion, horizon),
                                   position[:, obstacles], bodies.bounding_radius[obstacles])
        a, b = movers[a], obstacles[b]
        pairs.append((np.minimum(a, b), np.maximum(a, b)))
    for plane in planes.tolist():
        normal = bodies.plane_normal[:, plane]
        height, speed, pull = (normal @ values for values in motion)
        height = height - bodies.plane_offset[plane] - radius
        # 1e-9: a bound must not be lost by rounding
        reached = movers[first_falls(height - 1e-9 * radius, speed, pull) <= horizon * (1 + 1e-9)]
        pairs.append((reached, np.full(len(reached), plane)))
    return *(np.concatenate(side) for side in zip(*pairs)), horizon


def _all_pairs(movers, still):
    """Return all pairs a < b of a flying body with another or with what is still."""
    a, b = np.triu_indices(len(movers), 1)
    one = np.concatenate((movers[a], np.repeat(movers, len(still))))
    other = np.concatenate((movers[b], np.tile(still, len(movers))))
    return np.minimum(one, other), np.maximum(one, other)


def around_paths(radius, position, velocity, acceleration, horizon):
    """
    Return the center (3, k) and radius (k,) [m] of spheres that hold bodies all the way.

    A path x + v t + a t^2 / 2 is never further than |a| T^2 / 8 from its chord.
    """
    half = 0.5 * horizon * (velocity + 0.5 * horizon * acceleration)
    bulge = 0.125 * horizon * horizon * np.sqrt(dot(acceleration, acceleration))
    return position + half, (radius + np.sqrt(dot(half, half)) + bulge) * (1 + 1e-12)


def _horizon(radius, position, velocity, acceleration, others):
    """Return the time [s] in which spheres around the paths fill the space between `others`."""
    count = others.shape[1]
    if not count:
        return np.inf
    everyone = np.concatenate((position, others), axis=1)
    typical = np.median(radius)
    extent = everyone.max(axis=1) - everyone.min(axis=1) + 2 * typical
    growth = max(FILLING * np.cbrt(extent.prod() / count) - typical, LEAST_GROWTH * typical)
    speed = np.sqrt(dot(velocity, velocity).mean())
    pull = np.sqrt(dot(acceleration, acceleration).mean())
    # half the chord grows as speed T / 2 + pull T^2 / 4
    rate = speed + np.sqrt(speed * speed + 4 * pull * growth)
    return 4 * growth / rate if rate > 0 else np.inf
