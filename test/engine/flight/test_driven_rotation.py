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

"""Rotation under constant torque against stored digits, the momentum it must have, and itself."""

import numpy as np
import pytest
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.flight.driven_rotation import KEPT_STATES

from rotating import (  # noqa: I100
    angle_error, begin_one, case, cases, flights_of, momentum_and_energy, poses_at_times,
    random_quaternions)

TOLERANCES = {'driven cube': 1e-14, 'driven cube, torque down': 1e-14, 'driven cube, fast': 5e-14,
              'driven box': 2e-13, 'driven box, weak': 2e-13, 'driven box from rest': 2e-13,
              'driven rod': 2e-13}


@pytest.mark.parametrize('name', TOLERANCES)
def test_attitude_after_ten_seconds(name):
    one = case(name)
    copies = 20
    alone, together = flights_of([one]), flights_of([one], copies)
    for quaternion in (alone.motion(0, 10.0)[1],
                       alone.poses(10.0)[1][:, 0],
                       poses_at_times(alone, 0, np.array([3.0, 10.0]))[1][:, 1],
                       *together.poses(10.0)[1].T):
        assert angle_error(quaternion, one['result']) < TOLERANCES[name]


@pytest.mark.parametrize('one', cases('driven box', 'driven cube'), ids=lambda one: one['name'])
def test_momentum_is_torque_times_time(one):
    copies = 12
    alone, together = flights_of([one]), flights_of([one], copies)
    moments = np.array(one['moments'])[:, None]
    start, _ = momentum_and_energy(moments, alone.poses(0.0)[1], alone.velocities(0.0)[1])
    torque = np.array(one['torque'])[:, None]
    for time in (0.0, 0.4, 3.0, 10.0, 2.0):
        for flights in (alone, together):
            momentum, _ = momentum_and_energy(
                moments, flights.poses(time)[1], flights.velocities(time)[1])
            expected = start + torque * time
            assert abs(momentum - expected).max() <= 3e-13 * abs(expected).max()
        rate = alone.motion(0, time)[3]
        assert abs(np.array(rate) - together.velocities(time)[1][:, 5]).max() < 1e-12 * (
            1 + abs(np.array(rate)).max())


@pytest.mark.parametrize('one', cases('driven box', 'driven cube'), ids=lambda one: one['name'])
def test_what_was_asked_before_does_not_matter(one):
    times = np.linspace(0.0, 10.0, 41)
    forward, backward, scattered = (flights_of([one]) for _ in range(3))
    expected = [forward.motion(0, time) for time in times.tolist()]
    assert [backward.motion(0, time) for time in times[::-1].tolist()][::-1] == expected
    order = np.random.default_rng(4).permutation(len(times))
    for place in order.tolist():
        quaternion = scattered.poses(times[place])[1][:, 0]
        assert abs(quaternion - expected[place][1]).max() < 1e-14
    together = poses_at_times(forward, 0, times[order])[1]
    assert abs(together - np.array([expected[place][1] for place in order]).T).max() < 1e-14


def test_strides_join_and_series_end_in_time():
    # half way between, a series cut too early or a stride too long would show
    random = np.random.default_rng(5)
    count = 40
    quaternion = random_quaternions(random, count)
    zero = np.zeros((3, count))
    for moments in ((0.25,) * 3, (1.0, 2.0, 2.5)):
        columns = np.repeat(np.array(moments)[:, None], count, axis=1)
        rate = random.normal(size=(3, count)) * np.geomspace(1e-6, 50, count)
        torque = random.normal(size=(3, count)) * np.geomspace(20, 1e-9, count)
        flights, later = Flights(columns), Flights(columns)
        flights.begin(np.arange(count), 0.0, zero, quaternion, zero, rate, zero, torque)
        # the same motion begun anew on its way: other strides
        middle = 0.37
        later.begin(np.arange(count), middle, zero, flights.poses(middle)[1], zero,
                    flights.velocities(middle)[1], zero, torque)
        for time in (0.5, 1.0):
            angle = rotation.angle_between(flights.poses(time)[1], later.poses(time)[1])
            assert angle.max() < 1e-12


