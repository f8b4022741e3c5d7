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

"""Contact points of all pairs of shapes, against plain clipping and closed forms."""

from arrangements import bodies, random_box_pairs, random_orientations

from hypothesis import given, settings
from hypothesis import strategies as st

import numpy as np

import pytest

from rigid_sim_ros.engine.contacts import EDGES, FACE_A, FACE_B, ROUND
from rigid_sim_ros.engine.narrow_phase import find_contacts, PairGroups, PAIRS, separations
from rigid_sim_ros.engine.rotation import from_rotation_vector, matrix, multiply, rotate

UPRIGHT = np.array([0.0, 0, 0, 1])


def poses(*rows):
    """Return position (3, n) and orientation (4, n) of rows (x, y, z) or (x, y, z, q)."""
    return (np.array([row[:3] for row in rows], dtype=float).T,
            np.array([row[3] if len(row) > 3 else UPRIGHT for row in rows]).T)


def clipped_face(normal, reference, incident):
    """
    Return corners of the incident face within the sides of the reference face, plain loops.

    Sutherland and Hodgman 1974. A body is (half extents, centre, rotation); `normal` is out of the
    reference face. Returns the points and their heights above that face.
    """
    half, center, rotation = incident
    axis = np.abs(rotation.T @ normal).argmax()
    outward = -np.sign(rotation[:, axis] @ normal) * rotation[:, axis]
    first, second = (half[i] * rotation[:, i] for i in range(3) if i != axis)
    middle = center + outward * half[axis]
    polygon = [middle + first + second, middle - first + second,
               middle - first - second, middle + first - second]
    half, center, rotation = reference
    up = np.abs(rotation.T @ normal).argmax()
    for side in range(3):
        for sign in (-1, 1) if side != up else ():
            direction = sign * rotation[:, side]
            clipped = []
            for here, there in zip(polygon, polygon[1:] + polygon[:1]):
                one, two = (direction @ (point - center) - half[side] for point in (here, there))
                if one <= 0:
                    clipped.append(here)
                if one * two < 0:
                    clipped.append(here + (there - here) * one / (one - two))
            polygon = clipped
    return [(point, normal @ (point - center) - half[up]) for point in polygon]


def as_body(scene, position, rotations, body):
    return scene.half_extents[:, body], position[:, body], rotations[:, :, body]


def test_faces_have_all_corners_of_the_clipped_face_and_nothing_else():
    scene, a, b, position, orientation, scale = random_box_pairs(np.random.default_rng(3), 400)
    margin = 0.05 * scale
    contacts = find_contacts(scene, a, b, position, orientation, margin)
    rotations = matrix(orientation)
    compared = 0
    for pair in range(len(a)):
        unit = scale[pair]
        points = contacts.select(contacts.body_a == a[pair])
        if points.count == 0 or points.feature[0] == EDGES:
            continue
        assert len(set(points.feature)) == 1
        first, second = (as_body(scene, position, rotations, body) for body in (a[pair], b[pair]))
        sides = (first, second) if points.feature[0] == FACE_A else (second, first)
        normal = points.normal[:, 0] * (1 if points.feature[0] == FACE_A else -1)
        expected = [(point, height) for point, height in clipped_face(normal, *sides)
                    if height < margin[pair]]
        if not expected:
            assert points.count == 1
            continue
        surface = points.point + normal[:, np.newaxis] * points.separation / 2
        found = np.concatenate((surface, points.separation[np.newaxis])).T / unit
        wanted = np.array([[*point, height] for point, height in expected]) / unit
        apart = np.abs(found[:, np.newaxis] - wanted).max(axis=2)
        # sides that cross at a small angle do so elsewhere on the slightly wider rectangle
        assert apart.min(axis=1).max() < 1e-6, pair
        assert apart.min(axis=0).max() < 1e-6, pair
        compared += 1
    assert compared > 150


