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
"""What can be read of a simulation at any time."""

from dataclasses import replace

from rigid_sim_ros.engine import diagnostics


class Readings:
    """
    The state of a `Simulation`, and what follows from it.

    Rows of all arrays are the moving bodies in the order of `names`. What a property returned
    stays as it was when the simulation goes on.
    """

    @property
    def method(self):
        """Return how motion is computed, as given."""
        return self._method_name

    @property
    def max_step(self):
        """Return the longest step [s], as given."""
        return self._max_step

    @property
    def time(self):
        """Return how much time has been simulated since the start [s]."""
        return self._method.time

    @property
    def names(self):
        """Return the names of the moving bodies in scene order, the order of all rows."""
        return self._world.bodies.names[:self._world.bodies.moving_count]

    @property
    def all_names(self):
        """Return `names`, then fixed bodies, then planes: what `body_a` and `body_b` index."""
        return self._world.bodies.names

    @property
    def position(self):
        """Return the centres of mass [m], (n, 3)."""
        return self._rows(self._method.state.position)

    @property
    def orientation(self):
        """Return unit quaternions x, y, z, w, body to world, (n, 4)."""
        return self._rows(self._method.state.orientation)

    @property
    def linear_velocity(self):
        """Return the velocities of the centres of mass [m/s], (n, 3), world axes."""
        return self._rows(self._method.state.linear_velocity)

    @property
    def angular_velocity(self):
        """Return the angular velocities [rad/s], (n, 3), world axes."""
        return self._rows(self._method.state.angular_velocity)

    @property
    def force(self):
        """Return the held forces besides gravity [N], (n, 3), world axes."""
        return self._rows(self._method.state.force)

    @property
    def torque(self):
        """Return the held torques [N m], (n, 3), world axes."""
        return self._rows(self._method.state.torque)

    @property
    def collisions(self):
        """Return the events of the last advance in order of time, of dtype `events.COLLISION`."""
        return self._collisions

    @property
    def asleep(self):
        """Return whether each body rests and is skipped until something wakes it, (n,) bool."""
        return self._method.asleep

    @property
    def work(self):
        """Return what has been done since the start: a `work.Work` of counters."""
        return replace(self._work)

    @property
    def scene(self):
        """Return the `model.Scene` with the bodies there are now, each as it was at the start."""
        return self._scene

    def energy(self):
        """Return the kinetic and gravitational energy [J], zero at rest at the origin."""
        return diagnostics.energy(self._world.bodies, self._world.gravity, self._method.state)

    def momentum(self):
        """Return the momentum of all moving bodies [kg m/s], (3,)."""
        return diagnostics.momentum(self._world.bodies, self._method.state)

    def angular_momentum(self):
        """Return the angular momentum (3,) of all moving bodies about the origin [kg m^2/s]."""
        return diagnostics.angular_momentum(self._world.bodies, self._method.state)

    def penetration(self):
        """Return how deep the deepest pair of bodies overlaps [m], zero if none does."""
        return diagnostics.penetration(self._world.bodies, self._method.state)

    def _rows(self, columns):
        """Return the moving bodies' columns of an array (c, n) as rows that cannot be written."""
        rows = columns[:, :self._world.bodies.moving_count].T
        rows.setflags(False)  # not writeable; by `flags` it takes twice as long
        return rows
