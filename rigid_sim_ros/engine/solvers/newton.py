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

with both matrices block-diagonal, a contact's 3 x 3 each. They are made contact after contact in
plain floats, which is three times faster than arrays for the few contacts this is meant for.

The inverse of one iteration is kept for the next as long as that gains three digits. The first
guess is that all closed contacts stick, which one linear system tells. Once it is known who sticks
and who slides, refining the compliance away (see `canonical`) takes a product each time.
"""

from math import sqrt

import numpy as np

from rigid_sim_ros.engine.solvers import canonical
from rigid_sim_ros.engine.solvers.contact_equations import linearise, places, sticking

MAX_ITERATIONS = 20
"""From nothing 2 to 10 do; what has not converged by then mostly goes in circles."""

_WINDOW, _HALVINGS = 4, 6
"""
A step is halved until the residual is below the largest of the last four (Grippo, Lampariello and
Lucidi 1986), which breaks many circles; to go down always would get stuck more often.
"""

_GAIN = 1e-3
"""An inverse is kept while it shrinks the residual to this part or less."""

_STALLED = 0.5
"""A pass that changes the force by more than this part of what the last did gets nowhere."""

_SETTLED = 1e-9
"""Of the free motion: residual at which the choice of forces is made."""

_LADDERS = ((1e-2,), (1e-1, 1e-2, 1e-3, 1e-4))
"""
Compliances, of the mean normal response, on the way down to the canonical one where Newton's
method does not converge at once: what is softer is easier, and a good guess for what is stiffer.
Of 332 problems of 8 to 18 contacts that act on each other (ten tumbled cubes that fall) it finds
294 at once, 327 by the first and 331 by the second.
"""


def solve_newton(problem, guess, accuracy):
    """
    Return (force, iterations) of a `ContactProblem`: the canonical force (3k,), or None.

    The guess (3k,) or None saves time; iterations are linear systems solved. Where Newton's method
    does not get to the end the force is that with the least compliance it came down to.
    """
    compliance = canonical.compliance_of(problem)
    newton = Newton(problem, compliance)
    best = newton.refined(guess, accuracy)
    if best is None and guess is not None:
        best = newton.refined(None, accuracy)
    used = newton.iterations
    if best is not None:
        return best, used
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
            return newton.refined(force, accuracy), used
    return best, used


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
        """Linear systems solved so far."""
        self._free = problem.free
        self._compliance = compliance
        count = self._count = problem.count
        self.floor = np.zeros(3 * count)
        """Force (3k,) that is there in any case."""
        self.floor[:count] = problem.floor
        self._scale = float(np.abs(problem.free).max())
        self._matrix = problem.response.copy()
        diagonal = self._matrix.ravel()[::3 * count + 1]
        diagonal += compliance
        stiffness = diagonal.reshape(3, count).tolist()
        stiffness = [(n, max(t, u)) for n, t, u in zip(*stiffness)]
        self._constants = [
            (1 / n, 1 / t, *rest) for (n, t), *rest in zip(
                stiffness, problem.friction.tolist(), problem.floor.tolist(),
                *problem.slip.tolist())]
        # the rounding of matrix @ force is a floor below which no residual gets
        self._rounding = 5e-16 * count ** 1.5 * max(map(max, stiffness))
        self._inverse = self._by_motion = self._rows = None

    def refined(self, guess, accuracy):
        """
        Return the force (3k,) that is left when the compliance is refined away, or None.

        That is to `accuracy` of the free motion; the guess is a force or None. If a refinement
        fails the force is the one before it.
        """
        tolerance = accuracy * self._scale
        reference, done = self.floor, False
        force = self._iterate(reference, self._start() if guess is None else guess,
                              max(tolerance, _SETTLED * self._scale))
        for _ in range(canonical.MAX_PASSES):
            if force is None or done:
                break
            change = force - reference
            if self._compliance * float(np.abs(change).max()) <= tolerance:
                break
            reference, ahead, done = self._extrapolated(force, change, tolerance)
            refined = self._iterate(reference, ahead, tolerance)
            if refined is None:
                break
            force = refined
        return force

    def settled(self, guess):
        """Return the force with the compliance, from a guess, or None."""
        return self._iterate(self.floor, guess, _SETTLED * self._scale)

    # -- inside --------------------------------------------------------------------------------

    def _iterate(self, reference, force, tolerance):
        """Return the force near another with the compliance about a reference, or None."""
        free = self._free - self._compliance * reference
        residual, size = self._evaluate(free, force)
        sizes = []
        for _ in range(MAX_ITERATIONS):
            if size <= tolerance + self._rounding * float(np.abs(force).max()):
                # the last digits, unseen
                return force if self._inverse is None else force - self._inverse @ residual
            if (self._inverse is None or sizes and size > _GAIN * sizes[-1]) and (
                    not self._invert(self._rows)):
                return None
            sizes.append(size)
            change = self._inverse @ residual
            largest = max(sizes[-_WINDOW:])
            for _ in range(_HALVINGS):
                residual, size = self._evaluate(free, force - change)
                if size < largest:
                    break
                change *= 0.5
            force = force - change
        return None

    def _evaluate(self, free, force):
        """Return the residual (3k,) of a force, and its size in units of motion."""
        count = self._count
        forces, motions = force.tolist(), (free + self._matrix @ force).tolist()
        rows, size = [], 0.0
        for contact, constants in enumerate(self._constants):
            row = linearise(forces[contact::count], motions[contact::count], constants)
            rows.append(row)
            normal, first, second = row[0] / constants[0], row[1] / constants[1], (
                row[2] / constants[1])
            size += normal * normal + first * first + second * second
        self._rows = rows
        return np.array([row[:3] for row in rows]).T.ravel(), sqrt(size)

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
        if self._inverse is None and not self._invert(self._rows):
            return reference, force, False
        size = float(np.abs(change).max())
        for _ in range(canonical.MAX_PASSES):
            change = self._inverse @ (self._by_motion @ (self._compliance * change))
            reference, force = force, force + change
            before, size = size, float(np.abs(change).max())
            if self._compliance * size <= tolerance:
                break
            if size > _STALLED * before:
                return reference, force, True
        return reference, force, False

    def _start(self):
        """Return the force if all closed contacts stick, unless they are known to slide."""
        motion = self._free
        if self.floor.any():
            motion = motion + self._matrix @ self.floor - self._compliance * self.floor
        rows = [sticking(*each) for each in zip(
            motion.reshape(3, -1).T.tolist(), self._constants)]
        if not self._invert(rows):
            return self.floor
        return self.floor - self._inverse @ np.array([row[:3] for row in rows]).T.ravel()

    def _invert(self, rows):
        """Invert the derivative in which contacts have these rows; return whether it could be."""
        count = self._count
        motion_places, force_places = places(count)
        slopes = np.array(rows).T
        self._by_motion = np.zeros((3 * count, 3 * count))
        by_force = np.zeros((3 * count, 3 * count))
        self._by_motion.ravel()[motion_places] = slopes[3:8]
        by_force.ravel()[force_places] = slopes[8:]
        self.iterations += 1
        try:
            self._inverse = np.linalg.inv(self._by_motion @ self._matrix + by_force)
        except np.linalg.LinAlgError:
            return False
        return True
