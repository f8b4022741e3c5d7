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

"""Iterations of the solver of a pile, saved up for solutions that need more than their share."""

SAVED = 2000
"""
Iterations that are kept for later, at most. A row of 31 that is hit takes some 600 at once and
next to none afterwards; a heap that tumbles has none to spare.
"""


class Budget:
    """
    Iterations to spend, solution by solution.

    Parameters
    ----------
    older : list of Budget
        Of the piles it goes on from.

    """

    def __init__(self, older):
        """See the class."""
        self.saved = max((budget.saved for budget in older), default=SAVED)
        """Iterations left over so far."""

    def spend(self, used, share):
        """Note that groups have used so many iterations (g,), of a fair share (g,)."""
        self.saved = min(max(0, self.saved + int((share - used).min())), SAVED)
