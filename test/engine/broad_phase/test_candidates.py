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

"""Pairs by the grid, against all pairs."""

import numpy as np

import pytest

from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.broad_phase import candidate_pairs, swept_pairs
from rigid_sim_ros.engine.broad_phase.swept import around_paths
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.shapes import Sphere


def balls(radii, fixed=None, planes=()):
    fixed = np.zeros(len(radii), dtype=bool) if fixed is None else fixed
    return bodies_of(Scene(
        bodies=tuple(Body(f'ball_{number}', Sphere(float(radius)), 1.0, (1.0, 1.0, 1.0),
                          fixed=bool(still))
                     for number, (radius, still) in enumerate(zip(radii, fixed))),
        planes=tuple(Plane(f'plane_{number}', tuple(normal), offset)
                     for number, (normal, offset) in enumerate(planes))))


def with_planes(bodies, values):
    """Return values (3, m) of the bodies with zeros for the planes."""
    return np.concatenate((values, np.zeros((3, bodies.count - bodies.body_count))), axis=1)


def near_by_definition(bodies, position, margin):
    """Return the pairs {(a, b)} that are nearer than the margin, one by one."""
    found = set()
    count, radius = bodies.body_count, bodies.bounding_radius
    for a in range(bodies.moving_count):
        distance = np.sqrt(((position[:, :count] - position[:, [a]]) ** 2).sum(axis=0))
        near = distance - radius[:count] - radius[a] < margin
        found |= {(a, b) for b in np.flatnonzero(near).tolist() if b > a}
        for plane in range(count, bodies.count):
            height = bodies.plane_normal[:, plane] @ position[:, a] - bodies.plane_offset[plane]
            if height - radius[a] < margin:
                found.add((a, plane))
    return found


def as_set(a, b):
    pairs = list(zip(a.tolist(), b.tolist()))
    assert len(set(pairs)) == len(pairs), 'a pair came twice'
    return set(pairs)


