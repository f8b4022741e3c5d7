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

"""Rays meet shapes where marching along them in small steps finds them."""

import numpy as np
import pytest
from rigid_sim_ros.view.rays import hit_ball, hit_box, hit_plane, to_axes

HALF = np.array([0.5, 1.0, 0.25])
RADIUS = 0.8


def random_rays():
    random = np.random.default_rng(3)
    origin = 3 * random.normal(size=(3, 400))
    # half of them aimed well, half along axes now and then
    rays = random.normal(size=(3, 400)) * 0.3 - origin / 3
    rays[:, 300:] = np.round(rays[:, 300:])
    rays[:, ~rays.any(axis=0)] = 1.0
    return origin, rays


@pytest.mark.parametrize('hit, inside', [
    (lambda *ray: hit_box(*ray, HALF), lambda p: (np.abs(p).T - HALF).max(axis=-1).T),
    (lambda *ray: hit_ball(*ray, RADIUS), lambda p: np.linalg.norm(p, axis=0) - RADIUS)])
def test_against_marching(hit, inside):
    origin, rays = random_rays()
    enter, leave = hit(origin, rays)
    steps = np.linspace(-30, 30, 6001)
    outside = np.stack([inside(origin + step * rays) for step in steps])
    met = (outside < 0).any(axis=0)
    # a hit shorter than a step may be marched over
    assert not (met & ~(enter < leave)).any()
    assert not (~met & (leave - enter > 0.011)).any()
    assert met.sum() > 80 and (~met).sum() > 80
    for bound in (enter, leave):
        on_surface = inside(origin[:, met] + bound[met] * rays[:, met])
        assert np.abs(on_surface).max() < 1e-9
    assert (enter[met] <= steps[np.argmax(outside < 0, axis=0)[met]] + 1e-9).all()


def test_plane():
    origin, rays = random_rays()
    normal, offset = np.array([0.6, 0, 0.8]), -0.5
    found = hit_plane(origin, rays, normal, offset)
    meets = np.isfinite(found)
    point = origin[:, meets] + found[meets] * rays[:, meets]
    assert np.abs(normal @ point - offset).max() < 1e-9
    # the others go away from it or along it
    height = normal @ origin - offset
    assert ((height * (normal @ rays))[~meets] >= -1e-9).all()


def test_to_axes_is_the_transposed_matrix():
    matrix = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    vectors = np.arange(24.0).reshape(3, 2, 4)
    assert to_axes(matrix, vectors).reshape(3, -1) == pytest.approx(
        matrix.T @ vectors.reshape(3, -1))
