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

"""Flights as a whole: parabolas, rotation about axes that stay, and who flies how."""

from fractions import Fraction

import numpy as np
import pytest
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.flight.fixed_axis import BLOCK
from rigid_sim_ros.engine.flight.functions import MANY
from rigid_sim_ros.engine.flight.recycled_arrays import FEWEST, RecycledArrays

from rotating import begin_one, poses_at_times, random_quaternions  # noqa: I100


def assorted(count, seed=0):
    """Return flights of all kinds and the arguments that began them at time 0."""
    random = np.random.default_rng(seed)
    moments = random.uniform(1.0, 2.0, size=(3, count))
    moments[:, ::2] = moments[0, ::2]
    torque = random.normal(size=(3, count))
    torque[:, ::3] = 0.0
    rate = random.normal(size=(3, count))
    rate[:, ::5] = 0.0
    arguments = [random.normal(size=(3, count)), random_quaternions(random, count),
                 random.normal(size=(3, count)), rate, random.normal(size=(3, count)), torque]
    return moments, arguments


def begun(moments, arguments, time=0.0):
    """Return flights with all bodies begun at once."""
    flights = Flights(moments)
    flights.begin(np.arange(moments.shape[1]), time, *arguments)
    return flights


def everything(flights, time):
    """Return all poses and velocities at a time as one array (13, n)."""
    return np.vstack((*flights.poses(time), *flights.velocities(time)))


def test_before_the_first_begin_everything_rests_at_the_origin():
    flights = Flights(np.ones((3, 2)))
    position, orientation = flights.poses(7.0)
    assert position.tolist() == [[0, 0]] * 3
    assert orientation.tolist() == [[0, 0]] * 3 + [[1, 1]]
    assert not np.any(flights.velocities(7.0))
    assert not flights.acceleration.any()
    assert flights.motion(1, 7.0) == ((0, 0, 0), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0))


@pytest.mark.parametrize('time', [0.0, 0.3, 10.0])
def test_centres_follow_parabolas_to_rounding(time):
    random = np.random.default_rng(1)
    count = 20
    moments, arguments = assorted(count)
    start = 1.5
    flights = begun(moments, arguments, start)
    position, _, velocity, _, acceleration, _ = arguments
    now = start + time
    elapsed = Fraction(now) - Fraction(start)
    for body in random.permutation(count)[:8].tolist():
        for axis in range(3):
            x, v, a = (Fraction(values[axis, body]) for values in (
                position, velocity, acceleration))
            exact = x + v * elapsed + a * elapsed * elapsed / 2
            size = abs(x) + abs(v) * elapsed + abs(a) * elapsed * elapsed
            for value in (flights.poses(now)[0][axis, body],
                          flights.translation(now)[0][axis, body],
                          flights.motion(body, now)[0][axis],
                          poses_at_times(flights, body, np.array([now]))[0][axis, 0]):
                assert abs(Fraction(float(value)) - exact) < 4e-16 * size
            exact = v + a * elapsed
            for value in (flights.velocities(now)[0][axis, body],
                          flights.translation(now)[1][axis, body],
                          flights.motion(body, now)[2][axis]):
                assert abs(Fraction(float(value)) - exact) < 4e-16 * (abs(v) + abs(a) * elapsed)
    assert (flights.acceleration == acceleration).all()


def test_equal_moments_turn_at_a_constant_rate():
    random = np.random.default_rng(2)
    count = MANY + 10
    quaternion, rate = random_quaternions(random, count), random.normal(size=(3, count)) * 5
    zero = np.zeros((3, count))
    flights = begun(np.full((3, count), 0.3), [zero, quaternion, zero, rate, zero, zero])
    for time in (0.0, 0.01, 3.0, 10.0):
        expected = rotation.multiply(rotation.from_rotation_vector(rate * time), quaternion)
        limit = 1e-15 + 4e-16 * np.sqrt((rate * rate).sum(axis=0)) * time
        assert (rotation.angle_between(flights.poses(time)[1], expected) < 2 * limit).all()
        few = flights.poses(time, np.arange(5, 9))[1]
        assert (rotation.angle_between(few, expected[:, 5:9]) < 2 * limit[5:9]).all()
        single = np.array(flights.motion(7, time)[1])[:, None]
        assert (rotation.angle_between(single, expected[:, 7:8]) < 2 * limit[7]).all()
        assert (flights.velocities(time)[1] == rate).all()
        assert abs((flights.poses(time)[1] ** 2).sum(axis=0) - 1).max() < 2e-15


@pytest.mark.parametrize('moments, axis, moment', [
    ((0.5, 0.5, 0.5), (0.6, 0.0, -0.8), 0.5), ((1.0, 2.0, 2.5), (0.0, 1.0, 0.0), 2.0)])