def test_points_lie_on_both_bodies_and_the_deepest_has_the_depth():
    scene, a, b, position, orientation, scale = random_box_pairs(np.random.default_rng(4), 400)
    groups = PairGroups(scene, a, b)
    contacts = groups.find_contacts(position, orientation, 1e-6 * scale)
    depth = groups.separations(position, orientation)
    rotations = matrix(orientation)
    touched = np.flatnonzero(depth < 0)
    assert set(contacts.body_a[contacts.separation < 0]) == set(touched)
    for pair in touched:
        points = contacts.select(contacts.body_a == pair)
        assert points.normal.T @ points.normal == pytest.approx(np.ones((points.count,) * 2))
        unit = scale[pair]
        lead = 1e-6 * unit  # an edge pair must be better than a face by the margin
        assert points.separation.min() <= depth[pair] + 1e-8 * unit
        if points.feature[0] == EDGES:
            assert points.separation == pytest.approx(depth[pair], abs=1e-14 * unit)
        else:
            # along a face the clipped points are less deep only if a corner cuts a corner
            normal = points.normal[:, 0]
            reach = [np.abs(rotations[:, :, body].T @ normal) @ scene.half_extents[:, body]
                     for body in (pair, b[pair])]
            between = position[:, b[pair]] - position[:, pair]
            along = normal @ between - sum(reach)
            assert depth[pair] - lead <= along <= depth[pair] + 1e-12 * unit
        for body, towards in ((pair, -1), (b[pair], 1)):
            surface = points.point + towards * points.separation / 2 * points.normal
            local = rotations[:, :, body].T @ (surface - position[:, [body]])
            beyond = (np.abs(local) - scene.half_extents[:, [body]]).max(axis=0)
            assert beyond.max() < 3e-8 * unit


def test_a_cube_flat_on_a_larger_one_has_its_four_corners():
    scene = bodies([[4, 4, 2], [1, 1, 1]])
    contacts = find_contacts(scene, [0], [1], *poses((0, 0, 0), (0.3, -0.2, 1.5)), 1e-9)
    assert contacts.count == 4
    assert contacts.normal == pytest.approx(np.tile([[0], [0], [1]], 4))
    corners = sorted(map(tuple, np.round(contacts.point.T, 12)))
    assert corners == [(-0.2, -0.7, 1), (-0.2, 0.3, 1), (0.8, -0.7, 1), (0.8, 0.3, 1)]
    assert contacts.separation == pytest.approx(np.zeros(4), abs=1e-15)


@pytest.mark.parametrize('turn', [0.0, 1e-16, 1e-12, 1e-10])
def test_equal_cubes_flush_on_each_other_have_four_corners_however_rounded(turn):
    scene = bodies([[1, 1, 1], [1, 1, 1]])
    rng = np.random.default_rng(5)
    for _ in range(20):
        base = random_orientations(rng, 1)
        q = multiply(base, from_rotation_vector(np.array([[0], [0], [turn]])))
        position = np.concatenate((np.zeros((3, 1)), rotate(base, np.array([[0], [0], [1.0]]))), 1)
        position += rng.normal(size=(3, 1))
        contacts = find_contacts(scene, [0], [1], position, np.concatenate((base, q), 1), 1e-9)
        assert contacts.count == 4
        local = matrix(base)[:, :, 0].T @ (contacts.point - position[:, :1])
        assert np.abs(local) == pytest.approx(np.full((3, 4), 0.5), abs=2e-8)


def test_a_cube_turned_by_45_degrees_on_an_equal_one_has_eight_points():
    q = from_rotation_vector(np.array([0, 0, np.pi / 4]))
    contacts = find_contacts(bodies([[1, 1, 1], [1, 1, 1]]), [0], [1],
                             *poses((0, 0, 0), (0, 0, 1, q)), 1e-9)
    assert contacts.count == 8
    # a regular octagon of apothem 1/2
    assert np.hypot(*contacts.point[:2]) == pytest.approx(0.5 / np.cos(np.pi / 8), abs=1e-7)


def test_an_edge_across_a_face_has_two_points():
    q = from_rotation_vector(np.array([0, np.pi / 4, 0]))
    contacts = find_contacts(bodies([[2, 2, 2], [1, 6, 1]]), [0], [1],
                             *poses((0, 0, 0), (0.1, 0, 1 + 0.5 ** 0.5 - 1e-4, q)), 1e-6)
    assert contacts.feature.tolist() == [FACE_A, FACE_A]
    assert sorted(contacts.point[1]) == pytest.approx([-1, 1], abs=1e-7)
    assert contacts.separation == pytest.approx([-1e-4, -1e-4], abs=1e-13)


