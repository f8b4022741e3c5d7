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

"""Advancing to the first collision and no further: its instant is arithmetic."""

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.events import BEGIN, END, IMPACT
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Cube, Sphere

RADIUS = 0.1
GROUND = Plane('ground', (0.0, 0.0, 1.0), 0.0)
STEP = 1 / 240


def ball(name, x, speed, z=0.0):
    """Return a ball of 1 kg that moves along x."""
    shape = Sphere(RADIUS)
    return Body(name, shape, 1.0, shape.inertia(1.0), position=(x, 0.0, z),
                velocity=(speed, 0.0, 0.0), material=Material(restitution=1.0, friction=0.0))


def row(**values):
    """Return three balls: a hits b after 0.4 s, and b then c after 0.3 s more."""
    bodies = ball('a', 0.0, 2.0), ball('b', 1.0, 0.0), ball('c', 1.8, 0.0)
    return Simulation(Scene(bodies=bodies, gravity=(0.0, 0.0, 0.0)), **values)


def test_it_stops_at_the_instant_and_goes_on_from_there():
    simulation, through = row(), row()
    for time, pair in ((0.4, (0, 1)), (0.7, (1, 2))):
        simulation.advance(5.0, until_collision=True)
        assert simulation.time == pytest.approx(time, abs=1e-15)
        assert simulation.collisions[['body_a', 'body_b', 'kind']].tolist() == [(*pair, IMPACT)]
        # after the impact: the second of the two has all of the speed
        assert simulation.linear_velocity[:, 0].tolist() == [
            2.0 if index == pair[1] else 0.0 for index in range(3)]
    simulation.advance(5.0, until_collision=True)
    assert simulation.time == pytest.approx(5.7)
    assert len(simulation.collisions) == 0
    through.advance(simulation.time)
    np.testing.assert_allclose(simulation.position, through.position, atol=1e-13)


def test_without_being_asked_it_does_not_stop():
    simulation = row()
    simulation.advance(5.0)
    assert simulation.time == 5.0
    assert len(simulation.collisions) == 2


@pytest.mark.parametrize('method', ['stepped', 'report'])
def test_methods_that_step_stop_after_their_step(method):
    shape = Cube(2 * RADIUS)
    bodies = [Body(body.name, shape, 1.0, shape.inertia(1.0), position=body.position,
                   velocity=body.velocity, material=body.material)
              for body in row().scene.bodies]
    simulation = Simulation(Scene(bodies=bodies, gravity=(0.0, 0.0, 0.0)), method, STEP)
    simulation.advance(5.0, until_collision=True)
    assert 0.4 <= simulation.time <= 0.4 + 2.5 * STEP
    assert simulation.time / STEP == pytest.approx(round(simulation.time / STEP))
    assert (simulation.collisions['kind'] == IMPACT).all()


def sliding_and_falling():
    """Return a cube that slides to the right, and a ball that falls far from it."""
    shape = Cube(0.2)
    cube = Body('cube', shape, 1.0, shape.inertia(1.0), position=(-50.0, 0.0, 0.1),
                velocity=(3.0, 0.0, 0.0), material=Material(restitution=0.0, friction=0.1))
    return Simulation(Scene(bodies=(cube, ball('ball', 0.0, 0.0, z=1.1)), planes=(GROUND,)))


def test_it_stops_at_the_instant_while_others_are_in_lasting_contact():
    simulation = sliding_and_falling()
    fall = np.sqrt(2 * 1.0 / 9.81)
    while simulation.time < fall - 1e-9:
        simulation.advance(0.1, until_collision=True)
        met = simulation.collisions[simulation.collisions['kind'] != END]
    assert simulation.time == pytest.approx(fall, abs=1e-12)
    assert met['body_a'].tolist() == [1]
    assert simulation.linear_velocity[1, 2] == pytest.approx(9.81 * fall, rel=1e-12)
    # Coulomb friction, mu g, has slowed the cube down up to this very instant
    mixed = np.sqrt(0.1 * GROUND.material.friction)
    assert simulation.linear_velocity[0, 0] == pytest.approx(3.0 - mixed * 9.81 * fall, rel=1e-6)


def test_what_touches_at_the_start_does_not_collide():
    """A tower that stands, and a ball that falls beside it."""
    shape = Cube(0.2)
    tower = [Body(f'cube_{level}', shape, 1.0, shape.inertia(1.0),
                  position=(5.0, 0.0, 0.1 + 0.2 * level)) for level in range(3)]
    simulation = Simulation(Scene(bodies=(ball('ball', 0.0, 0.0, z=1.1), *tower),
                                  planes=(GROUND,)))
    simulation.advance(1.0, until_collision=True)
    assert simulation.time == pytest.approx(np.sqrt(2 / 9.81), abs=1e-12)


def test_the_end_of_a_contact_is_no_collision():
    simulation = Simulation(Scene(bodies=(ball('a', 0.0, 0.0, z=RADIUS),), planes=(GROUND,)))
    simulation.advance(0.1)
    assert BEGIN in simulation.collisions['kind'] or simulation.asleep.all()
    simulation.apply_wrench('a', force=(0.0, 0.0, 20.0))
    simulation.advance(0.5, until_collision=True)
    assert simulation.time == pytest.approx(0.6)
    assert simulation.position[0, 2] > 1.0