@pytest.mark.parametrize('moments', [(2.0, 2.0, 2.0), (2.0, 3.0, 4.0)])
def test_scales_of_time_and_body_do_not_matter(moments):
    # t -> t / s, w -> s w, torque -> s^2 m torque, moment -> m moment
    rate, torque = np.array((0.5, -1.0, 0.7)), np.array((1.0, 0.2, -0.4))
    results = []
    for speed, size in ((1.0, 1.0), (1e-30, 1e-15), (1e4, 1e12), (2.0 ** -300, 2.0 ** 100)):
        flights = Flights(np.array([moments]).T * size)
        begin_one(flights, 0, 0.0, angular_velocity=rate * speed,
                  torque=torque * speed ** 2 * size)
        results.append(flights.motion(0, 5.0 / speed)[1])
    assert abs(np.array(results) - results[0]).max() < 2e-13


@pytest.mark.parametrize('copies', [1, 9])
def test_a_long_flight_takes_no_more_memory_and_its_beginning_is_not_lost(copies):
    one = case('driven box, weak')
    flights, fresh = flights_of([one], copies), flights_of([one], copies)
    most = 0
    for time in np.arange(0.0, 15.0, 0.2).tolist():
        flights.poses(time)
        most = max([most, *(len(chain.states) for rotations in flights._present
                            for chain in rotations._chains.values())])
    # of about 110, and a few ahead
    assert KEPT_STATES / 2 < most < KEPT_STATES + 10
    for time in (1.3, 14.9, 8.0):
        np.testing.assert_array_equal(flights.poses(time)[1], fresh.poses(time)[1])
    times = np.array([0.0, 14.9])
    np.testing.assert_array_equal(poses_at_times(flights, 0, times)[1],
                                  poses_at_times(fresh, 0, times)[1])


def test_a_tiny_torque_joins_the_free_rotation():
    # the angle made by a torque alone is at most torque t^2 / (2 moment)
    for moments in ((1.0, 1.0, 1.0), (1.0, 2.0, 2.5)):
        flights = Flights(np.array([moments, moments]).T)
        rate = (1.0, -2.0, 0.7)
        begin_one(flights, 0, 0.0, angular_velocity=rate)
        begin_one(flights, 1, 0.0, angular_velocity=rate, torque=(1e-18, 2e-18, -1e-18))
        quaternion = flights.poses(6.0)[1]
        assert rotation.angle_between(quaternion[:, :1], quaternion[:, 1:]).max() < 1e-13


@pytest.mark.parametrize('copies', [1, 20])
@pytest.mark.parametrize('moments', [(1e-8,) * 3, (1e-8, 2e-8, 2.5e-8)])
def test_a_rotation_too_fast_to_follow_is_refused_and_not_followed(moments, copies):
    # a newton metre on a cube of a centimetre: a billion radians in seconds
    one = {'moments': moments, 'quaternion': (0.0, 0.0, 0.0, 1.0), 'rate': (0.1, 0.2, 0.3),
           'torque': (1.0, 0.0, 0.0)}
    flights = flights_of([one], copies)
    assert np.isfinite(flights.poses(1e-4)[1]).all()
    with pytest.raises(OverflowError, match='too fast to be followed to 100.0 s'):
        flights.poses(100.0)


@pytest.mark.filterwarnings('ignore:invalid value')
def test_what_is_not_a_number_ends():
    for moments in ((1.0, 1.0, 1.0), (1.0, 2.0, 2.5)):
        for torque in ((0.0, 0.0, 0.0), (np.nan, 0.0, 0.0)):
            one = {'moments': moments, 'quaternion': (0.0, 0.0, 0.0, 1.0),
                   'rate': (np.nan, 0.2, 0.3), 'torque': torque}
            for copies in (1, 20):
                assert np.isnan(flights_of([one], copies).poses(1.0)[1]).any()
