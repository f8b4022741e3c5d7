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

"""The references of impacts and contact, against laws of conservation and brute integration."""

import numpy as np
import pytest
from rigid_sim_ros.benchmark.problems import friction
from rigid_sim_ros.benchmark.problems.bounces import apexes, parabola_tops, quaternions, rest_time
from rigid_sim_ros.benchmark.references.bouncing import BouncingCube
from rigid_sim_ros.benchmark.references.impulses import after_impulse
from rigid_sim_ros.benchmark.references.tipping import landing_time, tipping_angle
from rigid_sim_ros.benchmark.trajectories import Trajectory
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
CORNERS = 0.1 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])

BODIES = [
    {'mass': 2.0, 'moment': 0.03, 'position': np.array([0.0, 0.1, 0.0]),
     'velocity': np.array([1.0, 0.5, 0.0]), 'spin': np.array([0.0, 1.0, 2.0])},
    {'mass': 1.0, 'moment': 0.01, 'position': np.array([0.3, 0.0, 0.1]),
     'velocity': np.array([-1.0, 0.0, 0.5]), 'spin': np.array([3.0, -1.0, 0.0])}]
POINT, NORMAL = np.array([0.15, 0.05, 0.08]), np.array([2.0, -1.0, 2.0]) / 3


def totals(bodies, velocities):
    momentum = sum(body['mass'] * linear for body, (linear, _) in zip(bodies, velocities))
    turning = sum(body['mass'] * np.cross(body['position'], linear) + body['moment'] * angular
                  for body, (linear, angular) in zip(bodies, velocities))
    energy = sum(body['mass'] * linear @ linear / 2 + body['moment'] * angular @ angular / 2
                 for body, (linear, angular) in zip(bodies, velocities))
    return momentum, turning, energy


def normal_speed(velocities):
    points = [linear + np.cross(angular, POINT - body['position'])
              for body, (linear, angular) in zip(BODIES, velocities)]
    return NORMAL @ (points[1] - points[0])


@pytest.mark.parametrize('restitution', [0.0, 0.5, 1.0])
def test_impulse_keeps_momenta_and_turns_the_normal_speed_round(restitution):
    before = [(body['velocity'], body['spin']) for body in BODIES]
    after = after_impulse(BODIES, POINT, NORMAL, restitution)
    momentum, turning, energy = totals(BODIES, before)
    new_momentum, new_turning, new_energy = totals(BODIES, after)
    np.testing.assert_allclose(new_momentum, momentum, atol=1e-14)
    np.testing.assert_allclose(new_turning, turning, atol=1e-14)
    assert normal_speed(before) < 0
    assert normal_speed(after) == pytest.approx(-restitution * normal_speed(before), abs=1e-14)
    if restitution == 1.0:
        assert new_energy == pytest.approx(energy, rel=1e-14)
    else:
        assert new_energy < energy


@pytest.fixture(scope='module')
def bouncing():
    """Return the impact times, and poses just before and after each, of a bouncing cube."""
    cube = BouncingCube(edge=0.2, mass=1.0, height=0.6, spin=(3.0, 5.0, 2.0), gravity=GRAVITY,
                        velocity=(0.25, 0.125, 0.0), restitution=0.75)
    instants, speeds, lowest = [], [], []
    for _ in range(4):
        start = float(cube.time)
        time, corner = cube.next_impact()
        instants.append(float(time))

        def height(moment, corner=corner):
            position, rotation = cube.pose_at(moment)
            return (rotation @ CORNERS.T + position[:, None])[2, corner]

        lowest.append(min(
            (rotation @ CORNERS.T + position[:, None])[2].min() for position, rotation in
            (cube.pose_at(moment) for moment in np.linspace(start, instants[-1], 25))))
        step = 1e-5
        before = (height(time - step) - height(time - 2 * step)) / step
        touching = height(time)
        cube.bounce()
        after = (height(time + 2 * step) - height(time + step)) / step
        speeds.append((before, after, touching))
    return instants, speeds, lowest


def test_corners_of_the_bouncing_cube_stay_above_the_plane(bouncing):
    assert bouncing[2] == pytest.approx([0.0] * 4, abs=1e-15)


def test_the_corner_that_hits_leaves_with_its_speed_times_restitution(bouncing):
    for before, after, touching in bouncing[1]:
        assert touching == pytest.approx(0.0, abs=1e-16)
        assert before < -0.1
        # the differences' own error is acceleration times their step
        assert after == pytest.approx(-0.75 * before, abs=5e-3)


