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
Contacts whose state can be guessed: which are closed, and that those stick unless known to slide.

One linear system then gives the forces, and a look at them proves the guess or refuses it.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import canonical
from rigid_sim_ros.engine.solvers.problem import Solution


def solve_guessed(problem, closed, accuracy):
    """
    Return the `Solution` in which exactly the contacts `closed` (k,) bool are closed, or None.

    Closed contacts end with motion_n = 0, open ones have their floor as normal force; where there
    is a normal force the contact sticks, or slides as `problem.slip` says. None means that this
    is not the solution, or not to be had by one linear system.
    """
    count = problem.count
    compliance = canonical.compliance_of(problem)
    matrix = problem.response.copy()
    diagonal = matrix.ravel()[::3 * count + 1]
    diagonal += compliance
    fixed, value = _prescribe(problem, closed, matrix)
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return None
    passes = 0

    def solve(free, force):
        nonlocal passes
        passes += 1
        wanted = -free if fixed is None else np.where(fixed, value, -free)
        # a correction of the force before, so that the digits an inverse loses are found again
        force = inverse @ wanted if force is None else force + inverse @ (wanted - matrix @ force)
        return force if _holds(problem, closed, force, free, compliance) else None

    force = canonical.refine(solve, problem, compliance, accuracy)
    return None if force is None else Solution(force, passes, force)


def _prescribe(problem, closed, matrix):
    """Replace the rows of forces that follow from others or are given; return which, and what."""
    count = problem.count
    if problem.slip is None and closed.all():
        return None, None
    pressed = closed | (problem.floor > 0)
    sliding = np.any(problem.slip != 0, axis=0) & pressed
    fixed = np.concatenate((~closed, sliding | ~pressed, sliding | ~pressed))
    value = np.zeros(3 * count)
    value[:count] = problem.floor
    rows = np.flatnonzero(fixed)
    matrix[rows] = 0.0
    matrix[rows, rows] = 1.0
    rows = np.flatnonzero(sliding)
    for tangent, slip in enumerate(problem.slip, start=1):
        matrix[rows + tangent * count, rows] = (problem.friction * slip)[rows]
    return fixed, value


def _holds(problem, closed, force, free, compliance):
    """Return whether closed contacts push, open ones part and those that stick may do so."""
    count = problem.count
    normal, first, second = force.reshape(3, count)
    if (normal < problem.floor).any():
        return False
    limit = problem.friction * normal
    if problem.slip is not None:
        limit = np.where(np.any(problem.slip != 0, axis=0), np.inf, limit)
    if (first * first + second * second > limit * limit).any():
        return False
    if closed.all():
        return True
    motion = free[:count] + problem.response[:count] @ force + compliance * normal
    return not (motion[~closed] < 0).any()
