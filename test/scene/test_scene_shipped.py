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

"""The shipped scenes hold what their comments promise."""

from math import sqrt

import numpy as np
import pytest
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.shapes import Cube
from rigid_sim_ros.scene import dump_scene, load_scene, shipped_scenes

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]).T


def array(scene, field):
    return np.array([getattr(body, field) for body in scene.bodies])


def test_the_names():
    assert {'drift', 'real_toss', 'report_collision', 'report_detection', 'report_dynamics',
            'ten_cubes', 'tower'} <= set(shipped_scenes())


@pytest.mark.parametrize('name', shipped_scenes())
def test_every_scene_loads_and_dumps(name):
    scene = load_scene(name)
    assert scene.bodies
    assert load_scene(dump_scene(scene)) == scene


def test_report_dynamics_is_the_five_motions_and_nothing_ever_meets():
    scene = load_scene('report_dynamics')
    moving = array(scene, 'velocity').any(axis=1)
    turning = array(scene, 'angular_velocity').any(axis=1)
    forced = array(scene, 'force').any(axis=1)
    twisted = array(scene, 'torque').any(axis=1)
    assert not any(scene.gravity) and not scene.planes
    assert np.stack((turning, twisted, moving, forced), axis=1).astype(int).tolist() == [
        [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [1, 0, 1, 0]]
    # all motion is along y, in lanes further apart than a cube's space diagonal
    assert not array(scene, 'velocity')[:, [0, 2]].any()
    assert not array(scene, 'force')[:, [0, 2]].any()
    assert np.diff(array(scene, 'position')[:, 0]).min() > 0.2 * sqrt(3)


@pytest.mark.parametrize('name, expected', [
    ('report_detection', 1.3268), ('report_collision', 1.3323)])
def test_two_cubes_meet_when_the_comment_says(name, expected):
    left, right = load_scene(name).bodies
    assert left.shape == right.shape == Cube(0.2)
    corners = np.array(right.position)[:, None] + rotation.rotate(
        np.array(right.orientation), 0.1 * CORNERS)
    first = corners[:, np.argmin(corners[0])]
    closing = left.velocity[0] - right.velocity[0]
    time = (first[0] - (left.position[0] + 0.1)) / closing
    assert time == pytest.approx(expected, abs=5e-5)
    # inside the face, by a margin
    assert np.abs(first[1:]).max() < 0.08


def test_report_collision_loses_no_energy():
    scene = load_scene('report_collision')
    assert {(body.material.restitution, body.material.friction)
            for body in scene.bodies} == {(1.0, 0.0)}


def test_ten_cubes():
    scene = load_scene('ten_cubes')
    assert [(body.shape, body.mass) for body in scene.bodies] == [(Cube(0.2), 1.0)] * 10
    material = scene.planes[0].material
    assert {body.material for body in scene.bodies} == {material}
    assert (material.restitution, material.friction) == (0.3, 0.5)
    assert scene.gravity == (0.0, 0.0, -9.81)


def test_tower_stands_touching():
    scene = load_scene('tower')
    assert array(scene, 'position') == pytest.approx(
        np.array([[0, 0, 0.1 + 0.2 * level] for level in range(10)]), abs=1e-15)


def test_drift_never_meets():
    scene = load_scene('drift')
    assert len(scene.bodies) == 1000
    assert len({body.velocity for body in scene.bodies}) == 1
    position = array(scene, 'position')
    distance = np.linalg.norm(position[:, None] - position, axis=2)
    np.fill_diagonal(distance, np.inf)
    assert distance.min() > 0.2 * sqrt(3)


# Toss 40 of ContactNets as published, in m and w x y z: samples 0 and 14 (the last before
# contact) of 148 a second.
PUBLISHED_POSITION = np.array([[0.0328844, -0.3059069, 0.1476466],
                               [0.0154964, -0.1937457, 0.0946680]])
PUBLISHED_QUATERNION = np.array([[-0.4250302, 0.2755088, -0.8542193, -0.1172759],
                                 [-0.4596659, 0.3360174, -0.8192368, 0.0681947]])
LENGTH_SCALE = 0.978


def test_real_toss_flies_through_the_measured_samples():
    body, = load_scene('real_toss').bodies
    time = np.array([0, 14]) / 148
    fall = np.outer(time ** 2, [0, 0, -9.81]) / 2
    position = body.position + np.outer(time, body.velocity) + fall
    # the noise of a measured position is 0.06 mm an axis
    assert np.abs(position - PUBLISHED_POSITION / LENGTH_SCALE).max() < 0.2e-3
    turn = rotation.from_rotation_vector(np.outer(body.angular_velocity, time))
    orientation = rotation.multiply(turn, np.array(body.orientation)[:, None])
    measured = PUBLISHED_QUATERNION[:, [1, 2, 3, 0]].T
    # and that of an orientation 0.02 degrees an axis
    assert np.degrees(rotation.angle_between(orientation, measured)).max() < 0.1


def test_real_toss_is_the_published_cube():
    scene = load_scene('real_toss')
    body, = scene.bodies
    assert (body.shape, body.mass, body.inertia) == (Cube(0.1048), 0.37, (0.00081,) * 3)
    assert {item.material.friction for item in (body, *scene.planes)} == {0.18}
    assert {item.material.restitution for item in (body, *scene.planes)} == {0.125}
