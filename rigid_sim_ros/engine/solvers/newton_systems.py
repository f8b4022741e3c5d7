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
The linear systems of Newton's method on contact conditions.

A system is by_force + by_motion @ (response + compliance), with both matrices block-diagonal, a
contact's 3 x 3 each, as `contact_equations.Derivatives` gives them. Most are solved once, the last
of a problem five times or so: a large one is inverted when it is asked for the second time.
"""

from functools import lru_cache

import numpy as np

_SMALL = 24
"""Rows up to which a system is inverted at once (measured)."""


class DenseSystem:
    """
    A system as one matrix.

    Parameters
    ----------
    derivatives : contact_equations.Derivatives
    matrix : (3k, 3k)
        The response with its compliance.

    """

    def __init__(self, derivatives, matrix):
        """See the class."""
        size = len(matrix)
        self._own, self._cross, by_force = derivatives
        system = self._system = self._own[:, None] * matrix
        if self._cross is not None:
            count = size // 3
            system.reshape(3, count, size)[1:] += (
                self._cross[:, None] * matrix.reshape(3, count, size)[:0:-1])
        system.ravel()[_places(size)] += by_force
        # a small one is inverted in the time in which it is solved
        self._is_spared, self._inverse = size > _SMALL, None

    def solve(self, residual):
        """Return the change of force (3k,) that makes a residual, or raise LinAlgError."""
        if self._is_spared:
            self._is_spared = False
            return np.linalg.solve(self._system, residual)
        if self._inverse is None:
            self._inverse = np.linalg.inv(self._system)
        return self._inverse @ residual

    def of_motion(self, motion):
        """Return the residual (3k,) that a motion makes."""
        residual = self._own * motion
        if self._cross is not None:
            residual.reshape(3, -1)[1:] += self._cross * motion.reshape(3, -1)[:0:-1]
        return residual


@lru_cache(maxsize=64)
def _places(size):
    """Return where `Derivatives.force` goes in a flat matrix of so many rows."""
    count = size // 3
    normal, first, second = np.arange(size).reshape(3, count)
    rows = np.concatenate((normal, first, second, first, second, first, second))
    columns = np.concatenate((normal, first, second, second, first, normal, normal))
    return rows * size + columns


class FactoredSystem:
    """
    A system of many contacts between few bodies, with a response that is factor @ factor.T.

    By the formula of Woodbury it takes a matrix with a row and a column for each freedom of the
    bodies, where `DenseSystem` has three for each contact. Systems of one shape that have nothing
    to do with each other can be taken together, with one more axis before that of the contacts.

    Parameters
    ----------
    derivatives : contact_equations.Derivatives
        Of the contacts of all systems.
    factor : (3, k, n) or (3, g, k, n)
        See `ContactProblem`.
    compliance : float or (g, 1)
        Above zero.

    """

    def __init__(self, derivatives, factor, compliance):
        """Raise LinAlgError if a contact by itself is singular; never with a compliance."""
        self._shape = (*factor.shape[:-1], 1)
        points = factor.shape[1:-1]
        own, cross, by_force = derivatives
        own = own.reshape(3, *points)
        cross = np.zeros(points) if cross is None else cross.reshape(points)
        self._own, self._cross = own[..., None], cross[..., None]
        by_force = by_force.reshape(7, *points)
        self._pull = by_force[5:, ..., None]
        normal, t11, t22 = by_force[:3] + compliance * own
        t12 = by_force[3] + compliance * cross
        determinant = t11 * t22 - t12 * t12
        if not normal.all() or not determinant.all():
            raise np.linalg.LinAlgError
        self._normal = 1 / normal[..., None]
        self._tangential = (np.array((t22, -t12, t11)) / determinant)[..., None]
        self._transposed = factor.swapaxes(-1, -2)
        # rows of the factor, as columns of residuals
        self._spread = self._without_response(self._of_motion(factor))
        self._matrix = self._on_bodies(self._spread)
        diagonal = np.arange(factor.shape[-1])
        self._matrix[..., diagonal, diagonal] += 1.0
        self._is_spared, self._inverse = True, None

    def solve(self, residual):
        """Return the change of force (3k,) that makes a residual."""
        alone = self._without_response(residual.reshape(self._shape))
        return (alone - self._spread @ self._solved(self._on_bodies(alone))).ravel()

    def of_motion(self, motion):
        """Return the residual (3k,) that a motion makes."""
        return self._of_motion(motion.reshape(self._shape)).ravel()

    def _solved(self, right):
        """Return the solutions (..., n, 1) of the matrix for right sides (..., n, 1)."""
        if self._is_spared:
            self._is_spared = False
            return np.linalg.solve(self._matrix, right)
        if self._inverse is None:
            self._inverse = np.linalg.inv(self._matrix)
        return self._inverse @ right

    def _on_bodies(self, force):
        """Return what forces (3, ..., k, .) do to bodies, (..., n, .)."""
        return (self._transposed @ force).sum(axis=0)

    def _of_motion(self, motion):
        """Return the residuals (3, ..., k, .) that motions (3, ..., k, .) make."""
        residual = self._own * motion
        residual[1] += self._cross * motion[2]
        residual[2] += self._cross * motion[1]
        return residual

    def _without_response(self, residual):
        """Return the forces (3, ..., k, .) that make residuals if there is no response."""
        force = np.empty_like(residual)
        np.multiply(self._normal, residual[0], out=force[0])
        first, second = residual[1:] - self._pull * force[0]
        i11, i12, i22 = self._tangential
        force[1] = i11 * first + i12 * second
        force[2] = i12 * first + i22 * second
        return force
