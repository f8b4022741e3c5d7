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

"""What islands remember when they are found anew."""

from types import SimpleNamespace

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.lasting_contact.near import memory_of
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube


def test_islands_take_over_the_impulses_of_their_own_pairs_only():
    points, forces = np.arange(18.0).reshape(2, 3, 3)
    first = SimpleNamespace(
        forces={'first': ([(0, 5), (0, 5), (1, 0)], points, forces)})
    second = SimpleNamespace(
        forces={'first': ([(2, 5)], np.full((3, 1), 6.0), np.full((3, 1), 7.0))})
    islands = [first, second]
    # found anew many times, each made of both: memory that all took over would double each time
    for _ in range(40):
        islands = [SimpleNamespace(forces=memory_of(islands, *np.array(pairs).T))
                   for pairs in ([(0, 5), (0, 1)], [(2, 5)])]
    pairs, *columns = islands[0].forces['first']
    assert pairs == [(0, 5), (0, 5), (1, 0)]
    np.testing.assert_array_equal(columns, (points, forces))
    pairs, *columns = islands[1].forces['first']
    assert pairs == [(2, 5)]
    np.testing.assert_array_equal(columns, [np.full((3, 1), value) for value in (6.0, 7.0)])


@pytest.mark.parametrize('rate, tolerance', [(240, 1e-4), (480, 3e-5), (960, 8e-6)])
def test_a_box_goes_on_tipping_as_it_began(rate, tolerance):
    """
    Alone on a plane, and to second order on a slab of a ton beside another body.

    After a while only two corners are in reach, of which one could take all of the load: a second
    solution, in which the box would begin to spin about it.
    """
    material = Material(restitution=0.0, friction=0.8)
    shape, slab, cube = Box((0.1, 0.15, 0.5)), Box((20.0, 20.0, 1.0)), Cube(0.2)
    box = Body('box', shape, 1.0, shape.inertia(1.0), (0.0, 0.0, 0.25),
               (0.0, 0.0, np.sin(0.2), np.cos(0.2)), material=material)
    ground = Plane('ground', (0.0, 0.0, 1.0), 0.0, material)
    alone = Simulation(Scene(bodies=(box,), planes=(ground,)))
    others = (Body('slab', slab, 1000.0, slab.inertia(1000.0), (0.0, 0.0, -0.5),
                   material=material),
              Body('cube', cube, 1.0, cube.inertia(1.0), (-3.0, 1.2, 0.1), material=material))
    rough = Plane('rough', (0.0, 0.0, 1.0), -1.0, Material(restitution=0.0, friction=1e4))
    together = Simulation(Scene(bodies=(box, *others), planes=(rough,)), max_step=1 / rate)
    for simulation in (alone, together):
        simulation.apply_wrench('box', force=(6.0, 0.0, -3.0), torque=(0.0, 0.0, 0.4))
        simulation.advance(0.1)
    np.testing.assert_allclose(together.angular_velocity[0], alone.angular_velocity[0],
                               atol=tolerance)
    assert abs(alone.angular_velocity[0, 1]) > 0.5
