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
above its floor and the friction inside its disc. Newton's method on that is a search for which
contacts are closed, stick and slide, and along what direction.

The inverse of one iteration is kept for the next as long as that gains a digit: near the end, and
while the compliance is refined away (see `canonical`), nothing needs to be inverted again.
"""

from functools import lru_cache

import numpy as np

MAX_ITERATIONS = 25
"""From nothing 2 to 10 do; what has not converged by then mostly goes in circles."""

_UNDAMPED = 6
_DAMPED_EVERY = 7
"""After six full steps each seventh is halved, which breaks many circles."""

_GAIN = 0.1
"""An inverse is kept while it shrinks the residual to this part or less."""

_TINY = np.finfo(float).tiny


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
        self._problem = problem
        count = self._count = problem.count
        self._matrix = problem.response.copy()
        diagonal = self._matrix.ravel()[::3 * count + 1]
        diagonal += compliance
        stiffness = diagonal.reshape(3, count).copy()
        np.maximum(stiffness[1], stiffness[2], out=stiffness[1])
        stiffness[2] = stiffness[1]
        self._weight = stiffness.ravel()
        self._steps = 1 / stiffness
        known = problem.slip.any(axis=0)
        self._known = known if known.any() else None
        # the rounding of matrix @ force is a floor below which no residual gets
        self._rounding = 3e-16 * count * float(diagonal.max())
        self._inverse = None

    def solve(self, free, force, accuracy):
        """
        Return the force (3k,) near a guess, or None.

        `free` is the free motion that goes with the compliance; the residual that is left is at
        most `accuracy` of its largest component.
        """
        tolerance = accuracy * float(np.abs(free).max())
        before = 0.0
        for iteration in range(MAX_ITERATIONS):
            target, *where = self._project(free, force)
            residual = force - target.ravel()
            size = float(np.abs(residual * self._weight).max())
            if size <= tolerance + self._rounding * float(np.abs(force).max()):
                return force
            if self._inverse is None or iteration > 0 and size > _GAIN * before:
                if not self._linearise(force, *where):
                    return None
            change = self._inverse @ residual
            if iteration > _UNDAMPED and iteration % _DAMPED_EVERY == 0:
                change *= 0.5
            force = force - change
            before = size
        return None

    # -- inside --------------------------------------------------------------------------------

    def _project(self, free, force):
        """
        Return the projection (3, k) of a force on what is allowed, and where it was made.

        That is which contacts are closed and which slide, (k,) bool, the directions of friction
        where they do, (2, k), and how much of its length is left, (k,): 1 where they stick.
        """
        problem = self._problem
        target = force.reshape(3, -1) - self._steps * (free + self._matrix @ force).reshape(3, -1)
        drawn = target[1:]
        limit = problem.friction * np.maximum(force[:self._count], 0.0)
        length = np.sqrt((drawn * drawn).sum(axis=0)) + _TINY
        slides = length > limit
        unit = drawn / length
        left = np.where(slides, limit / length, 1.0)
        if self._known is not None:
            slides = slides | self._known
            unit = np.where(self._known, -problem.slip, unit)
            left = np.where(self._known, 0.0, left)
        closed = target[0] > problem.floor
        np.maximum(target[0], problem.floor, out=target[0])
        target[1:] = np.where(slides, limit * unit, drawn)
        return target, closed, slides, unit, left

    def _linearise(self, force, closed, slides, unit, left):
        """
        Invert the derivative of force less projection; return whether that can be done.

        The derivative of the projection by its target is 1 where a contact is closed or sticks;
        where it slides it is what is left of the length, across the direction only.
        """
        count = self._count
        matrix = self._matrix.reshape(3, count, -1)
        first, second = unit
        slope_11 = np.where(slides, left * second * second, 1.0)
        slope_22 = np.where(slides, left * first * first, 1.0)
        slope_12 = np.where(slides, -left * first * second, 0.0)
        step_n, step_t, _ = self._steps
        rows = np.empty((3, count, 3 * count))
        np.multiply((closed * step_n)[:, None], matrix[0], out=rows[0])
        for row, (one, other) in enumerate(((slope_11, slope_12), (slope_12, slope_22)), start=1):
            rows[row] = ((one * step_t)[:, None] * matrix[1]
                         + (other * step_t)[:, None] * matrix[2])
        # the limit of friction grows with the normal force
        grows = np.where(slides & (force[:count] > 0.0), self._problem.friction, 0.0)
        rows.ravel()[_places(count)] += np.concatenate((
            ~closed, 1.0 - slope_11, -slope_12, -slope_12, 1.0 - slope_22,
            -grows * first, -grows * second))
        self.iterations += 1
        try:
            self._inverse = np.linalg.inv(rows.reshape(3 * count, -1))
        except np.linalg.LinAlgError:
            return False
        return True


@lru_cache(maxsize=64)
def _places(count):
    """Return where, (7k,), nn, 11, 12, 21, 22, 1n and 2n of each contact are in (3k, 3k)."""
    contact = np.arange(count)
    return np.concatenate([
        (row * count + contact) * 3 * count + column * count + contact
        for row, column in ((0, 0), (1, 1), (1, 2), (2, 1), (2, 2), (1, 0), (2, 0))])
