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

from rigid_sim_ros.engine.state import State


class FlightState(State):
    """
    A `state.State` whose poses and velocities are evaluated when they are first read.

    They become attributes then, so that reading them again costs nothing.
    """

    def __init__(self, flights, read_ahead, time, force, torque):
        self._flights = flights
        self._read_ahead = read_ahead
        self.time = time
        """When it is evaluated [s]."""
        self.force = force
        self.torque = torque

    def __getattr__(self, name):
        """Evaluate what has not been read yet; called for attributes that are not there."""
        if name in ('position', 'orientation'):
            self.position, self.orientation = self._read_ahead.poses(self.time)
        elif name in ('linear_velocity', 'angular_velocity'):
            self.linear_velocity, self.angular_velocity = self._flights.velocities(self.time)
        else:
            raise AttributeError(f'a state has no {name!r}')
        return self.__dict__[name]