@pytest.mark.parametrize('speed', [0.0, 3.0, -3.0])
def test_torque_along_the_axis_makes_the_angle_a_parabola(moments, axis, moment, speed):
    flights = Flights(np.array([moments]).T)
    axis, torque, time = np.array(axis), 0.25, 7.0
    begin_one(flights, 0, 1.0, angular_velocity=axis * speed, torque=axis * torque)
    angle = speed * time + torque / moment * time * time / 2
    expected = rotation.from_rotation_vector((axis * angle)[:, None])
    for quaternion in (flights.poses(1.0 + time)[1],
                       np.array(flights.motion(0, 1.0 + time)[1])[:, None],
                       poses_at_times(flights, 0, np.array([1.0 + time]))[1]):
        assert rotation.angle_between(quaternion, expected).max() < 3e-15 * (1 + abs(angle))
    rate = axis * (speed + torque / moment * time)
    assert abs(flights.velocities(1.0 + time)[1][:, 0] - rate).max() < 3e-15
    assert abs(np.array(flights.motion(0, 1.0 + time)[3]) - rate).max() < 3e-15


def test_a_torque_across_a_tiny_rate_is_not_taken_for_one_along_it():
    # products of components underflow here; the answer is that of rest
    flights = Flights(np.ones((3, 2)))
    begin_one(flights, 0, 0.0, angular_velocity=(1e-320, 0.0, 0.0), torque=(0.0, 1e-5, 0.0))
    begin_one(flights, 1, 0.0, torque=(0.0, 1e-5, 0.0))
    quaternion = flights.poses(100.0)[1]
    assert rotation.angle_between(quaternion[:, :1], quaternion[:, 1:]).max() < 1e-15
    assert rotation.angle_between(quaternion, np.array([[0.0], [0], [0], [1]])).min() > 0.04


def test_begun_together_or_one_by_one_is_the_same():
    count = 60
    moments, arguments = assorted(count)
    together, single = begun(moments, arguments), Flights(moments)
    for body in np.random.default_rng(3).permutation(count):
        single.begin(np.array([body]), 0.0, *(values[:, [body]] for values in arguments))
    for time in (0.0, 0.7, 5.0):
        assert abs(everything(together, time) - everything(single, time)).max() < 1e-12


def test_some_bodies_are_columns_of_all():
    moments, arguments = assorted(50)
    flights = begun(moments, arguments)
    indices = np.array([3, 49, 0, 17, 18, 20, 30])
    for time in (0.0, 0.7, 2.0):
        whole = everything(flights, time)
        some = np.vstack((*flights.poses(time, indices), *flights.velocities(time, indices)))
        assert abs(some - whole[:, indices]).max() < 1e-14
        assert np.array_equal(np.vstack(flights.translation(time, indices)),
                              np.vstack((some[:3], some[7:10])))
        for index in indices.tolist():
            motion = np.concatenate(flights.motion(index, time))
            assert abs(motion - whole[:, index]).max() < 1e-13
            position, orientation = poses_at_times(flights, index, np.array([time, 0.0]))
            assert abs(position[:, 0] - whole[:3, index]).max() < 1e-14
            assert abs(orientation[:, 0] - whole[3:7, index]).max() < 1e-13


def test_bodies_each_at_a_time_of_its_own_and_more_than_once():
    moments, arguments = assorted(60)
    flights = begun(moments, arguments)
    random = np.random.default_rng(8)
    indices = random.integers(60, size=500)
    times = random.uniform(0.0, 4.0, 500)
    times[:20] = 0.0
    together = np.vstack(flights.motions(indices, times))
    for place in random.permutation(500)[:100].tolist() + list(range(20)):
        single = flights.motion(int(indices[place]), times.item(place))
        assert abs(together[:, place] - np.concatenate(single)).max() < 1e-13


def test_more_bodies_than_are_evaluated_at_a_time_move_as_each_does_alone():
    moments, arguments = assorted(BLOCK + 5)
    flights = begun(moments, arguments)
    last = np.arange(BLOCK - 5, BLOCK + 5)
    whole = np.vstack(flights.poses(0.5))
    assert abs(whole[:, last] - np.vstack(flights.poses(0.5, last))).max() < 2e-15


