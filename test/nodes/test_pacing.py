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

"""The schedule on a made-up clock: expected times are arithmetic on the rate and the factor."""

from fractions import Fraction

import pytest
from rigid_sim_ros.nodes.pacing import (
    CATCH_UP_SPEED, MOST_LATENESS, NANOSECONDS, Pacer, PublishGrid)

MILLISECOND = 1_000_000


def test_due_times_follow_the_factor():
    pacer = Pacer(real_time_factor=2.0, period=0.01)
    pacer.anchor(5 * NANOSECONDS, now=100.0)
    # one simulated second takes half a second
    assert pacer.due(6 * NANOSECONDS) == 100.5


def test_factor_zero_is_always_due_and_never_late():
    pacer = Pacer(real_time_factor=0.0, period=0.01)
    pacer.anchor(0, now=100.0)
    pacer.published(10 * MILLISECOND, begun=500.0, now=500.0)
    assert pacer.due(NANOSECONDS) < 100.0
    assert (pacer.missed_deadlines, pacer.time_given_up) == (0, 0.0)


@pytest.mark.parametrize('cost', [0.0, 0.003, 0.007])
def test_short_stall_is_caught_up_at_no_more_than_the_catch_up_speed(cost):
    period = 0.01
    pacer = Pacer(1.0, period)
    pacer.anchor(0, now=0.0)
    number, now, published = 0, 0.0, []
    stalled = False
    while now < 3.0:
        number += 1
        begun = now = max(now, pacer.due(number * 10 * MILLISECOND))
        if now >= 0.5 and not stalled:
            now, stalled = now + 0.4, True
        now += cost
        pacer.published(number * 10 * MILLISECOND, begun, now)
        published.append(now)
    # a few states follow the stall at once, the others at the catch-up speed
    few = 3
    for first, later in zip(published, published[few + 1:]):
        assert later - first >= period / CATCH_UP_SPEED - 1e-12
    assert published[50 + 20 + few] - published[50] >= 20 * period / CATCH_UP_SPEED - 1e-12
    # caught up: the last states are on time again, and no state was left out
    assert published[-1] == pytest.approx(number * period + cost)
    # late by 0.4 s and the cost at the stall, then less by what each state gains, down to one
    # period: 0.40, 0.395, ..., 0.015 if they cost nothing; earlier by what the few gained
    expected = (0.4 + cost - period) / (period - max(cost, period / CATCH_UP_SPEED))
    assert expected - few - 1 <= pacer.missed_deadlines <= expected + 3
    assert pacer.time_given_up == 0.0


@pytest.mark.parametrize('late, cost', [(0.002, 0.007), (0.009, 0.002)])
def test_states_that_begin_late_and_take_long_are_caught_up(late, cost):
    period = 0.01
    pacer = Pacer(1.0, period)
    pacer.anchor(0, now=0.0)
    # behind from the start, and every wait takes longer than asked for
    now = 0.3
    for number in range(1, 1001):
        due = pacer.due(number * 10 * MILLISECOND)
        begun = now if now >= due else due + late
        now = begun + cost
        pacer.published(number * 10 * MILLISECOND, begun, now)
    assert now <= 1000 * period + late + cost + 1e-9
    assert pacer.time_given_up == 0.0


def test_long_stall_moves_the_schedule_and_says_so():
    pacer = Pacer(1.0, 0.01)
    pacer.anchor(0, now=0.0)
    stall = 60.0
    pacer.published(10 * MILLISECOND, begun=0.01, now=0.01 + stall)
    assert stall > MOST_LATENESS
    assert pacer.time_given_up == pytest.approx(stall)
    assert pacer.due(20 * MILLISECOND) == pytest.approx(0.02 + stall)
    pacer.published(20 * MILLISECOND, begun=0.02 + stall, now=0.02 + stall)
    assert pacer.missed_deadlines == 1
    assert pacer.worst_lateness == pytest.approx(stall)


def test_change_of_factor_goes_on_from_now():
    pacer = Pacer(1.0, 0.01)
    pacer.anchor(0, now=0.0)
    pacer.change(0.5, 0.01, time=NANOSECONDS, now=7.0)
    assert pacer.due(2 * NANOSECONDS) == 9.0


@pytest.mark.parametrize('rate', [0.1, 1.0, 60.0, 100.0, 240.0, 1000.0, 9999.0])
def test_grid_does_not_drift(rate):
    grid = PublishGrid(rate)
    time = 0
    for number in range(1, 2001):
        time = grid.after(time)
        exact = Fraction(number) * NANOSECONDS / Fraction(rate)
        assert abs(time - exact) <= 1


def test_grid_counts_from_its_origin_and_joins_from_between():
    grid = PublishGrid(100.0, origin=3 * MILLISECOND)
    assert grid.after(3 * MILLISECOND) == 13 * MILLISECOND
    assert grid.after(12 * MILLISECOND) == 13 * MILLISECOND
    assert grid.after(13 * MILLISECOND) == 23 * MILLISECOND


def test_grid_is_exact_after_a_year():
    grid = PublishGrid(100.0)
    year = 365 * 86400 * NANOSECONDS
    assert grid.after(year) == year + 10 * MILLISECOND
    assert grid.after(year - 1) == year
