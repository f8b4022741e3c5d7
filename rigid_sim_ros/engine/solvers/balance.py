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
Contacts between very unequal bodies, brought to a common scale.

The compliance of the canonical choice (see `canonical`) is a part of the mean response, which the
lightest bodies make. To a body a million times as heavy it is softer than the body is heavy:
refining it away would never end, and the body would sink. With force and motion of contact i

    motion_i = motion'_i / s_i,   force_i = s_i force'_i

the problem stays one of Coulomb friction, with the response s_i response_ij s_j.
"""

from dataclasses import replace

import numpy as np

from rigid_sim_ros.engine.solvers.problem import Solution

UNEQUAL = 1000.0
"""
The mean normal response may be so many times the least one: then refining still gains two digits
a pass. Problems within that are left alone.
"""


def scales_of(problem):
    """Return the scales s (3k,) of the contacts of a `ContactProblem`, or None if all are one."""
    count = problem.count
    normal = problem.response.ravel()[::3 * count + 1][:count]
    limit = float(normal.sum()) / (UNEQUAL * count)
    least = float(normal.min())
    if least >= limit or least <= 0.0:
        return None
    return np.tile(np.sqrt(np.maximum(limit / normal, 1.0)), 3)


def balanced(problem, scales):
    """Return a `ContactProblem` with its contacts on these scales (3k,)."""
    factor = problem.factor
    return replace(
        problem, response=scales[:, None] * problem.response * scales,
        free=scales * problem.free, floor=problem.floor / scales[:problem.count],
        factor=None if factor is None else scales[:, None] * factor)


def restored(solution, scales):
    """Return the `Solution` of the problem that was brought to these scales (3k,)."""
    return Solution(scales * solution.force, solution.iterations, scales * solution.start)