def test_bodies_may_be_listed_more_often_than_there_are():
    moments, arguments = assorted(5)
    flights = begun(moments, arguments)
    indices = np.tile(np.arange(5), 2 * BLOCK // 5)
    whole = np.vstack(flights.poses(0.5))
    assert abs(np.vstack(flights.poses(0.5, indices))[:, -5:] - whole).max() < 2e-15


def test_a_new_flight_replaces_the_old_one_of_any_kind_and_no_other():
    count = 40
    moments, arguments = assorted(count)
    flights = begun(moments, arguments)
    flights.poses(0.1)
    random = np.random.default_rng(6)
    expected = list(arguments)
    for _ in range(30):
        chosen = random.choice(count, size=random.choice((1, 2, 7, 25)), replace=False)
        _, other = assorted(count, seed=int(random.integers(1000)))
        # shuffle what is zero, so that bodies change their kind of flight
        other = [values[:, random.permutation(count)] for values in other]
        expected = [values.copy() for values in expected]
        for values, new in zip(expected, other):
            values[:, chosen] = new[:, chosen]
        flights.begin(chosen, 0.0, *(values[:, chosen] for values in other))
        if random.random() < 0.5:
            flights.poses(random.random())
    fresh = begun(moments, expected)
    for time in (0.0, 1.0):
        assert abs(everything(flights, time) - everything(fresh, time)).max() < 1e-12
    assert (flights.acceleration == expected[4]).all()


def test_every_body_has_its_own_start():
    moments, arguments = assorted(30)
    flights, shifted = begun(moments, arguments), Flights(moments)
    starts = np.arange(30) * 0.25
    for body in range(30):
        shifted.begin(np.array([body]), starts[body], *(values[:, [body]] for values in arguments))
    for body in range(30):
        a, b = flights.motion(body, 3.0), shifted.motion(body, starts[body] + 3.0)
        assert abs(np.concatenate(a) - np.concatenate(b)).max() < 1e-12
    assert abs(shifted.poses(10.0)[0][:, 4] - flights.poses(9.0)[0][:, 4]).max() < 1e-13


def test_at_its_start_a_body_is_as_given():
    moments, arguments = assorted(60)
    # a very thin body: its momentum alone would give the rate about its axis to 8 digits only
    moments[0, 3] = 1e-8 * moments[1, 3]
    arguments[5][:, 3] = 0.0
    arguments[3][:, 3] = (0.3, 0.2, 0.1)
    flights = begun(moments, arguments, 2.0)
    position, orientation = flights.poses(2.0)
    assert (position == arguments[0]).all()
    assert rotation.angle_between(orientation, arguments[1]).max() < 1e-15
    linear, angular = flights.velocities(2.0)
    assert (linear == arguments[2]).all()
    assert abs(angular - arguments[3]).max() < 2e-15
    assert angular[:, 3].tolist() == [0.3, 0.2, 0.1] == list(flights.motion(3, 2.0)[3])


def test_quaternions_are_brought_to_unit_length_at_the_start():
    flights = Flights(np.array([[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]))
    for body in range(2):
        begin_one(flights, body, 0.0, orientation=(0.0, 0.6 * 1.001, 0.0, 0.8 * 1.001),
                  angular_velocity=(1.0, 2.0, 3.0))
    for time in (0.0, 1.0):
        assert abs((flights.poses(time)[1] ** 2).sum(axis=0) - 1).max() < 1e-15


def test_blocks_of_many_bodies_are_evaluated_like_few():
    count = 2 * BLOCK + 5
    moments = np.full((3, count), 0.2)
    random = np.random.default_rng(7)
    arguments = [random.normal(size=(3, count)), random_quaternions(random, count),
                 *(random.normal(size=(3, count)) for _ in range(3)), np.zeros((3, count))]
    flights = begun(moments, arguments)
    position, orientation = flights.poses(3.0)
    indices = np.array([0, 5, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, count - 1])
    few_position, few_orientation = flights.poses(3.0, indices)
    assert abs(position[:, indices] - few_position).max() < 1e-14
    assert abs(orientation[:, indices] - few_orientation).max() < 2e-15


def test_results_stay_while_they_are_held():
    count = 2 * FEWEST
    flights = Flights(np.ones((3, count)))
    zero = np.zeros((3, count))
    quaternion = np.zeros((4, count))
    quaternion[3] = 1.0
    flights.begin(np.arange(count), 0.0, zero, quaternion, zero + 1.0, zero + 1.0, zero, zero)
    held = flights.poses(1.0)
    view = flights.poses(2.0)[0].T[5]
    for time in np.linspace(3.0, 4.0, 20):
        flights.poses(time)
    assert held[0][0, 0] == 1.0
    assert view.tolist() == [2.0] * 3
    expected = rotation.from_rotation_vector(np.ones((3, 1)))
    assert rotation.angle_between(held[1], expected).max() < 1e-15


def test_an_array_is_used_again_only_when_nobody_holds_it():
    arrays = RecycledArrays()
    first = arrays.take(3, FEWEST)
    address = first.ctypes.data
    assert arrays.take(3, FEWEST).ctypes.data != address
    view = first[1:, ::2]
    del first
    assert arrays.take(3, FEWEST).ctypes.data != address
    del view
    assert arrays.take(3, FEWEST).ctypes.data == address
    assert arrays.take(4, FEWEST).shape == (4, FEWEST)
    assert len([arrays.take(3, FEWEST + number) for number in range(20)]) == 20


def test_no_bodies_are_nothing_special():
    moments, arguments = assorted(30)
    flights = begun(moments, arguments)
    none = np.zeros(0, dtype=int)
    flights.begin(none, 0.0, *(values[:, none] for values in arguments))
    assert flights.poses(1.0, none)[1].shape == (4, 0)
    assert flights.velocities(1.0, none)[1].shape == (3, 0)
    assert flights.motions(none, np.zeros(0))[1].shape == (4, 0)
    assert flights.rate_bound(none, 0.0, 1.0).shape == (0,)
    assert Flights(np.zeros((3, 0))).poses(1.0)[0].shape == (3, 0)
