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

"""Rates of gaps and slip, against differences of the contacts of bodies on known flights."""

from arrangements import bodies, moved, random_orientations

import numpy as np

import pytest

from rigid_sim_ros.engine.contacts import EDGES, FACE_A, FACE_B, ROUND
from rigid_sim_ros.engine.narrow_phase import find_contacts, gap_acceleration_bias, PairGroups
from rigid_sim_ros.engine.rotation import cross

STEP = 1e-3  # [s]
# sixth order central differences of the second and of the first derivative
SECOND = np.array((2, -27, 270, -490, 270, -27, 2)) / (180 * STEP * STEP)
FIRST = np.array((-1, 9, -45, 0, 45, -9, 1)) / (60 * STEP)


def random_meetings(seed, count, kind):
    """
    Return contacts of `count` pairs that touch, one a pair, and how they move.

    The pairs are of `kind` (sizes or radii of their first and second body); every pair has
    velocities of its own and is shifted along its normal until the gap is closed.
    """
    rng = np.random.default_rng(seed)
    scene = bodies(**kind(rng, count))
    a, b = np.arange(count), np.arange(count, 2 * count)
    if 'plane' in scene.kinds:
        b = np.full(count, count)
    columns = scene.count
    position = rng.normal(size=(3, columns))
    orientation = random_orientations(rng, columns)
    moving = (np.arange(columns) < scene.body_count).astype(float)
    linear = rng.normal(size=(3, columns)) * moving
    angular = rng.normal(size=(3, columns)) * moving
    position[:, scene.body_count:] = 0
    orientation[:, scene.body_count:] = np.array([[0], [0], [0], [1.0]])
    groups = PairGroups(scene, a, b)
    for _ in range(3):  # the nearest feature may change as bodies approach
        contacts = one_a_pair(groups.find_contacts(position, orientation, np.inf))
        position[:, contacts.body_a] += contacts.normal * contacts.separation
    return scene, groups, position, orientation, linear, angular


def one_a_pair(contacts):
    """Return the contacts with the smallest separation of every body a."""
    order = np.lexsort((contacts.separation, contacts.body_a))
    _, first = np.unique(contacts.body_a[order], return_index=True)
    return contacts.select(order[first])


def boxes(rng, count):
    return {'sizes': rng.uniform(0.3, 1, (2 * count, 3))}


def boxes_on_a_plane(rng, count):
    return {'sizes': rng.uniform(0.3, 1, (count, 3)), 'planes': [((0, 0.6, 0.8), 0.1)]}


def boxes_and_spheres(rng, count):
    return {'sizes': rng.uniform(0.3, 1, (count, 3)), 'radii': rng.uniform(0.2, 1, count)}


def spheres(rng, count):
    return {'radii': rng.uniform(0.2, 1, 2 * count)}


def spheres_on_a_plane(rng, count):
    return {'radii': rng.uniform(0.2, 1, count), 'planes': [((0, 0.6, 0.8), 0.1)]}


def followed(groups, position, orientation, linear, angular):
    """Return the contacts, one a pair, at the seven times of the differences, and the same now."""
    at_times = []
    for number in range(-3, 4):
        there = moved(position, orientation, linear, angular, number * STEP)
        at_times.append((one_a_pair(groups.find_contacts(*there, np.inf)), *there))
    now = at_times[3][0]
    same = np.ones(now.count, dtype=bool)
    for contacts, *there in at_times:
        same &= contacts.feature == now.feature
        # another face, edge or vertex is far away, or turns the normal at once
        same &= np.abs(contacts.normal - now.normal).max(axis=0) < 0.03
        same &= np.abs(contacts.point - now.point).max(axis=0) < 0.03
        same &= np.abs(contacts.edge_a - now.edge_a).max(axis=0) < 0.03
        same &= np.abs(contacts.edge_b - now.edge_b).max(axis=0) < 0.03
        # where sides of two faces cross is not fixed to either body
        same &= np.abs(contacts.separation - groups.separations(*there)) < 1e-12
    return [(contacts.select(same), there) for contacts, there, _ in at_times]


def slip_at(contacts, scene, position, linear, angular):
    """Return both velocities, (3, k), at the point on a, or on b where its vertex or ball is."""
    ball = np.array([scene.kinds[body] == 'sphere' for body in contacts.body_b])
    on_b = (contacts.feature == FACE_A) | ball
    point = contacts.point + np.where(on_b, 0.5, -0.5) * contacts.separation * contacts.normal
    return [linear[:, body] + cross(angular[:, body], point - position[:, body])
            for body in (contacts.body_a, contacts.body_b)]


@pytest.mark.parametrize('kind, features', [
    (boxes, {FACE_A: 60, FACE_B: 60, EDGES: 60}), (boxes_on_a_plane, {FACE_B: 300}),
    (boxes_and_spheres, {ROUND: 300}), (spheres, {ROUND: 300}),
    (spheres_on_a_plane, {ROUND: 300})])
def test_bias_is_what_differences_along_free_flight_show(kind, features):
    scene, groups, position, orientation, linear, angular = random_meetings(8, 400, kind)
    at_times = followed(groups, position, orientation, linear, angular)
    now = at_times[3][0]
    for feature, least in features.items():
        assert (now.feature == feature).sum() > least
    assert set(now.feature) <= set(features)
    gamma_n, gamma_t = gap_acceleration_bias(now, scene, position, linear, angular)
    gaps = np.array([contacts.separation for contacts, _ in at_times])
    assert gamma_n == pytest.approx(SECOND @ gaps, rel=1e-6, abs=1e-6)
    slips = []
    for contacts, there in at_times:
        velocity_a, velocity_b = slip_at(contacts, scene, there, linear, angular)
        slips.append(velocity_b - velocity_a)
    rate = np.tensordot(FIRST, np.array(slips), 1)
    rate -= now.normal * (now.normal * rate).sum(axis=0)
    assert gamma_t == pytest.approx(rate, rel=1e-6, abs=1e-6)


def test_a_spinning_vertex_on_a_plane_has_its_centripetal_acceleration():
    scene = bodies([[2, 2, 2]], planes=[((0, 0, 1), 0.0)])
    position = np.array([[0.0, 0, 1], [0, 0, 0]]).T
    orientation = np.array([[0.0, 0, 0, 1]] * 2).T
    contacts = find_contacts(scene, [0], [1], position, orientation, 1e-9)
    spin = np.array([[3.0, 0, 0], [0, 0, 0]]).T
    gamma_n, gamma_t = gap_acceleration_bias(contacts, scene, position, np.zeros((3, 2)), spin)
    # w^2 r towards the axis of rotation, which is 1 above and 1 beside the vertices
    assert gamma_n == pytest.approx(np.full(4, 9.0))
    # b is the plane: what it does is minus what the vertex does
    assert gamma_t[1] == pytest.approx(9.0 * contacts.point[1])


def test_a_ball_that_rolls_in_a_curve_needs_no_bias():
    scene = bodies(radii=[0.5], planes=[((0, 0, 1), 0.0)])
    position = np.array([[0.0, 0, 0.5], [0, 0, 0]]).T
    orientation = np.array([[0.0, 0, 0, 1]] * 2).T
    contacts = find_contacts(scene, [0], [1], position, orientation, 1e-9)
    linear = np.array([[1.0, 0, 0], [0, 0, 0]]).T
    angular = np.array([[0.0, 2, 7], [0, 0, 0]]).T
    gamma_n, gamma_t = gap_acceleration_bias(contacts, scene, position, linear, angular)
    assert gamma_n == pytest.approx([0])
    assert gamma_t == pytest.approx(np.zeros((3, 1)))
