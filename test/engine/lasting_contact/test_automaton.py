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

"""One body on one plane: closed forms of sliding, tipping, spinning; throws that come to rest."""

from island_run import body, GRAVITY, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.lasting_contact.automaton.ball_resistance import resisted, turning_of
from rigid_sim_ros.engine.lasting_contact.automaton.dormand_prince import Step
from rigid_sim_ros.engine.lasting_contact.automaton.forces import general_forces
from rigid_sim_ros.engine.lasting_contact.automaton.patterns import constrained
from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import PlaneBody
from rigid_sim_ros.engine.model import Plane
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere


def cube(**values):
    """Return a cube of 1 m and 1 kg at rest on the ground, but for what is given."""
    return body('cube', Cube(1.0), **{'position': (0, 0, 0.5), **values})


@pytest.mark.parametrize('friction', [0.2, 0.5])
def test_sliding_to_rest(friction):
    """From 3 m/s: v^2 / (2 mu g), without tilt or lift."""
    run = IslandRun([cube(velocity=(3, 0, 0))], friction=friction)
    assert run.run_to_rest(3.0) == pytest.approx(3 / (friction * GRAVITY), abs=1 / 240)
    position = run.state.position[:, 0]
    assert position[0] == pytest.approx(9 / (2 * friction * GRAVITY), rel=2e-9)
    np.testing.assert_allclose(position[1:], (0, 0.5), atol=1e-14)
    np.testing.assert_allclose(run.state.orientation[:3, 0], 0, atol=1e-14)


def test_spinning_on_a_face():
    """At 5 rad/s: all corners slide at one distance, torque mu m g r, w^2 / (2 torque / I)."""
    run = IslandRun([cube(angular_velocity=(0, 0, 5))], friction=0.3)
    assert run.run_to_rest(3.0) is not None
    _, _, z, w = run.state.orientation[:, 0]
    slowing = 0.3 * GRAVITY * np.sqrt(0.5) / (1 / 6)
    assert 2 * np.arctan2(z, w) == pytest.approx(25 / (2 * slowing), rel=2e-9)
    np.testing.assert_allclose(run.state.position[:, 0], (0, 0, 0.5), atol=1e-14)


def sliding_and_turning(duration, steps):
    """
    Return x, y, angle of a unit cube after sliding at (2, 0.3) m/s and turning at 5 rad/s, mu 0.3.

    An independent integration: three freedoms, pressure c0 + c1 x + c2 y from balance of moments
    (friction acts half an edge below the centre), Runge-Kutta 4.
    """
    friction, corners = 0.3, np.array([(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)])

    def rates(state):
        angle, velocity, spin = state[2], state[3:5], state[5]
        turn = np.array(((np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))))
        arms = corners @ turn.T
        slip = velocity + spin * np.column_stack((-arms[:, 1], arms[:, 0]))
        slip /= np.hypot(slip[:, 0], slip[:, 1])[:, None]
        basis = np.column_stack((np.ones(4), arms))
        matrix = np.array((np.ones(4), arms[:, 1] - 0.5 * friction * slip[:, 1],
                           0.5 * friction * slip[:, 0] - arms[:, 0])) @ basis
        pressure = basis @ np.linalg.solve(matrix, (GRAVITY, 0, 0))
        force = -friction * pressure[:, None] * slip
        moment = (arms[:, 0] * force[:, 1] - arms[:, 1] * force[:, 0]).sum()
        return np.array((*velocity, spin, *force.sum(axis=0), 6 * moment))

    state, step = np.array((0, 0, 0, 2, 0.3, 5.0)), duration / steps
    for _ in range(steps):
        k1 = rates(state)
        k2 = rates(state + step / 2 * k1)
        k3 = rates(state + step / 2 * k2)
        k4 = rates(state + step * k3)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return state[:3]


def test_sliding_and_turning_on_a_face():
    """Against an independent integration with the pressure of a foundation."""
    run = IslandRun([cube(velocity=(2, 0.3, 0), angular_velocity=(0, 0, 5))], friction=0.3)
    run.run(0.5)
    expected = sliding_and_turning(0.5, 2000)
    _, _, z, w = run.state.orientation[:, 0]
    np.testing.assert_allclose((*run.state.position[:2, 0], 2 * np.arctan2(z, w)), expected,
                               atol=1e-9)


