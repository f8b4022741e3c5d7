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
"""How fast turning moves the surfaces of bodies: bounds, for what may meet what."""

import numpy as np

from rigid_sim_ros.engine import rotation

SLENDER = 3.0
"""Ratio of extents above which it pays to tell the axes apart about which a body turns."""


class TurningBounds:
    """
    Bounds for some `Bodies`.

    A ball may turn as it likes; a rod may spin fast about its own axis.
    """

    def __init__(self, bodies):
        """See the class."""
        self._radius = bodies.turning_radius
        self._arms = None
        """(3, n) [m]: how far points are from each axis of a body, if that differs much."""
        extents = bodies.half_extents
        if (extents.max(axis=0) > SLENDER * extents.min(axis=0)).any():
            self._arms = (self._radius > 0.0) * np.stack(
                [np.hypot(extents[i - 1], extents[i - 2]) for i in range(3)])

    @property
    def tells_axes(self):
        """Whether it matters about which of its axes a body turns."""
        return self._arms is not None

    def speeds(self, orientation, angular):
        """
        Return bounds (m,) [m/s] of how fast points of the first bodies go about their centres.

        For attitudes (4, m) and angular velocities (3, m) [rad/s] in world axes.
        """
        count = angular.shape[1]
        if self._arms is None:
            return self._radius[:count] * np.sqrt(rotation.dot(angular, angular))
        rates = rotation.transform_transposed(rotation.matrix(orientation), angular)
        return (np.abs(rates) * self._arms[:, :count]).sum(axis=0)
