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
Bounces without end: touches of the same pairs again and again at one instant.

What is light between two that come together hits the one and the other ever faster. If enough is
lost in each impact there are infinitely many in a finite time, after which nothing moves any more
against what it has bounced off ('inelastic collapse', McNamara and Young 1992, 'Inelastic collapse
and clumping in a one-dimensional granular medium'). Some hundred impacts before, their times
cannot be told apart any more, and gaps are far below those that count as none.
"""

import numpy as np

from rigid_sim_ros.engine.graph import connected

INSTANT = 1e-12
"""Longest time [s] between touches at one instant: instants are found some 1e-13 as well."""

_ROUNDING = 1e-15
"""The same of the time itself."""

TIMES = 8
"""
So often pairs touch at one instant and part again. Bodies in a row that hand on an impact, from
each to the next, do so in fewer touches of each pair.
"""


class Cascade:
    """
    The touches at one instant.

    Parameters
    ----------
    moving_count : int
        Bodies with an index below it move.

    """

    def __init__(self, moving_count):
        """See the class."""
        self._moving_count = moving_count
        self._until = -np.inf
        self._counts = {}

    def ended(self, time, body_a, body_b):
        """
        Return the pairs a, b (q,) that bounce without end at `time` [s], or None.

        If one of the pairs (p,) that touch now has done so too often at this instant, that is all
        that have touched at it and hang together with such a one. What else touches now is left
        for the next time, as it has nothing to do with them.
        """
        if time > self._until:
            self._counts.clear()
        self._until = time + max(INSTANT, _ROUNDING * abs(time))
        often = False
        for pair in zip(body_a.tolist(), body_b.tolist()):
            count = self._counts.get(pair, 0) + 1
            self._counts[pair] = count
            often = often or count > TIMES
        return self._endless() if often else None

    def _endless(self):
        """Return the pairs a, b (q,) that hang together with one that has touched too often."""
        pairs = sorted(self._counts)
        return np.array([pairs[place] for group in connected(pairs, self._moving_count)
                         if max(self._counts[pairs[place]] for place in group) > TIMES
                         for place in group]).T
