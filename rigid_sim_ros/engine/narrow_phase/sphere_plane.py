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

"""A sphere and a plane."""

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts, ROUND
from rigid_sim_ros.engine.rotation import dot


def separation(a, b):
    """Return the distances [m], (p,), of spheres from planes; negative in penetration."""
    return dot(b.plane_normal, a.center) - b.plane_offset - a.radius


def contacts(a, b, margin):
    """Return one contact for every pair with a separation below `margin` [m], (p,)."""
    gap = separation(a, b)
    near = np.flatnonzero(gap < margin)
    normal, gap = -b.plane_normal[:, near], gap[near]
    point = a.center[:, near] + normal * (a.radius[near] + 0.5 * gap)
    zeros = np.zeros_like(normal)
    return Contacts(a.index[near], b.index[near], point, normal, gap,
                    np.full(len(near), ROUND), zeros, zeros)
