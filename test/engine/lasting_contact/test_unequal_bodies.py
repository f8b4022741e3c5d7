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

"""Light bodies on heavy ones, up to a million million times as heavy, and heavy ones on light."""

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.scene import load_scene

GRAVITY = 9.81
FRICTION = 0.5
RATIOS = [1.0, 1e3, 1e5, 1e6, 1e7, 1e9, 1e12]


def on_a_slab(ratio, friction=FRICTION, speed=0.0):
    """Return a simulation of a cube of a gram on a loose slab so many times as heavy."""
    return Simulation(load_scene({
        'material': {'friction': friction, 'restitution': 0.0},
        'planes': [{'name': 'ground', 'normal': [0, 0, 1]}],
        'bodies': [
            {'name': 'slab', 'box': {'size': [1.0, 1.0, 0.2]}, 'mass': 1e-3 * ratio,
             'position': [0, 0, 0.1]},
            {'name': 'cube', 'cube': {'edge': 0.05}, 'mass': 1e-3, 'position': [-0.3, 0, 0.225],
             'velocity': [speed, 0, 0]}]}))


@pytest.mark.parametrize('ratio', RATIOS)
def test_friction_stops_a_light_body_on_a_heavy_one(ratio):
    """Its speed is v0 - mu g t until it stops after v0^2 / (2 mu g); the ground holds the slab."""
    simulation = on_a_slab(ratio, speed=1.0)
    simulation.advance(0.1)
    assert simulation.linear_velocity[1, 0] == pytest.approx(1.0 - FRICTION * GRAVITY * 0.1,
                                                             abs=1e-9)
    simulation.advance(0.3)
    assert simulation.position[1, 0] + 0.3 == pytest.approx(1.0 / (2 * FRICTION * GRAVITY),
                                                            abs=1e-5)
    np.testing.assert_allclose(simulation.position[:, 2], [0.1, 0.225], atol=1e-9)
    assert simulation.asleep.all()


@pytest.mark.parametrize('friction', [0.0, FRICTION])
@pytest.mark.parametrize('ratio', RATIOS)
def test_a_heavy_body_that_is_set_down_with_a_light_one_stays(ratio, friction):
    """Both dropped together from a millimetre: an impact, then rest."""
    simulation = on_a_slab(ratio, friction)
    simulation.set_pose('slab', position=(0, 0, 0.101))
    simulation.set_pose('cube', position=(-0.3, 0, 0.226))
    simulation.advance(0.5)
    # a gap counts as closed that is less than a fifth of a step's fall, g h^2
    np.testing.assert_allclose(simulation.position[:, 2], [0.1, 0.225],
                               atol=GRAVITY / 240 ** 2 / 5)
    assert simulation.asleep.all()


@pytest.mark.parametrize('ratio', [1.0, 1e3, 1e5, 1e6, 1e7])
def test_a_light_body_carries_a_heavy_one(ratio):
    """A box of a metre on a cube of 5 cm and a kilogram: neither moves, and both sleep."""
    simulation = Simulation(load_scene({
        'material': {'friction': FRICTION, 'restitution': 0.0},
        'planes': [{'name': 'ground', 'normal': [0, 0, 1]}],
        'bodies': [
            {'name': 'cube', 'cube': {'edge': 0.05}, 'mass': 1.0, 'position': [0, 0, 0.025]},
            {'name': 'box', 'cube': {'edge': 1.0}, 'mass': ratio, 'position': [0, 0, 0.55]}]}))
    simulation.advance(0.1)
    np.testing.assert_allclose(simulation.position, [[0, 0, 0.025], [0, 0, 0.55]], atol=1e-11)
    assert simulation.asleep.all()
