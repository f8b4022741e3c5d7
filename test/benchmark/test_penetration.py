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

"""Depth of overlap from poses, against known depths and linear programs."""

import numpy as np
import pytest
from rigid_sim_ros.benchmark.penetration import deepest_penetration
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Sphere
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

UNTURNED = (0.0, 0.0, 0.0, 1.0)


def scene_of(*shapes, planes=()):
    return Scene(tuple(Body(f'body_{number}', shape, 1.0, (1.0, 1.0, 1.0))
                       for number, shape in enumerate(shapes)), tuple(planes))


def depth(scene, positions, orientations):
    return deepest_penetration(scene, np.array(positions, float), np.array(orientations, float))


def test_boxes_that_overlap_by_a_slice():
    scene = scene_of(Box((1, 2, 3)), Box((2, 2, 2)))
    assert depth(scene, [(0, 0, 0), (1.25, 0.5, 0.5)], [UNTURNED] * 2) == pytest.approx(0.25)


def test_boxes_apart_have_none():
    scene = scene_of(Box((1, 1, 1)), Box((1, 1, 1)))
    assert depth(scene, [(0, 0, 0), (1.01, 0, 0)], [UNTURNED] * 2) == 0.0


def test_crossed_edges():
    # an edge along z against one along y, each at half a face's diagonal from its centre
    scene = scene_of(Box((1, 1, 1)), Box((1, 1, 1)))
    turned = Rotation.from_euler('z', 45, degrees=True), Rotation.from_euler('y', 45, degrees=True)
    found = depth(scene, [(0, 0, 0), (np.sqrt(2) - 0.03, 0, 0)],
                  [rotation.as_quat() for rotation in turned])
    assert found == pytest.approx(0.03, rel=1e-12)


def test_corner_and_ball_below_a_plane():
    plane = Plane('slope', (0.6, 0.0, 0.8), 0.5)
    scene = scene_of(Box((2, 2, 2)), planes=[plane])
    # the lowest corner is 0.6 + 0.8 below the centre, along the normal
    assert depth(scene, [(0.6 * 1.8, 5.0, 0.8 * 1.8)], [UNTURNED]) == pytest.approx(0.1)
    ball = scene_of(Sphere(1.0), planes=[plane])
    assert depth(ball, [(0.6 * 1.3, 5.0, 0.8 * 1.3)], [UNTURNED]) == pytest.approx(0.2)


def overlap_by_linear_program(sizes, positions, rotations):
    """Tell whether any point lies in both boxes."""
    rows, bounds = [], []
    for size, position, rotation in zip(sizes, positions, rotations):
        axes = rotation.as_matrix().T
        rows += [axes, -axes]
        bounds += [axes @ position + np.array(size) / 2, np.array(size) / 2 - axes @ position]
    return linprog(np.zeros(3), np.vstack(rows), np.concatenate(bounds),
                   bounds=[(None, None)] * 3).status == 0


def test_overlap_agrees_with_linear_programs():
    random = np.random.default_rng(5)
    rotations = Rotation.random(120, random_state=5)
    overlapping = 0
    for number in range(60):
        sizes = random.uniform(0.3, 2.0, (2, 3))
        positions = random.uniform(-0.9, 0.9, (2, 3))
        pair = rotations[2 * number], rotations[2 * number + 1]
        expected = overlap_by_linear_program(sizes, positions, pair)
        found = depth(scene_of(*(Box(tuple(size)) for size in sizes)), positions,
                      [rotation.as_quat() for rotation in pair])
        assert (found > 0) == expected
        overlapping += expected
    assert 10 < overlapping < 50


def test_all_pairs_are_looked_at():
    # a row longer than what is looked at in one piece, with one overlap at its end
    count = 450
    scene = scene_of(*[Box((1, 1, 1))] * count)
    positions = np.zeros((count, 3))
    positions[:, 0] = 1.5 * np.arange(count)
    positions[-1, 0] -= 0.6
    assert depth(scene, positions, [UNTURNED] * count) == pytest.approx(0.1)
