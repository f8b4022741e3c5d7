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
The rows of the Jacobian of few contacts, and of more: what contacts and bodies do to each other.

Of many more, `solvers.blocks` has them. All are scaled by M^-1/2, so that masses appear nowhere.
"""

import numpy as np


class DenseRows:
    """
    The rows of few contacts, with the response as a matrix.

    Parameters
    ----------
    rows : (3k, 6 slots)

    """

    def __init__(self, rows):
        """See the class."""
        self._rows = rows
        self._response = rows @ rows.T
        self.count = len(rows) // 3

    def motion(self, velocity):
        """Return how all rows move, (3k,), for scaled velocities, flat (6 slots,)."""
        return self._rows @ velocity

    def momentum(self, force):
        """Return the scaled velocities, flat (6 slots,), that forces (3k,) make."""
        return force @ self._rows

    def response(self, force):
        """Return the motion (3k,) that forces (3k,) make."""
        return self._response @ force


class PointRows:
    """
    The rows of k contacts, twelve numbers a row: those of its two bodies.

    Contacts go along the last axis: a product is a few long loops, however the contacts are
    spread over pairs.

    Parameters
    ----------
    rows : (3, 12, k)
        Normals, first, second tangents; six columns for either body.
    slots : (2, k) int
        Of the two bodies; what does not move has the last slot of all.
    slot_count : int
        Bodies that move, and one for all that do not.

    """

    def __init__(self, rows, slots, slot_count):
        """See the class."""
        self.count = rows.shape[2]
        self._slots, self._slot_count = slots, slot_count
        self._size = 6 * slot_count
        self._rows = np.ascontiguousarray(rows)
        self._places = (6 * slots[:, None] + np.arange(6)[:, None]).reshape(12, self.count)
        self._flat_places = self._places.ravel()
        self._each = np.empty((12, self.count))

    def select(self, kept):
        """Return the rows of some contacts (k,) bool."""
        return PointRows(self._rows[:, :, kept], self._slots[:, kept], self._slot_count)

    def motion(self, velocity):
        """Return how all rows move, (3k,), for scaled velocities, flat (6 slots,)."""
        # the places are in range: to say so saves a check of each
        velocity.take(self._places, out=self._each, mode='clip')
        return np.einsum('aik,ik->ak', self._rows, self._each).ravel()

    def momentum(self, force):
        """Return the scaled velocities, flat (6 slots,), that forces (3k,) make."""
        np.einsum('aik,ak->ik', self._rows, force.reshape(3, -1), out=self._each)
        return np.bincount(self._flat_places, self._each.ravel(), self._size)

    def response(self, force):
        """Return the motion (3k,) that forces (3k,) make."""
        return self.motion(self.momentum(force))
