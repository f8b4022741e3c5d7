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

"""The baseline engine does what its scheme says, to rounding, and what physics says, nearly."""

import numpy as np
import pytest

from rigid_sim_ros.engine import rotation, Simulation
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Cube, Sphere

STEP = 0.01


def cube(name, **values):
    """Return a cube of 1 m and 2 kg."""
    shape = Cube(1.0)
    return Body(name, shape, 2.0, shape.inertia(2.0), **values)


def test_translation_follows_the_explicit_scheme():
    """After n explicit steps x = x0 + n h v0 + n (n - 1) / 2 h^2 a, exactly."""
    scene = Scene(bodies=(cube('a', velocity=(1.0, 0.0, 0.0), force=(4.0, 0.0, 0.0)),))
    simulation = Simulation(scene, 'report', STEP)
    simulation.advance(100 * STEP)
    acceleration = np.array((2.0, 0.0, -9.81))
    expected = np.array((1.0, 0.0, 0.0)) * 1.0 + 100 * 99 / 2 * STEP ** 2 * acceleration
    np.testing.assert_allclose(simulation.position[0], expected, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(simulation.linear_velocity[0], (3.0, 0.0, -9.81), rtol=1e-12,
                               atol=1e-13)


def test_rotation_follows_the_explicit_scheme():
    """Each step turns R by (1 + h W): by atan(h w) about the axis, whatever the drift of R."""
    scene = Scene(gravity=(0.0, 0.0, 0.0), bodies=(cube('a', angular_velocity=(0.0, 0.0, 2.0)),))
    simulation = Simulation(scene, 'report', STEP)
    simulation.advance(100 * STEP)
    angle = 100 * np.arctan(2.0 * STEP)
    expected = rotation.from_rotation_vector(np.array((0.0, 0.0, angle)))
    # R has grown by a factor in the plane of the turn, which its nearest rotation forgets
    assert rotation.angle_between(expected, simulation.orientation[0]) < 1e-12


def test_torque_changes_the_rate():
    """A constant torque on a cube gives a rate of t tau / I, I = m l^2 / 6."""
    scene = Scene(gravity=(0.0, 0.0, 0.0), bodies=(cube('a', torque=(0.1, -0.2, 0.3)),))
    simulation = Simulation(scene, 'report', STEP)
    simulation.advance(1.0)
    np.testing.assert_allclose(simulation.angular_velocity[0],
                               np.array((0.1, -0.2, 0.3)) / (2.0 / 6), rtol=1e-2)


def test_collision_keeps_momentum_and_energy():
    """Face to face with e = 1: the impulse, at a vertex, spins the cubes but loses nothing."""
    material = Material(restitution=1.0)
    scene = Scene(gravity=(0.0, 0.0, 0.0), bodies=(
        cube('a', velocity=(1.0, 0.0, 0.0), material=material),
        cube('b', position=(1.5, 0.0, 0.0), material=material)))
    simulation = Simulation(scene, 'report', STEP)
    simulation.advance(0.49)
    assert len(simulation.collisions) == 0
    while not len(simulation.collisions):
        simulation.advance(STEP)
    (event,) = simulation.collisions
    assert event['time'] == pytest.approx(0.5, abs=1.5 * STEP)
    assert (event['body_a'], event['body_b']) == (0, 1)
    np.testing.assert_allclose(event['normal'], (1, 0, 0), atol=1e-12)
    np.testing.assert_allclose(event['speed'], 1.0, rtol=1e-12)
    np.testing.assert_allclose(simulation.momentum(), (2.0, 0, 0), atol=1e-12)
    np.testing.assert_allclose(simulation.energy(), 1.0, rtol=1e-12)
    assert np.linalg.norm(simulation.angular_velocity[0]) > 0.1


def test_event_with_a_plane_names_the_body_first():
    """The normal points from a to b: into the plane; the impulse acts on the plane."""
    scene = Scene(bodies=(cube('a', position=(0, 0, 0.501), velocity=(0, 0, -1.0)),),
                  planes=(Plane('ground'),))
    simulation = Simulation(scene, 'report', STEP)
    simulation.advance(STEP)
    event = simulation.collisions[0]
    assert (event['body_a'], event['body_b']) == (0, 1)
    np.testing.assert_allclose(event['normal'], (0, 0, -1))
    assert event['impulse'][2] < 0 < event['speed']


def test_a_sphere_is_refused():
    """The report has boxes only, and says so."""
    shape = Sphere(1.0)
    scene = Scene(bodies=(Body('ball', shape, 1.0, shape.inertia(1.0)),))
    with pytest.raises(ValueError, match="'sphere'.*boxes"):
        Simulation(scene, 'report')
