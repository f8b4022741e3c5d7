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
What can meet: one row a pair of shapes.

A row gives the two functions of its file. Both take `Solids` a and b of the row's kinds, in this
order; `separation(a, b)` returns signed distances (p,), `contacts(a, b, margin)` returns
`Contacts` with normals from a to b. A new shape is a file and a row for everything it can meet.
"""

from dataclasses import dataclass
from typing import Callable

from rigid_sim_ros.engine.bodies import PLANE
from rigid_sim_ros.engine.narrow_phase import box_box
from rigid_sim_ros.engine.narrow_phase import box_plane
from rigid_sim_ros.engine.narrow_phase import sphere_box
from rigid_sim_ros.engine.narrow_phase import sphere_plane
from rigid_sim_ros.engine.narrow_phase import sphere_sphere


@dataclass(frozen=True)
class PairOfShapes:
    """How two kinds of shape meet."""

    separation: Callable
    contacts: Callable


PAIRS = {
    ('box', 'box'): PairOfShapes(box_box.separation, box_box.contacts),
    ('box', PLANE): PairOfShapes(box_plane.separation, box_plane.contacts),
    ('sphere', 'box'): PairOfShapes(sphere_box.separation, sphere_box.contacts),
    ('sphere', PLANE): PairOfShapes(sphere_plane.separation, sphere_plane.contacts),
    ('sphere', 'sphere'): PairOfShapes(sphere_sphere.separation, sphere_sphere.contacts),
}
"""Every pair of kinds that can meet, in one order; the other order is the same pair."""
