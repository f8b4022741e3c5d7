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

"""The camera maps points to pixels as its rays say, and has everything in its picture."""

import numpy as np
import pytest
from rigid_sim_ros.view.camera import Camera, frame

CENTERS = np.array([[0.0, 0.0, 0.0], [3.0, -1.0, 0.5], [-2.0, 4.0, 1.0]])
RADII = np.array([0.5, 1.0, 0.2])


@pytest.mark.parametrize('view', [(0, 0), (300, 20), (-45, 90), (123, -90), (90, -30)])
@pytest.mark.parametrize('size', [(80, 50), (50, 80)])
def test_every_ball_is_in_the_picture_and_one_nearly_fills_it(view, size):
    camera = frame(CENTERS, RADII, *view, *size)
    random = np.random.default_rng(1)
    direction = random.normal(size=(20_000, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    surface = (CENTERS[:, None] + RADII[:, None, None] * direction).reshape(-1, 3)
    x, y, depth = camera.project(surface)
    assert depth.min() > 0
    share = np.stack((x / camera.width, y / camera.height))
    assert 0 <= share.min() and share.max() <= 1
    assert np.abs(share - 0.5).max() > 0.42


def test_points_on_a_ray_are_seen_in_its_pixel():
    camera = frame(CENTERS, RADII, 300, 20, 40, 30)
    rays = camera.rays()
    for row, column in ((0, 0), (7, 31), (29, 39)):
        x, y, depth = camera.project(camera.position + 3.5 * rays[:, row, column][None])
        assert (x[0], y[0], depth[0]) == pytest.approx((column + 0.5, row + 0.5, 3.5), abs=1e-9)


def test_right_is_right_and_up_is_up():
    # from -y, +x is on the right and +z above
    camera = frame(CENTERS[:1], RADII[:1], 270, 0, 40, 30)
    x, y, depth = camera.project(np.array([[0.1, 0, 0], [0, 0, 0.1], [0, -0.1, 0], [0, 0, 0]]))
    assert x[0] > 20 and y[1] < 15 and depth[2] < depth[3]
    assert (x[3], y[3]) == pytest.approx((20, 15))


def test_a_closer_look_is_the_same_look():
    camera = frame(CENTERS, RADII, 300, 20, 40, 30)
    larger = camera.scaled(3)
    assert isinstance(larger, Camera)
    for one, other in zip(camera.project(CENTERS)[:2], larger.project(CENTERS)[:2]):
        assert other == pytest.approx(3 * one)
