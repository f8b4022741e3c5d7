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

"""The methods of this package."""

from bisect import bisect_right

from rigid_sim_ros.benchmark.engines import Engine
from rigid_sim_ros.engine import Simulation


class Exact(Engine):
    """
    Flight by formula, impacts at their instant, contact integrated: the default method.

    The step is the longest contact step; flight and impacts do not depend on it. Bodies at rest
    always sleep: there is no setting.
    """

    method = 'exact'

    def build(self, scene, step, sleeping):
        """Make the simulation."""
        self.simulation = Simulation(scene, method=self.method, max_step=step)

    def expect(self, times):
        """Let states be evaluated together."""
        def coming(count):
            place = bisect_right(times, self.simulation.time)
            return times[place:place + count]

        self.simulation.expect_times(coming)

    def advance(self, duration):
        """Advance."""
        self.simulation.advance(duration)

    def read_poses(self):
        """Return positions and orientations."""
        return self.simulation.position, self.simulation.orientation

    def read_velocities(self):
        """Return linear and angular velocities."""
        return self.simulation.linear_velocity, self.simulation.angular_velocity

    def asleep(self):
        """Return which bodies sleep."""
        return self.simulation.asleep


class Stepped(Exact):
    """Every body in every step, semi-implicit."""

    method = 'stepped'


class Report(Exact):
    """The student report's engine as written: explicit Euler, face axes only."""

    method = 'report'
