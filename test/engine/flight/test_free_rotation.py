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

"""Rotation without torque against stored digits, what is conserved, and itself at many scales."""

import numpy as np
import pytest
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.flight.polhode import polhode_of_one

import reference_rotations  # noqa: I100
from rotating import (
    angle_error, begin_one, case, CASES, cases, flights_of, momentum_and_energy,
    poses_at_times, random_quaternions)

FREE = [one for one in CASES if not any(one['torque'])]

BOX_1_2_3 = reference_rotations.BOX_1_2_3


def ids(one):
    return one['name']


def rounding_of(one):
    """Return the error [rad] that rounding the angle turned to a double makes, and a little."""
    speed = np.linalg.norm(one['rate']) * max(one['moments']) / np.median(one['moments'])
    return 2e-15 + 4e-16 * speed * one['time']


@pytest.mark.parametrize('one', FREE, ids=ids)
def test_attitude_is_right_to_the_rounding_of_the_angle_turned(one):
    _, quaternion, _, _ = flights_of([one]).motion(0, one['time'])
    assert angle_error(quaternion, one['result']) < rounding_of(one)


@pytest.mark.parametrize('one', cases('departure'), ids=ids)
def test_tumbling_near_the_middle_axis_keeps_twelve_digits(one):
    _, quaternion, _, rate = flights_of([one]).motion(0, 30.0)
    assert angle_error(quaternion, one['result']) < 1e-13
    exact_rate = np.array(one['result'][4:], dtype=float)
    rate = rotation.rotate(rotation.conjugate(np.array(quaternion)), np.array(rate))
    # the rate changes by the product of rates in an angle error's time
    assert abs(rate - exact_rate).max() < 5e-13


@pytest.mark.parametrize('one', cases('long flight'), ids=ids)
def test_ten_thousand_seconds_keep_ten_digits(one):
    _, quaternion, _, _ = flights_of([one]).motion(0, 1e4)
    assert angle_error(quaternion, one['result']) < 1e-10


def test_the_stored_digits_are_those_of_an_independent_method():
    mpmath = pytest.importorskip('mpmath')
    one = case('long flight 0 1.0')
    arguments = [tuple(one[key]) for key in ('moments', 'quaternion', 'rate', 'torque')]
    with mpmath.workdps(30):
        by_taylor = reference_rotations.by_taylor(*arguments, 0.5)
        by_quadrature = reference_rotations.by_quadrature(*arguments, 0.5)
        assert max(abs(a - b) for a, b in zip(by_taylor, by_quadrature)) < 1e-27
    stored = case('order (1.0, 2.0, 2.6) signs (1, -1, 1)')
    arguments = [tuple(stored[key]) for key in ('moments', 'quaternion', 'rate', 'torque')]
    with mpmath.workdps(40):
        result = reference_rotations.by_taylor(*arguments, stored['time'])
        assert [mpmath.nstr(value, 30) for value in result] == stored['result']


def test_many_bodies_one_body_and_many_times_agree():
    rows = [one for one in FREE if one['time'] < 100]
    together, copies = flights_of(rows), flights_of(rows, 2)
    for time in (0.0, 0.3, 7.0):
        quaternion = together.poses(time)[1]
        rate = together.velocities(time)[1]
        assert abs(copies.poses(time)[1][:, ::2] - quaternion).max() < 1e-14
        for index, row in enumerate(rows):
            one = flights_of([row])
            _, single, _, single_rate = one.motion(0, time)
            tolerance = 1e-15 * (1 + np.linalg.norm(row['rate']) * time)
            assert abs(quaternion[:, index] - single).max() < 2 * tolerance
            many = poses_at_times(one, 0, np.array([0.1, time]))[1]
            assert abs(many[:, 1] - single).max() < 2 * tolerance
            # rates about thin axes carry the rounding of the momentum over their moment
            spread = max(row['moments']) / min(row['moments'])
            assert abs(rate[:, index] - single_rate).max() < 1e-14 * (1 + time) * spread


@pytest.mark.parametrize('moments', [BOX_1_2_3, (1.0, 2.0, 2.9), (3.0, 1.0, 3.0)])
def test_momentum_energy_and_length_stay(moments):
    random = np.random.default_rng(2)
    count = 50
    quaternion = random_quaternions(random, count)
    rate = random.normal(size=(3, count)) * 3
    # a few next to each axis
    rate[:, :3] = 4 * np.eye(3) + 1e-7
    quaternion[:, :3] = ((0,), (0,), (0,), (1,))
    columns = np.repeat(np.array(moments)[:, None], count, axis=1)
    zero = np.zeros((3, count))
    flights = Flights(columns)
    flights.begin(np.arange(count), 0.0, zero, quaternion, zero, rate, zero, zero)
    momentum, energy = momentum_and_energy(columns, quaternion, rate)
    size = np.sqrt((momentum * momentum).sum(axis=0))
    for time in (0.01, 1.0, 30.0, 1e4, 1e8):
        quaternion = flights.poses(time)[1]
        now, energy_now = momentum_and_energy(columns, quaternion, flights.velocities(time)[1])
        assert (np.sqrt(((now - momentum) ** 2).sum(axis=0)) / size).max() < 5e-15
        assert abs(energy_now / energy - 1).max() < 5e-15
        assert abs((quaternion * quaternion).sum(axis=0) - 1).max() < 2e-15