def test_edge_tips_over():
    """
    A cube balanced on an edge, 0.05 rad off, tips: when the opposite edge lands.

    The time is the integral of dangle / rate, with the rate from energy; the square root at the
    start is taken out by angle = 0.05 + s^2.
    """
    tilt = np.pi / 4 + 0.05
    half = np.sqrt(0.5)
    start = body('cube', Cube(1.0), position=(0, 0, half * np.cos(0.05)),
                 orientation=(0, np.sin(tilt / 2), 0, np.cos(tilt / 2)))
    run = IslandRun([start], friction=1.0)
    run.run(1.1)
    landing = run.world.events.take()
    landing = landing[landing['kind'] == IMPACT][0]
    moment, drop = 1 / 6 + 0.5, GRAVITY * half
    nodes, weights = np.polynomial.legendre.leggauss(60)
    top = np.sqrt(np.pi / 4 - 0.05)
    s = top * (nodes + 1) / 2
    # cos a - cos b = 2 sin((a + b) / 2) sin((b - a) / 2), free of cancellation at the start
    fallen = 2 * np.sin(0.05 + s * s / 2) * np.sin(s * s / 2)
    time = (weights * top / 2 * 2 * s / np.sqrt(2 * drop * fallen / moment)).sum()
    assert landing['time'] == pytest.approx(time, abs=1e-10)
    rate = np.sqrt(2 * drop * (np.cos(0.05) - np.cos(np.pi / 4)) / moment)
    assert landing['speed'] == pytest.approx(rate, rel=1e-9)


@pytest.mark.parametrize('axis', [(0, 0, 1), (0.6, 0, 0.8), (0, 0, -1)])
def test_incline(axis):
    """Below the friction angle nothing creeps, above it the acceleration is g (sin - mu cos)."""
    axis = np.array(axis, float)
    # gravity is 20 degrees off the plane's normal, towards a direction in the plane
    side = np.cross(axis, (0, 1, 0))
    angle = np.radians(20)
    gravity = GRAVITY * (np.sin(angle) * side - np.cos(angle) * axis)
    turn = np.array((axis[1], -axis[0], 0, 1 + axis[2]))
    turn = np.array((1.0, 0, 0, 0)) if axis[2] < 0 else turn / np.linalg.norm(turn)

    def placed(friction):
        return IslandRun(
            [cube(position=tuple(0.7 * axis), orientation=tuple(rotation.conjugate(turn)))],
            [Plane('ramp', tuple(axis), 0.2)], friction=friction, gravity=tuple(gravity))

    holding = placed(0.364 / 0.95)
    holding.run(1.0)
    np.testing.assert_allclose(holding.state.position[:, 0], 0.7 * axis, atol=1e-12)
    sliding = placed(0.364 / 1.05)
    sliding.run(1.0)
    way = (GRAVITY * (np.sin(angle) - 0.364 / 1.05 * np.cos(angle))) / 2
    np.testing.assert_allclose(sliding.state.position[:, 0] - 0.7 * axis, way * side, atol=1e-9)


def test_ball_slides_then_rolls_up_a_slope():
    """On the level it rolls at 5/7 of its speed; on a slope it rolls at 5/7 of the pull."""
    run = IslandRun([body('ball', Sphere(0.2), 3.0, position=(0, 0, 0.2), velocity=(1, 0.5, 0))],
                    friction=0.2)
    run.run(1.0)
    np.testing.assert_allclose(run.state.linear_velocity[:, 0], (5 / 7, 2.5 / 7, 0), atol=1e-12)
    pull = 1.0
    rolling = IslandRun([body('ball', Sphere(0.2), 3.0, position=(0, 0, 0.2))], friction=0.5,
                        gravity=(pull, 0.0, -GRAVITY))
    rolling.run(1.0)
    assert rolling.state.position[0, 0] == pytest.approx(5 / 7 * pull / 2, rel=1e-9)


def test_a_rolling_ball_turns_as_one_in_flight_under_that_torque():
    """Its spin grows as that of a ball under a constant torque, whose attitude is known."""
    radius, growth, spin = 0.2, 5 / 7 * 2.0 / 0.2, (0.0, 0.0, 40.0)
    ball = body('ball', Sphere(radius), 3.0, position=(0, 0, radius), angular_velocity=spin)
    run = IslandRun([ball], friction=0.9, gravity=(2.0, 0.0, -GRAVITY))
    run.run(1.0)
    flying = Flights(np.array([ball.inertia]).T)
    flying.begin(np.array([0]), 0.0, *(np.array([row], dtype=float).T for row in (
        (0, 0, 0), (0, 0, 0, 1), (0, 0, 0), spin, (0, 0, 0),
        (0, growth * ball.inertia[0], 0))))
    _, attitude, _, rate = flying.motion(0, 1.0)
    np.testing.assert_allclose(run.state.angular_velocity[:, 0], rate, rtol=1e-10)
    assert rotation.angle_between(run.state.orientation[:, 0], np.array(attitude)) < 1e-8