RADII = {
    'equal': lambda rng, count: np.full(count, 0.5),
    'mixed': lambda rng, count: rng.uniform(0.2, 1, count),
    'millimetres to decametres': lambda rng, count: 10 ** rng.uniform(-3, 1, count),
    'one giant': lambda rng, count: np.where(np.arange(count) == count // 2, 8.0, 0.3),
}


@pytest.mark.parametrize('count', [1, 2, 40, 300, 700])
@pytest.mark.parametrize('sizes', RADII)
@pytest.mark.parametrize('fixed_share', [0.0, 0.4])
def test_the_grid_finds_what_comparing_all_finds(count, sizes, fixed_share):
    rng = np.random.default_rng(count)
    radii = RADII[sizes](rng, count)
    bodies = balls(radii, rng.random(count) < fixed_share,
                   [((0, 0, 1), -1.0), ((0.6, 0, 0.8), -3.0)])
    # far from the origin and along a line, so that the grid is anything but a cube
    extent = np.array([[4.0], [1.5], [0.3]]) * np.cbrt(count)
    position = with_planes(bodies, 1e4 * (count == 300) + extent * rng.random((3, count)))
    for margin in (0.0, 0.3):
        found = as_set(*candidate_pairs(bodies, position, margin))
        assert found == near_by_definition(bodies, position, margin)


def test_fixed_bodies_alone_make_no_pairs():
    bodies = balls(np.full(100, 1.0), np.ones(100, dtype=bool), [((0, 0, 1), 0.0)])
    a, b = candidate_pairs(bodies, with_planes(bodies, np.zeros((3, 100))), 1.0)
    assert len(a) == len(b) == 0


def test_bodies_far_apart_do_not_need_more_cells_than_can_be_numbered():
    rng = np.random.default_rng(1)
    position = rng.uniform(-1e9, 1e9, (3, 400))
    position[:, 1] = position[:, 0] + 1e-3
    bodies = balls(np.full(400, 1e-3))
    assert as_set(*candidate_pairs(bodies, position)) == {(0, 1)}


@pytest.mark.parametrize('seed', range(2))
@pytest.mark.parametrize('sizes', ['mixed', 'millimetres to decametres'])
def test_nothing_meets_before_the_horizon_but_the_pairs_returned(seed, sizes):
    rng = np.random.default_rng(seed)
    count = 300
    bodies = balls(RADII[sizes](rng, count), rng.random(count) < 0.2,
                   [((0, 0, 1), -1.0), ((0.6, 0, 0.8), -3.0)])
    position = with_planes(bodies, 30 * rng.random((3, count)))
    flying = np.arange(bodies.count) < bodies.moving_count
    flying[:bodies.moving_count] &= rng.random(bodies.moving_count) < 0.8
    solid = flying | (np.arange(bodies.count) >= bodies.moving_count)
    solid[:bodies.moving_count] |= rng.random(bodies.moving_count) < 0.5
    velocity = (rng.normal(size=position.shape) + [[3], [0], [0]]) * flying
    # most fall, some are pushed
    pushed = rng.random(bodies.count) < 0.1
    acceleration = (np.array([[0], [0], [-9.81]]) + pushed * rng.normal(size=position.shape))
    acceleration = acceleration * flying
    a, b, horizon = swept_pairs(bodies, flying, solid, position, velocity, acceleration)
    assert 0 < horizon < np.inf
    found = as_set(a, b)
    assert all(solid[a] & solid[b] & (flying[a] | flying[b]))
    meeting = set()
    for time in np.linspace(0, horizon, 25):
        there = position + time * velocity + 0.5 * time * time * acceleration
        meeting |= {(a, b) for a, b in near_by_definition(bodies, there, 0.0)
                    if solid[a] and solid[b] and (flying[a] or flying[b])}
    assert len(meeting) > 10
    assert meeting <= found
    assert len(found) < 0.5 * count * count / 2


def test_few_bodies_get_all_their_pairs_for_ever():
    bodies = balls(np.ones(4), planes=[((0, 0, 1), 0.0)])
    zeros = np.zeros((3, 5))
    flying = np.array([True, True, False, False, False])
    solid = np.array([True, True, True, False, True])
    a, b, horizon = swept_pairs(bodies, flying, solid, zeros, zeros, zeros)
    assert as_set(a, b) == {(0, 1), (0, 2), (1, 2), (0, 4), (1, 4)}
    assert horizon == np.inf


def test_a_crowd_that_falls_together_makes_few_pairs():
    # only the common motion keeps these apart from each other's paths
    count = 1000
    bodies = balls(np.full(count, 0.4))
    axis = np.arange(10.0)
    position = np.stack(np.meshgrid(axis, axis, axis)).reshape(3, -1)
    velocity = np.tile([[100.0], [0], [0]], count)
    velocity += 1e-3 * np.random.default_rng(5).normal(size=velocity.shape)
    acceleration = np.tile([[0.0], [0], [-9.81]], count)
    everyone = np.ones(count, dtype=bool)
    a, b, horizon = swept_pairs(bodies, everyone, everyone, position, velocity, acceleration)
    # in this time they fall 500 m and more, and neighbours are 0.2 m apart
    assert horizon > 10
    assert len(a) < 500


def test_a_sphere_around_a_path_holds_all_of_it_and_little_else():
    rng = np.random.default_rng(6)
    radius = rng.uniform(0.1, 1, 500)
    position, velocity, acceleration = rng.normal(size=(3, 3, 500)) * [[[1]], [[1]], [[3]]]
    horizon = 1.3
    center, reach = around_paths(radius, position, velocity, acceleration, horizon)
    furthest = 0.0
    for time in np.linspace(0, horizon, 101):
        there = position + time * velocity + 0.5 * time * time * acceleration
        furthest = np.maximum(furthest, np.sqrt(((there - center) ** 2).sum(axis=0)))
    assert (furthest + radius <= reach).all()
    # there and back again: the bulge alone
    assert ((furthest + radius) / reach).max() > 0.9
    velocity = -0.5 * horizon * acceleration
    center, reach = around_paths(radius, position, velocity, acceleration, horizon)
    apex = position + 0.25 * horizon * velocity
    assert reach == pytest.approx(np.sqrt(((apex - center) ** 2).sum(axis=0)) + radius)
