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
"""How far bodies may come in a step, and how far they have."""

from math import sqrt

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.columns import columns_of
from rigid_sim_ros.engine.turning_bounds import TurningBounds

REACH_FACTOR = 2.0
"""
How much faster than now a body may be after an impact within a step: what could meet at this speed
is looked at together.
"""

FEW = 8
"""Up to so many bodies plain floats are quicker."""


class Reach:
    """How far `Bodies` with these `Flights` may come."""

    def __init__(self, bodies, flights):
        """See the class."""
        self._bodies = bodies
        self._flights = flights
        self._turning = TurningBounds(bodies)

    def until(self, state, start, end):
        """Return how far points of bodies may come until `end`, (n,) [m]; zero if they rest."""
        pull = self._flights.acceleration
        reach = np.zeros(self._bodies.count)
        moving = slice(0, self._bodies.moving_count)
        linear, pull = (np.sqrt(rotation.dot(values, values))[moving]
                        for values in (state.linear_velocity, pull))
        turning = self._turning.speeds(state.orientation[:, moving],
                                       state.angular_velocity[:, moving])
        reach[moving] = REACH_FACTOR * (end - start) * (linear + turning + pull * (end - start))
        return reach

    def most(self, members, state, start, end):
        """Return the largest of `until` of bodies (k,)."""
        if len(members) > FEW or self._turning.tells_axes:
            return self.until(state, start, end)[members].max()
        columns, time = columns_of(members), end - start
        return REACH_FACTOR * time * max(
            sqrt(x * x + y * y + z * z) + radius * sqrt(p * p + q * q + r * r)
            + sqrt(a * a + b * b + c * c) * time
            for x, y, z, p, q, r, a, b, c, radius in zip(
                *state.linear_velocity[:, columns].tolist(),
                *state.angular_velocity[:, columns].tolist(),
                *self._flights.acceleration[:, columns].tolist(),
                self._bodies.turning_radius[columns].tolist()))

    def way(self, members, position, orientation, state):
        """Return how far [m] points of bodies (k,) have come from these poses, at most."""
        columns = columns_of(members)
        moved = state.position[:, columns] - position
        # at a distance of one a turn moves points by no more than twice that of the quaternions
        turned = 2.0 * (state.orientation[:, columns] - orientation)
        radius = self._bodies.turning_radius[columns]
        if len(members) <= FEW:
            return max(sqrt(x * x + y * y + z * z) + r * sqrt(a * a + b * b + c * c + d * d)
                       for x, y, z, a, b, c, d, r in zip(
                           *moved.tolist(), *turned.tolist(), radius.tolist()))
        return (np.sqrt(rotation.dot(moved, moved))
                + radius * np.sqrt((turned * turned).sum(axis=0))).max()


def within(bodies, position, body_a, body_b, reach):
    """Return those of pairs (p,) whose bounding spheres come together by the reach (n,) [m]."""
    apart = position[:, body_b] - position[:, body_a]
    reach = reach + np.where(np.isfinite(bodies.bounding_radius), bodies.bounding_radius, 0.0)
    limit = reach[body_a] + reach[body_b]
    near = (rotation.dot(apart, apart) <= limit * limit) | (body_b >= bodies.body_count)
    return body_a[near], body_b[near]


def passed_on(bodies, position, body_a, body_b, reach):
    """Return the reach (n,) [m] of bodies that those of pairs (p,) may hit, as they then have."""
    a, b = within(bodies, position, body_a, body_b, reach)
    weak = bodies.inverse_mass
    result = reach.copy()
    for one, other in ((a, b), (b, a)):
        np.maximum.at(result, one, reach[other] * weak[one] / (weak[one] + weak[other]))
    return result
