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

"""States read ahead: the same to the bit as if each had been asked for alone, for less work."""

from dataclasses import replace

import numpy as np
import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.flight.functions import MANY
from rigid_sim_ros.engine.methods.read_ahead import MOST_TIMES
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere

ELASTIC = Material(restitution=1.0, friction=0.0)


@pytest.fixture
def evaluations(monkeypatch):
    """Return a list that grows by the number of times of every evaluation of all poses."""
    counts = []
    poses, together = Flights.poses, Flights.poses_together

    def count_poses(self, time, indices=None):
        counts.extend([1] if indices is None else [])
        return poses(self, time, indices)

    def count_together(self, times):
        counts.append(len(times))
        return together(self, times)

    monkeypatch.setattr(Flights, 'poses', count_poses)
    monkeypatch.setattr(Flights, 'poses_together', count_together)
    return counts


def drifting(count, gravity=(0.0, 0.0, 0.0), shape=Cube(0.2)):
    """Return bodies that tumble and never meet, every third driven about its own axis."""
    random = np.random.default_rng(count)
    bodies = []
    for number in range(count):
        rate = random.normal(size=3)
        torque = (0.0, 0.0, 0.0)
        if number % 3 == 0:
            rate[:2] = 0.0
            torque = (0.0, 0.0, 0.01)
        bodies.append(Body(
            f'body_{number}', shape, 1.0, shape.inertia(1.0), (4.0 * number, 0.0, 0.0),
            (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, random.normal()), tuple(rate),
            torque=torque))
    return Scene(bodies=tuple(bodies), gravity=gravity)


def box_of_balls():
    """Return balls and cubes without gravity in a closed room: something hits all the time."""
    random = np.random.default_rng(5)
    planes = tuple(
        Plane(f'wall_{axis}_{sign:+d}', tuple(float(sign * (axis == each)) for each in range(3)),
              -1.0, ELASTIC) for axis in range(3) for sign in (1, -1))
    bodies = []
    for number, place in enumerate(np.ndindex(2, 2, 2)):
        shape = (Cube(0.3), Sphere(0.2))[number % 2]
        bodies.append(Body(
            f'body_{number}', shape, 1.0, shape.inertia(1.0),
            tuple((np.array(place) - 0.5).tolist()), (0.0, 0.0, 0.0, 1.0),
            tuple(random.normal(size=3)), tuple(random.normal(size=3)), material=ELASTIC))
    return Scene(bodies=tuple(bodies), planes=planes, gravity=(0.0, 0.0, 0.0))


def falling():
    """Return a few cubes that fall, land, and lie still: flight, contact and sleep."""
    ground = Plane('ground', (0.0, 0.0, 1.0), 0.0, Material())
    scene = drifting(3, (0.0, 0.0, -9.81))
    return Scene(bodies=tuple(
        Body(body.name, body.shape, body.mass, body.inertia, (0.5 * number, 0.0, 0.4),
             body.orientation, angular_velocity=body.angular_velocity)
        for number, body in enumerate(scene.bodies)), planes=(ground,))


def disturb(simulation, step):
    """Give commands at some of the steps."""
    if step % 37 == 36:
        simulation.set_velocity(simulation.names[step % len(simulation.names)], (0.1, 0.2, 0.3))
    if step % 53 == 52:
        simulation.apply_wrench(simulation.names[0], (0.0, 0.1, 0.0))


SCENES = {
    'few': drifting(3), 'falling': drifting(40, (0.0, 0.0, -9.81)), 'many': drifting(MANY + 5),
    'unequal moments': drifting(4, shape=Box((0.1, 0.2, 0.3))), 'impacts': box_of_balls(),
    'landing': falling()}


def readings(simulation):
    return (simulation.position, simulation.orientation, simulation.linear_velocity,
            simulation.angular_velocity)


@pytest.mark.parametrize('duration', [1 / 240, 0.003])
@pytest.mark.parametrize('name', SCENES)
def test_what_is_read_does_not_depend_on_what_was_read_before(name, duration):
    always, seldom = Simulation(SCENES[name]), Simulation(SCENES[name])
    random = np.random.default_rng(1)
    read = 0
    for step in range(160):
        for simulation in (always, seldom):
            disturb(simulation, step)
            simulation.advance(duration)
        mine = [quantity.copy() for quantity in readings(always)]
        if random.random() < 0.2:
            read += 1
            for one, other in zip(mine, readings(seldom)):
                assert one.tobytes() == other.tobytes()
    assert read > 20