def thrown(seed, restitution, friction, size=(1.0, 1.0, 1.0), turn=(0.0, 0.0, 0.0, 1.0), **more):
    """Return a box thrown with a spin from 1 to 1.5 m, turned by `turn` in its own axes first."""
    random = np.random.default_rng(seed)
    attitude = random.normal(size=4)
    attitude = rotation.multiply(attitude / np.linalg.norm(attitude), np.array(turn))
    return IslandRun(
        [body('box', Box(size), position=(0, 0, random.uniform(1.0, 1.5)),
              orientation=tuple(attitude), velocity=tuple(1.5 * random.normal(size=3)),
              angular_velocity=tuple(4 * random.normal(size=3)))],
        restitution=restitution, friction=friction, step=1 / 100, **more)


@pytest.mark.parametrize('size', [(1.0, 1.0, 1.0), (0.5, 1.0, 1.5)])
@pytest.mark.parametrize('restitution, friction, law', [
    (0.0, 1.0, 'poisson'), (0.3, 0.5, 'poisson'), (0.5, 0.2, 'newton'), (0.6, 0.5, 'stronge')])
def test_thrown_boxes_come_to_rest(size, restitution, friction, law):
    """At rest flat on a face, never stuck, energy never rising by more than 1e-8 of its scale."""
    for seed in range(2):
        run = thrown(seed, restitution, friction, size, law=law)
        energy = first = run.energy()
        while not run.step().resting.all():
            energy, before = run.energy(), energy
            assert energy - before < 1e-8 * first
            assert run.time < 10
        turn = rotation.matrix(run.state.orientation[:, 0])
        assert np.abs(turn[2]).max() > 1 - 1e-14
        assert not run.state.linear_velocity.any()


def test_names_of_corners_do_not_matter():
    """A cube turned in its own axes before the throw is the same cube: it rests there too."""
    half = np.sqrt(0.5)
    places = []
    for turn in ((0, 0, 0, 1), (0, 0, half, half), (half, 0, 0, half), (0.5, 0.5, 0.5, 0.5)):
        run = thrown(5, 0.3, 0.3, turn=turn)
        assert run.run_to_rest(10.0) is not None
        places.append(run.state.position[:, 0])
    np.testing.assert_allclose(places, np.broadcast_to(places[0], (4, 3)), atol=1e-9)


@pytest.mark.parametrize('edge', [0.01, 10.0])
def test_size_does_not_matter(edge):
    """A throw at another scale, times scaled by its root, ends in the same way."""
    root = edge ** 0.5

    def scaled(scale, step):
        return IslandRun([body('cube', Cube(scale), position=(0, 0, 1.2 * scale),
                               orientation=(0.1, 0.5, -0.3, np.sqrt(0.65)),
                               velocity=(scale ** 0.5, 0, 0),
                               angular_velocity=(2 / scale ** 0.5, 1 / scale ** 0.5, 0))],
                         step=step, restitution=0.3, friction=0.5)

    unit, other = scaled(1.0, 1 / 240), scaled(edge, root / 240)
    assert unit.run_to_rest(10.0) * root == pytest.approx(other.run_to_rest(10.0 * root))
    np.testing.assert_allclose(other.state.position[:, 0] / edge, unit.state.position[:, 0],
                               atol=1e-6)


def test_bounces_to_rest_end_when_the_series_ends():
    """A flat drop with e = 0.5: at rest when the sum of all bounces is over, to a step."""
    drop = np.sqrt(2 * 1.0 / GRAVITY)
    run = IslandRun([cube(position=(0, 0, 1.5))], restitution=0.5, friction=0.5, step=1e-3)
    end = drop + 2 * (0.5 * GRAVITY * drop) / GRAVITY / (1 - 0.5)
    assert run.run_to_rest(3.0) == pytest.approx(end, abs=2e-3)
    assert run.state.position[2, 0] == pytest.approx(0.5, abs=1e-14)