def test_ten_million_evaluations_do_not_drift():
    # evaluation has no memory: any sample of ten million times, in any order, is as good
    flights = flights_of([case('any box 1')])
    random = np.random.default_rng(3)
    times = random.uniform(0.0, 1e7 / 240, 20_000)
    quaternion = poses_at_times(flights, 0, times)[1]
    assert abs((quaternion * quaternion).sum(axis=0) - 1).max() < 2e-15
    before = flights.motion(0, 30.0)
    for time in times[:1000].tolist():
        flights.motion(0, time)
        flights.poses(time)
    assert flights.motion(0, 30.0) == before


@pytest.mark.parametrize('size', [1e-3, 1.0, 1e3])
def test_scale_of_the_body_does_not_matter(size):
    # mass grows as size^3, moments as size^5; rates and so attitudes stay
    one = case('any box 3')
    scaled = dict(one, moments=[moment * size ** 5 for moment in one['moments']])
    quaternion = flights_of([scaled]).motion(0, one['time'])[1]
    assert angle_error(quaternion, one['result']) < rounding_of(one)


@pytest.mark.parametrize('factor', [1e-200, 1e-30, 1e6])
def test_scale_of_the_rate_does_not_matter(factor):
    # w(t) of a free body has the scale of time as its only one
    one = case('any box 3')
    rate = [component * factor for component in one['rate']]
    flights = flights_of([dict(one, rate=rate)])
    quaternion = flights.motion(0, one['time'] / factor)[1]
    assert angle_error(quaternion, one['result']) < 3 * rounding_of(one)


def test_zero_rate_stays_at_rest():
    flights = flights_of([dict(case('any box 3'), rate=(0.0, 0.0, 0.0))])
    assert flights.velocities(1e9)[1].tolist() == [[0]] * 3
    assert flights.poses(1e9)[1].tolist() == flights.poses(0.0)[1].tolist()


@pytest.mark.parametrize('axis', range(3))
def test_rotation_exactly_about_a_principal_axis_stays_there_for_ever(axis):
    rate = np.zeros(3)
    rate[axis] = -2.0
    flights = Flights(np.array([BOX_1_2_3]).T)
    begin_one(flights, 0, 0.0, angular_velocity=rate)
    _, quaternion, _, now = flights.motion(0, 1e4)
    assert now == tuple(rate)
    expected = np.zeros(4)
    expected[axis], expected[3] = np.sin(-1e4), np.cos(-1e4)
    assert abs(quaternion - expected).max() < 1e-14


def test_the_two_forms_meet():
    # one body on either side of the border between the forms; the motion is continuous there
    def bodies(departure):
        rate = (departure, 3.0, 0.02)
        return polhode_of_one(BOX_1_2_3, rate).complementary, rate
    low, high = 0.0, 3.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if bodies(middle)[0] < 0.03 else (low, middle)
    below, above = sorted((bodies(low), bodies(high)))
    assert below[0] < 0.03 <= above[0]
    results = []
    for _, rate in (below, above):
        flights = Flights(np.array([BOX_1_2_3]).T)
        begin_one(flights, 0, 0.0, angular_velocity=rate)
        results.append(poses_at_times(flights, 0, np.linspace(0, 20, 50))[1])
    assert rotation.angle_between(*results).max() < 1e-13


def test_rates_are_the_derivative_of_the_attitude():
    flights = flights_of(cases('any box', 'top', 'order'))
    step = 1e-4
    for time in (0.5, 3.0):
        a, b, c, d = (flights.poses(time + shift * step)[1] for shift in (-2, -1, 1, 2))
        derivative = ((a - d) / 12 + (c - b) * 2 / 3) / step
        rate = 2 * rotation.multiply(derivative, rotation.conjugate(flights.poses(time)[1]))[:3]
        # five points: an error of step^4 times the fifth derivative
        assert abs(rate - flights.velocities(time)[1]).max() < 1e-9


@pytest.mark.parametrize('count', [1, 40])
def test_a_body_may_change_its_form_and_back(count):
    # near the middle axis the form is hyperbolic, else trigonometric; the last begun counts
    moments = np.repeat(np.array([BOX_1_2_3]).T, count, axis=1)
    zero, identity = np.zeros((3, count)), np.zeros((4, count))
    identity[3] = 1.0
    flights, indices = Flights(moments), np.arange(count)
    for rate in ((1e-4, 2.0, 1e-4), (2.0, 0.5, 0.3), (1e-3, -2.0, 1e-4), (0.3, 0.1, 3.0)):
        columns = np.repeat(np.array([rate]).T, count, axis=1)
        flights.begin(indices, 0.0, zero, identity, zero, columns, zero, zero)
        alone = Flights(moments[:, :1])
        begin_one(alone, 0, 0.0, angular_velocity=rate)
        expected = np.array(alone.motion(0, 3.0)[1])
        assert abs(flights.poses(3.0)[1].T - expected).max() < 1e-14
        assert flights.poses(3.0, indices[:1])[1].shape == (4, 1)
        assert abs(flights.motion(0, 3.0)[1] - expected).max() < 1e-14


def test_tiny_rates_of_many():
    count = 30
    one = case('any box 3')
    rows = [dict(one, rate=[component * 1e-200 for component in one['rate']])] * count
    quaternion = flights_of(rows).poses(one['time'] * 1e200)[1]
    assert angle_error(quaternion[:, 7], one['result']) < 3 * rounding_of(one)
