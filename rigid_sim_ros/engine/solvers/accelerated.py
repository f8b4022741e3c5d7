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
Contact problems too large for Newton's method: an accelerated projected gradient.

The contact problem without coupling of friction and normal motion is a quadratic over cones. Its
projected gradient with Nesterov's momentum and restarts (Mazhar et al. 2015, 'Using Nesterov's
method to accelerate multibody dynamics with friction and contact', section 4) needs one product
with the response an iteration. It departs from the paper in the projection, which is on Coulomb's
disc |t| <= mu n and not on the cone of the convex relaxation: that one would lift what slides; and
in the test for a restart, which is on the projected step (O'Donoghue and Candes 2015, section 3.2)
and not on the gradient: a tenth of the error after 40 iterations, measured on collapsing piles.
"""

import numpy as np

_TINY = 1e-60
"""Of a force: nothing, and its square is no denormal number, which would be slow."""

SHORTER = 0.9
"""Of the longest step that a change would have allowed."""

_TESTED = 4
"""Convergence is tested at the first two iterations and then at each of so many."""


class Cones:
    """
    What is allowed of forces, (3k,) or (3, k): k normals, k first and k second tangents.

    Parameters
    ----------
    friction : (k,)
    floor : float or (k,)
        Normal force that is there in any case.

    """

    def __init__(self, friction, floor=0.0):
        """See the class."""
        self._friction = friction
        # a normal force that is never quite zero needs no guard in a division
        self._floor = np.maximum(np.broadcast_to(floor, friction.shape), _TINY)
        self._length = np.empty_like(friction)
        self._square = np.empty_like(friction)

    def project(self, force):
        """Draw forces back onto what is allowed, in place."""
        normal, first, second = force.reshape(3, -1)
        np.maximum(normal, self._floor, out=normal)
        length, square = self._length, self._square
        np.multiply(first, first, out=length)
        np.multiply(second, second, out=square)
        length += square
        np.sqrt(length, out=length)
        np.multiply(self._friction, normal, out=square)
        np.maximum(length, square, out=length)
        length += _TINY
        np.divide(square, length, out=square)
        first *= square
        second *= square

    def select(self, kept):
        """Return those of some contacts (k,) bool."""
        return Cones(self._friction[kept], self._floor[kept])


def is_tested(iteration):
    """Return whether convergence is tested at an iteration, the first of which is 1."""
    return iteration <= 2 or iteration % _TESTED == 0


def accelerated(response, step, cones, free, force, tolerance, iterations):
    """
    Return (force, iterations used, residual (n,)): an approximate solution of a contact problem.

    Parameters
    ----------
    response : callable
        Gives the motion (n,) made by forces (n,); symmetric, not negative.
    step : float
        About the reciprocal of its largest eigenvalue; shortened where it turns out too long.
    cones : object
        `project(force)` draws forces back onto what is allowed, in place.
    free : (n,)
        Motion without forces, less what is asked for.
    force : (n,)
        To start from.
    tolerance : float
        Change of motion in an iteration at which to stop.
    iterations : int
        At most, one or more.

    """
    here = force.copy()
    cones.project(here)
    ahead = here
    made_here = made_ahead = response(here)
    theta = 1.0
    for iteration in range(1, iterations + 1):
        there = ahead - step * (made_ahead + free)
        cones.project(there)
        change = there - ahead
        if is_tested(iteration) or iteration == iterations:
            residual = np.abs(change) / step
            if residual.max(initial=0.0) <= tolerance:
                break
        made_there = response(there)
        size, curvature = change @ change, change @ (made_there - made_ahead)
        if 0.0 < size < curvature * step:
            # the step is longer than the response allows: back, and on with a shorter one
            step = SHORTER * size / curvature
            theta = 1.0
            ahead, made_ahead = here, made_here
            continue
        moved = there - here
        if change @ moved < 0.0:
            # the projected step goes back where it came from: on without momentum
            theta = 1.0
            ahead, made_ahead = there, made_there
        else:
            following = 2.0 * theta / (theta + (theta * theta + 4.0) ** 0.5)
            weight = theta * (1.0 - theta) / (theta * theta + following)
            theta = following
            ahead = there + weight * moved
            # the response is linear: what momentum makes is known without a product
            made_ahead = made_there + weight * (made_there - made_here)
        here, made_here = there, made_there
    return there, iteration, residual


def largest_eigenvalue(response, vector, rounds):
    """
    Return (estimate from below, vector) of the largest eigenvalue of a symmetric response.

    By `rounds` of the power method from a vector (n,), which is close to the answer next time.
    """
    size = 0.0
    for _ in range(rounds):
        size = float(np.sqrt(vector @ vector))
        if size == 0.0:
            return 0.0, vector
        vector = response(vector / size)
    return float(np.sqrt(vector @ vector)), vector
