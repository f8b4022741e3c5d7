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

"""Times at which bounding spheres meet, against polynomials and closed forms."""

import numpy as np

import pytest

from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.broad_phase import meeting_times
from rigid_sim_ros.engine.broad_phase.meeting import first_fall, first_falls
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.shapes import Sphere


def two_balls_and_a_plane(count=1):
    """Return `Bodies` of 2 count balls of radii 0.5 and 0.25, and a plane at z = 1."""
    return bodies_of(Scene(
        bodies=tuple(Body(f'ball_{number}', Sphere(0.5 if number < count else 0.25), 1.0,
                          (1.0, 1.0, 1.0)) for number in range(2 * count)),
        planes=(Plane('ground', (0.0, 0.0, 1.0), 1.0),)))


def first_root(coefficients):
    """Return the least positive real root of a polynomial, highest power first."""
    roots = np.roots(coefficients)
    real = roots.real[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0)]
    return real.min(initial=np.inf)


def random_motions(rng, count):
    bodies = two_balls_and_a_plane(count)
    columns = bodies.count
    position = rng.normal(size=(3, columns)) * 2
    velocity = rng.normal(size=(3, columns))
    # towards each other, and past
    velocity[:, :count] += position[:, count:-1] - position[:, :count]
    acceleration = np.tile([[0.0], [0], [-2.0]], columns)
    for values in (position, velocity, acceleration):
        values[:, -1] = 0
    return bodies, position, velocity, acceleration


@pytest.mark.parametrize('together', [True, False], ids=['as arrays', 'one by one'])
def test_two_balls_with_the_same_acceleration_meet_at_the_root_of_a_quadratic(together):
    count = 300
    bodies, position, velocity, acceleration = random_motions(np.random.default_rng(1), count)
    a, b = np.arange(count), np.arange(count, 2 * count)
    rows = [slice(None)] if together else [[row] for row in range(count)]
    found = np.concatenate([meeting_times(bodies, a[row], b[row], position, velocity,
                                          acceleration) for row in rows])
    for row in range(count):
        between = position[:, b[row]] - position[:, row]
        relative = velocity[:, b[row]] - velocity[:, row]
        beyond = between @ between - 0.75 ** 2
        expected = first_root([relative @ relative, 2 * between @ relative, beyond])
        assert found[row] == pytest.approx(0.0 if beyond < 0 else expected, rel=1e-9)
    assert 40 < np.isfinite(found).sum() < 260


@pytest.mark.parametrize('together', [True, False], ids=['as arrays', 'one by one'])
def test_a_ball_meets_a_plane_where_its_parabola_does(together):
    count = 200
    bodies, position, velocity, acceleration = random_motions(np.random.default_rng(2), count)
    acceleration[2, :count:2] *= -1
    a, b = np.arange(count), np.full(count, 2 * count)
    rows = [slice(None)] if together else [[row] for row in range(count)]
    # either may come first
    found = np.concatenate([meeting_times(bodies, b[row], a[row], position, velocity,
                                          acceleration) for row in rows])
    for row in range(count):
        height = position[2, row] - 1.5
        expected = first_root([acceleration[2, row] / 2, velocity[2, row], height])
        assert found[row] == pytest.approx(0.0 if height < 0 else expected, rel=1e-9)
    assert np.isinf(found).any()


@pytest.mark.parametrize('together', [True, False], ids=['as arrays', 'one by one'])
def test_with_different_accelerations_the_bound_is_below_the_root_and_near_it(together):
    rng = np.random.default_rng(3)
    count = 300
    bodies, position, velocity, acceleration = random_motions(rng, count)
    acceleration[:, :2 * count] += rng.normal(size=(3, 2 * count))
    a, b = np.arange(count), np.arange(count, 2 * count)
    rows = [slice(None)] if together else [[row] for row in range(count)]
    found = np.concatenate([meeting_times(bodies, a[row], b[row], position, velocity,
                                          acceleration) for row in rows])
    near = 0
    for row in range(count):
        x, u, w = (values[:, b[row]] - values[:, row]
                   for values in (position, velocity, acceleration / 2))
        # |x + u t + w t^2|^2 = R^2
        expected = first_root([w @ w, 2 * u @ w, u @ u + 2 * x @ w, 2 * x @ u,
                               x @ x - 0.75 ** 2])
        assert found[row] <= (0.0 if x @ x < 0.75 ** 2 else expected)
        near += 0 < found[row] < np.inf and found[row] > 0.99 * expected
    assert near > 50


@pytest.mark.parametrize('part', [slice(None), slice(3)], ids=['many', 'few'])
def test_what_is_later_than_asked_for_is_bounded_and_the_rest_as_ever(part):
    count, later = 300, 0.5
    bodies, position, velocity, acceleration = random_motions(np.random.default_rng(3), count)
    acceleration[:, :2 * count] += np.random.default_rng(4).normal(size=(3, 2 * count))
    a, b = np.arange(count), np.arange(count, 2 * count)
    full = meeting_times(bodies, a, b, position, velocity, acceleration)
    # of few that are soon each is looked at by itself
    rows = np.flatnonzero(full <= later)[part]
    rows = np.concatenate((rows, np.flatnonzero(full > later)))
    found = meeting_times(bodies, a[rows], b[rows], position, velocity, acceleration, later)
    soon = full[rows] <= later
    assert found[soon] == pytest.approx(full[rows][soon], rel=1e-9)
    assert (found[~soon] > later).all() and (found <= full[rows] * (1 + 1e-9)).all()
    assert (found < 0.99 * full[rows]).any()


def test_a_graze_by_less_than_rounding_counts_as_meeting():
    bodies = two_balls_and_a_plane()
    position = np.array([[0.0, 0, 0], [1e6, 0.75, 0], [0, 0, 0]]).T
    velocity = np.array([[1e3, 0, 0], [0, 0, 0], [0, 0, 0]]).T
    args = (np.array([0]), np.array([1]), position, velocity, np.zeros((3, 3)))
    assert meeting_times(bodies, *args) == pytest.approx([1e3], rel=1e-5)
    position[1, 1] = 0.75 + 1e-4
    assert meeting_times(bodies, *args) == [np.inf]


@pytest.mark.parametrize('speed, acceleration, expected', [
    # 2 u / g from next to nothing: a ball that has just rebounded is not to fall through the floor
    (4.4726, -100.0, 2 * 4.4726 / 100), (4.4726, 0.0, np.inf), (4.4726, 1.0, np.inf),
    (0.0, -100.0, np.sqrt(2 * 6e-17 / 100)), (-2.0, -100.0, 3e-17), (-2.0, 100.0, 3e-17)])
def test_falls_from_next_to_nothing_do_not_cancel(speed, acceleration, expected):
    assert first_fall(6e-17, speed, acceleration) == pytest.approx(expected, rel=1e-12)
    found = first_falls(*(np.array([value]) for value in (6e-17, speed, acceleration)))
    assert found[0] == pytest.approx(expected, rel=1e-12)
