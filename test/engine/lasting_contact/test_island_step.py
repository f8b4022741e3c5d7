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

"""The step of islands: its order against closed forms, impacts in it, rest."""

from island_run import body, GRAVITY, ground, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.lasting_contact.scales import Scales
from rigid_sim_ros.engine.model import Material
from rigid_sim_ros.engine.narrow_phase import separations
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere


def tipping_angle(duration):
    """
    Return the angle of the plank of `plank_on_cube`, by Runge-Kutta 4 with 4000 steps.

    It turns about the cube's edge, from which its centre is 0.05 m along and 0.05 m up.
    """
    moment = (2.0 ** 2 + 0.1 ** 2) / 12 + 0.05 ** 2 + 0.05 ** 2

    def rates(angle, rate):
        return rate, GRAVITY * 0.05 * (np.cos(angle) + np.sin(angle)) / moment

    angle = rate = 0.0
    step = duration / 4000
    for _ in range(4000):
        k1 = rates(angle, rate)
        k2 = rates(angle + step / 2 * k1[0], rate + step / 2 * k1[1])
        k3 = rates(angle + step / 2 * k2[0], rate + step / 2 * k2[1])
        k4 = rates(angle + step * k3[0], rate + step * k3[1])
        angle, rate = (value + step / 6 * (a + 2 * b + 2 * c + d)
                       for value, a, b, c, d in zip((angle, rate), k1, k2, k3, k4))
    return angle


def plank_on_cube(step):
    """Return a plank whose centre lies 5 cm beyond the edge of a heavy cube; it tips, sticking."""
    return IslandRun([body('cube', Cube(1.0), 20.0, position=(0, 0, 0.5)),
                      body('plank', Box((2.0, 0.6, 0.1)), position=(0.55, 0, 1.05))],
                     step=step, friction=1.0)


def test_plank_tips_off_a_cube_to_second_order():
    """The angle after 0.9 s against the pendulum's: 1e-7 rad at 1/240 s, and no energy lost."""
    errors = []
    for step in (1 / 60, 1 / 120, 1 / 240):
        run = plank_on_cube(step)
        energy = run.energy()
        run.run(0.9)
        assert run.energy() == pytest.approx(energy, rel=1e-13)
        _, y, _, w = run.state.orientation[:, 1]
        errors.append(2 * np.arctan2(y, w) - tipping_angle(0.9))
        np.testing.assert_allclose(run.state.position[:, 0], (0, 0, 0.5), atol=1e-14)
    assert abs(errors[2]) < 1e-7
    assert errors[0] / errors[1] > 4
    assert errors[1] / errors[2] > 4


def test_cube_slides_on_a_free_plate():
    """Until both move together, by v^2 / (2 mu g (1 + m/M)); momentum stays, nothing tilts."""
    run = IslandRun(
        [body('cube', Cube(1.0), 1.0, position=(0, 0, 0.7), velocity=(2, 0, 0),
              material=Material(0, 0.4)),
         body('plate', Box((4.0, 4.0, 0.2)), 3.0, position=(0, 0, 0.1),
              material=Material(0, 0.4))],
        planes=[ground(material=Material(0, 0.0))], step=1 / 960)
    run.run(1.0)
    state = run.state
    relative = state.position[0, 0] - state.position[0, 1]
    assert relative == pytest.approx(4 / (2 * 0.4 * GRAVITY * (1 + 1 / 3)), rel=1e-8)
    np.testing.assert_allclose(state.linear_velocity[0, :2], 0.5, atol=1e-10)
    np.testing.assert_allclose(state.orientation[:3, :2], 0, atol=1e-14)
    momentum = state.linear_velocity[0, 0] + 3 * state.linear_velocity[0, 1]
    assert momentum == pytest.approx(2.0, rel=1e-13)


