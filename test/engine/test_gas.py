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

"""A gas of mixed bodies in a closed room: many impacts, each found, nothing lost or gained."""

from dataclasses import replace

import numpy as np
import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.scene import load_scene

ELASTIC = Material(restitution=1.0, friction=0.0)
HALF_ROOM = 2.0


def gas(seed):
    """Return a room of six planes with 18 cubes, bricks and balls, all moving and turning."""
    random = np.random.default_rng(seed)
    planes = tuple(
        Plane(f'wall_{axis}_{sign:+d}', tuple(float(sign * (axis == each)) for each in range(3)),
              -HALF_ROOM, ELASTIC)
        for axis in range(3) for sign in (1, -1))
    bodies = []
    for number, place in enumerate(np.ndindex(3, 3, 2)):
        shape = (Cube(0.5), Box((0.3, 0.5, 0.7)), Sphere(0.3))[number % 3]
        mass = 1.0 + number % 2
        quaternion = random.normal(size=4)
        bodies.append(Body(
            f'body_{number}', shape, mass, shape.inertia(mass),
            position=tuple(1.2 * (np.array(place) - (1, 1, 0.5))),
            orientation=tuple(quaternion / np.linalg.norm(quaternion)),
            velocity=tuple(2 * random.normal(size=3)),
            angular_velocity=tuple(2 * random.normal(size=3)), material=ELASTIC))
    return Scene(bodies=tuple(bodies), planes=planes, gravity=(0.0, 0.0, 0.0))


def falling(scene):
    """Return the scene with gravity and surfaces that rub and do not rebound well."""
    material = Material(restitution=0.4, friction=0.5)
    return replace(
        scene, gravity=(0.0, 0.0, -9.81),
        bodies=tuple(replace(body, material=material) for body in scene.bodies),
        planes=tuple(replace(plane, material=material) for plane in scene.planes))


@pytest.mark.parametrize('seed', [1, 2])
def test_gas_keeps_its_energy_and_its_room(seed):
    """Elastic and frictionless: energy to 1e-13 over all impacts, no overlap, nobody gets out."""
    simulation = Simulation(gas(seed))
    energy = simulation.energy()
    momentum = simulation.momentum()
    for _ in range(20):
        simulation.advance(0.05)
        # the walls take momentum: what the events tell must account for all of it
        events = simulation.collisions
        walls = events['body_b'] >= len(simulation.names)
        momentum = momentum - events['impulse'][walls].sum(axis=0)
        np.testing.assert_allclose(simulation.momentum(), momentum, atol=1e-11)
        assert simulation.energy() == pytest.approx(energy, rel=1e-13)
        assert simulation.penetration() < 1e-12
    assert simulation.work.impacts > 30
    assert simulation.work.contact_steps == 0
    assert np.abs(simulation.position).max() < HALF_ROOM


def test_gas_falls_to_rest_without_overlap():
    """With gravity, friction and losses: contact of all kinds, and never a body in another."""
    simulation = Simulation(falling(gas(3)))
    energy = simulation.energy()
    while simulation.time < 0.75:
        simulation.advance(0.05)
        # steps of several bodies may overlap a little in between: 0.3 mm of half a metre
        assert simulation.penetration() < 3e-4
        assert simulation.energy() < energy + 1e-6 * abs(energy)
        energy = simulation.energy()
    assert simulation.work.contact_steps > 50


def test_a_spinning_body_held_against_another_does_not_rattle_for_ever():
    """
    Without gravity a turning body comes back to what it has hit, in ever smaller bounces.

    One is pushed against its neighbour again and again: the bounces have to end as contact.
    """
    simulation = Simulation(load_scene('report_dynamics'))
    for push in range(1, 160):
        simulation.set_velocity('spinning', linear=(push * 1e-3, 0.0, 0.0), angular=(0, 0, 0))
        simulation.advance(0.5 if push % 7 == 0 else 0.02)
        assert simulation.work.impacts < 40 * push
    assert simulation.work.contact_steps > 0
    assert np.isfinite(simulation.position).all()


def test_a_field_of_cubes_falls_together():
    """Bodies that do not move relative to each other never meet, however many they are."""
    shape = Cube(0.2)
    bodies = tuple(
        Body(f'cube_{row}_{column}', shape, 1.0, shape.inertia(1.0),
             position=(0.5 * row, 0.5 * column, 1.0)) for row in range(13) for column in range(13))
    simulation = Simulation(Scene(bodies=bodies, planes=(Plane('ground'),)))
    simulation.advance(0.3)
    np.testing.assert_allclose(simulation.position[:, 2], 1.0 - 9.81 * 0.3 ** 2 / 2, rtol=1e-13)
    simulation.advance(0.2)
    assert simulation.work.impacts == len(bodies)
    assert set(simulation.collisions['body_b']) == {len(bodies)}
