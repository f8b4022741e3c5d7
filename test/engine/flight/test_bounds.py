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

"""Bounds of rates and accelerations hold on every flight, and are not wastefully wide."""

from hypothesis import example, given, settings
from hypothesis import strategies
import numpy as np
import pytest
from rigid_sim_ros.engine.flight import Flights

from rotating import begin_one  # noqa: I100

SIZES = strategies.floats(-1.0, 1.0)
VECTORS = strategies.tuples(SIZES, SIZES, SIZES)
MOMENTS = strategies.one_of(
    strategies.just((1.0, 1.0, 1.0)),
    strategies.tuples(*[strategies.sampled_from((0.01, 0.5, 1.0, 1.0 + 1e-9, 2.0))] * 3),
    strategies.tuples(*[strategies.floats(0.05, 5.0)] * 3))
INDEX = np.array([0])


def flight(moments, rate, torque, scale):
    """Return flights of one body begun at 1 s."""
    flights = Flights(np.array([moments]).T)
    begin_one(flights, 0, 1.0, orientation=(0.5, -0.5, 0.1, 0.7),
              angular_velocity=np.array(rate) * scale, torque=np.array(torque) * scale)
    return flights


@settings(max_examples=100, deadline=None)
@given(MOMENTS, VECTORS, VECTORS, strategies.sampled_from((1e-3, 1.0, 5.0)),
       strategies.booleans(), strategies.floats(0.0, 2.0), strategies.floats(0.01, 2.0))
@example((0.01, 0.01, 0.5), (0.0, 0.0, 0.0), (0.0, 0.0, 2e-302), 1e-3, True, 0.0, 1.0)
@example((1.0, 1.0, 1.0), (0.0, 0.0, 1.4722296174008987e-157), (0.0, 0.0, 0.0), 1e-3, False, 0.0,
         1.0)
def test_no_rate_and_no_acceleration_exceeds_its_bound(
        moments, rate, torque, scale, driven, begin, duration):
    flights = flight(moments, rate, torque if driven else (0.0, 0.0, 0.0), scale)
    start, end = 1.0 + begin, 1.0 + begin + duration
    rate_bound = flights.rate_bound(INDEX, start, end)[0]
    derivative_bound = flights.rate_derivative_bound(INDEX, start, end)[0]
    times = np.linspace(start, end, 60)
    rates = np.array([flights.motion(0, time)[3] for time in times.tolist()])
    sizes = np.sqrt((rates * rates).sum(axis=1))
    # where a tiny moment meets a large one, computed rates carry a rounding of their own
    # and squares of what is smaller still are no numbers
    slack = max(1e-12 * sizes.max() * max(moments) / min(moments), 1e-150)
    assert sizes.max() <= rate_bound + slack
    # the mean derivative between two samples is no larger than the largest in between
    steps = np.sqrt((np.diff(rates, axis=0) ** 2).sum(axis=1)) / np.diff(times)
    assert steps.max() <= derivative_bound + 4 * slack / (times[1] - times[0])


@pytest.mark.parametrize('moments, rate', [
    ((1.0, 1.0, 1.0), (1.0, 2.0, 3.0)), ((1.0, 2.0, 2.5), (1.0, 2.0, 3.0)),
    ((1.0, 2.0, 2.5), (0.1, 3.0, 0.1)), ((0.01, 1.0, 1.0), (1.0, 2.0, 3.0)),
    ((2.0, 2.0, 1.0), (1.0, 2.0, 3.0))])
def test_without_torque_bounds_are_reached(moments, rate):
    flights = flight(moments, rate, (0.0, 0.0, 0.0), 1.0)
    times = np.linspace(1.0, 30.0, 4001)
    rates = np.array([flights.motion(0, time)[3] for time in times.tolist()])
    largest = np.sqrt((rates * rates).sum(axis=1)).max()
    assert flights.rate_bound(INDEX, 1.0, np.inf)[0] == pytest.approx(largest, rel=1e-3)
    steps = np.sqrt((np.diff(rates, axis=0) ** 2).sum(axis=1)).max() / (times[1] - times[0])
    assert flights.rate_derivative_bound(INDEX, 1.0, np.inf)[0] == pytest.approx(
        steps, rel=1e-3, abs=1e-12)


