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

"""Friction against rolling and pivoting: closed forms of balls that come to rest, or do not."""

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Sphere

GRAVITY, RADIUS, MASS = 9.81, 0.1, 2.0
FRICTION = 0.6
STEP = 1 / 240


def ball(name='ball', x=0.0, z=RADIUS, **values):
    """Return a ball of 2 kg on the ground."""
    shape = Sphere(RADIUS)
    return Body(name, shape, MASS, shape.inertia(MASS), position=(x, 0.0, z), **values)


def simulated(*bodies, slope=0.0, max_step=STEP, **material):
    """Return a simulation on a plane that falls towards x, of one material."""
    surface = Material(**{'restitution': 0.0, 'friction': FRICTION, **material})
    bodies = [Body(**{**vars(body), 'material': surface}) for body in bodies]
    gravity = (GRAVITY * np.sin(slope), 0.0, -GRAVITY * np.cos(slope))
    return Simulation(Scene(tuple(bodies), (Plane('ground', material=surface),), gravity=gravity),
                      max_step=max_step)


def run(simulation, end):
    """Advance to a time [s] in steps, or until all rest."""
    while simulation.time < end - 1e-9 and not simulation.asleep.all():
        simulation.advance(STEP)
    return simulation


def rolling(speed):
    """Return the start of a ball that rolls."""
    return {'velocity': (speed, 0.0, 0.0), 'angular_velocity': (0.0, speed / RADIUS, 0.0)}


@pytest.mark.parametrize('count', [1, 3])
def test_rolling_balls_come_to_rest(count):
    """The torque about the contact, width times weight, takes from 7/5 m r^2 of inertia."""
    width, speed, early = 0.01, 0.2, 0.1
    slowing = width * GRAVITY * 5 / (7 * RADIUS)
    balls = [ball(f'ball{row}', x=0.5 * row, **rolling(speed)) for row in range(count)]
    simulation = run(simulated(*balls, rolling_friction=width), early)
    np.testing.assert_allclose(simulation.linear_velocity[:, 0], speed - early * slowing,
                               rtol=1e-9)
    np.testing.assert_allclose(simulation.angular_velocity[:, 1],
                               (speed - early * slowing) / RADIUS, rtol=1e-9)
    run(simulation, 1.0)
    assert simulation.asleep.all()
    assert simulation.time == pytest.approx(speed / slowing, abs=2 * STEP)
    way = simulation.position[:, 0] - 0.5 * np.arange(count)
    # alone it stops at an instant, several do so in a step
    np.testing.assert_allclose(way, speed ** 2 / (2 * slowing), rtol=1e-9 if count == 1 else 1e-4)


@pytest.mark.parametrize('spin', [1.7e-18, -1e-30, 5e-324])
def test_a_spin_of_next_to_nothing_ends_at_once(spin):
    """In no time. The other, by width times weight over 2/5 m r^2; it slides on as before."""
    width, speed, rate = 0.002, 0.75, 0.5
    simulation = simulated(
        ball(velocity=(speed, 0.0, 0.0), angular_velocity=(0.0, rate, spin)),
        friction=0.0, rolling_friction=width, pivoting_friction=width)
    slowing = width * GRAVITY / (0.4 * RADIUS ** 2)
    simulation.advance(0.5 * rate / slowing)
    np.testing.assert_allclose(simulation.angular_velocity[0], (0.0, 0.5 * rate, 0.0), rtol=1e-9)
    simulation.advance(1.0)
    assert (simulation.angular_velocity == 0.0).all()
    np.testing.assert_allclose(
        simulation.position[0], (speed * simulation.time, 0.0, RADIUS), rtol=1e-12)


def test_many_balls_on_one_plate_roll_as_one_does():
    """A pile, of first order: that of nine balls on a plate too heavy for them to move."""
    width, speed, early = 0.01, 0.2, 0.1
    plate = Box((5.0, 1.0, 0.1))
    under = Body('plate', plate, 1e4, plate.inertia(1e4), position=(2.0, 0.0, 0.05))
    balls = [ball(f'ball{row}', x=0.5 * row, z=0.1 + RADIUS, **rolling(speed))
             for row in range(9)]
    slowing = width * GRAVITY * 5 / (7 * RADIUS)
    simulation = run(simulated(under, *balls, rolling_friction=width), early)
    np.testing.assert_allclose(simulation.linear_velocity[1:, 0], speed - early * slowing,
                               rtol=2e-3)
    run(simulation, 2.0)
    assert simulation.asleep.all()
    np.testing.assert_allclose(simulation.position[1:, 0] - 0.5 * np.arange(9),
                               speed ** 2 / (2 * slowing), rtol=0.03)


