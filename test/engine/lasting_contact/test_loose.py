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

"""Islands with something fast in them: what is clear of it is stepped by itself."""

from island_run import body, GRAVITY, ground

import numpy as np

import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.model import Material, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere

STEP = 1 / 240
FRICTION = 0.5
SMOOTH = Material(restitution=1.0, friction=0.0)


def cube(name, x, z=0.1, **values):
    """Return a cube of 0.2 m at rest."""
    return body(name, Cube(0.2), position=(x, 0.0, z), **values)


def simulated(bodies, material, **values):
    """Return a simulation of bodies over the ground, all of a material."""
    return Simulation(Scene(tuple(bodies), (ground(material=material),), **values), max_step=STEP)


@pytest.mark.parametrize('column', (1, 3))
def test_who_is_pushed_away_costs_nobody_a_thing(column):
    """A cube pushed by a million newtons goes by the closed form, and what it leaves stays."""
    rough, force = Material(restitution=0.3, friction=FRICTION), 1e6
    left = [cube(f'left_{level}', 0.5, 0.1 + 0.2 * level, material=rough)
            for level in range(column)]
    simulation = simulated([cube('pushed', 0.0, material=rough), *left], rough)
    simulation.advance(4 * STEP)
    before = simulation.position
    simulation.apply_wrench('pushed', force=(-force, 0.0, 0.0))
    work = simulation.work.contact_steps
    simulation.advance(12 * STEP)
    assert simulation.work.contact_steps - work < 200
    way = 0.5 * (force / 1.0 - FRICTION * GRAVITY) * (12 * STEP) ** 2
    assert before[0, 0] - simulation.position[0, 0] == pytest.approx(way, rel=1e-9)
    assert np.abs(simulation.position[1:] - before[1:]).max() < 1e-9


def test_who_comes_back_from_afar_has_hit_at_its_instant():
    """A ball slides to a fixed box 20 m away at 10 km/s and back within a step."""
    speed, way = 1e4, 20.0
    ball = body('ball', Sphere(0.1), position=(0.0, 0.0, 0.1), velocity=(speed, 0.0, 0.0),
                material=SMOOTH)
    beside = body('beside', Sphere(0.1), position=(0.0, 1.0, 0.1), velocity=(0.0, 1.0, 0.0),
                  material=SMOOTH)
    target = body('target', Box((1.0, 1.0, 1.0)), position=(way + 0.6, 0.0, 0.5), fixed=True,
                  material=SMOOTH)
    simulation = simulated([ball, beside, target], SMOOTH)
    simulation.advance(STEP)
    assert simulation.linear_velocity[0] == pytest.approx((-speed, 0.0, 0.0), abs=1e-9 * speed)
    assert simulation.position[0, 0] == pytest.approx(2 * way - speed * STEP, abs=1e-6)
    assert simulation.position[1] == pytest.approx((0.0, 1.0 + STEP, 0.1), abs=1e-9)
    assert simulation.work.contact_steps < 200


def test_what_flies_through_a_gap_hits_nobody():
    """A plate flies between two cubes on the ground at 10 km/s; they do not notice."""
    rough = Material(restitution=0.3, friction=FRICTION)
    plate = body('plate', Box((0.2, 0.02, 0.2)), position=(-3.0, 0.0, 0.2), mass=1.0,
                 velocity=(1e4, 0.0, 0.0), material=rough)
    sides = [body(f'side_{y}', Cube(0.2), position=(0.0, y, 0.1), material=rough)
             for y in (-0.12, 0.12)]
    simulation = simulated([*sides, plate], rough)
    simulation.set_velocity('side_0.12', angular=(0.0, 0.0, 1e-3))
    simulation.advance(STEP)
    assert simulation.linear_velocity[2, 0] == 1e4
    assert simulation.position[2, 0] == pytest.approx(-3.0 + 1e4 * STEP, abs=1e-9)
    assert simulation.work.impacts == 0
    assert np.abs(simulation.position[:2, :2] - [[0.0, -0.12], [0.0, 0.12]]).max() < 1e-9
