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
The linear systems of Newton's method on contact conditions, ready to be solved many times.

A system is by_force + by_motion @ (response + compliance), with both matrices block-diagonal, a
contact's 3 x 3 each, as `contact_equations` gives them.
"""

import numpy as np

from rigid_sim_ros.engine.solvers.contact_equations import places


class DenseSystem:
    """
    A system as one matrix, which is inverted.

    Parameters
    ----------
    rows : (15, k)
        See `contact_equations.linearise`.
    matrix : (3k, 3k)
        The response with its compliance.

    """

    def __init__(self, rows, matrix):
        """Raise LinAlgError if it is singular."""
        count = rows.shape[1]
        motion_places, force_places = places(count)
        self._by_motion = np.zeros((3 * count, 3 * count))
        by_force = np.zeros((3 * count, 3 * count))
        self._by_motion.ravel()[motion_places] = rows[3:8]
        by_force.ravel()[force_places] = rows[8:]
        self._inverse = np.linalg.inv(self._by_motion @ matrix + by_force)

    def solve(self, residual):
        """Return the change of force (3k,) that makes a residual."""
        return self._inverse @ residual

    def of_motion(self, motion):
        """Return the residual (3k,) that a motion makes."""
        return self._by_motion @ motion


class FactoredSystem:
    """
    A system of many contacts between few bodies, with a response that is factor @ factor.T.

    By the formula of Woodbury it takes a matrix with a row and a column for each freedom of the
    bodies, where `DenseSystem` has three for each contact.

    Parameters
    ----------
    rows : (15, k)
        As for `DenseSystem`.
    factor : (3k, n)
        See `ContactProblem`.
    compliance : float
        Above zero.

    """

    def __init__(self, rows, factor, compliance):
        """Raise LinAlgError if a contact by itself is singular; never with a compliance."""
        self._slopes = rows[3:8]
        nn, t11, t12, t21, t22 = rows[8:13] + compliance * rows[3:8]
        self._pull = rows[13:]
        determinant = t11 * t22 - t12 * t21
        if not nn.all() or not determinant.all():
            raise np.linalg.LinAlgError
        self._normal = 1 / nn
        self._tangential = np.stack((t22, -t12, -t21, t11)) / determinant
        self._factor = factor
        count, size = rows.shape[1], factor.shape[1]
        # (3, k) of rows of the factor, as columns of residuals
        self._spread = self._without_response(self._of_motion(factor.reshape(3, count, size)))
        self._spread = self._spread.reshape(3 * count, size)
        self._matrix = factor.T @ self._spread
        self._matrix.ravel()[::size + 1] += 1.0

    def solve(self, residual):
        """Return the change of force (3k,) that makes a residual."""
        alone = self._without_response(residual.reshape(3, -1, 1)).ravel()
        # most systems are solved once or twice, which takes less than to invert them
        return alone - self._spread @ np.linalg.solve(self._matrix, self._factor.T @ alone)

    def of_motion(self, motion):
        """Return the residual (3k,) that a motion makes."""
        return self._of_motion(motion.reshape(3, -1, 1)).ravel()

    def _of_motion(self, motion):
        """Return the residuals (3, k, .) that motions (3, k, .) make."""
        nn, t11, t12, t21, t22 = self._slopes[:, :, None]
        return np.stack((nn * motion[0], t11 * motion[1] + t12 * motion[2],
                         t21 * motion[1] + t22 * motion[2]))

    def _without_response(self, residual):
        """Return the forces (3, k, .) that make residuals (3, k, .) if there is no response."""
        normal = self._normal[:, None] * residual[0]
        first = residual[1] - self._pull[0][:, None] * normal
        second = residual[2] - self._pull[1][:, None] * normal
        i11, i12, i21, i22 = self._tangential[:, :, None]
        return np.stack((normal, i11 * first + i12 * second, i21 * first + i22 * second))
