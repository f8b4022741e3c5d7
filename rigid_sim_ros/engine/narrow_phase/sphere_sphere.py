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

"""Two spheres."""

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts, ROUND
from rigid_sim_ros.engine.rotation import dot


def separation(a, b):
    """Return the distances [m], (p,), of the surfaces; negative in penetration."""
    between = b.center - a.center
    return np.sqrt(dot(between, between)) - a.radius - b.radius


def contacts(a, b, margin):
    """Return one contact for every pair with a separation below `margin` [m], (p,)."""
    between = b.center - a.center
    distance = np.sqrt(dot(between, between))
    gap = distance - a.radius - b.radius
    near = np.flatnonzero(gap < margin)
    between, distance, gap = between[:, near], distance[near], gap[near]
    # the same centre leaves the direction open; any will do, this one is the same for all labels
    concentric = distance == 0
    normal = between / np.where(concentric, 1.0, distance)
    normal[2, concentric] = 1.0
    point = a.center[:, near] + normal * (a.radius[near] + 0.5 * gap)
    zeros = np.zeros_like(normal)
    return Contacts(a.index[near], b.index[near], point, normal, gap,
                    np.full(len(near), ROUND), zeros, zeros)
