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
"""

from functools import lru_cache
from math import sqrt

import numpy as np

from rigid_sim_ros.engine.solvers import canonical

MAX_ITERATIONS = 40
"""From nothing 4 to 16 do; what has not converged by then goes in circles."""

_UNDAMPED = 6
_DAMPED_EVERY = 7
"""After six full steps each seventh is halved, which breaks most circles."""


def newton(problem, matrix, free, force):
    """
    Return (force, iterations): the solution near a guess (3k,), or None in place of the force.

    The matrix is the response with its compliance, `free` the free motion that goes with it.
    """
    count = problem.count
    diagonal = matrix.ravel()[::3 * count + 1].reshape(3, count)
    stiffness = np.array((diagonal[0], np.maximum(diagonal[1], diagonal[2])))
    constants = list(zip(*(1 / stiffness).tolist(), problem.friction.tolist(),
                         problem.floor.tolist(), problem.slip.T.tolist()))
    weight = stiffness[[0, 1, 1]].ravel()
    motion_places, force_places = _places(count)
    # the rounding of matrix @ force is a floor below which no residual gets
    rounding = 1e-16 * 3 * count * float(diagonal.max())
    tolerance = canonical.ACCURACY * float(np.abs(free).max())
    by_motion = np.zeros((3 * count, 3 * count))
    by_force = np.zeros((3 * count, 3 * count))
    for iteration in range(MAX_ITERATIONS):
        motion = free + matrix @ force
        rows = [_linearise(f, u, *each) for f, u, each in zip(
            force.reshape(3, count).T.tolist(), motion.reshape(3, count).T.tolist(), constants)]
        rows = np.array(rows).T
        residual = rows[:3].ravel()
        size = float(np.abs(residual * weight).max())
        if size <= tolerance + rounding * float(np.abs(force).max()):
            return force, iteration
        by_motion.ravel()[motion_places] = rows[3:8]
        by_force.ravel()[force_places] = rows[8:]
        try:
            change = np.linalg.solve(by_motion @ matrix + by_force, residual)
        except np.linalg.LinAlgError:
            return None, iteration
        if iteration > _UNDAMPED and iteration % _DAMPED_EVERY == 0:
            change *= 0.5
        force = force - change
    return None, MAX_ITERATIONS


def _linearise(force, motion, step_n, step_t, friction, floor, slip):
    """
    Return one contact's equations: 3 residuals, 5 derivatives by motion, 7 by force.

    The places they have in the matrices are those of `_places`.
    """
    normal, first, second = force
    motion_n, motion_1, motion_2 = motion
    if normal - floor > step_n * motion_n:
        head, motion_nn, force_nn = step_n * motion_n, step_n, 0.0
    else:
        head, motion_nn, force_nn = normal - floor, 0.0, 1.0
    limit, grows = (friction * normal, friction) if normal > 0.0 else (0.0, 0.0)
    slip_1, slip_2 = slip
    if slip_1 or slip_2:
        return (head, first + limit * slip_1, second + limit * slip_2,
                motion_nn, 0.0, 0.0, 0.0, 0.0,
                force_nn, 1.0, 0.0, 0.0, 1.0, grows * slip_1, grows * slip_2)
    target_1, target_2 = first - step_t * motion_1, second - step_t * motion_2
    length = sqrt(target_1 * target_1 + target_2 * target_2)
    if length <= limit:
        return (head, step_t * motion_1, step_t * motion_2,
                motion_nn, step_t, 0.0, 0.0, step_t,
                force_nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    unit_1, unit_2 = target_1 / length, target_2 / length
    # derivative of the projection by its target: across the direction only
    turn = limit / length
    turn_11, turn_22 = turn * unit_2 * unit_2, turn * unit_1 * unit_1
    turn_12 = -turn * unit_1 * unit_2
    return (head, first - limit * unit_1, second - limit * unit_2,
            motion_nn, step_t * turn_11, step_t * turn_12, step_t * turn_12, step_t * turn_22,
            force_nn, 1.0 - turn_11, -turn_12, -turn_12, 1.0 - turn_22,
            -grows * unit_1, -grows * unit_2)


@lru_cache(maxsize=64)
def _places(count):
    """Return where derivatives by motion (5, k) and force (7, k) go in flat (3k, 3k) matrices."""
    contact = np.arange(count)

    def place(row, column):
        return (row * count + contact) * 3 * count + column * count + contact

    tangential = [place(1, 1), place(1, 2), place(2, 1), place(2, 2)]
    return (np.array([place(0, 0), *tangential]),
            np.array([place(0, 0), *tangential, place(1, 0), place(2, 0)]))