@pytest.mark.parametrize('max_step', [1 / 240, 1 / 960])
def test_a_crowd_of_balls_rolls_as_one_does(max_step):
    """One pile, as there are many: each by the closed form, however long contacts are kept."""
    width, speed = 0.01, 0.3
    balls = [ball(f'ball{row}', x=0.5 * row, **rolling(speed)) for row in range(30)]
    simulation = simulated(*balls, rolling_friction=width, max_step=max_step)
    slowing = width * GRAVITY * 5 / (7 * RADIUS)
    for _ in range(6):
        simulation.advance(0.05)
    np.testing.assert_allclose(simulation.linear_velocity[:, 0],
                               speed - slowing * simulation.time, rtol=1e-12)


def test_a_ball_rests_on_a_slope_that_its_width_holds():
    simulation = run(simulated(ball(), slope=0.019, rolling_friction=0.002), 0.2)
    assert simulation.asleep.all()
    assert abs(simulation.position[0, 0]) < 1e-9


def test_on_a_steeper_slope_it_rolls():
    slope, width = 0.05, 0.002
    end = 0.2
    simulation = run(simulated(ball(), slope=slope, rolling_friction=width), end)
    pull = 5 / 7 * GRAVITY * (np.sin(slope) - width / RADIUS * np.cos(slope))
    assert simulation.linear_velocity[0, 0] == pytest.approx(pull * end, rel=1e-9)
    assert simulation.position[0, 0] == pytest.approx(pull * end ** 2 / 2, rel=1e-9)


def test_a_spinning_ball_comes_to_rest_where_it_is():
    """Width times weight on 2/5 m r^2; nothing else moves."""
    width, spin, early = 0.01, 5.0, 0.1
    slowing = width * GRAVITY / (0.4 * RADIUS ** 2)
    simulation = run(simulated(ball(angular_velocity=(0.0, 0.0, spin)),
                               pivoting_friction=width), early)
    assert simulation.angular_velocity[0, 2] == pytest.approx(spin - early * slowing, rel=1e-9)
    run(simulation, 1.0)
    assert simulation.asleep.all()
    assert simulation.time == pytest.approx(spin / slowing, abs=2 * STEP)
    np.testing.assert_allclose(simulation.position[0], (0.0, 0.0, RADIUS), atol=1e-12)
    angle = 2 * np.arctan2(simulation.orientation[0, 2], simulation.orientation[0, 3])
    assert angle == pytest.approx(spin ** 2 / (2 * slowing), abs=1e-9)


@pytest.mark.parametrize('spin', [0.0, -20.0])
def test_a_thrown_ball_slides_then_rolls_then_rests(spin):
    """
    Sliding is slowed by mu g, rolling by 5/7 of width g / r; spin grows by what is left of them.

    The torque of the width is against the spin: with it while the ball turns backwards.
    """
    width, speed = 0.01, 1.0
    time = way = 0.0
    slide = FRICTION * GRAVITY
    backwards = (FRICTION * RADIUS + width) * GRAVITY / (0.4 * RADIUS ** 2)
    forwards = (FRICTION * RADIUS - width) * GRAVITY / (0.4 * RADIUS ** 2)
    for duration in (-spin / backwards, None):
        if duration is None:
            duration = speed / (slide + forwards * RADIUS)
        time += duration
        way += speed * duration - slide * duration ** 2 / 2
        speed -= slide * duration
    slowing = width * GRAVITY * 5 / (7 * RADIUS)
    simulation = run(simulated(ball(velocity=(1.0, 0.0, 0.0), angular_velocity=(0.0, spin, 0.0)),
                               rolling_friction=width), 3.0)
    assert simulation.time == pytest.approx(time + speed / slowing, abs=STEP)
    assert simulation.position[0, 0] == pytest.approx(way + speed ** 2 / (2 * slowing), rel=1e-9)


