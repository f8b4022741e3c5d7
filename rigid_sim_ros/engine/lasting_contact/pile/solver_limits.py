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

"""How far a pile's solver goes, and by what means, for each group of contacts."""

from typing import NamedTuple

import numpy as np

ITERATIONS = 60
"""
The least that is a solution's fair share; what the `Budget` has saved comes on top. What hardly
moves needs a few, a row of 31 that is hit some 600, a pushed tower thousands.
"""

HIT_ITERATIONS = 25
"""The same for what something hits in a step, and again as long as something sinks."""

MOST_ITERATIONS = 1000
"""The most that is a fair share."""

THOROUGH = 200
"""A share from which on Newton's method is quicker, as far as it gets to the end."""

WORK = 500_000
"""
Iterations times contacts to the power of 3/2 in a fair share: that of few, and the fewest from
some hundreds on, which are dear and hardly gain by more as long as they are disturbed each step.
"""

ACCURACY = 5e-8
"""
Of what the acceleration scale does to velocities in a step: where the solver stops. A row of 30
that friction holds goes by a tenth of a nanometre until it does.
"""

HIT_ACCURACY = 1e-6
"""Of the speed of what hits: where the solver stops then. A row goes on at a fraction of that."""

STEADY = 0.05
"""Of the speed scale: what turns slower does not tumble, but stands, slides or lands flat."""


class Limits(NamedTuple):
    """What the solver is given for each of g groups."""

    tolerance: np.ndarray
    """(g,) [m/s]: change of motion in an iteration at which to stop."""

    share: np.ndarray
    """(g,) int: iterations that are a fair share."""

    thorough: np.ndarray
    """(g,) bool: worth it to be solved by Newton's method where these do not do."""


def solver_limits(island, scales, contacts, motion, duration, hit_speed):
    """
    Return the `Limits` for `PileContacts` in a step of `duration` [s] from a `Motion`.

    The speeds (k,) [m/s] of approach are those of what hits, and zero for others.
    """
    speed = np.zeros(contacts.group_count)
    np.maximum.at(speed, contacts.groups, hit_speed)
    share = int(WORK / max(1, len(hit_speed)) ** 1.5)
    thorough = (np.full(len(speed), True) if share >= THOROUGH
                else _steady(island, scales, contacts, motion))
    calm = ACCURACY * scales.acceleration * duration
    return Limits(
        np.where(speed > 0, HIT_ACCURACY * speed, calm),
        np.clip(share, np.where(speed > 0, HIT_ITERATIONS, ITERATIONS), MOST_ITERATIONS),
        thorough)


def _steady(island, scales, contacts, motion):
    """Return in which groups (g,) bool of contacts at least half of the bodies hardly turn."""
    count = island.member_count
    turning = island.bodies.bounding_radius[:count] * np.abs(motion.angular[:, :count]).max(axis=0)
    votes = np.bincount(contacts.body_groups[:count],
                        np.where(turning <= STEADY * scales.speed, 1.0, -1.0),
                        contacts.group_count + 1)
    return votes[:-1] >= 0.0