def test_crossed_edges_have_one_point_where_they_cross():
    lower = from_rotation_vector(np.array([np.pi / 4, 0, 0]))
    upper = from_rotation_vector(np.array([0, np.pi / 4, 0]))
    contacts = find_contacts(
        bodies([[1, 1, 1], [1, 1, 1]]), [1], [0],
        *poses((0, 0, 0, lower), (0.1, -0.2, 2 ** 0.5 + 1e-3, upper)), 1e-2)
    assert contacts.feature.tolist() == [EDGES]
    assert contacts.normal[:, 0] == pytest.approx([0, 0, -1], abs=1e-15)
    # the lower cube's edge is along x at y = 0, the upper one's along y at x = 0.1
    assert contacts.point[:, 0] == pytest.approx([0.1, 0, 0.5 ** 0.5 + 5e-4], abs=1e-15)
    assert np.abs(contacts.edge_a[:, 0]) == pytest.approx([0, 1, 0], abs=1e-15)
    assert np.abs(contacts.edge_b[:, 0]) == pytest.approx([1, 0, 0], abs=1e-15)


def test_corners_that_cut_corners_still_touch():
    # the lower edge of b cuts the corner of a from outside its upper face
    scene, a, b, position, orientation, scale = random_box_pairs(np.random.default_rng(6), 3000)
    groups = PairGroups(scene, a, b)
    depth = groups.separations(position, orientation)
    contacts = groups.find_contacts(position, orientation, 0.0)
    assert set(np.flatnonzero(depth < 0)) == set(contacts.body_a)


def test_box_on_plane_has_every_vertex_below_the_margin():
    scene = bodies([[2, 1, 1]], planes=[((0, 0.6, 0.8), 0.25)])
    q = random_orientations(np.random.default_rng(7), 1)[:, 0]
    position, orientation = poses((0.3, 0.2, 0.4, q), (0, 0, 0))
    contacts = find_contacts(scene, [0], [1], position, orientation, 0.1)
    vertices = [position[:, 0] + rotate(q, np.array([x, y, z]) / 2)
                for x in (-2, 2) for y in (-1, 1) for z in (-1, 1)]
    heights = sorted(np.dot((0, 0.6, 0.8), vertex) - 0.25 for vertex in vertices)
    expected = [height for height in heights if height < 0.1]
    assert 0 < len(expected) < 8
    assert sorted(contacts.separation) == pytest.approx(expected, abs=1e-15)
    assert contacts.normal == pytest.approx(np.tile([[0], [-0.6], [-0.8]], len(expected)))
    assert set(contacts.feature) == {FACE_B}
    midway = np.array([0, 0.6, 0.8]) @ contacts.point - 0.25
    assert midway == pytest.approx(contacts.separation / 2, abs=1e-15)
    assert separations(scene, [0], [1], position, orientation) == pytest.approx(heights[:1])


def test_one_box_in_plain_floats_has_the_contacts_it_has_in_arrays():
    rng = np.random.default_rng(9)
    scene = bodies(rng.uniform(0.3, 2, (40, 3)), planes=[((0, 0.6, 0.8), 0.25)])
    position = rng.normal(size=(3, 41))
    orientation = random_orientations(rng, 41)
    counts = set()
    for box in range(40):
        one = find_contacts(scene, [box], [40], position, orientation, np.array([0.2]))
        many = PairGroups(scene, [box], [40]).find_contacts(position, orientation, 0.2)
        for name in ('body_a', 'body_b', 'feature', 'edge_a', 'edge_b', 'normal'):
            assert (getattr(one, name) == getattr(many, name)).all()
            assert getattr(one, name).shape == getattr(many, name).shape
        assert one.point == pytest.approx(many.point, abs=1e-14)
        assert one.separation == pytest.approx(many.separation, abs=1e-14)
        counts.add(one.count)
    assert {0, 1, 2, 8} <= counts


def test_spheres_by_hand():
    scene = bodies([[2, 2, 2]], radii=[0.5, 0.25], planes=[((0, 0, 1), -1.0)])
    position, orientation = poses((0, 0, 0), (0, 0, 1.45), (1.1, 1.2, 0), (0, 0, 0))
    contacts = find_contacts(scene, [1, 0, 2, 1], [0, 2, 3, 2], position, orientation, 10.0)
    by_pair = {(a, b): contacts.select(np.array([k])) for k, (a, b) in
               enumerate(zip(contacts.body_a.tolist(), contacts.body_b.tolist()))}
    assert set(contacts.feature) == {ROUND}
    face, edge = by_pair[1, 0], by_pair[0, 2]
    plane, pair = by_pair[2, 3], by_pair[1, 2]
    assert face.separation == pytest.approx([-0.05])
    assert face.normal[:, 0] == pytest.approx([0, 0, -1])
    assert face.point[:, 0] == pytest.approx([0, 0, 0.975])
    assert edge.separation == pytest.approx([np.hypot(0.1, 0.2) - 0.25])
    assert edge.normal[:, 0] == pytest.approx(np.array([1, 2, 0]) / 5 ** 0.5)
    assert np.abs(edge.edge_a[:, 0]) == pytest.approx([0, 0, 1])
    assert plane.separation == pytest.approx([0.75])
    assert plane.normal[:, 0] == pytest.approx([0, 0, -1])
    between = np.array([1.1, 1.2, -1.45])
    assert pair.separation == pytest.approx([np.sqrt(between @ between) - 0.75])
    assert pair.normal[:, 0] == pytest.approx(between / np.sqrt(between @ between))


