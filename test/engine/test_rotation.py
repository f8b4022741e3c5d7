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

"""Rotations against matrices: products, Rodrigues' formula and known turns."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from rigid_sim_ros.engine import rotation

ROUNDING = 4e-16


@pytest.fixture
def random():
    """Return a generator of its own for each test."""
    return np.random.default_rng(11)


def quaternions(random, count):
    """Return evenly spread unit quaternions, (4, count) (Marsaglia 1972)."""
    q = random.normal(size=(4, count))
    return q / np.linalg.norm(q, axis=0)


def rodrigues(vector):
    """Return the matrix of a turn about a vector by its length, without quaternions."""
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(angle) * k + (1 - cos(angle)) * k @ k


def test_a_quarter_turn_about_z_takes_x_to_y():
    q = np.array([[0.0], [0.0], [sqrt(0.5)], [sqrt(0.5)]])
    assert np.allclose(rotation.rotate(q, np.eye(3)), [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
                       atol=ROUNDING)
    assert np.allclose(rotation.matrix(q)[..., 0], [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
                       atol=ROUNDING)


def test_the_matrix_rotates_as_the_quaternion_does(random):
    q, v = quaternions(random, 50), random.normal(size=(3, 50))
    m = rotation.matrix(q)
    assert m.shape == (3, 3, 50)
    assert abs(rotation.transform(m, v) - rotation.rotate(q, v)).max() < 10 * ROUNDING
    for column in range(50):
        expected = m[..., column] @ v[:, column]
        assert abs(rotation.rotate(q, v)[:, column] - expected).max() < 10 * ROUNDING
        assert abs(m[..., column] @ m[..., column].T - np.eye(3)).max() < 6 * ROUNDING
        assert np.linalg.det(m[..., column]) == pytest.approx(1, abs=6 * ROUNDING)


def test_the_transposed_matrix_is_the_inverse_rotation(random):
    q, v = quaternions(random, 50), random.normal(size=(3, 50))
    back = rotation.transform_transposed(rotation.matrix(q), rotation.rotate(q, v))
    assert abs(back - v).max() < 10 * ROUNDING
    assert abs(rotation.rotate(rotation.conjugate(q), rotation.rotate(q, v)) - v).max() < 1e-14


def test_a_product_is_the_second_rotation_then_the_first(random):
    p, q = quaternions(random, 20), quaternions(random, 20)
    matrices = rotation.matrix(rotation.multiply(p, q))
    for column in range(20):
        expected = rotation.matrix(p)[..., column] @ rotation.matrix(q)[..., column]
        assert abs(matrices[..., column] - expected).max() < 5 * ROUNDING


def test_a_product_with_the_conjugate_is_the_identity(random):
    q = quaternions(random, 20)
    identity = np.array([[0.0], [0], [0], [1]])
    assert abs(rotation.multiply(q, rotation.conjugate(q)) - identity).max() < ROUNDING


def test_normalize_keeps_the_direction(random):
    q = quaternions(random, 20)
    assert abs(rotation.normalize(q * random.uniform(0.1, 10, 20)) - q).max() < ROUNDING


@pytest.mark.parametrize('size', [1e-200, 1e-9, 1e-3, 1.0, pi, 5.0, 100.0])
def test_a_rotation_vector_turns_by_its_length_about_itself(random, size):
    v = random.normal(size=(3, 20))
    v *= size / np.linalg.norm(v, axis=0)
    q = rotation.from_rotation_vector(v)
    assert abs((q * q).sum(axis=0) - 1).max() < 2 * ROUNDING
    for column in range(20):
        expected = rodrigues(v[:, column]) if size > 1e-100 else np.eye(3)
        assert abs(rotation.matrix(q)[..., column] - expected).max() < 5 * ROUNDING * (1 + size)
    # to first order a small turn is half its vector, to the last digit
    if size < 1e-8:
        assert (q[:3] == 0.5 * v).all()


def test_no_rotation_vector_is_the_identity():
    assert rotation.from_rotation_vector(np.zeros((3, 2))).T.tolist() == [[0, 0, 0, 1]] * 2
    assert rotation.from_rotation_vector((0, 0, 0)).tolist() == [0, 0, 0, 1]


@pytest.mark.parametrize('angles', [(0.3, -1.2, 2.5), (pi, 0.1, 0.0), (-2.0, pi / 2, 1.0)])
def test_roll_pitch_yaw_are_turns_about_fixed_axes_in_this_order(angles):
    roll, pitch, yaw = np.diag(angles)
    expected = np.eye(3)
    for vector in (roll, pitch, yaw):
        if vector.any():
            expected = rodrigues(vector) @ expected
    q = np.array(rotation.from_rpy(*angles))[:, None]
    assert abs(rotation.matrix(q)[..., 0] - expected).max() < 5 * ROUNDING


def test_from_matrix_is_the_inverse_of_matrix(random):
    # among them turns by nearly pi, about each axis, where the scalar part vanishes
    awkward = np.array([[1, 0, 0, 1e-9], [0, 1, 0, -1e-12], [0, 0, 1, 0], [1, 1, 0, 0],
                        [0, 1, 1, 1e-3], [1, 1, 1, 1], [0, 0, 0, 1], [1e-9, 0, 0, 1]]).T
    for q in (*quaternions(random, 50).T, *rotation.normalize(awkward.astype(float)).T):
        back = rotation.from_matrix(rotation.matrix(q[:, None])[..., 0])
        assert back[3] >= 0
        assert min(abs(back - q).max(), abs(back + q).max()) < 3 * ROUNDING


@pytest.mark.parametrize('angle', [0.0, 1e-200, 1e-12, 1e-3, 1.0, 3.0, pi])
def test_the_angle_between_is_that_of_the_turn_even_when_tiny(random, angle):
    q = quaternions(random, 20)
    axis = random.normal(size=(3, 20))
    turn = rotation.from_rotation_vector(axis * (angle / np.linalg.norm(axis, axis=0)))
    identity = np.array([[0.0], [0], [0], [1]]) + np.zeros((4, 20))
    if angle > 1e-100:
        found = rotation.angle_between(identity, turn)
        assert found == pytest.approx(np.full(20, angle), rel=5 * ROUNDING)
        # -q is the same rotation
        assert rotation.angle_between(identity, -turn) == pytest.approx(found, rel=5 * ROUNDING)
    found = rotation.angle_between(q, rotation.multiply(turn, q))
    assert abs(found - angle).max() < 5 * ROUNDING


def test_cross_and_dot(random):
    a, b = random.normal(size=(3, 10)), random.normal(size=(3, 10))
    assert abs(rotation.cross(a, b) - np.cross(a.T, b.T).T).max() < 5 * ROUNDING
    assert abs(rotation.dot(a, b) - np.einsum('ij,ij->j', a, b)).max() < 5 * ROUNDING


def test_trailing_axes_broadcast(random):
    q, v = quaternions(random, 5), random.normal(size=(3, 1))
    assert abs(rotation.rotate(q, v)[:, 3] - rotation.rotate(q[:, 3], v[:, 0])).max() < ROUNDING
    grid = rotation.rotate(q[:, :, None], random.normal(size=(3, 5, 4)))
    assert grid.shape == (3, 5, 4)
    assert rotation.matrix(q[:, 0]).shape == (3, 3)
    assert rotation.matrix(q[:, :, None]).shape == (3, 3, 5, 1)
