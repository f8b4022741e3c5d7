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

"""Real tosses: the start fitted to the flight, the scores and the choice of parameters."""

import numpy as np
import pytest
from rigid_sim_ros.benchmark.errors import BenchmarkError
from rigid_sim_ros.benchmark.tosses.data import read_tosses, Toss
from rigid_sim_ros.benchmark.tosses.fitting import best_fit
from rigid_sim_ros.benchmark.tosses.flight_fit import (
    fitted_start, flight_sample_count, left_jacobian, lowest_corner, rotation_matrix)
from rigid_sim_ros.benchmark.tosses.scores import Score, score, summary, upper_face
from scipy.spatial.transform import Rotation

EDGE, GRAVITY = 0.1, 9.81
VELOCITY, SPIN = np.array([1.0, 0.2, 0.3]), np.array([5.0, -3.0, 2.0])
START = np.array([0.0, 0.1, 0.4])
ATTITUDE = Rotation.from_rotvec([0.3, 0.2, -0.1])


def flying_toss(noise=0.0, count=60):
    """Return a toss that is in flight and then goes on below the board, as no cube can."""
    random = np.random.default_rng(2)
    times = np.arange(count) / 148
    position = START + np.outer(times, VELOCITY) + np.outer(times ** 2, [0, 0, -GRAVITY / 2])
    attitude = Rotation.from_rotvec(np.outer(times, SPIN)) * ATTITUDE
    turn = Rotation.from_rotvec(noise * random.normal(size=(count, 3)))
    return Toss(times, position + noise * random.normal(size=(count, 3)),
                (turn * attitude).as_quat(), EDGE, 0.37, 0.0008, GRAVITY)


def angle_between(quaternion, rotation):
    return (Rotation.from_quat(quaternion) * rotation.inv()).magnitude()


def test_start_of_an_exact_flight_is_found():
    start = fitted_start(flying_toss())
    np.testing.assert_allclose(start.position, START, atol=1e-13)
    np.testing.assert_allclose(start.velocity, VELOCITY, atol=1e-12)
    np.testing.assert_allclose(start.spin, SPIN, atol=1e-11)
    assert angle_between(start.orientation, ATTITUDE) < 1e-12


def test_noise_of_samples_is_averaged():
    noise = 1e-4
    start = fitted_start(flying_toss(noise))
    count = flight_sample_count(flying_toss())
    # a line through n points has 2 sigma / sqrt(n) at its end and sqrt(12 / n) sigma / T in slope
    assert np.abs(start.position - START).max() < 3 * 2 * noise / np.sqrt(count)
    assert np.abs(start.spin - SPIN).max() < 3 * np.sqrt(12 / count) * noise / (count / 148)


def test_flight_ends_before_the_first_touch():
    toss = flying_toss()
    count = flight_sample_count(toss)
    corners = EDGE / 2 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    lowest = [(Rotation.from_quat(quaternion).apply(corners) + place)[:, 2].min()
              for place, quaternion in zip(toss.position, toss.orientation)]
    np.testing.assert_allclose(lowest_corner(toss.position, toss.orientation, EDGE), lowest,
                               atol=1e-15)
    assert min(lowest[:count]) >= 0.002 > lowest[count]


def test_jacobian_is_that_of_the_exponential():
    vector, change = np.array([0.7, -1.1, 0.4]), 1e-7 * np.array([1.0, 2.0, -0.5])
    turned = rotation_matrix(left_jacobian(vector) @ change) @ rotation_matrix(vector)
    # second order in the change
    np.testing.assert_allclose(rotation_matrix(vector + change), turned, atol=1e-13)
    np.testing.assert_allclose(left_jacobian(1e-9 * vector), np.eye(3), atol=1e-8)


def test_score_is_in_percent_of_the_width_and_in_degrees():
    toss = flying_toss(count=10)
    moved = toss.position + [0.0, 0.3 * EDGE, 0.4 * EDGE]
    quarter = (Rotation.from_euler('x', 90, degrees=True)
               * Rotation.from_quat(toss.orientation)).as_quat()
    assert score(toss, moved, toss.orientation) == Score(pytest.approx(50.0), pytest.approx(0.0),
                                                         True)
    turned = score(toss, toss.position, quarter)
    assert turned.position_percent == 0.0
    assert turned.rotation_degrees == pytest.approx(90.0)
    assert not turned.right_face


@pytest.mark.parametrize('euler, face', [
    ((0, 0, 30), (2, True)), ((180, 0, 0), (2, False)), ((90, 0, 0), (1, True)),
    ((0, 90, 0), (0, False))])
def test_face_that_is_up(euler, face):
    assert upper_face(Rotation.from_euler('xyz', euler, degrees=True).as_quat()) == face


def test_best_parameters_are_found_and_scored_on_the_other_half():
    def scores(position):
        return [Score(position + 0.01 * number, 10.0, number % 2 == 0) for number in range(20)]

    tried = [({'friction': friction}, scores(position))
             for friction, position in ((0.1, 15.0), (0.2, 12.0), (0.3, 14.0))]
    fit = best_fit(tried)
    assert fit.parameters == {'friction': 0.2}
    assert fit.fitted == pytest.approx((12.095, 10.0, 50.0))
    # every half chooses the same, so the mean over all halves is the mean over all
    assert fit.unseen == pytest.approx(fit.fitted)
    assert summary(tried[0][1])[0] == pytest.approx(15.095)


def test_parameters_that_suit_single_tosses_do_worse_on_unseen_ones():
    random = np.random.default_rng(0)
    tried = [({'friction': number}, [Score(value, 0.0, True)
                                     for value in random.exponential(10.0, 10)])
             for number in range(40)]
    fit = best_fit(tried)
    assert fit.unseen[0] > fit.fitted[0]


def write(path, **changes):
    toss = flying_toss()
    arrays = {'offset': [0, 20, 60], 't': toss.times, 'position': toss.position * 0.978,
              'quaternion': toss.orientation[:, [3, 0, 1, 2]], 'edge_m': EDGE, 'mass_kg': 0.37,
              'inertia_kg_m2': 0.0008, 'gravity_m_s2': GRAVITY, **changes}
    np.savez(path, **{name: value for name, value in arrays.items() if value is not None})
    return path


def test_tosses_are_read_with_true_lengths(tmp_path):
    first, second = read_tosses(write(tmp_path / 'tosses.npz'))
    whole = flying_toss()
    assert (len(first.times), len(second.times)) == (20, 40)
    assert second.times[0] == 0.0
    np.testing.assert_allclose(second.position, whole.position[20:], rtol=1e-14)
    np.testing.assert_array_equal(first.orientation, whole.orientation[:20])


def test_missing_array_and_other_files_are_refused(tmp_path):
    with pytest.raises(BenchmarkError, match="no array 'edge_m'; needed: offset, t, position"):
        read_tosses(write(tmp_path / 'tosses.npz', edge_m=None))
    with pytest.raises(BenchmarkError, match='has arrays of other shapes'):
        read_tosses(write(tmp_path / 'tosses.npz', quaternion=np.ones((3, 2))))
    other = tmp_path / 'other.npz'
    other.write_text('something else')
    with pytest.raises(BenchmarkError, match='is not an archive of tosses'):
        read_tosses(other)
    with pytest.raises(BenchmarkError, match='No such file'):
        read_tosses(tmp_path / 'none.npz')
