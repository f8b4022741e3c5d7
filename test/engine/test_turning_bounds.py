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
"""Bounds of how fast turning moves surfaces: never too low, and nothing where nothing changes."""

import numpy as np

import pytest

from rigid_sim_ros.engine import rotation, Simulation
from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.engine.turning_bounds import TurningBounds


def body(name, shape, **values):
    """Return a body of 1 kg."""
    return Body(name, shape, 1.0, shape.inertia(1.0),
                material=Material(restitution=0.0, friction=0.0), **values)


@pytest.mark.parametrize('shapes', [
    (Cube(0.2), Box((0.1, 0.2, 0.15)), Sphere(0.3)),
    (Cube(0.2), Box((0.02, 2.0, 0.03)), Sphere(0.3), Box((1.0, 1.0, 0.01)))])
def test_no_corner_is_faster(shapes):
    """Whichever way a body lies and turns; in the fastest direction the bound is nearly met."""
    bodies = bodies_of(Scene(bodies=tuple(
        body(f'body_{number}', shape) for number, shape in enumerate(shapes))))
    bounds = TurningBounds(bodies)
    random = np.random.default_rng(0)
    nearest = np.zeros(len(shapes))
    for _ in range(500):
        orientation = rotation.normalize(random.normal(size=(4, len(shapes))))
        angular = random.normal(size=(3, len(shapes)))
        speeds = bounds.speeds(orientation, angular)
        for column, shape in enumerate(shapes):
            if isinstance(shape, Sphere):
                assert speeds[column] == 0.0
                continue
            corner = np.array(shape.half_extents) * random.choice((-1, 1), 3)
            arm = rotation.rotate(orientation[:, column], corner)
            speed = np.linalg.norm(np.cross(angular[:, column], arm))
            assert speed <= speeds[column] * (1 + 1e-12)
            nearest[column] = max(nearest[column], speed / speeds[column])
    assert (nearest[[not isinstance(shape, Sphere) for shape in shapes]] > 0.6).all()


def test_a_rod_that_spins_about_itself_is_slow():
    rod = Box((0.01, 2.0, 0.01))
    bounds = TurningBounds(bodies_of(Scene(bodies=(body('rod', rod),))))
    still = np.array(((0.0,), (0.0,), (0.0,), (1.0,)))
    about_itself = bounds.speeds(still, np.array(((0.0,), (100.0,), (0.0,))))[0]
    assert 100.0 * 0.5 * np.hypot(0.01, 0.01) <= about_itself < 1.0


def test_a_ball_that_spins_on_a_tower_makes_nobody_look_again():
    """Nothing comes anywhere: contacts are found at the start and when rest is tested for."""
    cubes = [body(f'cube_{level}', Cube(0.2), position=(0.0, 0.0, 0.1 + 0.2 * level))
             for level in range(9)]
    ball = body('ball', Sphere(0.1), position=(0.0, 0.0, 1.9), angular_velocity=(0.0, 0.0, 20.0))
    simulation = Simulation(Scene(bodies=(*cubes, ball),
                                  planes=(Plane('ground', (0.0, 0.0, 1.0), 0.0),)))
    steps = 120
    for _ in range(steps):
        simulation.advance(1 / 240)
    assert not simulation.asleep.any()
    assert simulation.work.contact_steps == steps
    # once in twelve steps each of ten pairs, instead of every time
    assert simulation.work.narrow_phases < 2 * steps
