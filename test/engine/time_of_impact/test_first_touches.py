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

"""Instants of first touch, against closed forms and against sampling with bisection."""

from flying import Flying, GRAVITY, touching_contacts

import numpy as np

import pytest

from rigid_sim_ros.engine.rotation import from_rotation_vector, matrix
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.engine.time_of_impact import first_touches

GROUND = [((0.0, 0.0, 1.0), 0.0)]
FALLING = [(0.0, 0.0, -GRAVITY)]


def touch(flying, a=0, b=1, start=0.0, end=10.0, guarded=False):
    """Return the first touch [s] of one pair."""
    return first_touches(flying.bodies, flying.flights, np.array([a]), np.array([b]), start, end,
                         np.array([guarded])).item()


def random_orientations(rng, count):
    q = rng.normal(size=(count, 4))
    return q / np.sqrt((q * q).sum(axis=1, keepdims=True))


@pytest.mark.parametrize('shape, height', [(Cube(0.2), 0.1), (Sphere(0.3), 0.3)])
def test_a_drop_without_spin_lands_at_the_root_of_its_parabola(shape, height):
    flying = Flying([shape], GROUND, position=[(1.0, 2.0, 1.7)], velocity=[(3.0, 0, 0.5)],
                    acceleration=FALLING)
    drop = 1.7 - height
    expected = (0.5 + np.sqrt(0.25 + 2 * GRAVITY * drop)) / GRAVITY
    assert touch(flying) == pytest.approx(expected, rel=1e-15)
    contacts = touching_contacts(flying.bodies, flying.flights, np.array([0]), np.array([1]),
                                 touch(flying))
    assert contacts.count == (4 if height == 0.1 else 1)
    assert np.abs(contacts.separation).max() < 1e-15


def test_a_cube_that_turns_about_an_edge_direction_lands_where_its_support_says():
    # at angle q about y the lowest point is (|cos q| + |sin q|) / 2 below the centre
    flying = Flying([Cube(1.0)], GROUND, position=[(0, 0, 0.9)], velocity=[(0, 0, -0.3)],
                    spin=[(0, 2.0, 0)])
    time = touch(flying)
    times = np.append(np.linspace(0, time - 1e-6, 1000), time)
    height = 0.9 - 0.3 * times - 0.5 * (np.abs(np.cos(2 * times)) + np.abs(np.sin(2 * times)))
    assert (height[:-1] > 0).all()
    assert abs(height[-1]) < 4e-16


def test_two_balls_that_fall_alike_meet_at_the_root_of_a_quadratic():
    flying = Flying([Sphere(0.3), Sphere(0.2)], position=[(0, 0, 0), (2, 0.1, -0.2)],
                    velocity=[(1, 0, 3), (-2, 0, 3)], acceleration=FALLING * 2)
    # |(2, 0.1, -0.2) - (3, 0, 0) t| = 0.5
    expected = (2 - np.sqrt(0.25 - 0.05)) / 3
    assert touch(flying) == pytest.approx(expected, rel=1e-15)


def random_shape(rng, kind):
    size = 10 ** rng.uniform(-0.5, 0)
    if kind == 'sphere':
        return Sphere(0.5 * size)
    if kind == 'cube':
        return Cube(size)
    sides = rng.uniform(0.2, 1, 3)
    if kind == 'plate':
        sides[rng.integers(3)] = 0.01
    elif kind == 'rod':
        sides[np.arange(3) != rng.integers(3)] = 0.01
    return Box(tuple(size * sides))


@pytest.mark.parametrize('kind_a, kind_b', [
    ('cube', 'cube'), ('box', 'box'), ('plate', 'rod'), ('rod', 'rod'), ('sphere', 'cube'),
    ('box', 'sphere'), ('plate', 'sphere'), ('sphere', 'sphere')])
def test_pairs_of_all_shapes_touch_when_sampling_says(kind_a, kind_b):
    rng = np.random.default_rng(len(kind_a) + 7 * len(kind_b))
    pairs = 20
    shapes = [random_shape(rng, kind) for kind in (kind_a, kind_b) for _ in range(pairs)]
    position = rng.normal(size=(2 * pairs, 3))
    away = rng.normal(size=(pairs, 3))
    away *= 1.5 / np.sqrt((away * away).sum(axis=1, keepdims=True))
    position[pairs:] = position[:pairs] + away
    # what is thin is aimed well, and not driven by a torque, which would make it drill
    thin = bool({'rod', 'plate'} & {kind_a, kind_b})
    velocity = (0.01 if thin else 0.3) * rng.normal(size=(2 * pairs, 3))
    velocity[:pairs] += away
    acceleration = np.tile((0, 0, -GRAVITY), (2 * pairs, 1))
    acceleration[::3] += 0.3 * rng.normal(size=(len(acceleration[::3]), 3))
    torque = np.zeros((2 * pairs, 3))
    if not thin:
        torque[::4] = 0.05 * rng.normal(size=(len(torque[::4]), 3))
    flying = Flying(shapes, position=position, velocity=velocity, acceleration=acceleration,
                    spin=3 * rng.normal(size=(2 * pairs, 3)), torque=torque,
                    orientation=random_orientations(rng, 2 * pairs))
    check_against_sampling(flying, np.arange(pairs), np.arange(pairs, 2 * pairs), 1.5)