def test_a_ball_whose_width_is_too_great_slides_without_turning():
    simulation = run(simulated(ball(velocity=(1.0, 0.0, 0.0)), rolling_friction=0.08), 1.0)
    assert simulation.asleep.all()
    assert simulation.position[0, 0] == pytest.approx(1 / (2 * FRICTION * GRAVITY), rel=1e-9)
    np.testing.assert_array_equal(simulation.orientation[0], (0.0, 0.0, 0.0, 1.0))


def test_down_a_steep_slope_it_slides_and_turns():
    """Steeper than friction holds: from rest, g (sin - mu cos), turned by friction less width."""
    slope, width, end = 1.2, 0.002, 0.5
    simulation = run(simulated(ball(), slope=slope, rolling_friction=width), end)
    pull = GRAVITY * (np.sin(slope) - FRICTION * np.cos(slope))
    turning = (FRICTION * RADIUS - width) * GRAVITY * np.cos(slope) / (0.4 * RADIUS ** 2)
    assert simulation.position[0, 0] == pytest.approx(pull * end ** 2 / 2, rel=1e-9)
    assert simulation.angular_velocity[0, 1] == pytest.approx(turning * end, rel=1e-9)


def test_a_ball_rolls_in_a_curve_and_spins_down():
    """
    Across a slope: 7/5 v' = g - width N / (m r) along v, integrated by itself; spin apart from it.

    By Runge and Kutta's classical method, in steps so small that its error is at rounding.
    """
    slope, width, twist, end = 0.1, 0.004, 0.002, 1.0
    pull, press = GRAVITY * np.sin(slope), GRAVITY * np.cos(slope)

    def rates(state):
        velocity = state[2:]
        return np.concatenate((velocity, 5 / 7 * (np.array((pull, 0.0)) - width * press / RADIUS
                                                  * velocity / np.hypot(*velocity))))

    state, size = np.array((0.0, 0.0, 0.0, 0.5)), end / 2000
    for _ in range(2000):
        k1 = rates(state)
        k2 = rates(state + size / 2 * k1)
        k3 = rates(state + size / 2 * k2)
        k4 = rates(state + size * k3)
        state = state + size / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    simulation = run(simulated(ball(velocity=(0.0, 0.5, 0.0), angular_velocity=(-5.0, 0.0, 8.0)),
                               slope=slope, rolling_friction=width, pivoting_friction=twist), end)
    np.testing.assert_allclose(simulation.position[0, :2], state[:2], atol=1e-9)
    np.testing.assert_allclose(simulation.linear_velocity[0, :2], state[2:], atol=1e-9)
    np.testing.assert_allclose(
        simulation.angular_velocity[0],
        (-state[3] / RADIUS, state[2] / RADIUS, 8.0 - twist * press / (0.4 * RADIUS ** 2) * end),
        atol=1e-8)


def test_a_ball_bounces_and_comes_to_rest():
    """What it does in the air is not resisted: all energy goes, and never comes."""
    simulation = simulated(ball(z=0.5, velocity=(1.0, 0.0, 0.0), angular_velocity=(3.0, 0, 9.0)),
                           restitution=0.5, rolling_friction=0.005, pivoting_friction=0.005)
    energy = simulation.energy()
    while not simulation.asleep.all():
        simulation.advance(STEP)
        before, energy = energy, simulation.energy()
        assert energy - before < 1e-9
        assert simulation.time < 5.0
    np.testing.assert_array_equal(simulation.angular_velocity, 0.0)


def test_torques_act_on_both():
    """A ball that spins on a plate in the air: together they keep their angular momentum."""
    plate = Box((1.0, 1.0, 0.1))
    under = Body('plate', plate, 5.0, plate.inertia(5.0), position=(0.0, 0.0, 1.0))
    simulation = simulated(
        ball(z=1.05 + RADIUS, angular_velocity=(0.0, 0.0, 20.0), force=(0.0, 0.0, -30.0)), under,
        pivoting_friction=0.01)
    simulation.apply_wrench('plate', force=(0.0, 0.0, 7 * GRAVITY + 30.0))
    momentum = simulation.angular_momentum()[2]
    simulation.advance(0.2)
    spins = simulation.angular_velocity[:, 2]
    assert 0.0 < spins[1] < spins[0] < 20.0
    assert simulation.angular_momentum()[2] == pytest.approx(momentum, rel=1e-9)


def test_without_it_balls_roll_on():
    simulation = run(simulated(ball(**rolling(0.5))), 5.0)
    assert simulation.position[0, 0] == pytest.approx(2.5, rel=1e-9)
