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
"""What a pile may take to be solved: iterations that some steps leave and others need, Newton."""

SAVED = 2000
"""
Iterations that are kept for later, at most. A row of 31 that is hit takes some 600 at once and
next to none afterwards; a heap that tumbles has none to spare.
"""

WAITS = 16
"""
Solutions that do without Newton's method where it has not paid. It solves nearly all groups where
columns land, and half of them where they jump and topple.
"""

_PAYS, _TRIES = 0.75, 8
"""It pays if it solves this part of the groups it is tried for, seen after so many at least."""


def newton_pays(tried, solved, tries=_TRIES):
    """Return whether to go on with Newton's method that was tried and solved so many groups."""
    return tried < tries or solved >= _PAYS * tried


class Budget:
    """
    Iterations to spend, solution by solution, and whether Newton's method is to be tried.

    Parameters
    ----------
    older : list of Budget
        Of the piles it goes on from.

    """

    def __init__(self, older):
        """See the class."""
        self.saved = max((budget.saved for budget in older), default=SAVED)
        """Iterations left over so far."""
        self._waits = max((budget._waits for budget in older), default=0)

    @property
    def tries_newton(self):
        """Whether Newton's method is to be tried in the next solution."""
        return self._waits == 0

    def note_newton(self, tried, solved):
        """Note that so many groups were tried by Newton's method and so many of them solved."""
        if not newton_pays(tried, solved, tries=1):
            self._waits = WAITS + 1

    def spend(self, used, share):
        """Note that groups have used so many iterations (g,), of a fair share (g,)."""
        self._waits = max(0, self._waits - 1)
        self.saved = min(max(0, self.saved + int((share - used).min())), SAVED)
