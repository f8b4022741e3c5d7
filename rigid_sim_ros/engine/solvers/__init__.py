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

All give the same, canonical forces (see `canonical`), but for the gradient as a last resort.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import canonical
from rigid_sim_ros.engine.solvers.accelerated import accelerated, Cones, largest_eigenvalue
from rigid_sim_ros.engine.solvers.frictionless import solve_frictionless
from rigid_sim_ros.engine.solvers.linear import solve_guessed
from rigid_sim_ros.engine.solvers.newton import Newton
from rigid_sim_ros.engine.solvers.problem import ContactProblem, Solution
from rigid_sim_ros.engine.solvers.rows import contact_rows, ContactRows
from rigid_sim_ros.engine.solvers.single import solve_one

__all__ = ['contact_rows', 'ContactProblem', 'ContactRows', 'Solution', 'solve']

_FACTORS = 10.0 ** np.arange(3.0, -0.1, -0.5)
"""Of the usual compliance: the way down to it where Newton's method does not get there at once."""

_LAST_ITERATIONS = 1000
"""Of the projected gradient, where all of that fails."""

_ROUNDS = 20


def solve(problem, guess=None, accuracy=canonical.ACCURACY):
    """
    Return the `Solution` of a `ContactProblem` with one or more contacts.

    The guess (3k,), a remembered force say, saves time and does not change the answer. The
    accuracy is what may be left of each condition, in parts of the free motion.
    """
    if problem.count == 1 and not problem.slip.any():
        return _solve_one(problem)
    if not problem.friction.any():
        solution = solve_frictionless(problem, accuracy)
        if solution is not None:
            return solution
    solution = solve_guessed(problem, _closed(problem, guess), accuracy)
    return solution if solution is not None else _solve_newton(problem, guess, accuracy)


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


def _solve_newton(problem, guess, accuracy):
    """Return the `Solution` by Newton's method, and where that fails led there from softer ones."""
    start = np.concatenate((problem.floor, np.zeros(2 * problem.count)))
    found, iterations = _refined(problem, 1.0, start if guess is None else guess, accuracy)
    if found is not None:
        return Solution(found, iterations)
    factor, force, used = _softened(problem, start, accuracy)
    iterations += used
    if force is not None:
        found, used = _refined(problem, factor, force, accuracy)
        iterations += used
    if found is None:
        found, used = _solve_accelerated(problem, start)
        iterations += used
    return Solution(found, iterations)


def _refined(problem, factor, guess, accuracy):
    """Return (force or None, iterations), with `factor` times the usual compliance refined away."""
    compliance = factor * canonical.compliance_of(problem)
    newton = Newton(problem, compliance)

    def solve_pass(free, previous):
        return newton.solve(free, guess if previous is None else previous, accuracy)

    return canonical.refine(solve_pass, problem, compliance, accuracy), newton.iterations


def _softened(problem, start, accuracy):
    """
    Return (factor, force or None, iterations): a solution with as little compliance as can be had.

    Each solution is the guess for the next, with a third of the compliance. Contacts that hardly
    slide, a few in a hundred problems, are found in no other way: from afar Newton's method goes in
    circles about them.
    """
    found, iterations = (None, None), 0
    force = start
    for factor in _FACTORS:
        compliance = factor * canonical.compliance_of(problem)
        newton = Newton(problem, compliance)
        free = problem.free - compliance * start
        solution = newton.solve(free, force, accuracy)
        iterations += newton.iterations
        if solution is not None:
            force = solution
            found = factor, force
    return (*found, iterations)


def _solve_accelerated(problem, start):
    """Return (force, iterations) by the projected gradient, which finds any sliding itself."""
    largest, _ = largest_eigenvalue(
        problem.response.__matmul__, np.ones(len(problem.free)), _ROUNDS)
    force, used, _ = accelerated(
        problem.response.__matmul__, 0.8 / largest, Cones(problem.friction, problem.floor),
        problem.free, start, 1e-9 * np.abs(problem.free).max(), _LAST_ITERATIONS)
    return force, used
