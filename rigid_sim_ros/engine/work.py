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

"""Counters of the work a simulation has done, so that tests can prove what was skipped."""

from dataclasses import dataclass


@dataclass
class Work:
    """What has been done since the start, each a count."""

    pair_bounds: int = 0
    """Pairs whose bounding spheres were compared."""

    touch_searches: int = 0
    """Pairs whose first touch was searched on their exact flights."""

    narrow_phases: int = 0
    """Pairs whose contact points were computed."""

    impacts: int = 0
    """Instants at which impulses were applied."""

    contact_steps: int = 0
    """Steps of bodies in lasting contact."""

    solver_iterations: int = 0
    """Iterations of contact solvers, in impacts and contact steps."""

    pose_evaluations: int = 0
    """Times at which the poses of all bodies were evaluated."""
