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

"""Islands stepped on their own, for tests of lasting contact."""

from dataclasses import replace

import numpy as np

from rigid_sim_ros.engine import diagnostics
from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.events import EventLog
from rigid_sim_ros.engine.lasting_contact import advance_island, Island
from rigid_sim_ros.engine.lasting_pairs import LastingPairs
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.state import state_of
from rigid_sim_ros.engine.work import Work
from rigid_sim_ros.engine.world import World

GRAVITY = 9.81


def body(name, shape, mass=1.0, **values):
    """Return a body of this shape and mass, solid."""
    return Body(name, shape, mass, shape.inertia(mass), **values)


def ground(**values):
    """Return the plane z = 0."""
    return Plane('ground', **values)


class IslandRun:
    """One island of all bodies of a scene, and the steps it takes."""

    def __init__(self, bodies, planes=None, step=1 / 240, restitution=None, friction=None,
                 law='poisson', gravity=(0.0, 0.0, -GRAVITY)):
        planes = (ground(),) if planes is None else planes
        if friction is not None:
            material = Material(restitution or 0.0, friction)
            bodies = [replace(each, material=material) for each in bodies]
            planes = [replace(each, material=material) for each in planes]
        scene = Scene(tuple(bodies), tuple(planes), gravity, law)
        constants = bodies_of(scene)
        self.world = World(constants, np.array(gravity), law, step, EventLog(), LastingPairs(),
                           Work(), lambda count: [np.nan] * count)
        self.state = state_of(scene)
        self.time = 0.0
        self._step = step
        moving = constants.moving_count
        a, b = np.triu_indices(constants.count, 1)
        self.island = Island(self.world, np.arange(moving), a[a < moving], b[a < moving])

    def step(self):
        """Take one step and return its outcome."""
        outcome = advance_island(self.island, self.state, self.time, self._step)
        self.time += self._step
        return outcome

    def run(self, duration):
        """Advance for a duration, a whole number of steps."""
        for _ in range(round(duration / self._step)):
            self.step()

    def run_to_rest(self, longest):
        """Advance until all rests and return when, or None after the longest duration."""
        while self.time < longest:
            if self.step().resting.all():
                return self.time
        return None

    def energy(self):
        """Return kinetic and potential energy [J]."""
        return diagnostics.energy(self.world.bodies, self.world.gravity, self.state)
