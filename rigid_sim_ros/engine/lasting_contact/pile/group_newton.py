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

"""Newton's method for groups of a pile's contacts that are small enough for it."""

import numpy as np

from rigid_sim_ros.engine.solvers.canonical import compliance_of
from rigid_sim_ros.engine.solvers.newton import Newton
from rigid_sim_ros.engine.solvers.problem import ContactProblem

MOST_BODIES = 12
"""
Of a group. From what 40 iterations of the gradient leave Newton's method solves columns of ten in
a twentieth of the time in which that does, and four of five groups of up to ten tumbled cubes; of
more than 30 cubes it does one group of five, in the time of the gradient.
"""

_SAFETY = 0.1
"""Of the tolerance: what Newton's method, which has another norm, is asked for."""


def newton_forces(rows, slots, free, friction, force, tolerance):
    """
    Return (forces (3k,) of one group of contacts or None, iterations), from forces close by.

    Parameters
    ----------
    rows : (3, k, 2, 6)
        Scaled Jacobian, six columns for either body.
    slots : (2, k) int
        Of the two bodies; what does not move has rows of zeros.
    free, force : (3, k)
        Motion without forces less what is asked for; forces to start from.
    friction : (k,)
        As in `ContactProblem`.
    tolerance : float
        Of motion.

    """
    bodies, columns = np.unique(slots, return_inverse=True)
    count = len(friction)
    factor = np.zeros((3, count, len(bodies), 6))
    for side, column in enumerate(columns.reshape(2, count)):
        factor[:, np.arange(count), column] += rows[:, :, side]
    factor = factor.reshape(3 * count, -1)
    problem = ContactProblem(factor @ factor.T, free.ravel(), friction, np.zeros(count),
                             np.zeros((2, count)), factor)
    newton = Newton(problem, compliance_of(problem))
    found = newton.refined(force.ravel(), _SAFETY * tolerance / np.abs(free).max())
    return found, newton.iterations
