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
Solvers of the contact problem: the quickest that fits is tried first, the next if it refuses.

All give the same, canonical forces (see `canonical`), but for a projected gradient as the last
resort.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import canonical
from rigid_sim_ros.engine.solvers.accelerated import accelerated, Cones, largest_eigenvalue
from rigid_sim_ros.engine.solvers.balance import balanced, restored, scales_of
from rigid_sim_ros.engine.solvers.frictionless import solve_frictionless
from rigid_sim_ros.engine.solvers.newton import solve_newton
from rigid_sim_ros.engine.solvers.problem import ContactProblem, Solution
from rigid_sim_ros.engine.solvers.rows import contact_rows, ContactRows
from rigid_sim_ros.engine.solvers.single import slide_one, solve_one

__all__ = ['contact_rows', 'ContactProblem', 'ContactRows', 'Solution', 'solve']

_LAST_ITERATIONS = 1000
"""Of the projected gradient, where Newton's method fails."""

_ROUNDS = 20
"""Of the power method, for its step."""


def solve(problem, guess=None, accuracy=canonical.ACCURACY):
    """
    Return the `Solution` of a `ContactProblem` with one or more contacts.

    The guess (3k,), a remembered force say, saves time and does not change the answer. The
    accuracy is what may be left of each condition, in parts of the free motion.
    """
    if problem.count == 1 and (solution := _solve_one(problem)) is not None:
        return solution
    scales = scales_of(problem)
    if scales is None:
        return _solve_many(problem, guess, accuracy)
    guess = None if guess is None else guess / scales
    return restored(_solve_many(balanced(problem, scales), guess, accuracy), scales)


def _solve_many(problem, guess, accuracy):
    """Return the `Solution` of a problem of several contacts whose responses are alike."""
    if not problem.friction.any():
        solution = solve_frictionless(problem, accuracy)
        if solution is not None:
            return solution
    solution = solve_newton(problem, guess, accuracy)
    if solution.force is None:
        force, used = _solve_accelerated(problem)
        solution = Solution(force, solution.iterations + used, force)
    return solution


def _solve_one(problem):
    """Return the `Solution` of a problem of one contact, by closed form, or None."""
    response = problem.response[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]].tolist()
    free, friction, floor = problem.free.tolist(), problem.friction.item(), problem.floor.item()
    slip = problem.slip[:, 0].tolist()
    if slip == [0.0, 0.0]:
        force = np.array(solve_one(response, free, friction, floor))
        return Solution(force, 1, force)
    force = slide_one(response, free[0], friction, slip) if floor == 0.0 else None
    if force is None:
        return None
    force = np.array(force)
    return Solution(force, 1, force)


def _solve_accelerated(problem):
    """Return (force, iterations) by the projected gradient, which finds any sliding itself."""
    largest, _ = largest_eigenvalue(
        problem.response.__matmul__, np.ones(len(problem.free)), _ROUNDS)
    start = np.concatenate((problem.floor, np.zeros(2 * problem.count)))
    force, used, _ = accelerated(
        problem.response.__matmul__, 0.8 / largest, Cones(problem.friction, problem.floor),
        problem.free, start, 1e-9 * np.abs(problem.free).max(), _LAST_ITERATIONS)
    return force, used
