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

"""Bounces between two that come together: counted by pi, and without end where much is lost."""

from math import inf

import numpy as np

import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.cascade import Cascade, INSTANT, TIMES
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Cube, Sphere


def between(shape, mass, restitution, law='poisson'):
    """Return a light body of 1 kg at 1 m/s between a wall and a heavy one that comes at 1 m/s."""
    material = Material(restitution=restitution, friction=0.0)
    return Simulation(Scene(
        bodies=(Body('light', shape, 1.0, shape.inertia(1.0), position=(0.15, 0.0, 0.0),
                     velocity=(-1.0, 0.0, 0.0), material=material),
                Body('heavy', shape, mass, shape.inertia(mass), position=(0.5, 0.0, 0.0),
                     velocity=(-1.0, 0.0, 0.0), material=material)),
        planes=(Plane('wall', (1.0, 0.0, 0.0), 0.0, material),), gravity=(0.0, 0.0, 0.0),
        impact_law=law))


def bounces(mass, restitution, most):
    """Return the velocities of both after their last impact, and how many there are, or inf."""
    at_wall, apart, light, heavy = 0.05, 0.15, -1.0, -1.0
    for count in range(most):
        wall_time = at_wall / -light if light < 0 else inf
        time = min(wall_time, apart / (light - heavy) if light > heavy else inf)
        if time == inf:
            return light, heavy, count
        if time == wall_time:
            at_wall, apart, light = 0.0, apart + (heavy - light) * time, -restitution * light
        else:
            at_wall, apart = at_wall + light * time, 0.0
            impulse = (1 + restitution) * (light - heavy) * mass / (1 + mass)
            light, heavy = light - impulse, heavy + impulse / mass
    return light, heavy, inf


@pytest.mark.parametrize('digits', [0, 1, 2])
def test_impacts_count_pi(digits):
    """Galperin 2003, 'Playing pool with pi': of masses 1 and 100^n, the other at rest."""
    mass = 100.0 ** digits
    simulation = between(Sphere(0.1), mass, 1.0)
    simulation.set_velocity('light', linear=(0.0, 0.0, 0.0))
    simulation.advance(10.0)
    assert len(simulation.collisions) == int(np.pi * 10 ** digits)
    speed = simulation.linear_velocity[:, 0]
    assert 0.0 <= speed[0] <= speed[1]
    assert speed[0] ** 2 + mass * speed[1] ** 2 == pytest.approx(mass, rel=1e-14)


def test_all_bounces_that_end_are_followed():
    """Those of a restitution of 0.9 and a mass of 100, one by one."""
    light, heavy, count = bounces(100.0, 0.9, 100)
    simulation = between(Cube(0.2), 100.0, 0.9)
    simulation.advance(20.0)
    assert len(set(simulation.collisions['time'].tolist())) == count == 37
    np.testing.assert_allclose(simulation.linear_velocity[:, 0], (light, heavy), rtol=1e-9)


@pytest.mark.parametrize('law', ['poisson', 'newton', 'stronge'])
@pytest.mark.parametrize('mass, restitution', [(1e2, 0.5), (1e4, 0.9)])
def test_bounces_without_end_end(mass, restitution, law):
    """They never do by themselves, and take finite time: nothing moves after it."""
    assert bounces(mass, restitution, 900)[2] == inf
    simulation = between(Cube(0.2), mass, restitution, law)
    simulation.advance(1.0)
    assert simulation.work.impacts < 400
    assert np.abs(simulation.linear_velocity).max() < 1e-9
    np.testing.assert_allclose(simulation.position[:, 0], (0.1, 0.3), atol=1e-9)


def test_what_touches_elsewhere_at_the_same_instant_rebounds():
    """A third body hits the wall, a meter aside, when the others bounce for the ninth time."""
    cascade, wall = Cascade(3), 3
    for number in range(2 * TIMES):
        pair = np.array(((0, wall), (0, 1))[number % 2])[:, None]
        assert cascade.ended(1.0 + 1e-14 * number, *pair) is None
    a, b = cascade.ended(1.0, np.array((0, 2)), np.array((wall, wall)))
    assert list(zip(a, b)) == [(0, 1), (0, wall)]
    assert cascade.ended(1.0, np.array((2,)), np.array((wall,))) is None
    assert cascade.ended(1.0 + 2 * INSTANT, np.array((0,)), np.array((wall,))) is None


@pytest.mark.parametrize('shape', [Cube(0.2), Sphere(0.1)])
@pytest.mark.parametrize('along', [2.0, 0.0])
def test_landing_without_gravity(shape, along):
    """What does not rebound slides on the plane as fast as friction in the impact leaves it."""
    material = Material(restitution=0.0, friction=0.5)
    simulation = Simulation(Scene(
        bodies=(Body('lands', shape, 1.0, shape.inertia(1.0), position=(0.0, 0.0, 0.5),
                     velocity=(along, 0.0, -1.0), material=material),),
        planes=(Plane('ground', (0.0, 0.0, 1.0), 0.0, material),), gravity=(0.0, 0.0, 0.0)))
    simulation.advance(2.0)
    left = max(along - 0.5, 0.0)
    np.testing.assert_allclose(simulation.linear_velocity[0], (left, 0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(simulation.position[0], (0.4 * along + 1.6 * left, 0.0, 0.1),
                               atol=1e-12)
