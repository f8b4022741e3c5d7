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
Semismooth Newton on the contact conditions, written as equations (Alart and Curnier 1991).

Each condition is 'force equals its projection on what is allowed', with the normal force allowed
above its floor and the friction inside its disc. The derivative of force less projection is

    by_force + by_motion @ response

with both matrices block-diagonal, a contact's 3 x 3 each.

The system of one iteration is kept for the next as long as that gains three digits. The first
guess is that all closed contacts stick, which one linear system tells. Once it is known who sticks
and who slides, refining the compliance away (see `canonical`) takes a product each time.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import canonical
from rigid_sim_ros.engine.solvers.contact_equations import equations_of
from rigid_sim_ros.engine.solvers.newton_systems import DenseSystem, FactoredSystem
from rigid_sim_ros.engine.solvers.problem import Solution

MAX_ITERATIONS = 20
"""From nothing 2 to 10 do; what has not converged by then mostly goes in circles."""

_WINDOW, _HALVINGS = 4, 6
"""
A step is halved until the residual is below the largest of the last four (Grippo, Lampariello and
Lucidi 1986), which breaks many circles; to go down always would get stuck more often.
"""

_SLACK = 1e-2
"""Of the free motion: a residual that is no reason to halve a step. It rises where who slides is
found out, and half steps would only creep there."""

_GAIN = 1e-3
"""A system is kept while it shrinks the residual to this part or less."""

_FACTORED, _FACTORED_ROWS = 1.7, 90
"""
A response is taken in factors if it has so many times more rows than these have columns, and so
many rows (measured).
"""

STALLED = 0.5
"""A pass that changes the force by more than this part of what the last did gets nowhere."""

SETTLED = 1e-9
"""Of the free motion: residual at which the choice of forces is made."""

_FEW_VALUES = 60
"""Up to so many plain floats are quicker."""

_LEFT, _STIFFER = 1e-6, 1e-3
"""
Where refining leaves more of the compliance than this part of the free motion, as of the cube of a
kilogram that a hundred tons stand on, it is tried again with so much of the compliance.
"""

_LADDERS = ((1e-2,), (1e-1, 1e-2, 1e-3, 1e-4))
"""
Compliances, of the mean normal response, on the way down to the canonical one where Newton's
method does not converge at once: what is softer is easier, and a good guess for what is stiffer.
Of 332 problems of 8 to 18 contacts that act on each other (ten tumbled cubes that fall) it finds
294 at once, 327 by the first and 331 by the second.
"""


def solve_newton(problem, guess, accuracy):
    """
    Return the `Solution` of a `ContactProblem`, with the canonical force, or with None.

    The guess (3k,) or None saves time; iterations are linear systems solved. Where Newton's method
    does not get to the end the force is that with the least compliance it came down to.
    """
    compliance = canonical.compliance_of(problem)
    newton = Newton(problem, compliance)
    best = newton.refined(guess, accuracy)
    used = newton.iterations
    if best is not None:
        if newton.left > _LEFT:
            stiffer = Newton(problem, _STIFFER * compliance)
            again = stiffer.refined(best, accuracy)
            used += stiffer.iterations
            best = best if again is None or stiffer.left > newton.left else again
        return Solution(best, used, newton.first)
    for ladder in _LADDERS:
        force = newton.floor
        for step in (*ladder, canonical.COMPLIANCE):
            newton = Newton(problem, step / canonical.COMPLIANCE * compliance)
            force = newton.settled(force)
            used += newton.iterations
            if force is None:
                break
            best = force
        else:
            best = newton.refined(force, accuracy)
            return Solution(best, used, newton.first)
    return Solution(best, used, best)


def rounding_of(count, largest):
    """
    Return the rounding of the motion of so many contacts per force, below which no residual gets.

    `largest` is the largest of the response.
    """
    return 5e-16 * count ** 1.5 * largest


def _largest(values):
    """Return the largest size of some values (n,)."""
    if len(values) > _FEW_VALUES:
        return float(np.abs(values).max())
    return max(map(abs, values.tolist()))