def test_sliding_does_not_lift_and_stops_at_rest():
    """True Coulomb friction: v^2 / (2 mu g) from 3 m/s at 1/240 s, without tilt or lift."""
    run = IslandRun([body('cube', Cube(1.0), position=(0, 0, 0.5), velocity=(3, 0, 0))],
                    friction=0.3)
    stop = run.run_to_rest(2.0)
    assert stop == pytest.approx(3 / (0.3 * GRAVITY), abs=1 / 240)
    position = run.state.position[:, 0]
    assert position[0] == pytest.approx(9 / (2 * 0.3 * GRAVITY), rel=3e-6)
    assert abs(position[2] - 0.5) < 1e-13
    assert np.abs(run.state.orientation[:3, 0]).max() < 1e-13


def test_ball_rolls_after_sliding():
    """A ball that slides ends rolling at 5/7 of its speed, whatever the friction."""
    run = IslandRun([body('ball', Sphere(0.2), 3.0, position=(0, 0, 0.2), velocity=(1, 0.5, 0))],
                    friction=0.2)
    run.run(1.0)
    np.testing.assert_allclose(run.state.linear_velocity[:, 0], (5 / 7, 2.5 / 7, 0), atol=1e-12)
    np.testing.assert_allclose(run.state.angular_velocity[:, 0], (-2.5 / 1.4, 5 / 1.4, 0),
                               atol=1e-11)


@pytest.mark.parametrize('size', [(1.0, 1.0, 1.0), (0.3, 0.7, 1.1)])
def test_free_flight_in_an_island_keeps_angular_momentum(size):
    """Away from everything: the angular momentum to rounding, the energy nearly so."""
    run = IslandRun([body('box', Box(size), position=(0, 0, 9), angular_velocity=(2, 3, -1))],
                    planes=[], friction=0.0, gravity=(0.0, 0.0, 0.0))

    def spin():
        turn = rotation.matrix(run.state.orientation)
        return rotation.transform(turn, run.world.bodies.inertia * rotation.transform_transposed(
            turn, run.state.angular_velocity))

    before, energy = spin(), run.energy()
    run.run(1.0)
    np.testing.assert_allclose(spin(), before, atol=1e-13)
    assert run.energy() == pytest.approx(energy, rel=1e-9)


def test_impact_inside_a_step_is_at_its_instant():
    """A cube dropped flat on another at rest hits at sqrt(2 h / g), with e, and is logged so."""
    run = IslandRun([body('low', Cube(1.0), 1e3, position=(0, 0, 0.5)),
                     body('high', Cube(1.0), 1.0, position=(0, 0, 1.8))],
                    restitution=0.5, friction=0.5)
    run.run(0.3)
    events = run.world.events.take()
    events = events[(events['kind'] == IMPACT) & (events['body_b'] == 1)]
    np.testing.assert_allclose(events['time'], np.sqrt(2 * 0.3 / GRAVITY), atol=1e-10)
    np.testing.assert_allclose(events['speed'], np.sqrt(2 * 0.3 * GRAVITY), rtol=1e-9)
    assert len(events) == 4
    after = 0.3 - np.sqrt(2 * 0.3 / GRAVITY)
    rebound = 0.5 * np.sqrt(2 * 0.3 * GRAVITY)
    # the lower cube, on the ground, gives way by no more than its mass lets it
    assert run.state.linear_velocity[2, 1] == pytest.approx(rebound - GRAVITY * after, abs=5e-3)


def thrown(seed, restitution, friction, order=(0, 1)):
    """Return two cubes flung at each other above the ground, the second listed first on demand."""
    random = np.random.default_rng(seed)
    direction = random.normal(size=3) * (1, 1, 0.3)
    direction /= np.linalg.norm(direction)
    speed = random.uniform(0.5, 1.25)
    bodies = []
    for name, side in (('a', -1.0), ('b', 1.0)):
        turn = random.normal(size=4)
        bodies.append(body(
            name, Cube(1.0), position=tuple((0, 0, 2) + side * direction),
            orientation=tuple(turn / np.linalg.norm(turn)),
            velocity=tuple(-side * speed * direction),
            angular_velocity=tuple(3 * random.normal(size=3))))
    return IslandRun([bodies[which] for which in order], restitution=restitution,
                     friction=friction)