def test_forces_of_patterns_are_those_of_the_general_solver():
    """Closed forms against the general contact problem: face and edge, sticking and sliding."""
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.4, 0.4) for z in (-0.3, 0.3)]
    for spin, slips in (((0.0, 0.0, 0.0), [None] * 4),
                        ((0.0, 0.0, 1.0), [(0.6, 0.8), (0.8, -0.6), (1.0, 0.0), (0.0, -1.0)]),
                        ((0.0, 0.0, 1.0), [None, (0.8, 0.6), (-0.8, 0.6), (0.0, -1.0)]),
                        ((0.0, 0.7, 0.0), [None] * 2),
                        ((0.3, 0.7, 0.2), [(0.6, 0.8), (0.8, -0.6)]),
                        ((0.3, 0.7, 0.2), [(0.6, 0.8)])):
        plate = PlaneBody(corners, np.sqrt(0.5), 1 / 1.7, (0.4, 0.5, 0.6), (0.2, 0.1, -GRAVITY),
                          (0.1, -0.2, 0.05), 0.5)
        state = [0, 0, 0.3, 0, 0, 0, 1, 0, 0, 0, *spin]
        turn = plate.turn(state)
        points = [point for point, corner in enumerate(corners) if corner[2] < 0][:len(slips)]
        arms = plate.arms(turn, points)
        angular = plate.free_turning(state, turn)
        forces, linear, turning = constrained(plate, state, turn, points, arms, slips,
                                              plate.acceleration, angular)
        free = plate.accelerations(state, arms, plate.acceleration, angular)
        expected = general_forces(plate, turn, arms, free, slips)
        np.testing.assert_allclose(forces, expected, atol=1e-9)
        left = plate.accelerations(state, arms, linear, turning)
        np.testing.assert_allclose([motion[2] for motion in left], 0, atol=1e-12)


def test_order_of_dormand_prince():
    """Of order 5, its interpolant 4: an oscillator, the step halved."""
    def rates(state):
        return [state[1], -state[0]]

    ends, middles = [], []
    for size in (0.4, 0.2):
        step = Step(rates, [1.0, 0.0], rates([1.0, 0.0]), size)
        ends.append(abs(step.end[0] - np.cos(size)))
        middles.append(abs(step.between(0.3 * size)[0] - np.cos(0.3 * size)))
    assert np.log2(ends[0] / ends[1]) > 5.8
    assert np.log2(middles[0] / middles[1]) > 4.8


@pytest.mark.parametrize('friction', [0.05, 0.3, 1.0])
@pytest.mark.parametrize('rolling', [0.0, 0.01, 0.1])
def test_resistance_of_a_ball_is_the_law(friction, rolling):
    """At random: what is held does not move, what moves meets all there is, against its motion."""
    random = np.random.default_rng(0)
    radius, mass, moment, twist = 0.2, 2.0, 0.03, 0.004
    for _ in range(50):
        linear = np.array((*random.normal(scale=3.0, size=2), -9.0))
        angular = random.normal(scale=20.0, size=3)
        body_ = PlaneBody([], radius, 1 / mass, [moment] * 3, linear.tolist(), [0.0] * 3,
                          friction, rolling, twist)
        force, after, turning = (np.array(each) for each in resisted(
            body_, None, (None, None), linear.tolist(), angular.tolist()))
        np.testing.assert_allclose(mass * (after - linear), force, atol=1e-12)
        arm = np.array((0.0, 0.0, -radius))
        torque = moment * (turning - angular) - np.cross(arm, force)
        point = (after + np.cross(turning, arm))[:2]
        press = 9.0 * mass
        assert force[2] == pytest.approx(press, rel=1e-14)
        for held, motion, most in ((force[:2], point, friction * press),
                                   (torque[:2], turning[:2], rolling * press),
                                   (torque[2:], turning[2:], twist * press)):
            size, speed = np.linalg.norm(held), np.linalg.norm(motion)
            assert size <= most * (1 + 1e-12) + 1e-14
            if size < most * (1 - 1e-9):
                assert speed < 1e-9
            np.testing.assert_allclose(size * motion, -speed * held, atol=1e-9)


def test_a_ball_goes_on_turning_within_a_step():
    """What has turned somewhere is taken to go on there while it is slow, or has come back."""
    ball = PlaneBody([], 0.1, 1.0, [0.004] * 3, [0.0, 0.0, -9.0], [0.0] * 3, 0.5, 0.01, 0.01)
    state = [0.0] * 6 + [1.0] + [0.0] * 3

    def turning(spin, going=None):
        return turning_of(ball, [*state, *spin], going, 1e-4)

    assert turning((0.0, 0.0, 0.0)) == (None, None)
    assert turning((3.0, 4.0, -2.0)) == ((0.6, 0.8), -1.0)
    assert turning((3.0, 4.0, -2.0), ((1.0, 0.0), 1.0)) == ((0.6, 0.8), 1.0)
    assert turning((-3.0, -4.0, 2.0), ((1.0, 0.0), 1.0)) == ((0.6, 0.8), 1.0)
    assert turning((0.0, 5e-4, 0.0), ((1.0, 0.0), 1.0)) == ((1.0, 0.0), 1.0)