def test_equal_moments_have_exact_bounds():
    flights = flight((2.0, 2.0, 2.0), (3.0, 0.0, 4.0), (0.0, 0.0, 0.0), 1.0)
    assert flights.rate_bound(INDEX, 1.0, 9.0)[0] == pytest.approx(5.0, rel=1e-11)
    assert flights.rate_derivative_bound(INDEX, 1.0, 9.0)[0] == 0.0
    for torque, largest in (((0.0, 2.0, 0.0), np.hypot(5, 3)), ((1.5, 0.0, 2.0), 5 + 1.25 * 3)):
        flights = flight((2.0, 2.0, 2.0), (3.0, 0.0, 4.0), torque, 1.0)
        assert flights.rate_bound(INDEX, 2.0, 4.0)[0] == pytest.approx(largest, rel=1e-11)
        assert flights.rate_derivative_bound(INDEX, 2.0, 4.0)[0] == pytest.approx(
            np.linalg.norm(torque) / 2, rel=1e-11)


def test_a_weak_torque_hardly_widens_the_bound():
    rate = (1.0, 2.0, 3.0)
    free = flight((1.0, 2.0, 2.5), rate, (0.0, 0.0, 0.0), 1.0)
    driven = flight((1.0, 2.0, 2.5), rate, (1e-9, 0.0, 1e-9), 1.0)
    bounds = [flights.rate_bound(INDEX, 1.0, 3.0)[0] for flights in (free, driven)]
    assert bounds[0] <= bounds[1] * (1 + 1e-12) < 1.2 * bounds[0]


@pytest.mark.parametrize('moments', [(1.0, 1.0, 1.0), (1.0, 2.0, 2.5)])
@pytest.mark.parametrize('rate', [(1.0, 0.0, 0.0), (1.0, 2.0, 3.0)])
def test_for_ever_under_torque_there_is_no_bound(moments, rate):
    flights = flight(moments, rate, (1.0, 0.0, 0.0), 1.0)
    assert flights.rate_bound(INDEX, 1.0, np.inf)[0] == np.inf
    assert np.isfinite(flights.rate_bound(INDEX, 1.0, 100.0)[0])


def test_each_body_has_its_own_interval():
    flights = Flights(np.array([[1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 2.5, 1.0]]))
    for body in range(3):
        begin_one(flights, body, 0.0, angular_velocity=(0.5, 0.0, 0.1 * body),
                  torque=(1.0 if body < 2 else 0.0, 0.2, 0.0))
    indices = np.array([2, 0, 1])
    start, end = np.array([0.5, 1.0, 2.0]), np.array([1.0, 3.0, 5.0])
    for bound in (flights.rate_bound, flights.rate_derivative_bound):
        together = bound(indices, start, end)
        for place, body in enumerate(indices):
            single = bound(np.array([body]), start[place], end[place])
            assert together[place] == pytest.approx(single[0], rel=1e-14)


@pytest.mark.parametrize('moments', [(1.0, 1.0, 1.0), (1.0, 2.0, 2.5)])
@pytest.mark.parametrize('torque', [(0.0, 0.0, 0.0), (0.3, 0.0, 0.1), (-3.0, -6.0, -9.0)])
def test_bounds_of_one_are_those_of_many(moments, torque):
    flights = flight(moments, (1.0, 2.0, 3.0), torque, 0.5)
    for start, end in ((1.0, 1.0), (1.25, 1.5), (2.0, 30.0)):
        rate, derivative = flights.bounds_of_one(0, start, end)
        assert rate == pytest.approx(flights.rate_bound(INDEX, start, end)[0], rel=1e-14)
        assert derivative == pytest.approx(
            flights.rate_derivative_bound(INDEX, start, end)[0], rel=1e-14)
