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

"""Bodies put anywhere, for tests of the narrow phase."""

import numpy as np

from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.rotation import from_rotation_vector, multiply, rotate
from rigid_sim_ros.engine.shapes import Box, Sphere


def bodies(sizes=(), radii=(), planes=()):
    """Return `Bodies` of boxes with these sides, spheres, and planes as (normal, offset)."""
    shapes = [Box(tuple(size)) for size in sizes] + [Sphere(radius) for radius in radii]
    return bodies_of(Scene(
        bodies=tuple(Body(f'body_{number}', shape, 1.0, shape.inertia(1.0))
                     for number, shape in enumerate(shapes)),
        planes=tuple(Plane(f'plane_{number}', tuple(normal), offset)
                     for number, (normal, offset) in enumerate(planes))))


def random_orientations(rng, count):
    """Return quaternions, (4, count), uniform over all attitudes."""
    q = rng.normal(size=(4, count))
    return q / np.sqrt((q * q).sum(axis=0))


def random_box_pairs(rng, count):
    """
    Return bodies, pairs, poses of box pairs about as often apart as overlapping.

    One in three is parallel or turned by little, one in three thin (1:100) or of another scale.
    """
    half = rng.uniform(0.3, 1.0, (3, 2 * count))
    thin = rng.random(2 * count) < 1 / 3
    half[rng.integers(0, 3, 2 * count), np.arange(2 * count)] *= np.where(thin, 0.01, 1.0)
    orientation = random_orientations(rng, 2 * count)
    near = rng.random(count) < 1 / 3
    turn = rng.normal(size=(3, count)) * 10.0 ** rng.uniform(-12, -1, count)
    turn *= rng.random(count) < 0.7
    orientation[:, count:] = np.where(
        near, multiply(orientation[:, :count], from_rotation_vector(turn)),
        orientation[:, count:])
    direction = rng.normal(size=(3, count))
    axis_aligned = near & (rng.random(count) < 0.5)
    direction *= np.where(axis_aligned, np.eye(3)[:, rng.integers(0, 3, count)], 1.0)
    direction /= np.sqrt((direction * direction).sum(axis=0))
    reach = np.sqrt((half * half).sum(axis=0))
    distance = rng.uniform(0.05, 0.95, count) * (reach[:count] + reach[count:])
    position = np.zeros((3, 2 * count))
    position[:, :count] = rng.normal(size=(3, count))
    position[:, count:] = position[:, :count] + rotate(orientation[:, :count],
                                                       direction) * distance
    scale = 10.0 ** rng.uniform(-3, 3, count)
    scale = np.concatenate((scale, scale))
    return (bodies(2 * (half * scale).T), np.arange(count), np.arange(count, 2 * count),
            position * scale, orientation, scale[:count])


def moved(position, orientation, linear, angular, time):
    """Return poses after `time` [s] at constant velocities (3, n), world axes."""
    turn = from_rotation_vector(angular * time)
    return position + linear * time, multiply(turn, orientation)