def test_a_result_stays_when_the_simulation_goes_on():
    simulation = Simulation(drifting(5))
    kept = []
    for _ in range(100):
        simulation.advance(0.01)
        kept.append((simulation.position, simulation.position.copy()))
    assert all(np.array_equal(result, copy) for result, copy in kept)


def test_velocities_that_stay_are_copied_once_until_one_changes():
    scene = drifting(3)
    simulation = Simulation(replace(scene, bodies=tuple(
        replace(body, torque=(0.0, 0.0, 0.0)) for body in scene.bodies)))

    def arrays():
        simulation.advance(0.01)
        return simulation.linear_velocity.base, simulation.angular_velocity.base

    before, after = arrays(), arrays()
    assert before[0] is after[0] and before[1] is after[1]
    simulation.set_velocity('body_1', linear=(1, 2, 3), angular=(4, 5, 6))
    changed = arrays()
    assert changed[0] is not before[0] and changed[1] is not before[1]
    assert simulation.linear_velocity[1].tolist() == [1, 2, 3]
    assert simulation.angular_velocity[1].tolist() == [4, 5, 6]
    assert before[0][:, 1].tolist() != [1, 2, 3] and before[1][:, 1].tolist() != [4, 5, 6]


def test_regular_readings_are_evaluated_together(evaluations):
    simulation = Simulation(drifting(10))
    for _ in range(1000):
        simulation.advance(0.001)
        assert simulation.position.shape == (10, 3)
    assert evaluations[:6] == [1, 2, 4, 8, 16, MOST_TIMES]
    assert len(evaluations) < 6 + 1000 / MOST_TIMES
    assert sum(evaluations) < 1000 + MOST_TIMES
    assert simulation.work.pose_evaluations == sum(evaluations)


@pytest.mark.parametrize('heights', [(0.1,), (0.1, 0.1), (0.1, 5.0)])
def test_steps_of_contact_leave_nothing_to_evaluate(evaluations, heights):
    """But where something flies: cubes slide on the ground, or one is thrown above it."""
    shape, friction = Cube(0.2), 0.2
    bodies = tuple(Body(f'cube_{y}', shape, 1.0, shape.inertia(1.0), (0.0, float(y), height),
                        velocity=(3.0, 0.0, 0.0), material=Material(friction=friction))
                   for y, height in enumerate(heights))
    ground = Plane('ground', material=Material(friction=friction))
    simulation = Simulation(Scene(bodies, (ground,)))
    flying = np.array(heights) > 0.1
    simulation.advance(1e-6)
    begun = len(evaluations)
    for _ in range(100):
        simulation.advance(1 / 240)
        time = simulation.time
        fall = 9.81 * np.where(flying, 0.0, friction)
        np.testing.assert_allclose(simulation.position[:, 0],
                                   3.0 * time - 0.5 * fall * time ** 2, atol=1e-7)
        np.testing.assert_allclose(simulation.linear_velocity[:, 0], 3.0 - fall * time, atol=1e-7)
    assert (len(evaluations) > begun) == flying.any()


def test_times_that_were_said_are_evaluated_together(evaluations):
    left = np.cumsum(np.random.default_rng(0).uniform(0.001, 0.01, 300)).tolist()
    simulation = Simulation(drifting(10))
    simulation.expect_times(lambda count: left[:count])
    while left:
        simulation.advance(left[0] - simulation.time)
        assert simulation.time == left.pop(0)
        assert simulation.position.shape == (10, 3)
    assert len(evaluations) < 20


def test_irregular_readings_are_not_evaluated_in_vain(evaluations):
    simulation = Simulation(drifting(10))
    for duration in np.random.default_rng(0).uniform(0.001, 0.01, 100):
        simulation.advance(float(duration))
        assert simulation.position.shape == (10, 3)
    assert evaluations == [1] * 100


def test_what_is_told_a_body_at_every_step_leaves_nothing_to_read_ahead(evaluations):
    simulation = Simulation(drifting(10))
    for step in range(100):
        simulation.apply_wrench('body_3', (1.0 + step, 0.0, 0.0))
        simulation.advance(0.001)
        assert simulation.position.shape == (10, 3)
    assert sum(evaluations) <= 101
