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

"""How late many things were, in little memory however many they are."""

from math import ceil, log2

FINEST = 1e-6
"""Lateness [s] below which nothing is told apart."""

STEPS = 8
"""Steps to which a doubling of lateness is told: each is 9 % more than the one before."""


class Lateness:
    """Counts latenesses [s] by size, in logarithmic steps; the counts grow only with the range."""

    def __init__(self):
        self._counts = {}
        self.count = 0
        """How many were added."""

    def add(self, lateness):
        """Count one."""
        step = ceil(STEPS * log2(max(lateness, FINEST) / FINEST))
        self._counts[step] = self._counts.get(step, 0) + 1
        self.count += 1

    def quantile(self, fraction):
        """Return a lateness [s] that this fraction did not exceed, at most a step too large."""
        needed = fraction * self.count
        for step in sorted(self._counts):
            needed -= self._counts[step]
            if needed <= 0:
                break
        return FINEST * 2 ** (step / STEPS)
