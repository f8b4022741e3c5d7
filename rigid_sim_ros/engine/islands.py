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
Bodies in lasting contact: who is, who may join, their steps, their sleep and their waking.

Fixed bodies, planes and sleeping bodies are what islands may lie on.
"""

from dataclasses import replace

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.broad_phase import candidate_pairs
from rigid_sim_ros.engine.methods.stepped import Stepped
from rigid_sim_ros.engine.narrow_phase import find_contacts

REACH_FACTOR = 4.0
"""
How much faster than the fastest body now one can be after an impact within a step: a body in
flight that could reach a body in lasting contact at this speed is stepped with it.
"""

PARTING_MARGIN = 1e-4
"""Bodies further apart than this part of the smaller one no longer touch."""


class Islands:
    """The moving bodies in lasting contact, awake (`touching`) or not (`asleep`)."""

    def __init__(self, world, flights):
        self._world = world
        self._flights = flights
        count = world.bodies.moving_count
        self.touching = np.zeros(count, dtype=bool)
        self.asleep = np.zeros(count, dtype=bool)

    def step_end(self, time, end):
        """Return how far to go at once [s], at most to `end`: steps are equal and short enough."""
        if not self.touching.any():
            return end
        steps = np.ceil((end - time) / self._world.max_step * (1 - 1e-9))
        return end if steps <= 1 else time + (end - time) / steps

    def reached(self, time, end):
        """Return the bodies in flight (k,) that may meet one in lasting contact before `end`."""
        flying = ~(self.touching | self.asleep)
        if not (flying.any() and self.touching.any()):
            return np.zeros(0, dtype=int)
        bodies = self._world.bodies
        radius = bodies.bounding_radius[:bodies.moving_count]
        position, linear = self._flights.translation(time)
        spin = self._flights.rate_bound(np.arange(bodies.moving_count), time, end)
        pull = self._flights.acceleration
        fastest = (np.sqrt(rotation.dot(linear, linear)[:bodies.moving_count]) + spin * radius
                   + np.sqrt(rotation.dot(pull, pull)[:bodies.moving_count]) * (end - time)).max()
        a, b = candidate_pairs(bodies, position, REACH_FACTOR * fastest * (end - time))
        both = b < bodies.moving_count
        a, b = a[both], b[both]
        return np.union1d(a[flying[a] & self.touching[b]], b[flying[b] & self.touching[a]])

    def add(self, indices):
        """From now on these bodies (k,) are in lasting contact."""
        self.touching[indices] = True

    def remove(self, indices):
        """From now on these bodies (k,) are not."""
        self.touching[indices] = False

    def wake(self, indices):
        """Wake these bodies (k,) and all that sleep with them; return all that woke."""
        return indices[:0]

    def advance(self, members, start, end, state):
        """
        Step these bodies (k,) from `start` to `end` [s]; return those that touch nothing then.

        `state` is that of all bodies at `start`; the columns of `members` are replaced.
        """
        bodies = self._world.bodies
        others = np.ones(bodies.count, dtype=bool)
        others[members] = False
        alone = replace(
            bodies, inverse_mass=np.where(others, 0.0, bodies.inverse_mass),
            inverse_inertia=np.where(others, 0.0, bodies.inverse_inertia))
        state.linear_velocity = np.where(others, 0.0, state.linear_velocity)
        state.angular_velocity = np.where(others, 0.0, state.angular_velocity)
        stepped = Stepped(replace(self._world, bodies=alone), state, end)
        stepped.step(end - start)
        self._world.work.contact_steps += 1
        a, b = candidate_pairs(alone, state.position, 0.0)
        ours = ~(others[a] & others[b])
        a, b = a[ours], b[ours]
        size = np.minimum(bodies.bounding_radius[a], bodies.bounding_radius[b])
        contacts = find_contacts(alone, a, b, state.position, state.orientation,
                                 PARTING_MARGIN * size)
        others[contacts.body_a] = others[contacts.body_b] = True
        return members[~others[members]]