@pytest.mark.parametrize('kind', ['cube', 'box', 'rod', 'plate', 'sphere'])
def test_shapes_touch_a_plane_when_sampling_says(kind):
    rng = np.random.default_rng(len(kind))
    count = 20
    flying = Flying([random_shape(rng, kind) for _ in range(count)], [((0.0, 0.6, 0.8), -1.0)],
                    position=rng.uniform(0, 1, (count, 3)), velocity=rng.normal(size=(count, 3)),
                    acceleration=FALLING * count, spin=5 * rng.normal(size=(count, 3)),
                    orientation=random_orientations(rng, count))
    check_against_sampling(flying, np.arange(count), np.full(count, count), 0.8)


def check_against_sampling(flying, a, b, end):
    """Compare with bisection; what sampling misses must be a graze, and there are few."""
    found = first_touches(flying.bodies, flying.flights, a, b, 0.0, end, np.zeros(len(a), bool))
    # the order of the two must not matter
    swapped = first_touches(flying.bodies, flying.flights, b, a, 0.0, end, np.zeros(len(a), bool))
    assert swapped == pytest.approx(found, abs=1e-14)
    expected, least = flying.sampled_first_touches(a, b, end, 300)
    touched = np.isfinite(expected) & (expected > 0)
    assert 4 < touched.sum()
    earlier = found < expected - 1e-9
    for pair in np.flatnonzero(earlier):
        # an earlier touch that sampling jumped over: it does touch then, and goes deeper
        times = found[pair] + np.array((0.0, 1e-8))
        here, after = flying.separations(a[pair:pair + 1], b[pair:pair + 1], times)[0]
        assert abs(here) < 1e-14
        assert after < 0
    assert earlier.sum() <= 3
    rest = touched & ~earlier
    # a slow touch is sharp to rounding of the distance over its speed
    assert np.abs(found[rest] - expected[rest]).max() < 1e-13
    assert (np.isinf(found) == np.isinf(expected))[~earlier].all()


@pytest.mark.parametrize('beyond', [1e-6, 1e-10, 1e-13])
def test_a_graze_counts_and_a_near_miss_does_not(beyond):
    # a cube spins in place: its vertices reach sqrt(3)/2 cos(angle) at best, again and again
    axis = np.array((0.3, 1.0, 0.2))
    q = from_rotation_vector(np.array((0.1, 0.2, 0.3)))
    spin = 4 * axis / np.sqrt(axis @ axis)
    unit = spin / 4
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    r = corners @ matrix(q).T
    # the lowest point of a circle: along the axis, less the radius times the slope
    along = (r @ unit) * unit[2]
    across = r - (r @ unit)[:, np.newaxis] * unit
    lowest = (along - np.sqrt((across ** 2).sum(axis=1)) * np.hypot(unit[0], unit[1])).min()
    for height, touches in ((-lowest - beyond, True), (-lowest + beyond, False)):
        flying = Flying([Cube(1.0)], GROUND, position=[(0, 0, height)], spin=[spin],
                        orientation=[q])
        assert np.isfinite(touch(flying, end=20.0)) == touches


def test_a_rebound_is_not_found_again_and_the_next_landing_is_exact():
    flying = Flying([Cube(1.0)], GROUND, position=[(0, 0, 0.5)], velocity=[(0, 0, 2.0)],
                    acceleration=FALLING)
    assert touch(flying, guarded=True) == pytest.approx(4.0 / GRAVITY, rel=1e-15)
    assert touch(flying, guarded=False) == pytest.approx(4.0 / GRAVITY, rel=1e-15)


def test_a_rebound_on_a_box_is_not_found_again():
    flying = Flying([Box((4.0, 4, 1)), Cube(1.0)], position=[(0, 0, 0), (0.3, 0, 1.0 - 1e-16)],
                    velocity=[(0, 0, 0), (0, 0, 2.0)], spin=[(0, 0, 0), (0, 0, 3.0)],
                    acceleration=[(0, 0, 0), (0, 0, -GRAVITY)])
    assert touch(flying, guarded=True) == pytest.approx(4.0 / GRAVITY, rel=1e-14)