class Newton:
    """
    The conditions of one `ContactProblem` with a compliance in every row.

    Parameters
    ----------
    problem : ContactProblem
    compliance : float

    """

    def __init__(self, problem, compliance):
        """See the class."""
        self.iterations = 0
        """Linear systems made so far."""
        self.left = 0.0
        """What refining has left of the compliance, of the free motion."""
        self.first = None
        """The last force (3k,) with the whole compliance, or None."""
        self._free = problem.free
        self._compliance = compliance
        count = self._count = problem.count
        self.floor = np.zeros(3 * count)
        """Force (3k,) that is there in any case."""
        self.floor[:count] = problem.floor
        self._scale = _largest(problem.free)
        self._matrix = problem.response.copy()
        diagonal = self._matrix.ravel()[::3 * count + 1]
        diagonal += compliance
        self._equations = equations_of(problem, diagonal)
        factor = problem.factor
        self._factor = None
        if (factor is not None and 3 * count >= _FACTORED_ROWS
                and factor.shape[1] * _FACTORED <= 3 * count):
            self._factor = factor
            self._columns = factor.reshape(3, count, -1)
        self._rounding = rounding_of(count, _largest(diagonal))
        self._system = self._at = None

    def refined(self, guess, accuracy):
        """
        Return the force (3k,) that is left when the compliance is refined away, or None.

        That is to `accuracy` of the free motion; the guess is a force or None. If a refinement
        fails the force is the one before it.
        """
        tolerance = accuracy * self._scale
        reference, done = self.floor, False
        force = self.first = self._iterate(reference, self._start() if guess is None else guess,
                                           max(tolerance, SETTLED * self._scale))
        if force is None:
            return None
        for _ in range(canonical.MAX_PASSES):
            change = force - reference
            left = self._compliance * _largest(change)
            if done or left <= tolerance:
                break
            reference, ahead, done = self._extrapolated(force, change, tolerance)
            refined = self._iterate(reference, ahead, tolerance)
            if refined is None:
                break
            force = refined
        self.left = left / (self._scale or 1.0)
        return force

    def settled(self, guess):
        """Return the force with the compliance, from a guess, or None."""
        return self._iterate(self.floor, guess, SETTLED * self._scale)

    # -- inside --------------------------------------------------------------------------------

    def _iterate(self, reference, force, tolerance):
        """Return the force near another with the compliance about a reference, or None."""
        free = self._free - self._compliance * reference
        residual, size = self._evaluate(free, force)
        sizes = []
        try:
            for _ in range(MAX_ITERATIONS):
                if self._is_solved(size, tolerance):
                    # the last digits, unseen
                    return force if self._system is None else force - self._system.solve(residual)
                if self._system is None or sizes and size > _GAIN * sizes[-1]:
                    self._prepare(self._equations.derivatives(*self._at))
                sizes.append(size)
                change = self._system.solve(residual)
                largest = max(_SLACK * self._scale, *sizes[-_WINDOW:])
                for _ in range(_HALVINGS):
                    trial = force - change
                    residual, size = self._evaluate(free, trial)
                    if size < largest:
                        break
                    change *= 0.5
                force = trial
        except np.linalg.LinAlgError:
            pass
        return None

    def _is_solved(self, size, tolerance):
        """Return whether a residual of a size is as small as it should be or can be."""
        return size <= tolerance or size <= tolerance + self._rounding * _largest(self._at[0])

    def _evaluate(self, free, force):
        """Return the residual (3k,) of a force, and its size in units of motion."""
        self._at = force, free + self._motion_of(force)
        return self._equations.residual(*self._at)

    def _motion_of(self, force):
        """Return the motion a force makes, and that of the compliance."""
        if self._factor is None:
            return self._matrix @ force
        # by way of the bodies, where what the contacts do to each other is gone: its rounding over
        # the compliance would else be in the forces that are redundant
        return self._factor @ (force @ self._factor) + self._compliance * force

    def _extrapolated(self, force, change, tolerance):
        """
        Return (reference, force, done) of the pass in which the compliance makes no difference.

        That is if everybody goes on sticking or sliding as in the last pass, which changed the
        force by `change`: then each pass does to it what the one before did to that. If passes
        stop getting nearer they would not end: what is asked of redundant contacts does not quite
        agree, by some 1e-9 in a step, and what the compliance leaves is the compromise. Then that
        is all that can be done.
        """
        reference = force
        if self._system is None:
            self._prepare(self._equations.derivatives(*self._at))
        size = _largest(change)
        try:
            for _ in range(canonical.MAX_PASSES):
                change = self._system.solve(self._system.of_motion(self._compliance * change))
                reference, force = force, force + change
                before, size = size, _largest(change)
                if self._compliance * size <= tolerance:
                    break
                if size > STALLED * before:
                    return reference, force, True
        except np.linalg.LinAlgError:
            pass
        return reference, force, False

    def _start(self):
        """Return the force if all closed contacts stick, unless they are known to slide."""
        motion = self._free
        if self.floor.any():
            motion = motion + self._matrix @ self.floor - self._compliance * self.floor
        residual, derivatives = self._equations.sticking(motion)
        self._prepare(derivatives)
        try:
            return self.floor - self._system.solve(residual)
        except np.linalg.LinAlgError:
            return self.floor

    def _prepare(self, derivatives):
        """Make the linear system in which the residual has these derivatives."""
        self.iterations += 1
        if self._factor is None:
            self._system = DenseSystem(derivatives, self._matrix)
        else:
            self._system = FactoredSystem(derivatives, self._columns, self._compliance)