def test_the_tipping_cube_is_a_pendulum():
    def derivative(time, state):
        # about the edge: r^2 + d^2 = 2/3 edge^2
        return [state[1], GRAVITY * 0.2 / np.sqrt(2) * np.sin(state[0]) / (2 / 3 * 0.2 ** 2)]

    landing = landing_time(0.05, 0.2, GRAVITY)
    solved = solve_ivp(derivative, (0, landing), [0.05, 0.0], rtol=1e-12, atol=1e-13,
                       dense_output=True)
    for time in (0.1, 0.3, 0.45):
        assert tipping_angle(time, 0.05, 0.2, GRAVITY) == pytest.approx(solved.sol(time)[0],
                                                                        abs=1e-10)
    assert solved.y[0, -1] == pytest.approx(np.pi / 4, abs=1e-10)


def test_apexes_are_those_of_falls_and_rebounds():
    time, speed = np.sqrt(2 / GRAVITY), np.sqrt(2 * GRAVITY)
    times, heights = apexes(0.5, 3)
    for expected_time, expected_height in zip(times, heights):
        speed *= 0.5
        assert time + speed / GRAVITY == pytest.approx(expected_time, rel=1e-14)
        assert speed ** 2 / (2 * GRAVITY) == pytest.approx(expected_height, rel=1e-14)
        time += 2 * speed / GRAVITY
    # the flights that are left halve from one to the next: as long again as the last one
    assert time + 2 * speed / GRAVITY == pytest.approx(rest_time(0.5), rel=1e-14)


def test_parabola_top_is_found_from_uneven_points():
    times = np.array([[0.1, 0.25, 0.3]])
    tops = parabola_tops(times, 2.0 - 4.9 * (times - 0.22) ** 2)
    assert (tops[0][0], tops[1][0]) == pytest.approx((0.22, 2.0), rel=1e-13)


def test_quaternions_are_those_of_the_matrices():
    rotations = Rotation.random(20, random_state=1)
    found = Rotation.from_quat(quaternions(rotations.as_matrix()))
    assert (found.inv() * rotations).magnitude().max() < 1e-14


def brute(problem, force, state, step=5e-5):
    """Return the trajectory of one body by midpoint steps of (x, z-angle or y-angle) rates."""
    times, rows, now = problem.times, [], 0.0
    for time in times:
        count = int(np.ceil((time - now) / step))
        for _ in range(count):
            h = (time - now) / count
            middle = state + h / 2 * force(state)
            state = state + h * force(middle)
        now = time
        rows.append(state)
    return np.array(times), np.array(rows)


def trajectory_of(times, x, angle_axis, angle, velocity, spin):
    count = len(times)
    position = np.zeros((count, 1, 3))
    position[:, 0, 0], position[:, 0, 2] = x, 0.1
    orientation = Rotation.from_rotvec(np.outer(angle, angle_axis)).as_quat()[:, None]
    linear, angular = np.zeros((2, count, 1, 3))
    linear[:, 0, 0] = velocity
    angular[:, 0] = np.outer(spin, angle_axis)
    return Trajectory(times, position, orientation, linear, angular, np.zeros(1, bool))


def problem_named(name):
    return next(problem for problem in friction.PROBLEMS if problem.name == name)


def test_slide_is_what_brute_integration_gives():
    problem = problem_named('slide')

    def force(state):
        return np.array([state[1], -0.3 * GRAVITY * np.tanh(state[1] / 1e-4)])

    times, rows = brute(problem, force, np.array([0.0, 3.0]))
    zero = np.zeros(len(times))
    errors = problem.measure(trajectory_of(times, rows[:, 0], (0, 0, 1), zero, rows[:, 1], zero))
    # friction that is smooth below 0.1 mm/s creeps a little
    assert errors['distance_error_relative'] < 1e-4
    assert errors['position_error_m'] < 1e-4


def test_spin_is_what_brute_integration_gives():
    problem = problem_named('flat_spin')

    def force(state):
        # four corners, each with a quarter of the weight, at half the face's diagonal
        torque = 4 * 0.3 * GRAVITY / 4 * np.hypot(0.1, 0.1)
        return np.array([state[1], -torque / (0.2 ** 2 / 6) * np.tanh(state[1] / 1e-3)])

    times, rows = brute(problem, force, np.array([0.0, 10.0]))
    zero = np.zeros(len(times))
    errors = problem.measure(trajectory_of(times, zero, (0, 0, 1), rows[:, 0], zero, rows[:, 1]))
    assert errors['angle_error_rad'] < 1e-3


def test_rolling_is_what_brute_integration_gives():
    problem = problem_named('rolling')

    def force(state):
        slip = state[1] - 0.1 * state[2]
        pull = -0.3 * GRAVITY * np.tanh(slip / 1e-4)
        return np.array([state[1], pull, -pull * 0.1 / (0.4 * 0.1 ** 2)])

    times, rows = brute(problem, force, np.array([0.0, 3.0, 0.0]))
    zero = np.zeros(len(times))
    errors = problem.measure(
        trajectory_of(times, rows[:, 0], (0, 1, 0), zero, rows[:, 1], rows[:, 2]))
    assert errors['position_error_m'] < 1e-4
    assert errors['spin_error_relative'] < 1e-4
