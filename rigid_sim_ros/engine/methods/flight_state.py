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

"""The state of bodies in flight at one time: what is not read is not evaluated."""

from functools import cached_property

from rigid_sim_ros.engine.state import State


class FlightState(State):
    """A `state.State` whose poses and velocities are evaluated when they are first read."""

    def __init__(self, flights, time, force, torque, work):
        self._flights = flights
        self._time = time
        self._work = work
        self.force = force
        self.torque = torque

    @cached_property
    def _poses(self):
        self._work.pose_evaluations += 1
        return self._flights.poses(self._time)

    @cached_property
    def _velocities(self):
        return self._flights.velocities(self._time)

    @cached_property
    def position(self):
        """(3, n) [m]."""
        return self._poses[0]

    @cached_property
    def orientation(self):
        """(4, n)."""
        return self._poses[1]

    @cached_property
    def linear_velocity(self):
        """(3, n) [m/s]."""
        return self._velocities[0]

    @cached_property
    def angular_velocity(self):
        """(3, n) [rad/s]."""
        return self._velocities[1]
