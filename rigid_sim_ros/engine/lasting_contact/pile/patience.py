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
Which groups of contacts of a pile are to be tried by Newton's method.

It solves nearly all groups where columns stand and land, and half of them where they jump and
topple; one that it has failed on it mostly fails on again. Groups come and go: bodies remember.
"""

import numpy as np

WAITS = np.array((0, 1, 4, 16, 64))
"""Solutions that do without it after it has failed so many times in a row, or more."""

_PAYS, _TRIES = 0.75, 8
"""It pays if it solves this part of the groups it is tried for, seen after so many."""


def newton_pays(tried, solved):
    """Return whether to go on in a solution in which so many groups were tried and solved."""
    return tried < _TRIES or solved >= _PAYS * tried


class Patience:
    """
    What the bodies of a pile know of Newton's method.

    Parameters
    ----------
    members : (m,) int
        Indices of the bodies in the scene.

    """

    def __init__(self, members):
        """See the class."""
        self._members = members
        self._failures, self._waits = np.zeros((2, len(members)), dtype=int)

    def take_over(self, older):
        """Know what another knew of the same bodies."""
        _, mine, theirs = np.intersect1d(self._members, older._members, return_indices=True)
        self._failures[mine] = older._failures[theirs]
        self._waits[mine] = older._waits[theirs]

    def allows(self, groups, group_count):
        """Return which groups (g,) bool are to be tried; bodies are in (m,) int, up to g."""
        allowed = np.ones(group_count + 1, dtype=bool)
        allowed[groups[self._waits > 0]] = False
        return allowed[:group_count]

    def note(self, groups, tried, solved):
        """Note a solution in which some groups (g,) bool were tried and some of these solved."""
        self._waits = np.maximum(self._waits - 1, 0)
        bodies = np.flatnonzero(np.append(tried, False)[groups])
        failures = np.minimum(self._failures[bodies] + 1, len(WAITS) - 1)
        self._failures[bodies] = np.where(solved[groups[bodies]], 0, failures)
        self._waits[bodies] = WAITS[self._failures[bodies]]
