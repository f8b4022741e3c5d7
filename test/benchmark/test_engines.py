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

"""
The adapters: the same scene means the same in every engine that is installed.

A first-order scheme is off by its step times the acceleration: that bound, or what the discrete
scheme must give, is the tolerance.
"""

import numpy as np
import pytest
from rigid_sim_ros.benchmark.engines import ENGINES, installed_engines
from rigid_sim_ros.scene import load_scene
from scipy.spatial.transform import Rotation

STEP = 1 / 240
NO_GRAVITY = [0.0, 0.0, 0.0]
START = Rotation.from_rotvec([0.5, -0.3, 0.8])

every_engine = pytest.mark.parametrize('name', installed_engines())
no_report = pytest.mark.parametrize(
    # the report's engine knows cubes only, and no planes' friction
    'name', [name for name in installed_engines() if name != 'report'])


def built(name, mapping, sleeping=False):
    engine = ENGINES[name].load()
    engine.build(load_scene(mapping), STEP, sleeping)
    return engine


def box(**changes):
    return {'name': 'box', 'cube': {'edge': 0.4}, 'mass': 2.0, 'position': [1.0, 2.0, 3.0],
            'orientation': START.as_quat().tolist(), **changes}


@every_engine
def test_force_torque_and_pose_have_the_same_meaning(name):
    force, torque, time = np.array([1.0, -2.0, 0.5]), np.array([0.01, 0.02, -0.03]), 0.5
    engine = built(name, {'gravity': [0.0, 0.0, -1.0], 'bodies': [
        box(inertia=0.05, velocity=[0.1, 0.2, 0.3], force=force.tolist(),
            torque=torque.tolist())]})
    start = engine.read_poses()
    np.testing.assert_allclose(start[0], [[1.0, 2.0, 3.0]], atol=1e-6)
    assert (Rotation.from_quat(start[1][0]) * START.inv()).magnitude() < 1e-6
    engine.advance(time)
    position, orientation = engine.read_poses()
    linear, angular = engine.read_velocities()
    acceleration = force / 2.0 + [0.0, 0.0, -1.0]
    np.testing.assert_allclose(linear[0], [0.1, 0.2, 0.3] + acceleration * time, atol=2e-5)
    np.testing.assert_allclose(angular[0], torque / 0.05 * time, atol=5e-4)
    moved = np.array([0.1, 0.2, 0.3]) * time + acceleration * time ** 2 / 2
    bound = np.abs(acceleration).max() * time * STEP
    np.testing.assert_allclose(position[0] - [1.0, 2.0, 3.0], moved, atol=bound)
    turn = Rotation.from_rotvec(torque / 0.05 * time ** 2 / 2) * START
    # Rapier applies a torque in substeps, in float32
    assert (Rotation.from_quat(orientation[0]) * turn.inv()).magnitude() < 0.01


@no_report
def test_principal_moments_and_spin_have_the_same_axes(name):
    # about the axis of a symmetric top's symmetry nothing wobbles; about another it would
    spin = START.apply([0.0, 0.0, 4.0])
    rod = {'name': 'rod', 'box': {'size': [0.1, 0.1, 0.6]}, 'mass': 2.0,
           'position': [0.0, 0.0, 0.0], 'orientation': START.as_quat().tolist(),
           'inertia': [0.06, 0.06, 0.003], 'angular_velocity': spin.tolist()}
    engine = built(name, {'gravity': NO_GRAVITY, 'bodies': [rod]})
    engine.advance(1.0)
    expected = Rotation.from_rotvec(spin) * START
    assert (Rotation.from_quat(engine.read_poses()[1][0]) * expected.inv()).magnitude() < 2e-3
    # 240 steps in float32 lose four digits
    np.testing.assert_allclose(engine.read_velocities()[1][0], spin, atol=1e-3)


@no_report
def test_a_cube_comes_to_rest_on_a_tilted_plane_away_from_the_origin(name):
    normal = np.array([0.28, 0.0, 0.96])
    tilt = Rotation.from_euler('y', np.arctan2(0.28, 0.96))
    engine = built(name, {
        'material': {'restitution': 0.0, 'friction': 1.0},
        'planes': [{'name': 'slope', 'normal': normal.tolist(), 'offset': 0.5}],
        'bodies': [box(position=(0.701 * normal).tolist(), orientation=tilt.as_quat().tolist())]})
    engine.advance(0.5)
    position, _ = engine.read_poses()
    # engines of soft contact sink in by part of a millimetre
    assert position[0] @ normal - 0.5 == pytest.approx(0.2, abs=1e-3)
    assert np.linalg.norm(position[0] - 0.7 * normal) < 5e-3


@no_report
def test_fixed_bodies_stay_and_are_not_read(name):
    engine = built(name, {'material': {'restitution': 0.0}, 'bodies': [
        {'name': 'table', 'cube': {'edge': 1.0}, 'mass': 1.0, 'position': [0, 0, 0],
         'fixed': True},
        {'name': 'ball', 'sphere': {'radius': 0.1}, 'mass': 1.0, 'position': [0, 0, 0.601]}]})
    engine.advance(0.5)
    position, orientation = engine.read_poses()
    assert position.shape == (1, 3) and orientation.shape == (1, 4)
    assert position[0] == pytest.approx((0.0, 0.0, 0.6), abs=2e-3)
    assert engine.asleep().shape == (1,)


@pytest.mark.parametrize('restitution, height', [(1.0, 1.0), (0.5, 0.25)])
@pytest.mark.parametrize('name', [name for name in installed_engines()
                                  if name in ('mujoco', 'mujoco_rk4', 'rapier', 'bullet')])
def test_peers_rebound_as_the_scene_says(name, restitution, height):
    engine = built(name, {
        'material': {'restitution': restitution, 'friction': 0.0}, 'planes': [{'name': 'ground'}],
        'bodies': [{'name': 'ball', 'sphere': {'radius': 0.1}, 'mass': 1.0,
                    'position': [0, 0, 1.1]}]})
    heights = []
    for _ in range(240):
        engine.advance(STEP)
        heights.append(engine.read_poses()[0][0, 2] - 0.1)
    # 4 % of the speed is what a step's worth of gravity makes of it
    assert max(heights[120:]) == pytest.approx(height, rel=0.12)


@pytest.mark.parametrize('name', [name for name in ('mujoco', 'rapier') if
                                  name in installed_engines()])
def test_sleep_is_told_and_can_be_refused(name):
    scene = {'material': {'restitution': 0.0}, 'planes': [{'name': 'ground'}],
             'bodies': [box(position=[0, 0, 0.2], orientation=[0, 0, 0, 1])]}
    for sleeping in (True, False):
        engine = built(name, scene, sleeping)
        engine.advance(5.0)
        assert engine.asleep().tolist() == [sleeping]
