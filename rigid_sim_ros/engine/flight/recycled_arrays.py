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

"""Arrays for results, used again once nobody holds them."""

from sys import getrefcount

import numpy as np

FEWEST = 1000
"""Columns from which on it pays: smaller arrays come from memory that is at hand anyway."""

KEPT = 4
"""Arrays kept: two kinds of results, each while its successor is made."""

UNHELD = 3
"""References to an array that only this module knows: the list, a variable, an argument."""


class RecycledArrays:
    """
    A few arrays of doubles, handed out as if new.

    An array is handed out again only when neither it nor any view of it is referenced elsewhere,
    so a result never changes while somebody has it. Fresh memory for large results is costly, as
    the system clears it page by page: more than evaluating them, measured.
    """

    def __init__(self):
        """Start with none."""
        self._arrays = []

    def take(self, row_count, column_count):
        """Return an array (row_count, column_count) with any content."""
        if column_count < FEWEST:
            return np.empty((row_count, column_count))
        shape = row_count, column_count
        for array in self._arrays:
            if array.shape == shape and getrefcount(array) == UNHELD:
                return array
        array = np.empty(shape)
        if len(self._arrays) == KEPT:
            del self._arrays[0]
        self._arrays.append(array)
        return array
