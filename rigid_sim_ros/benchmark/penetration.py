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
How deep bodies overlap, from their poses alone: the same measure for every engine.

Written for the benchmark with nothing in common with the engine. Boxes by the separating axis
theorem with all 15 axes: the depth of a pair is the smallest overlap along any of them
(Gottschalk, Lin and Manocha 1996). Boxes and spheres against planes by their lowest point.
"""

import numpy as np

PARALLEL = 1e-6
"""Edges with a smaller sine between them have no axis of their own: the faces' axes decide."""

CHUNK = 200
"""Rows of the distance table that are made at once."""


def deepest_penetration(scene, position, orientation):
    """
    Return the deepest overlap [m] of any two bodies or a body and a plane, zero if there is none.

    Parameters
    ----------
    scene : model.Scene
        Without fixed bodies; spheres are only measured against planes.
    position, orientation : (n, 3), (n, 4)
        Of its bodies [m], x, y, z, w.

    """
    axes = np.moveaxis(_matrices(orientation), 2, 1)
    half = np.array([body.shape.half_extents for body in scene.bodies])
    round_ = np.array([body.shape.kind == 'sphere' for body in scene.bodies])
    deepest = 0.0
    for plane in scene.planes:
        normal = np.array(plane.normal)
        reach = np.where(round_, half[:, 0], (np.abs(axes @ normal) * half).sum(axis=1))
        deepest = max(deepest, (reach - (position @ normal - plane.offset)).max())
    first, second = _near_pairs(position[~round_], np.linalg.norm(half[~round_], axis=1))
    if first.size:
        axes, half, position = axes[~round_], half[~round_], position[~round_]
        depth = _box_overlaps(position[second] - position[first], axes[first], axes[second],
                              half[first], half[second])
        deepest = max(deepest, depth.max())
    return float(deepest)


def _matrices(orientation):
    """Return rotation matrices (n, 3, 3), body to world."""
    x, y, z, w = orientation.T
    return np.moveaxis(np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]), -1, 0)


def _near_pairs(position, radius):
    """Return the two index arrays of the pairs whose bounding spheres overlap."""
    pairs = []
    for start in range(0, len(position), CHUNK):
        rows = slice(start, start + CHUNK)
        distance = np.linalg.norm(position[rows, None] - position, axis=2)
        first, second = np.nonzero(distance < radius[rows, None] + radius)
        first = first + start
        pairs.append((first[first < second], second[first < second]))
    if not pairs:
        return np.zeros(0, int), np.zeros(0, int)
    return tuple(np.concatenate(part) for part in zip(*pairs))


def _box_overlaps(offset, axes_a, axes_b, half_a, half_b):
    """Return the smallest overlap [m], (p,), along the 15 axes; negative where they are apart."""
    crossed = np.cross(axes_a[:, :, None], axes_b[:, None]).reshape(-1, 9, 3)
    length = np.linalg.norm(crossed, axis=2)
    usable = length > PARALLEL
    crossed /= np.where(usable, length, 1.0)[..., None]
    tried = np.concatenate((axes_a, axes_b, crossed), axis=1)
    reach = (np.abs(np.einsum('pij,pkj->pik', tried, axes_a)) @ half_a[..., None]
             + np.abs(np.einsum('pij,pkj->pik', tried, axes_b)) @ half_b[..., None])[..., 0]
    overlap = reach - np.abs(np.einsum('pij,pj->pi', tried, offset))
    overlap[:, 6:][~usable] = np.inf
    return overlap.min(axis=1)
