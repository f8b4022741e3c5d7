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

Candidates come from sorting along the axis that leaves the fewest; boxes are then compared by
the separating axis test on all 15 axes, many pairs at a time (Gottschalk, Lin, Manocha, OBBTree,
SIGGRAPH 1996, section 5). Fixed bodies may overlap each other and planes, to build a
surrounding.
"""

import numpy as np
from rigid_sim_ros.engine import rotation

RELATIVE_TOLERANCE = 1e-3
"""Overlap allowed, over the smallest half side of the smaller body: positions of touching
bodies are often written with few digits."""

CHUNK = 200_000
"""Pairs examined together: enough for NumPy, and a few tens of MB."""


def deepest_overlap(scene):
    """
    Return (name_a, name_b, depth [m], allowed depth [m]), or None if nothing overlaps.

    It is the deepest among the pairs looked at until the first overlap was found.
    """
    bodies = scene.bodies
    if not bodies:
        return None
    geometry = _Geometry(bodies)
    for plane in scene.planes:
        depth = geometry.depth_in_plane(plane)
        found = _worst(depth, geometry.tolerance)
        if found is not None:
            return (bodies[found].name, plane.name, depth[found], geometry.tolerance[found])
    for a, b in _candidates(geometry):
        depth = geometry.depth_of_pairs(a, b)
        tolerance = np.minimum(geometry.tolerance[a], geometry.tolerance[b])
        found = _worst(depth, tolerance)
        if found is not None:
            return (bodies[a[found]].name, bodies[b[found]].name, depth[found], tolerance[found])
    return None


def _worst(depth, tolerance):
    excess = depth - tolerance
    found = int(np.argmax(excess)) if len(excess) else None
    return found if found is not None and excess[found] > 0 else None


class _Geometry:
    """The bodies as arrays, component-major."""

    def __init__(self, bodies):
        self.position = np.array([body.position for body in bodies]).T
        self.half = np.array([body.shape.half_extents for body in bodies]).T
        self.radius = np.array([body.shape.bounding_radius for body in bodies])
        self.matrix = rotation.matrix(np.array([body.orientation for body in bodies]).T)
        self.sphere = np.array([body.shape.kind == 'sphere' for body in bodies])
        self.fixed = np.array([body.fixed for body in bodies])
        self.tolerance = RELATIVE_TOLERANCE * self.half.min(axis=0)
        # half sides of the box along the world axes around each body
        self.extent = np.where(self.sphere, self.radius,
                               np.einsum('ijn,jn->in', np.abs(self.matrix), self.half))

    def depth_in_plane(self, plane):
        """Return how deep [m] each moving body is in a plane, (n,); negative above it."""
        normal = np.array(plane.normal)
        along = np.abs(np.einsum('i,ijn->jn', normal, self.matrix))
        reach = np.where(self.sphere, self.radius, (along * self.half).sum(axis=0))
        return np.where(self.fixed, -np.inf, reach - (normal @ self.position - plane.offset))

    def depth_of_pairs(self, a, b):
        """Return the depth [m] of pairs of bodies (index arrays); not above 0 if apart."""
        depth = np.empty(len(a))
        spheres = self.sphere[a].astype(int) + self.sphere[b]
        for count, examine in enumerate((self._box_box, self._box_sphere, self._sphere_sphere)):
            chosen = np.flatnonzero(spheres == count)
            if len(chosen):
                depth[chosen] = examine(a[chosen], b[chosen])
        return depth

    def _sphere_sphere(self, a, b):
        between = self.position[:, b] - self.position[:, a]
        return self.radius[a] + self.radius[b] - np.sqrt((between * between).sum(axis=0))

    def _box_sphere(self, a, b):
        swapped = self.sphere[a]
        box, ball = np.where(swapped, b, a), np.where(swapped, a, b)
        between = self.position[:, ball] - self.position[:, box]
        # distance of the centre beyond each pair of faces, in the axes of the box
        beyond = np.abs(rotation.transform_transposed(self.matrix[:, :, box], between)) \
            - self.half[:, box]
        outside = np.maximum(beyond, 0)
        distance = np.sqrt((outside * outside).sum(axis=0)) \
            + np.minimum(beyond.max(axis=0), 0)
        return self.radius[ball] - distance

    def _box_box(self, a, b):
        matrix_a, matrix_b = self.matrix[:, :, a], self.matrix[:, :, b]
        half_a, half_b = self.half[:, a], self.half[:, b]
        between = self.position[:, b] - self.position[:, a]
        depth = np.full(len(a), np.inf)
        for axis in _axes(matrix_a, matrix_b):
            length = np.sqrt(rotation.dot(axis, axis))
            reach_a = (np.abs(rotation.transform_transposed(matrix_a, axis)) * half_a).sum(axis=0)
            reach_b = (np.abs(rotation.transform_transposed(matrix_b, axis)) * half_b).sum(axis=0)
            overlap = reach_a + reach_b - np.abs(rotation.dot(axis, between))
            # the product of parallel edges is no axis; the faces then decide
            usable = length > 1e-6
            overlap = np.divide(overlap, length, out=np.full_like(overlap, np.inf), where=usable)
            depth = np.minimum(depth, overlap)
        return depth


def _axes(matrix_a, matrix_b):
    """Yield the 15 axes, (3, m), along which two boxes that are apart can be told apart."""
    for i in range(3):
        yield matrix_a[:, i]
        yield matrix_b[:, i]
    for i in range(3):
        for j in range(3):
            yield rotation.cross(matrix_a[:, i], matrix_b[:, j])


def _candidates(geometry):
    """Yield index arrays (a, b), a < b, of pairs whose boxes along the world axes overlap."""
    lower = geometry.position - geometry.extent
    upper = geometry.position + geometry.extent
    order, ends = min((_sweep(lower[axis], upper[axis]) for axis in range(3)),
                      key=lambda swept: swept[1].sum())
    lower, upper, fixed = lower[:, order], upper[:, order], geometry.fixed[order]
    totals = np.cumsum(ends)
    first = 0
    while first < len(order):
        done = totals[first - 1] if first else 0
        last = max(first + 1, int(np.searchsorted(totals, done + CHUNK, side='right')))
        counts = ends[first:last]
        a = np.repeat(np.arange(first, last), counts)
        starts = np.repeat(np.cumsum(counts) - counts, counts)
        b = a + 1 + np.arange(len(a)) - starts
        keep = ~(fixed[a] & fixed[b])
        for axis in range(3):
            keep &= (lower[axis, a] < upper[axis, b]) & (lower[axis, b] < upper[axis, a])
        a, b = order[a[keep]], order[b[keep]]
        yield np.minimum(a, b), np.maximum(a, b)
        first = last


def _sweep(lower, upper):
    """Return the order by lower end, and how many following bodies begin within each body."""
    order = np.argsort(lower, kind='stable')
    begins = lower[order]
    return order, np.searchsorted(begins, upper[order]) - np.arange(len(order)) - 1