def test_a_sphere_whose_centre_is_inside_a_box_leaves_the_shortest_way():
    scene = bodies([[2, 2, 2]], radii=[0.1])
    contacts = find_contacts(scene, [0], [1], *poses((0, 0, 0), (0.1, -0.9, 0.3)), 0.0)
    assert contacts.separation == pytest.approx([-0.2])
    assert contacts.normal[:, 0] == pytest.approx([0, -1, 0])
    centered = find_contacts(scene, [0], [1], *poses((0, 0, 0), (0, 0, 0)), 0.0)
    assert centered.separation == pytest.approx([-1.1])
    assert np.abs(centered.normal).sum() == pytest.approx(1)


def test_a_margin_for_every_pair_is_its_own():
    scene = bodies(radii=[1, 1, 1])
    position, orientation = poses((0, 0, 0), (2.1, 0, 0), (4.2, 0, 0))
    contacts = find_contacts(scene, [0, 1], [1, 2], position, orientation, np.array([0.2, 0.05]))
    assert contacts.body_a.tolist() == [0]


def test_two_planes_are_refused_and_named():
    scene = bodies(planes=[((0, 0, 1), 0.0), ((1, 0, 0), 0.0)])
    with pytest.raises(ValueError, match='plane and plane cannot meet; allowed: .*box'):
        PairGroups(scene, [0], [1])
    assert set(PAIRS) == {('box', 'box'), ('box', 'plane'), ('sphere', 'box'),
                          ('sphere', 'plane'), ('sphere', 'sphere')}


def test_no_pairs_give_no_contacts():
    scene = bodies(radii=[1])
    assert find_contacts(scene, [], [], *poses((0, 0, 0)), 1.0).count == 0
    assert separations(scene, [], [], *poses((0, 0, 0))).shape == (0,)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2 ** 32 - 1))
def test_exchanging_a_and_b_exchanges_nothing_else(seed):
    rng = np.random.default_rng(seed)
    scene = bodies(rng.uniform(0.2, 1.5, (2, 3)), radii=[0.4, 0.6], planes=[((0, 0, 1), -0.5)])
    position = rng.normal(size=(3, 5)) * 0.6
    orientation = np.concatenate((random_orientations(rng, 4), UPRIGHT[:, np.newaxis]), axis=1)
    a, b = np.triu_indices(5, 1)
    forth = find_contacts(scene, a, b, position, orientation, 1.0)
    back = find_contacts(scene, b, a, position, orientation, 1.0)
    assert forth.count == back.count
    key = [np.lexsort((*np.round(contacts.point, 9), one, two)) for contacts, one, two in
           ((forth, forth.body_a, forth.body_b), (back, back.body_b, back.body_a))]
    forth, back = forth.select(key[0]), back.select(key[1])
    assert (forth.body_a == back.body_b).all()
    assert (forth.body_b == back.body_a).all()
    assert forth.point == pytest.approx(back.point, abs=1e-12)
    assert forth.normal == pytest.approx(-back.normal, abs=1e-12)
    assert forth.separation == pytest.approx(back.separation, abs=1e-12)
    swapped = {FACE_A: FACE_B, FACE_B: FACE_A, EDGES: EDGES, ROUND: ROUND}
    assert forth.feature.tolist() == [swapped[feature] for feature in back.feature]
    assert np.abs(rotation_free(forth.edge_a, back.edge_b)).max(initial=0) < 1e-12


def rotation_free(one, two):
    """Return the difference of unit vectors that may be opposite, (3, k)."""
    return one - two * np.copysign(1.0, (one * two).sum(axis=0))