def test_another_corner_of_a_guarded_body_lands_at_its_instant():
    # turned by 30 degrees, its lowest edge has just been hit and rises by next to nothing while
    # the cube turns flat
    rate = 0.7
    q = from_rotation_vector(np.array((0, np.pi / 6, 0)))
    center = matrix(q) @ np.array((-0.5, 0, 0.5))
    velocity = np.cross((0, -rate, 0), center) + (0, 0, 1e-3)
    flying = Flying([Cube(1.0)], GROUND, position=[center], orientation=[q], velocity=[velocity],
                    spin=[(0, -rate, 0)])
    time = touch(flying, guarded=True)
    assert 0.1 < time < 1
    assert abs(flying.separations(np.array([0]), np.array([1]), [time])[0, 0]) < 1e-15


def test_resting_contact_is_reported_at_once_or_when_it_has_sunk():
    flying = Flying([Cube(1.0)], GROUND, position=[(0, 0, 0.5)], velocity=[(1.0, 0, 0)],
                    acceleration=FALLING)
    assert touch(flying) == 0.0
    sunk = np.sqrt(2e-10 * 0.75 ** 0.5 / GRAVITY)
    assert touch(flying, guarded=True) == pytest.approx(sunk, rel=1e-6)
    many = Flying([Cube(1.0)] * 20, GROUND, position=[(0, 0, 0.5)] * 20, acceleration=FALLING * 20)
    times = first_touches(many.bodies, many.flights, np.arange(20), np.full(20, 20), 0.0, 1.0,
                          np.arange(20) < 10)
    assert times == pytest.approx([sunk] * 10 + [0.0] * 10, rel=1e-6)


@pytest.mark.parametrize('other', ['plane', 'box'])
def test_overlapping_bodies_touch_at_the_start_if_they_approach(other):
    below = {'plane': ([], GROUND), 'box': ([Box((4.0, 4, 2))], ())}[other]
    for speed, expected in ((-1.0, 0.5), (1.0, np.inf)):
        flying = Flying([Cube(1.0), *below[0]], below[1],
                        position=[(0, 0, 0.3), (0, 0, -1)][:1 + len(below[0])],
                        velocity=[(0, 0, speed), (0, 0, 0)][:1 + len(below[0])])
        # at 0.5 s the one is 0.7 or so deep, the other out
        assert touch(flying, start=0.5 if speed < 0 else 0.1) == expected


def test_what_slides_past_without_approach_never_touches():
    flying = Flying([Box((4.0, 4, 1)), Cube(1.0)], position=[(0, 0, 0), (-5, 0, 1 + 1e-12)],
                    velocity=[(0, 0, 0), (3.0, 0, 0)])
    assert touch(flying) == np.inf


def test_a_hair_above_a_plane_the_search_ends():
    # rocking by 1e-11 rad or turning flat within 1e-12 m: neither comes nor goes
    for spin in ((0, 0, 5.0), (1e-11, 0, 5.0)):
        flying = Flying([Cube(1.0)], GROUND, position=[(0, 0, 0.5 + 1e-12)], spin=[spin])
        time = touch(flying, end=1.0)
        assert time == np.inf or 0 <= time <= 1.0


def test_each_pair_has_its_own_start_and_nothing_after_the_end_counts():
    shapes = [Sphere(0.5)] * 3
    flying = Flying(shapes, GROUND, position=[(0, 0, 10.5)] * 3, velocity=[(0, 0, -1.0)] * 3)
    times = first_touches(flying.bodies, flying.flights, np.array([0, 1, 2]), np.full(3, 3),
                          np.array([0.0, 9.0, 9.99]), 10.5, np.zeros(3, bool))
    assert times == pytest.approx([10.0, 10.0, 10.0], rel=1e-15)
    assert touch(flying, 0, 3, end=9.9) == np.inf
    assert first_touches(flying.bodies, flying.flights, np.zeros(0, int), np.zeros(0, int), 0.0,
                         1.0, np.zeros(0, bool)).shape == (0,)


def test_bodies_may_be_in_many_more_pairs_than_there_are_bodies():
    count = 150
    planes = [((0.0, 0, 1), -offset) for offset in range(4)]
    flying = Flying([Cube(0.5)] * count, planes, position=[(0, 0, 5.0)] * count,
                    velocity=[(0, 0, -1.0)] * count)
    a, b = np.repeat(np.arange(count), 4), np.tile(np.arange(count, count + 4), count)
    times = first_touches(flying.bodies, flying.flights, a, b, 0.0, 20.0, np.zeros(len(a), bool))
    assert times == pytest.approx(np.tile((4.75, 5.75, 6.75, 7.75), count), rel=1e-15)
