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
Where rays meet boxes, balls and planes.

Vectors are component-major: the first axis is x, y, z (three times faster than the last).
"""

import numpy as np

PARALLEL = 1e-12
"""Stands for the component of a ray that has none, so that nothing is divided by zero."""


def hit_box(origin, rays, half):
    """
    Return where rays enter and leave a box, in multiples of the rays; it is hit if enter < leave.

    Parameters
    ----------
    origin : (3, ...) [m]
        Where the rays start, in body axes.
    rays : (3, ...)
        Their directions, of any length, in body axes.
    half : (3,) [m]
        Half the edges of the box.

    """
    enter, leave = -np.inf, np.inf
    for start, ray, side in zip(origin, rays, half):
        inverse = 1 / np.where(np.abs(ray) < PARALLEL, PARALLEL, ray)
        middle = -start * inverse
        reach = np.abs(inverse) * side
        enter = np.maximum(enter, middle - reach)
        leave = np.minimum(leave, middle + reach)
    return enter, leave


def hit_ball(origin, rays, radius):
    """Return the same for a ball of the radius [m]."""
    square = dot(rays, rays)
    middle = -dot(origin, rays) / square
    nearest = [start + middle * ray for start, ray in zip(origin, rays)]
    inside = radius * radius - dot(nearest, nearest)
    reach = np.sqrt(np.maximum(inside, 0) / square)
    return np.where(inside > 0, middle - reach, np.inf), middle + reach


def hit_plane(origin, rays, normal, offset):
    """Return the multiples of the rays at which they meet normal . x = offset; inf if never."""
    along = dot(normal, rays)
    parallel = np.abs(along) < PARALLEL
    multiple = (offset - dot(normal, origin)) / np.where(parallel, PARALLEL, along)
    return np.where((multiple > 0) & ~parallel, multiple, np.inf)


def dot(a, b):
    """Return the scalar products of vectors (3, ...)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def to_axes(matrix, vectors):
    """Return vectors (3, ...) in the axes that are the columns of a rotation matrix (3, 3)."""
    return np.stack([dot(axis, vectors) for axis in matrix.T])
