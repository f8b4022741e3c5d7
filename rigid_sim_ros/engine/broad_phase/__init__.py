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
Which pairs can touch: now, within a margin, or during a flight up to a horizon.

Only bounding spheres and planes are looked at, and nothing is missed: every pair that is left out
is proven apart.
"""

from rigid_sim_ros.engine.broad_phase.candidates import candidate_pairs
from rigid_sim_ros.engine.broad_phase.meeting import meeting_time, meeting_times
from rigid_sim_ros.engine.broad_phase.sphere_grid import spheres_with_others, spheres_with_spheres
from rigid_sim_ros.engine.broad_phase.swept import swept_pairs

__all__ = ['candidate_pairs', 'meeting_time', 'meeting_times', 'spheres_with_others',
           'spheres_with_spheres', 'swept_pairs']
