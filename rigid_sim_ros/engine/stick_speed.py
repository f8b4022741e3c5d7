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
"""How slowly points may part and stay in contact."""

from math import inf, sqrt

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.friction import mixed_restitution, restitution_of_one, surfaces_of
from rigid_sim_ros.engine.plain_vectors import dot, length

STICK_SPEED = 1e-3
"""
Points that part slower than this, times the root of acceleration times size, stay in contact. The
error it makes in a motion is of its second order (the bounces left out take as long as it says).
The acceleration is the largest of any point: a spinning body comes back to what it has hit without
gravity too, and bounces as often as one that falls.
"""

ELASTIC_STICK_SPEED = 1e-5
"""The same where nothing is lost in a rebound: bounces hardly get smaller, and energy is kept."""


def stick_speed(bodies, acceleration, angular, body_a, body_b):
    """Return the speed [m/s] below which contacts of these bodies, lists (k,), do not part."""
    strongest = largest = 0.0
    for index in {*body_a, *body_b}:
        if index < bodies.moving_count:
            radius = bodies.bounding_radius.item(index)
            rate = angular[:, index].tolist()
            strongest = max(strongest, length(acceleration[:, index].tolist())
                            + dot(rate, rate) * radius)
            largest = max(largest, radius)
    elastic = all(restitution_of_one(surfaces_of(bodies, a, b), inf) >= 1
                  for a, b in zip(body_a, body_b))
    return (ELASTIC_STICK_SPEED if elastic else STICK_SPEED) * sqrt(strongest * largest)


def stick_speeds(bodies, acceleration, angular, body_a, body_b, groups=None):
    """
    Return the `stick_speed` of each of contacts (k,), arrays (k,), or of the group it is in.

    Groups are given by number (k,) int, from 0 on; without them each is by itself.
    """
    strongest, largest = [], []
    for index in (body_a, body_b):
        radius = np.where(index < bodies.moving_count, bodies.bounding_radius[index], 0.0)
        pull, rate = acceleration[:, index], angular[:, index]
        strongest.append(np.sqrt(rotation.dot(pull, pull)) + rotation.dot(rate, rate) * radius)
        largest.append(radius)
    strongest, largest = np.maximum(*strongest), np.maximum(*largest)
    loses = mixed_restitution(bodies, body_a, body_b) < 1
    if groups is not None:
        strongest, largest, loses = (
            _greatest(values, groups) for values in (strongest, largest, loses))
    return np.where(loses, STICK_SPEED, ELASTIC_STICK_SPEED) * np.sqrt(strongest * largest)


def _greatest(values, groups):
    """Return the greatest of the values (k,) in the group (k,) each belongs to, (k,)."""
    greatest = np.zeros(groups.max() + 1, dtype=values.dtype)
    np.maximum.at(greatest, groups, values)
    return greatest[groups]
