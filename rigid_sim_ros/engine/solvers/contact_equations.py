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
other, which takes a third of the time of arrays.
"""

from functools import cached_property
from math import sqrt
from typing import NamedTuple

import numpy as np

FEW = 20
"""Up to so many contacts plain floats are faster (measured)."""

_TINY = np.finfo(float).tiny


class Derivatives(NamedTuple):
    """
    Derivatives of k contacts' residuals by their own motion and force; what is not here is zero.

    Rows are in the order of a vector (3k,): normals, first and second tangents.
    """

    own_motion: np.ndarray
    """(3k,): of each row by its own motion."""

    cross_motion: np.ndarray
    """(k,): of the first tangent by the second, and the other way round; None if all are zero."""

    force: np.ndarray
    """
    (7k,) by force: of each row by its own, of the first tangent by the second and the other way
    round, of both by the normal force.
    """


def equations_of(problem, diagonal):
    """Return the equations of a `ContactProblem`, whose response has this diagonal (3k,)."""
    count = problem.count
    normal, first, second = (
        diagonal[:count], diagonal[count:2 * count], diagonal[2 * count:])
    if count <= FEW:
        steps = [1.0 / n for n in normal.tolist()], [
            1.0 / max(t, u) for t, u in zip(first.tolist(), second.tolist())]
        return FewEquations(steps, problem.friction, problem.floor, problem.slip)
    return ManyEquations(1.0 / np.array((normal, np.maximum(first, second))), problem.friction,
                         problem.floor, problem.slip)


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
        self._constants = _constants_of(steps, friction, floor, slip)

    def residual(self, force, motion):
        """Return what is left of the conditions, (3k,), and its size in units of motion."""
        force, motion = force.tolist(), motion.tolist()
        count = len(self._constants)
        left, square = [0.0] * (3 * count), 0.0
        for one, (step_n, step_t, friction, floor, slip_1, slip_2) in enumerate(self._constants):
            two, three = one + count, one + 2 * count
            normal, first, second = force[one], force[two], force[three]
            head = step_n * motion[one]
            if head > normal - floor:
                head = normal - floor
            limit = friction * normal if normal > 0.0 else 0.0
            if slip_1 or slip_2:
                first += limit * slip_1
                second += limit * slip_2
            else:
                change_1, change_2 = step_t * motion[two], step_t * motion[three]
                target_1, target_2 = first - change_1, second - change_2
                length = sqrt(target_1 * target_1 + target_2 * target_2)
                if length <= limit:
                    first, second = change_1, change_2
                else:
                    share = limit / length
                    first -= share * target_1
                    second -= share * target_2
            left[one], left[two], left[three] = head, first, second
            head /= step_n
            square += head * head + (first * first + second * second) / (step_t * step_t)
        return np.array(left), sqrt(square)

    def derivatives(self, force, motion):
        """Return the `Derivatives` of the residual."""
        force, motion = force.tolist(), motion.tolist()
        count = len(self._constants)
        return _derivatives([
            _derivatives_of(constants, force[one], force[one + count], force[one + 2 * count],
                            motion[one], motion[one + count], motion[one + 2 * count])
            for one, constants in enumerate(self._constants)])

    def sticking(self, motion):
        """
        Return (residual (3k,), `Derivatives`) if closed contacts stick unless known to slide.

        The motion is that of the floor; closed is what would close, or has a floor.
        """
        normals, firsts, seconds = motion.reshape(3, -1).tolist()
        each = [_sticking(*one) for one in zip(self._constants, normals, firsts, seconds)]
        residual = np.array([row for row, _ in each]).T.ravel()
        return residual, _derivatives([row for _, row in each])


class ManyEquations(FewEquations):
    """The same in arrays."""

    def __init__(self, steps, friction, floor, slip):
        """See the class."""
        self._steps = steps[[0, 1, 1]]
        self._friction, self._floor, self._slip = friction, floor, slip
        slips = slip.any(axis=0)
        self._slips = slips if slips.any() else None

    @cached_property
    def _constants(self):
        """Return what is given of each contact, in plain floats: only `sticking` takes them."""
        return _constants_of(self._steps[:2].tolist(), self._friction, self._floor, self._slip)

    def residual(self, force, motion):
        """Return what is left of the conditions, (3k,), and its size in units of motion."""
        force, change = force.reshape(3, -1), self._steps * motion.reshape(3, -1)
        limit, unit, _, slides = self._projected(force, change)
        residual = np.empty_like(force)
        np.minimum(change[0], force[0] - self._floor, out=residual[0])
        residual[1:] = np.where(slides, force[1:] - limit * unit, change[1:])
        weighted = (residual / self._steps).ravel()
        return residual.ravel(), sqrt(weighted @ weighted)

    def derivatives(self, force, motion):
        """Return the `Derivatives` of the residual."""
        force, steps = force.reshape(3, -1), self._steps
        change = steps * motion.reshape(3, -1)
        closed = force[0] - self._floor > change[0]
        _, unit, turn, slides = self._projected(force, change)
        one, two = unit
        # derivative of the projection by its target: across the direction only
        turn_11 = np.where(slides, turn * two * two, 1.0)
        turn_12 = np.where(slides, -turn * one * two, 0.0)
        turn_22 = np.where(slides, turn * one * one, 1.0)
        grows = np.where(slides & (force[0] > 0.0), -self._friction, 0.0)
        return Derivatives(
            np.concatenate((np.where(closed, steps[0], 0.0), steps[1] * turn_11,
                            steps[1] * turn_22)),
            steps[1] * turn_12,
            np.concatenate((np.where(closed, 0.0, 1.0), 1.0 - turn_11, 1.0 - turn_22,
                            -turn_12, -turn_12, *(grows * unit))))

    def _projected(self, force, change):
        """Return the discs' limits, directions (2, k) in them, limit per length, who slides."""
        limit = self._friction * np.maximum(force[0], 0.0)
        target = force[1:] - change[1:]
        length = np.sqrt(target[0] * target[0] + target[1] * target[1])
        slides = length > limit
        length = np.maximum(length, _TINY)
        unit, turn = target / length, np.where(slides, limit, 0.0) / length
        if self._slips is not None:
            slides = slides | self._slips
            unit = np.where(self._slips, -self._slip, unit)
            turn = np.where(self._slips, 0.0, turn)
        return limit, unit, turn, slides


