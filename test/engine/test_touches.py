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
"""Many bodies that touch at one instant: who approaches is struck, who parts flies."""

import numpy as np
import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Cube, Sphere


def standing(velocities, friction=0.5):
    """Return a simulation of cubes that stand apart on level ground and move (n, 3) [m/s]."""
    shape, material = Cube(0.2), Material(restitution=0.5, friction=friction)
    bodies = tuple(Body(f'cube_{number}', shape, 1.0, shape.inertia(1.0),
                        position=(1.0 * number, 0.0, 0.1), velocity=tuple(velocity),
                        material=material) for number, velocity in enumerate(velocities))
    plane = Plane('ground', (0.0, 0.0, 1.0), 0.0, material=material)
    return Simulation(Scene(bodies=bodies, planes=(plane,)))


def test_each_does_what_it_would_do_by_itself():
    """Whatever the others do: at rest, sliding, driven into the ground, thrown up."""
    kinds = np.array(((0, 0, 0), (1.0, 0.5, 0), (0, 0, -2.0), (0, 0, 1.5), (0.3, 0, -1e-9)))
    velocities = np.tile(kinds, (12, 1)).astype(float)
    simulation = standing(velocities)
    simulation.advance(1 / 240)
    struck = simulation.collisions[simulation.collisions['kind'] == IMPACT]
    np.testing.assert_array_equal(np.unique(struck['body_a']),
                                  np.flatnonzero(velocities[:, 2] < -0.1))
    assert len(struck) == 4 * 12
    np.testing.assert_allclose(struck['speed'], 2.0, rtol=1e-12)
    np.testing.assert_array_equal(simulation.asleep, (velocities == 0).all(axis=1))
    for number in range(len(kinds)):
        alone = standing(velocities[number:number + 1])
        alone.advance(1 / 240)
        same = np.arange(number, len(velocities), len(kinds))
        np.testing.assert_allclose(
            simulation.position[same] - np.outer(same, (1, 0, 0)),
            np.broadcast_to(alone.position, (len(same), 3)), rtol=0, atol=1e-9)


def above_ground(shape, heights):
    """Return a simulation of bodies at rest with gaps (n,) [m] to the ground, without gravity."""
    material = Material(restitution=1.0, friction=0.0)
    bodies = tuple(Body(f'body_{number}', shape, 1.0, shape.inertia(1.0),
                        position=(1.0 * number, 0.0, height + 0.005), material=material)
                   for number, height in enumerate(heights))
    return Simulation(Scene(bodies=bodies, planes=(Plane('ground', material=material),),
                            gravity=(0.0, 0.0, 0.0)))


@pytest.mark.parametrize('shape', [Sphere(0.005), Cube(0.01)])
@pytest.mark.parametrize('time', [1e5, 1e8])
def test_what_is_late_touches_too(shape, time):
    """
    From one number to the next bodies then go further than those are apart that touch.

    They rebound to where a mirror has them, as well as times are known.
    """
    height, speed = np.array((1.0, 2.0, 3.0)), np.array((1.0, 2.5, 40.0))
    simulation = above_ground(shape, height)
    simulation.advance(time)
    simulation.set_velocities(np.outer(-speed, (0.0, 0.0, 1.0)))
    simulation.advance(2.5)
    np.testing.assert_allclose(simulation.position[:, 2], 0.005 + abs(height - 2.5 * speed),
                               rtol=0, atol=4 * 40.0 * np.spacing(time))


def test_a_touch_that_no_number_tells_is_an_error():
    """From 1 s to the next number a cube at 1e20 m/s goes 22 km."""
    simulation = above_ground(Cube(0.01), (1.0,))
    simulation.advance(1.0)
    simulation.set_velocity('body_0', (0.0, 0.0, -1e20))
    with pytest.raises(ArithmeticError, match='too fast to tell where they touch'):
        simulation.advance(1.0)


def test_who_is_pushed_among_many_hits_at_its_instant_long_after():
    """
    One of 1200 balls that fly alike is pushed, and hits the next one after 20 s.

    The closed form: gap = force t^2 / (2 mass).
    """
    radius, way, push = 0.1, 40.0, 0.2
    shape = Sphere(radius)
    bodies = [Body(f'ball_{number}', shape, 1.0, shape.inertia(1.0), velocity=(3.0, 0.0, 0.0),
                   position=(way * (number % 60), way * (number // 60), 0.0),
                   material=Material(1.0, 0.0)) for number in range(1200)]
    simulation = Simulation(Scene(tuple(bodies), gravity=(0.0, 0.0, 0.0)))
    simulation.advance(1.0)
    simulation.apply_wrench('ball_100', force=(push, 0.0, 0.0))
    expected = 1.0 + np.sqrt(2 * (way - 2 * radius) / push)
    hits = []
    while simulation.time < 25.0:
        simulation.advance(0.5)
        hits += simulation.collisions['time'].tolist()
    assert hits == [pytest.approx(expected, rel=1e-12)]