@pytest.mark.parametrize('seed, restitution, friction',
                         [(0, 0.0, 0.5), (1, 0.3, 0.5), (2, 0.6, 0.2)])
def test_two_thrown_cubes_come_to_rest(seed, restitution, friction):
    """At rest on a face each, nothing overlaps, energy never rises by more than 1e-6."""
    run = thrown(seed, restitution, friction)
    energy, rise = run.energy(), 0.0
    for _ in range(5 * 240):
        resting = run.step().resting.all()
        energy, before = run.energy(), energy
        rise = max(rise, energy - before)
        if resting:
            break
    assert resting
    assert rise < 1e-6 * 2 * GRAVITY
    turn = rotation.matrix(run.state.orientation[:, :2])
    np.testing.assert_allclose(np.abs(turn[2]).max(axis=0), 1, atol=1e-12)
    gaps = separations(run.world.bodies, [0, 0, 1], [1, 2, 2], run.state.position,
                       run.state.orientation)
    assert gaps.min() > -1e-9


def test_order_of_bodies_does_not_matter():
    """Two thrown cubes, listed in either order, rest in the same places."""
    first, second = thrown(7, 0.3, 0.5), thrown(7, 0.3, 0.5, order=(1, 0))
    assert first.run_to_rest(5.0) == second.run_to_rest(5.0) is not None
    np.testing.assert_allclose(second.state.position[:, [1, 0]], first.state.position[:, :2],
                               atol=1e-6)


def test_a_balanced_stack_rests_at_once_and_a_tipping_one_does_not():
    """The static problem decides: offset by less than half an edge it stands, by more it tips."""
    def stack(offset):
        return IslandRun([body('low', Cube(1.0), position=(0, 0, 0.5)),
                          body('high', Cube(1.0), position=(offset, 0, 1.5))], friction=0.5)

    assert stack(0.49).step().resting.all()
    assert not stack(0.51).step().resting.all()


def test_incline_holds_below_the_friction_angle_and_not_above():
    """On a plane with tan(20 degrees) = 0.364."""
    angle = np.radians(20)
    gravity = (GRAVITY * np.sin(angle), 0.0, -GRAVITY * np.cos(angle))

    def cube(friction):
        return IslandRun([body('cube', Cube(1.0), position=(0, 0, 0.5))], friction=friction,
                         gravity=gravity)

    assert cube(0.37).step().resting.all()
    sliding = cube(0.36)
    sliding.run(1.0)
    expected = GRAVITY * (np.sin(angle) - 0.36 * np.cos(angle)) / 2
    assert sliding.state.position[0, 0] == pytest.approx(expected, rel=1e-6)


def test_fast_small_bodies_do_not_pass_through_thin_ones():
    """A 1 cm cube at 30 m/s against a plate of 1 mm: 125 mm a step of 1/240 s."""
    run = IslandRun([body('bullet', Cube(0.01), 0.01, position=(0, 0, 0.1), velocity=(0, 0, -30)),
                     body('plate', Box((1.0, 1.0, 0.001)), 10.0, position=(0, 0, 0))],
                    planes=[], restitution=0.5, friction=0.3, gravity=(0.0, 0.0, 0.0))
    run.step()
    assert run.state.position[2, 0] > run.state.position[2, 1]
    assert run.state.linear_velocity[2, 0] > 0


def test_scales_follow_the_scene():
    """Limits have the units of the island: ten times the size at ten times gravity, ten times."""
    small, large = Scales(0.1, 9.81), Scales(1.0, 98.1)
    assert large.speed == pytest.approx(10 * small.speed)
    assert large.touch_gap(0.01) == pytest.approx(10 * small.touch_gap(0.01))