def _constants_of(steps, friction, floor, slip):
    """Return what is given of each contact."""
    return list(zip(*steps, friction.tolist(), floor.tolist(), *slip.tolist()))


def _derivatives(rows):
    """Return `Derivatives` of k rows, each in the order of `_derivatives_of`."""
    motion_n, motion_1, motion_2, cross, *force = zip(*rows)
    return Derivatives(np.array(motion_n + motion_1 + motion_2),
                       np.array(cross) if any(cross) else None,
                       np.array([each for part in force for each in part]))


def _derivatives_of(constants, normal, first, second, motion_n, motion_1, motion_2):
    """
    Return the derivatives of one contact: four by motion, seven by force.

    By motion and by force alike: n by n, 1 by 1, 2 by 2, 1 by 2. By force also 2 by 1, 1 by n and
    2 by n.
    """
    step_n, step_t, friction, floor, slip_1, slip_2 = constants
    motion_nn, force_nn = (step_n, 0.0) if normal - floor > step_n * motion_n else (0.0, 1.0)
    limit, grows = (friction * normal, friction) if normal > 0.0 else (0.0, 0.0)
    if slip_1 or slip_2:
        return (motion_nn, 0.0, 0.0, 0.0, force_nn, 1.0, 1.0, 0.0, 0.0, grows * slip_1,
                grows * slip_2)
    target_1, target_2 = first - step_t * motion_1, second - step_t * motion_2
    length = sqrt(target_1 * target_1 + target_2 * target_2)
    if length <= limit:
        return motion_nn, step_t, step_t, 0.0, force_nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    unit_1, unit_2 = target_1 / length, target_2 / length
    # derivative of the projection by its target: across the direction only
    turn = limit / length
    turn_11, turn_22 = turn * unit_2 * unit_2, turn * unit_1 * unit_1
    turn_12 = -turn * unit_1 * unit_2
    return (motion_nn, step_t * turn_11, step_t * turn_22, step_t * turn_12,
            force_nn, 1.0 - turn_11, 1.0 - turn_22, -turn_12, -turn_12,
            -grows * unit_1, -grows * unit_2)


def _sticking(constants, motion_n, motion_1, motion_2):
    """Return (residual (3,), `_derivatives_of`) one contact that sticks if it is closed."""
    step_n, step_t, friction, floor, slip_1, slip_2 = constants
    closes = motion_n < 0.0
    head, motion_nn, force_nn = (step_n * motion_n, step_n, 0.0) if closes else (0.0, 0.0, 1.0)
    limit = friction * floor
    if not closes and floor <= 0.0:
        slip_1 = slip_2 = friction = 0.0
    elif not (slip_1 or slip_2):
        return ((head, step_t * motion_1, step_t * motion_2),
                (motion_nn, step_t, step_t, 0.0, force_nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    return ((head, limit * slip_1, limit * slip_2),
            (motion_nn, 0.0, 0.0, 0.0, force_nn, 1.0, 1.0, 0.0, 0.0,
             friction * slip_1, friction * slip_2))
