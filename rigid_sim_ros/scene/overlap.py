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
Which bodies of a scene overlap before anything has moved.

Fixed bodies may overlap each other and planes, to build a surrounding.
"""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.bodies import bodies_of, ordered
from rigid_sim_ros.engine.narrow_phase import separations

RELATIVE_TOLERANCE = 1e-3
"""Overlap allowed, over the smallest half side of the smaller body: positions of touching
bodies are often written with few digits."""

CHUNK = 200_000
"""Candidates examined together: enough for NumPy, and a few tens of MB."""


def deepest_overlap(scene):
    """
    Return (name_a, name_b, depth [m], allowed depth [m]), or None if nothing overlaps.

    It is the deepest among the pairs looked at until the first overlap was found.
    """
    if not scene.bodies:
        return None
    bodies = bodies_of(scene)
    position, orientation = _poses(scene)
    # a plane has no size; what touches it counts
    thickness = bodies.half_extents.min(axis=0)
    allowed = RELATIVE_TOLERANCE * np.where(thickness > 0, thickness, np.inf)
    for a, b in _candidates(bodies, position, orientation):
        depth = -separations(bodies, a, b, position, orientation)
        tolerance = np.minimum(allowed[a], allowed[b])
        if (depth > tolerance).any():
            worst = int(np.argmax(depth - tolerance))
            return (bodies.names[a[worst]], bodies.names[b[worst]], depth[worst],
                    tolerance[worst])
    return None


def _poses(scene):
    """Return positions (3, n) and orientations (4, n) in the order of `Bodies`."""
    bodies = ordered(scene)
    position = np.zeros((3, len(bodies) + len(scene.planes)))
    orientation = np.zeros((4, position.shape[1]))
    orientation[3] = 1.0
    position[:, :len(bodies)] = np.array([body.position for body in bodies]).T
    orientation[:, :len(bodies)] = np.array([body.orientation for body in bodies]).T
    return position, orientation


def _candidates(bodies, position, orientation):
    """Yield index arrays (a, b) of moving bodies and what they may overlap: planes, bodies."""
    moving = np.arange(bodies.moving_count)
    for plane in range(bodies.body_count, bodies.count):
        yield moving, np.full(len(moving), plane)
    body_count = bodies.body_count
    half = bodies.half_extents[:, :body_count]
    # half sides of the box along the world axes around each body; a sphere's are its radius
    matrix = rotation.matrix(orientation[:, :body_count])
    extent = np.minimum(rotation.transform(np.abs(matrix), half),
                        bodies.bounding_radius[:body_count])
    lower, upper = position[:, :body_count] - extent, position[:, :body_count] + extent
    for a, b in _sweep(lower, upper):
        keep = (a < bodies.moving_count) | (b < bodies.moving_count)
        for axis in range(3):
            keep &= (lower[axis, a] < upper[axis, b]) & (lower[axis, b] < upper[axis, a])
        yield np.minimum(a, b)[keep], np.maximum(a, b)[keep]


def _sweep(lower, upper):
    """
    Yield index arrays (a, b) of all intervals that overlap along one axis, some at a time.

    It is the axis that leaves the fewest pairs, of x, y and z.
    """
    order, counts = min((_sorted_by_lower_end(lower[axis], upper[axis]) for axis in range(3)),
                        key=lambda swept: swept[1].sum())
    totals = np.cumsum(counts)
    first = 0
    while first < len(order):
        done = totals[first - 1] if first else 0
        last = max(first + 1, int(np.searchsorted(totals, done + CHUNK, side='right')))
        a = np.repeat(np.arange(first, last), counts[first:last])
        before = np.repeat(totals[first:last] - counts[first:last] - done, counts[first:last])
        b = a + 1 + np.arange(len(a)) - before
        yield order[a], order[b]
        first = last


def _sorted_by_lower_end(lower, upper):
    """Return the order by lower end, and how many of those that follow begin within each."""
    order = np.argsort(lower, kind='stable')
    following = np.searchsorted(lower[order], upper[order]) - np.arange(len(order)) - 1
    # far out an interval may have no length left
    return order, np.maximum(following, 0)
