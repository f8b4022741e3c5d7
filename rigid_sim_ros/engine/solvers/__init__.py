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

All give the same, canonical forces (see `canonical`), but for Gauss-Seidel as a last resort.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import canonical
from rigid_sim_ros.engine.solvers.frictionless import solve_frictionless
from rigid_sim_ros.engine.solvers.gauss_seidel import sweeps
from rigid_sim_ros.engine.solvers.linear import solve_guessed
from rigid_sim_ros.engine.solvers.newton import newton
from rigid_sim_ros.engine.solvers.problem import ContactProblem, Solution
from rigid_sim_ros.engine.solvers.rows import contact_rows, ContactRows
from rigid_sim_ros.engine.solvers.single import solve_one

__all__ = ['contact_rows', 'ContactProblem', 'ContactRows', 'Solution', 'solve']

_GUESS_SWEEPS = 60
"""Sweeps of Gauss-Seidel that make a guess for Newton's second attempt."""

_LAST_SWEEPS = 1000
"""Sweeps where Newton fails twice."""


def solve(problem, guess=None):
    """
    Return the `Solution` of a `ContactProblem` with one or more contacts.

    The guess (3k,), a remembered force say, saves time and does not change the answer.
    """
    if problem.count == 1 and not problem.slip.any():
        return _solve_one(problem)
    if not problem.friction.any():
        solution = solve_frictionless(problem)
        if solution is not None:
            return solution
    solution = solve_guessed(problem, _closed(problem, guess))
    return solution if solution is not None else _solve_newton(problem, guess)


def _closed(problem, guess):
    """Return which contacts (k,) are taken as closed, for a start."""
    count = problem.count
    if guess is not None:
        return guess[:count] > problem.floor
    if not problem.floor.any():
        return np.ones(count, dtype=bool)
    return problem.free[:count] + problem.response[:count, :count] @ problem.floor < 0


def _solve_one(problem):
    """Return the `Solution` of a problem of one contact, by closed form."""
    response = problem.response[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]].tolist()
    force = solve_one(response, problem.free.tolist(), problem.friction.item(),
                      problem.floor.item())
    return Solution(np.array(force), 1)


def _solve_newton(problem, guess):
    """Return the `Solution` by Newton's method, with Gauss-Seidel where it fails."""
    compliance = canonical.compliance_of(problem)
    matrix = problem.response + compliance * np.eye(len(problem.response))
    iterations = 0
    start = np.concatenate((problem.floor, np.zeros(2 * problem.count)))

    def solve_pass(free, previous):
        nonlocal iterations
        first = previous if previous is not None else start if guess is None else guess
        force, used = newton(problem, matrix, free, first)
        iterations += used
        if force is not None:
            return force
        first = sweeps(problem, matrix, free, start, _GUESS_SWEEPS)
        force, used = newton(problem, matrix, free, first)
        iterations += used + _GUESS_SWEEPS
        if force is not None:
            return force
        iterations += _LAST_SWEEPS
        return sweeps(problem, matrix, free, first, _LAST_SWEEPS)

    return Solution(canonical.refine(solve_pass, problem, compliance), iterations)
