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
Contacts without friction: the normal rows alone, a linear complementarity problem.

Newton's method is then a search for the set of closed contacts: solve as if a set were it, let go
what pulls, take in what closes, until nothing changes.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import canonical
from rigid_sim_ros.engine.solvers.problem import Solution

_MAX_ITERATIONS = 50


def solve_frictionless(problem, accuracy):
    """Return the `Solution` of a problem whose frictions are all zero, or None."""
    count = problem.count
    compliance = canonical.compliance_of(problem)
    matrix = problem.response[:count, :count] + compliance * np.eye(count)
    closed = problem.free[:count] + problem.response[:count, :count] @ problem.floor < 0
    iterations = 0

    def solve(free, _):
        nonlocal closed, iterations
        for _ in range(_MAX_ITERATIONS):
            iterations += 1
            normal = _closing(matrix, free[:count], problem.floor, closed)
            motion = free[:count] + matrix @ normal
            found = np.where(closed, normal > problem.floor, motion < 0)
            if (found == closed).all():
                return np.concatenate((normal, np.zeros(2 * count)))
            closed = found
        return None

    force = canonical.refine(solve, problem, compliance, accuracy)
    return None if force is None else Solution(force, iterations, force)


def _closing(matrix, free, floor, closed):
    """Return the normal forces (k,) if exactly the contacts `closed` have no motion."""
    normal = floor.copy()
    if closed.all():
        return np.linalg.solve(matrix, -free)
    which = np.flatnonzero(closed)
    if which.size:
        # what the open contacts' floors do is part of the free motion
        floor = np.where(closed, 0.0, floor)
        normal[which] = np.linalg.solve(
            matrix[np.ix_(which, which)], -(free + matrix @ floor)[which])
    return normal
