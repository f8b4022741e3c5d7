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

"""What the methods share that advance every body in steps."""

from math import ceil

import numpy as np


class Stepping:
    """A method that keeps a state and advances all of it by `step`."""

    def __init__(self, world, state, time):
        self._world = world
        self.state = state
        self.time = time

    def step(self, dt):
        """Advance the state by `dt` [s], at most the world's `max_step`."""
        raise NotImplementedError

    def advance(self, duration, until_collision=False):
        """
        Advance by `duration` [s] in equal steps of at most `max_step`.

        If `until_collision`, not beyond the step in which bodies first come together.
        """
        # a duration of n steps is not cut into n + 1 for the sake of its rounding
        count = max(1, ceil(duration / self._world.max_step * (1 - 1e-12)))
        start, dt = self.time, duration / count
        for number in range(1, count + 1):
            self.time = start + duration * (number / count)
            self.step(dt)
            if until_collision and self._world.events.struck:
                return

    def set_motion(self, indices, **values):
        """Give bodies (k,) new values (., k) of the quantities named, fields of `State`."""
        for quantity, columns in values.items():
            self.state.change(quantity, indices, columns)

    def set_wrench(self, indices, force, torque):
        """Hold these forces and torques (3, k) on bodies (k,)."""
        self.state.change('force', indices, force)
        self.state.change('torque', indices, torque)

    @property
    def asleep(self):
        """Whether each moving body rests and is skipped, (n,) bool: never."""
        return np.zeros(self._world.bodies.moving_count, dtype=bool)
