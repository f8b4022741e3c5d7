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

"""Signed distances of boxes, against methods that know nothing of separating axes."""

from arrangements import bodies, random_box_pairs, random_orientations

from hypothesis import given, settings
from hypothesis import strategies as st

import numpy as np

import pytest

from rigid_sim_ros.engine.narrow_phase import separations
from rigid_sim_ros.engine.rotation import from_rotation_vector, matrix, multiply, rotate

from scipy.optimize import linprog
from scipy.spatial import ConvexHull

SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


def half_spaces(half_extents, center, rotation):
    """Return rows normal . x <= offset of a box."""
    normals = np.concatenate((rotation.T, -rotation.T))
    return normals, normals @ center + np.tile(half_extents, 2)


def margin_of_common_points(scene, a, b, position, rotations):
    """Return the least s so that some point is within both boxes grown by s (linear program)."""
    rows, offsets = [], []
    for body in (a, b):
        normals, offset = half_spaces(scene.half_extents[:, body], position[:, body],
                                      rotations[:, :, body])
        rows.append(normals)
        offsets.append(offset)
    rows, offsets = np.concatenate(rows), np.concatenate(offsets)
    # seen from the first centre, in units of its size: the solver's tolerances are absolute
    unit = scene.bounding_radius[a]
    offsets = (offsets - rows @ position[:, a]) / unit
    result = linprog([0, 0, 0, 1], A_ub=np.column_stack((rows, -np.ones(len(rows)))),
                     b_ub=offsets, bounds=[(None, None)] * 4)
    assert result.status == 0
    return result.fun * unit


def test_overlap_agrees_with_a_linear_program_on_pairs_of_all_kinds():
    scene, a, b, position, orientation, scale = random_box_pairs(np.random.default_rng(1), 250)
    found = separations(scene, a, b, position, orientation)
    rotations = matrix(orientation)
    overlapping = 0
    for pair in range(len(a)):
        margin = margin_of_common_points(scene, a[pair], b[pair], position, rotations)
        if abs(margin) > 1e-6 * scale[pair]:
            assert (found[pair] > 0) == (margin > 0), pair
            overlapping += margin < 0
    assert 60 < overlapping < 190


def test_distance_and_depth_are_those_of_the_hull_of_all_vertex_differences():
    scene, a, b, position, orientation, scale = random_box_pairs(np.random.default_rng(2), 200)
    found = separations(scene, a, b, position, orientation)
    rotations = matrix(orientation)
    for pair in range(len(a)):
        vertices = [position[:, body] / scale[pair]
                    + (SIGNS * scene.half_extents[:, body] / scale[pair]) @ rotations[:, :, body].T
                    for body in (a[pair], b[pair])]
        differences = (vertices[1][:, np.newaxis] - vertices[0]).reshape(-1, 3)
        # facets of the difference of two boxes have exactly the normals of the 15 axes
        expected = ConvexHull(differences).equations[:, 3].max()
        # qhull merges facets that are nearly coplanar
        assert found[pair] / scale[pair] == pytest.approx(expected, abs=2e-9), pair


@pytest.mark.parametrize('unit', [1e-3, 1.0, 1e3])
def test_closed_form_depths(unit):
    scene = bodies(np.array([[1.0, 1, 1], [2, 2, 2], [0.01, 1, 1]]) * unit)
    position = np.array([[0.0, 0, 0], [1.4, 0.2, 0.1], [0.502, 0.3, 0]]).T * unit
    straight = np.tile(np.array([[0.0], [0], [0], [1]]), 3)
    found = separations(scene, [0, 0, 1], [1, 2, 2], position, straight)
    assert found == pytest.approx(np.array([-0.1, -0.003, -0.107]) * unit, rel=1e-12)
    # a cube turned by 45 degrees about z reaches sqrt(2) / 2 along x
    orientation = straight.copy()
    orientation[:, 0] = from_rotation_vector(np.array([0, 0, np.pi / 4]))
    position[:, 1] = np.array([1.8, 0, 0]) * unit
    found = separations(scene, [0], [1], position, orientation)
    assert found == pytest.approx([(1.8 - 1 - 0.5 ** 0.5) * unit], rel=1e-12)


def test_crossed_edges_at_a_known_distance():
    # each cube on edge, the upper one turned so that the lowest edge crosses the topmost
    scene = bodies([[1, 1, 1], [1, 1, 1]])
    lower = from_rotation_vector(np.array([np.pi / 4, 0, 0]))
    upper = from_rotation_vector(np.array([0, np.pi / 4, 0]))
    position = np.array([[0, 0, 0], [0.1, -0.2, 2 ** 0.5 + 1e-3]]).T
    found = separations(scene, [0, 1], [1, 0], position, np.stack((lower, upper), axis=1))
    assert found == pytest.approx([1e-3, 1e-3], abs=1e-15)


@pytest.mark.parametrize('angle', [1e-3, 1e-5, 1e-6])
def test_long_rods_that_cross_at_a_small_angle_are_apart(angle):
    # square rods on edge, one above the other: only the product of their edges separates them
    scene = bodies([[100, 1, 1], [100, 1, 1]])
    on_edge = from_rotation_vector(np.array([np.pi / 4, 0, 0]))
    turned = multiply(from_rotation_vector(np.array([0, 0, angle])), on_edge)
    gap = 1e-3 * angle
    position = np.array([[0, 0, 0], [0, 0, 2 ** 0.5 + gap]]).T
    found = separations(scene, [0], [1], position, np.stack((on_edge, turned), axis=1))
    assert found == pytest.approx([gap], abs=1e-14)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2 ** 32 - 1), thin=st.floats(0.01, 1), unit=st.floats(1e-3, 1e3))
def test_the_frame_the_unit_and_the_order_do_not_matter(seed, thin, unit):
    rng = np.random.default_rng(seed)
    half = np.array([[1.0, 0.7, thin], [thin, 1.0, 0.8]])
    position = np.array([[0.0, 0, 0], rng.normal(size=3)]).T
    orientation = random_orientations(rng, 2)
    found = separations(bodies(half), [0], [1], position, orientation)[0]
    turn = random_orientations(rng, 1)
    there = rotate(turn, position) + rng.normal(size=(3, 1))
    again = separations(bodies(half * unit), [1], [0], there * unit,
                        multiply(turn, orientation))[0]
    assert again / unit == pytest.approx(found, abs=2e-14)
