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

"""What every stage of a simulation is given: the constants of its scene, and where to note."""

from dataclasses import dataclass
from typing import Callable

import numpy as np

from rigid_sim_ros.engine.bodies import Bodies
from rigid_sim_ros.engine.events import EventLog
from rigid_sim_ros.engine.lasting_pairs import LastingPairs
from rigid_sim_ros.engine.work import Work


@dataclass(frozen=True)
class World:
    """A scene as the methods see it."""

    bodies: Bodies
    gravity: np.ndarray
    """(3,) [m/s^2], world axes."""

    impact_law: str
    """A key of `impacts.IMPACT_LAWS`."""

    max_step: float
    """Longest step of lasting contact, or of everything in methods that step [s]."""

    events: EventLog
    lasting_pairs: LastingPairs
    """Those in lasting contact, who may have been there before this world was made."""

    work: Work
    coming_times: Callable
    """`coming_times(count)`: up to so many times [s] at which states are likely to be read."""

    def acceleration(self, force):
        """Return gravity plus force over mass (3, n) [m/s^2], zero where a body is fixed."""
        inverse_mass = self.bodies.inverse_mass
        return self.gravity[:, None] * (inverse_mass > 0) + inverse_mass * force
