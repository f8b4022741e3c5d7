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

"""Pairs that are near each other now."""

import numpy as np

from rigid_sim_ros.engine.broad_phase.sphere_grid import spheres_with_others, spheres_with_spheres


def candidate_pairs(bodies, position, margin=0.0):
    """
    Return all pairs a < b whose bounding spheres, or sphere and plane, are nearer than `margin`.

    Of two fixed columns none is returned.

    Parameters
    ----------
    bodies : Bodies
        Which bodies there are.
    position : (3, n) [m]
        Of all bodies; what follows for the planes is not read.
    margin : float [m]
        Largest distance of the spheres.

    Returns
    -------
    pairs_a, pairs_b : (p,) int

    """
    moving, count = bodies.moving_count, bodies.body_count
    radius = bodies.bounding_radius[:count] + 0.5 * margin
    pairs = [spheres_with_spheres(position[:, :moving], radius[:moving])]
    if count > moving:
        a, b = spheres_with_others(position[:, :moving], radius[:moving],
                                   position[:, moving:count], radius[moving:])
        pairs.append((a, b + moving))
    if bodies.count > count:
        height = (bodies.plane_normal[:, count:].T @ position[:, :moving]
                  - bodies.plane_offset[count:, np.newaxis])
        plane, body = np.nonzero(height < bodies.bounding_radius[:moving] + margin)
        pairs.append((body, plane + count))
    return tuple(np.concatenate(side) for side in zip(*pairs))
