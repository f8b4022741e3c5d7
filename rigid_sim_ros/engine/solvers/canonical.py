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
The canonical choice among contact forces, and the loop that makes it.

Four corners of a face on a plane have one force too many: the motion does not determine them, and
with friction the motion in turn depends on them. The choice made here is that of a stiff uniform
elastic foundation, pressure affine over a face: the motion is replaced by

    motion + compliance (force - reference)

with the same compliance in every row, first about no force, then about the force just found,
until that no longer moves. The compliance is gone in the end, and relabelling contacts or bodies
changes nothing. The reference must never be a remembered force: history would decide.
"""

import numpy as np

COMPLIANCE = 1e-5
"""Of the mean normal response. Less loses digits of the redundant part, more needs more passes."""

MAX_PASSES = 12
"""Refinements at most; each multiplies what is left by COMPLIANCE over the least response."""

ACCURACY = 1e-13
"""Of the free motion: what is left of the compliance, and of each condition, at the end."""


def compliance_of(problem):
    """Return the compliance of a `ContactProblem`."""
    count = problem.count
    diagonal = problem.response.ravel()[::len(problem.response) + 1]
    return COMPLIANCE * diagonal[:count].sum() / count


def refine(solve, problem, compliance, accuracy):
    """
    Return the force that is left when the compliance is refined away, or None if a pass fails.

    Away is when it makes less motion than `accuracy` of the free motion.

    `solve(free, guess)` returns the force for a free motion less compliance * reference, or None;
    the guess is None or the force of the pass before.
    """
    free = problem.free
    tolerance = accuracy * np.abs(free).max()
    reference = np.zeros_like(free)
    reference[:problem.count] = problem.floor
    guess = None
    for _ in range(MAX_PASSES):
        force = solve(free - compliance * reference, guess)
        if force is None or compliance * np.abs(force - reference).max() <= tolerance:
            return force
        reference = guess = force
    return force
