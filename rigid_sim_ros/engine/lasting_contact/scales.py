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
The numbers that decide what is touching, sticking, an impact, at rest: all in units of the island.

An island's own scales are its smallest body's bounding radius (length), the largest acceleration
that is not due to contact (gravity, mostly), and the speed that makes of the two, sqrt(length
acceleration): 3 m/s for a metre on Earth.
"""

from dataclasses import dataclass

STICK = 1e-3
"""
Of the speed scale: what rebounds slower stays. The error in a whole throw is about 7e-3 of this
speed times a second; less costs impacts and gains little in steps.
"""

APPROACH_STEPS = 2.0
"""Fall during so many steps: what approaches faster is an impact, cut out of the step."""

SLIDE_STEPS = 4.0
"""Fall during so many steps: what slides faster keeps its direction in the first half of one."""

ARRIVAL_STEPS = 20.0
"""Acceleration times the square of the step, so many times: a gap that may close in the step."""

TOUCH_STEPS = 0.2
"""Acceleration times the square of the step, so much of it: a gap that counts as closed."""

TOUCH = 1e-9
"""Of the length scale: what is added to that."""

IMPACT_GAP = 1e-6
"""Of the length scale: contacts closer than this take part in an impact."""

OVERLAP = 1e-9
"""Of the length scale: overlap that is left alone; more is an impact, or is pushed out."""

DEEP = 1e-3
"""
Of the length scale: overlap of few bodies that is pushed out whatever energy that takes; their own
steps and those of piles leave less, so somebody else has made it.
"""

REST = 3e-4
"""Of the speed scale: what is slower and in equilibrium is at rest."""

EQUILIBRIUM = 1e-6
"""Of the acceleration scale: what contact forces may leave of it on a body at rest."""

MAX_BOUNCES = 8
"""Impacts in one step; after so many the rest of it has no restitution."""

MAX_CUTS = 64
"""The same; after so many it is not cut any more, and ends with an overlap that is pushed out."""


@dataclass(frozen=True)
class Scales:
    """The scales of one island; see the module."""

    length: float
    """[m]"""

    acceleration: float
    """[m/s^2]"""

    @property
    def speed(self):
        """Speed scale [m/s]."""
        return (self.length * self.acceleration) ** 0.5

    def touch_gap(self, step):
        """Return the gap [m] below which contacts count as closed in a step [s]."""
        return TOUCH_STEPS * self.acceleration * step * step + TOUCH * self.length

    def arrival_gap(self, step):
        """Return the gap [m] that may close in a step [s] without any speed of approach."""
        return ARRIVAL_STEPS * self.acceleration * step * step + TOUCH * self.length

    def impact_speed(self, step):
        """Return the speed of approach [m/s] above which a contact is an impact."""
        return max(STICK * self.speed, APPROACH_STEPS * self.acceleration * step)

    def slide_speed(self, step):
        """Return the speed [m/s] above which sliding cannot turn round within a step [s]."""
        return SLIDE_STEPS * self.acceleration * step
