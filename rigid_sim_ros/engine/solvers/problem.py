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
The contact problem that every force and impulse of the engine comes from, as plain arrays.

For k contacts, in contact axes, the rows of a vector (3k,) are the k normal components, the k
first and the k second tangential ones. Force and motion stand for impulse and velocity, or for
force and acceleration: the problem is the same.

    motion = free + response @ force
    0 <= force_n - floor  _|_  motion_n >= 0
    |force_t| <= friction force_n, and where the motion is not zero the friction opposes it with
    all of that (Coulomb's law; the disc, not a pyramid)
"""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.engine.friction import project_on_disc


@dataclass
class ContactProblem:
    """One contact problem; see the module. Forces act on body b of each contact."""

    response: np.ndarray
    """(3k, 3k), symmetric: the motion across the contacts per force (Delassus operator)."""

    free: np.ndarray
    """(3k,): the motion without contact force, less what is asked for."""

    friction: np.ndarray
    """(k,), 0 or more."""

    floor: np.ndarray
    """(k,): normal force that is there in any case; 0 but for a Poisson rebound."""

    slip: np.ndarray
    """
    (2, k) unit vectors along which contacts are known to slide, zero where that is to be found.
    Friction is then -friction force_n slip.
    """

    factor: np.ndarray = None
    """(3k, n) or None: the response is factor @ factor.T; of use where n is small."""

    @property
    def count(self):
        """Count of contacts."""
        return len(self.friction)

    def residual(self, force, motion):
        """
        Return by how much each condition is violated, (3k,), in units of motion.

        It is force less its projection on what is allowed, divided by the diagonal response.
        """
        count = self.count
        diagonal = self.response.ravel()[::3 * count + 1].reshape(3, count)
        stiffness = np.stack((diagonal[0], *(np.maximum(diagonal[1], diagonal[2]),) * 2))
        normal, first, second = force.reshape(3, count)
        target = (force - motion / stiffness.ravel()).reshape(3, count)
        limit = self.friction * np.maximum(normal, 0.0)
        known = np.any(self.slip != 0, axis=0)
        allowed_1, allowed_2 = project_on_disc(target[1], target[2], limit)
        allowed = np.stack((
            np.maximum(target[0], self.floor),
            np.where(known, -limit * self.slip[0], allowed_1),
            np.where(known, -limit * self.slip[1], allowed_2)))
        return ((force.reshape(3, count) - allowed) * stiffness).ravel()


@dataclass(frozen=True)
class Solution:
    """What a solver found."""

    force: np.ndarray
    """(3k,) in contact axes."""

    iterations: int
    """Linear systems solved, or sweeps done."""

    start: np.ndarray
    """
    (3k,): a force to start from in a problem much like this one. It is the one before the
    compliance is refined away (see `canonical`), which is what is searched first.
    """
