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
Contacts guessed to be all closed and sticking: the forces are those of one linear system.

A look at them proves the guess or refuses it. The system is that of the contacts alone, so it is
solved again under other forces by a multiplication.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import canonical


class Sticking:
    """
    The linear system of contacts (k,) with this response and friction.

    Parameters
    ----------
    problem : ContactProblem
        Without floors and without known slips; of it, what is asked for may have another motion
        `free`.

    """

    def __init__(self, problem):
        """See the class."""
        self._compliance = canonical.compliance_of(problem)
        self._matrix = problem.response.copy()
        self._matrix.ravel()[::3 * problem.count + 1] += self._compliance
        try:
            self._inverse = np.linalg.inv(self._matrix)
        except np.linalg.LinAlgError:
            self._inverse = None

    def force(self, problem, accuracy):
        """
        Return what leaves no motion, (3k,), or None if a contact would pull or slide then.

        `accuracy` is that of `canonical.refine`. None also if the system is singular.
        """
        if self._inverse is None:
            return None

        def solve(free, guess):
            # a correction of the force before, so that the digits an inverse loses are found again
            force = (self._inverse @ -free if guess is None
                     else guess - self._inverse @ (free + self._matrix @ guess))
            return force if _holds(force, problem.friction) else None

        return canonical.refine(solve, problem, self._compliance, accuracy)


def _holds(force, friction):
    """Return whether contacts with forces (3k,) push, with no more friction than allowed."""
    normal, first, second = force.reshape(3, -1)
    limit = friction * normal
    return bool((normal >= 0).all() and (first * first + second * second <= limit * limit).all())
