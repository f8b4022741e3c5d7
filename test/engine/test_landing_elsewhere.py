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

"""Bodies that leave one support and come down on another: they touch what is there now."""

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box

GROUND = Plane('ground', (0.0, 0.0, 1.0), 0.0, Material(restitution=0.3, friction=0.5))


def box(name, size, position, material, **values):
    """Return a box of 1 kg."""
    shape = Box(size)
    return Body(name, shape, 1.0, shape.inertia(1.0), position=position, material=material,
                **values)


@pytest.mark.parametrize('restitution', [0.0, 0.3])
def test_box_that_tips_off_a_ledge_comes_to_rest_on_the_ground(restitution):
    # it is in contact with the ledge alone, then flies, then with the ground alone
    material = Material(restitution=restitution, friction=0.5)
    ledge = box('ledge', (1.0, 1.0, 0.1), (0.0, 0.0, 0.5), material, fixed=True)
    tipping = box('tipping', (0.3, 0.2, 0.1), (0.55, 0.0, 0.62), material,
                  orientation=(0.0, np.sin(0.05), 0.0, np.cos(0.05)))
    simulation = Simulation(Scene(bodies=(tipping, ledge), planes=(GROUND,)))
    deepest = 0.0
    for _ in range(150):
        simulation.advance(0.02)
        deepest = max(deepest, simulation.penetration())
    assert deepest < 1e-6
    assert simulation.asleep.all()
    # on one of its faces
    assert min(abs(simulation.position[0, 2] - half) for half in (0.15, 0.1, 0.05)) < 1e-9
