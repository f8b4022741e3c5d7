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

"""Who is in an island: what may touch in a step, and what touches already."""

from dataclasses import replace

import numpy as np

from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.events import EventLog
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.islands import Islands
from rigid_sim_ros.engine.lasting_pairs import LastingPairs
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.shapes import Cube
from rigid_sim_ros.engine.state import state_of
from rigid_sim_ros.engine.work import Work
from rigid_sim_ros.engine.world import World

GAP = 1e-11
"""[m]: what is left between bodies that rest."""

STEP = 1 / 60


def test_a_blow_that_is_handed_on_finds_the_ground_below_the_last():
    """
    Cubes in a row just woken, of whom the first is pushed: none goes through the ground.

    They rest, so neither reaches further by itself than where it is, and how far they may come
    when they are hit goes no further than from one to the next.
    """
    cube = Body('pushed', Cube(0.2), 1.0, Cube(0.2).inertia(1.0), position=(0.0, 0.0, 0.1),
                velocity=(3.0, 0.0, 0.0))
    row = [replace(cube, name=f'cube_{place}', velocity=(0.0, 0.0, 0.0),
                   position=(place * (0.2 + GAP), 0.0, 0.1 + GAP)) for place in (1, 2, 3)]
    scene = Scene((cube, *row), (Plane('ground'),))
    bodies, state = bodies_of(scene), state_of(scene)
    world = World(bodies, np.array(scene.gravity), 'poisson', STEP, EventLog(), LastingPairs(),
                  Work(), lambda count: [np.nan] * count)
    islands = Islands(world, Flights(bodies.inertia))
    members = np.arange(4)
    islands.add(members)
    islands.advance(members, 0.0, STEP, state)
    assert state.position[2, :4].min() > 0.1 - 1e-6
