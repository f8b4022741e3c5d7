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
The conditions of contacts as equations, with their derivatives (Alart and Curnier 1991).

Each condition is 'force equals its projection on what is allowed', with the normal force allowed
above its floor and the friction inside its disc. For few contacts in plain floats, one after the
other, which is three times faster than arrays.

For each contact there are rows: 3 residuals, 5 derivatives by motion, 7 by force, whose places in
the matrices are those of `places`.
"""

from functools import lru_cache
from math import sqrt

import numpy as np

FEW = 12
"""Up to so many contacts plain floats are faster (measured)."""

_TINY = np.finfo(float).tiny


def equations_of(problem, diagonal):
    """Return the equations of a `ContactProblem`, whose response has this diagonal (3, k)."""
    stiffness = np.stack((diagonal[0], np.maximum(diagonal[1], diagonal[2])))
    kind = FewEquations if problem.count <= FEW else ManyEquations
    return kind(1 / stiffness, problem.friction, problem.floor, problem.slip)


class FewEquations:
    """
    Equations in plain floats.

    Parameters
    ----------
    steps : (2, k)
        Force per motion, normal and tangential, with which projections are made.
    friction, floor, slip
        As in `ContactProblem`.

    """

    def __init__(self, steps, friction, floor, slip):
        """See the class."""
        self._constants = list(zip(*steps.tolist(), friction.tolist(), floor.tolist(),
                                   *slip.tolist()))

    def evaluate(self, force, motion):
        """Return (rows (15, k), residual (3k,), its size in units of motion)."""
        count = len(self._constants)
        forces, motions = force.tolist(), motion.tolist()
        rows, size = [], 0.0
        for contact, constants in enumerate(self._constants):
            row = linearise(forces[contact::count], motions[contact::count], constants)
            rows.append(row)
            normal = row[0] / constants[0]
            first, second = row[1] / constants[1], row[2] / constants[1]
            size += normal * normal + first * first + second * second
        rows = np.array(rows).T
        return rows, rows[:3].ravel(), sqrt(size)

    def sticking(self, motion):
        """Return rows (15, k) in which closed contacts stick unless known to slide."""
        return np.array([sticking(*each) for each in zip(
            motion.reshape(3, -1).T.tolist(), self._constants)]).T


class ManyEquations(FewEquations):
    """The same in arrays."""

    def __init__(self, steps, friction, floor, slip):
        """See the class."""
        super().__init__(steps, friction, floor, slip)
        self._steps = steps[[0, 1, 1]]
        self._friction, self._floor, self._slip = friction, floor, slip
        slips = slip.any(axis=0)
        self._slips = slips if slips.any() else None

    def evaluate(self, force, motion):
        """Return (rows (15, k), residual (3k,), its size in units of motion)."""
        rows = self._linearise(force.reshape(3, -1), motion.reshape(3, -1))
        residual = rows[:3]
        weighted = (residual / self._steps).ravel()
        return rows, residual.ravel(), sqrt(weighted @ weighted)

    def _linearise(self, force, motion):
        """Return the rows: `linearise` of all."""
        steps = self._steps
        target = force - steps * motion
        closed = target[0] > self._floor
        pressed = force[0] > 0.0
        limit = np.where(pressed, self._friction * force[0], 0.0)
        length = np.sqrt(target[1] * target[1] + target[2] * target[2])
        slides = length > limit
        length = np.maximum(length, _TINY)
        turn, unit = np.where(slides, limit / length, 1.0), target[1:] / length
        if self._slips is not None:
            slides = slides | self._slips
            unit = np.where(self._slips, -self._slip, unit)
            turn = np.where(self._slips, 0.0, turn)
        rows = np.empty((15, len(limit)))
        rows[0] = np.where(closed, steps[0] * motion[0], force[0] - self._floor)
        rows[1:3] = np.where(slides, force[1:] - limit * unit, steps[1:] * motion[1:])
        rows[3], rows[8] = np.where(closed, steps[0], 0.0), ~closed
        one, two = unit
        # derivative of the projection by its target: across the direction only
        turn_11 = np.where(slides, turn * two * two, 1.0)
        turn_12 = np.where(slides, -turn * one * two, 0.0)
        turn_22 = np.where(slides, turn * one * one, 1.0)
        rows[4], rows[7] = steps[1] * turn_11, steps[1] * turn_22
        rows[5] = rows[6] = steps[1] * turn_12
        rows[9], rows[12] = 1.0 - turn_11, 1.0 - turn_22
        rows[10] = rows[11] = -turn_12
        rows[13:] = np.where(slides & pressed, -self._friction * unit, 0.0)
        return rows


def linearise(force, motion, constants):
    """
    Return one contact's equations: 3 residuals, 5 derivatives by motion, 7 by force.

    The places they have in the matrices are those of `places`.
    """
    normal, first, second = force
    motion_n, motion_1, motion_2 = motion
    step_n, step_t, friction, floor, slip_1, slip_2 = constants
    if normal - floor > step_n * motion_n:
        head, motion_nn, force_nn = step_n * motion_n, step_n, 0.0
    else:
        head, motion_nn, force_nn = normal - floor, 0.0, 1.0
    limit, grows = (friction * normal, friction) if normal > 0.0 else (0.0, 0.0)
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


def sticking(motion, constants):
    """Return `linearise` at the floor's motion for a contact that sticks if it is closed."""
    motion_n, motion_1, motion_2 = motion
    step_n, step_t, friction, floor, slip_1, slip_2 = constants
    closes = motion_n < 0.0
    normal = (step_n * motion_n, step_n, 0.0) if closes else (0.0, 0.0, 1.0)
    head, motion_nn, force_nn = normal
    limit = friction * floor
    if not closes and floor <= 0.0:
        slip_1 = slip_2 = friction = 0.0
    elif not (slip_1 or slip_2):
        return (head, step_t * motion_1, step_t * motion_2, motion_nn, step_t, 0.0, 0.0, step_t,
                force_nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return (head, limit * slip_1, limit * slip_2, motion_nn, 0.0, 0.0, 0.0, 0.0,
            force_nn, 1.0, 0.0, 0.0, 1.0, friction * slip_1, friction * slip_2)


@lru_cache(maxsize=64)
def places(count):
    """Return where derivatives by motion (5, k) and force (7, k) go in flat (3k, 3k) matrices."""
    contact = np.arange(count)

    def place(row, column):
        return (row * count + contact) * 3 * count + column * count + contact

    tangential = [place(1, 1), place(1, 2), place(2, 1), place(2, 2)]
    return (np.array([place(0, 0), *tangential]),
            np.array([place(0, 0), *tangential, place(1, 0), place(2, 0)]))
