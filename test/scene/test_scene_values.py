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

"""What a scene file says is what the scene holds, with the defaults it leaves out."""

from math import pi, sqrt

import numpy as np
import pytest
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.scene import load_scene

EVERYTHING = """
gravity: [0.1, -0.2, -1.62]
material: {restitution: 0.25, friction: 1.5}
impact_law: stronge
planes:
  - {name: ground, normal: [0, 0, 1], offset: -1}
  - {name: wall, normal: [0.6, 0, 0.8], offset: -9, material: {friction: 0}}
bodies:
  - name: brick
    box: {size: [0.1, 0.2, 0.3]}
    mass: 2
    inertia: [0.03, 0.02, 0.04]
    position: [1, 2, 3]
    orientation: [0.5, -0.5, 0.5, -0.5]
    velocity: [4, 5, 6]
    angular_velocity: [7, 8, 9]
    force: [-1, -2, -3]
    torque: [-4, -5, -6]
    material: {restitution: 1, restitution_speed: 2, rolling_friction: 0.01,
               pivoting_friction: 0.02}
  - name: ball
    sphere: {radius: 0.5}
    density: 1000
    position: [-3, 0, 0]
    fixed: true
"""


def test_everything():
    brick = Body(
        name='brick', shape=Box((0.1, 0.2, 0.3)), mass=2.0, inertia=(0.03, 0.02, 0.04),
        position=(1.0, 2.0, 3.0), orientation=(0.5, -0.5, 0.5, -0.5), velocity=(4.0, 5.0, 6.0),
        angular_velocity=(7.0, 8.0, 9.0), force=(-1.0, -2.0, -3.0), torque=(-4.0, -5.0, -6.0),
        material=Material(restitution=1.0, friction=1.5, restitution_speed=2.0,
                          rolling_friction=0.01, pivoting_friction=0.02))
    mass = 4 / 3 * pi * 0.5 ** 3 * 1000
    ball = Body(
        name='ball', shape=Sphere(0.5), mass=mass, inertia=(0.4 * mass * 0.25,) * 3,
        position=(-3.0, 0.0, 0.0), fixed=True, material=Material(0.25, 1.5))
    assert load_scene(EVERYTHING) == Scene(
        bodies=(brick, ball), gravity=(0.1, -0.2, -1.62), impact_law='stronge',
        planes=(Plane('ground', (0.0, 0.0, 1.0), -1.0, Material(0.25, 1.5)),
                Plane('wall', (0.6, 0.0, 0.8), -9.0, Material(0.25, 0.0))))


def test_defaults():
    scene = load_scene({'planes': [{'name': 'ground'}],
                        'bodies': [{'name': 'cube', 'cube': {'edge': 2}, 'mass': 3,
                                    'position': [0, 0, 1]}]})
    material = Material(restitution=0.3, friction=0.5)
    assert scene == Scene(
        gravity=(0.0, 0.0, -9.81), impact_law='poisson',
        planes=(Plane('ground', (0.0, 0.0, 1.0), 0.0, material),),
        bodies=(Body('cube', Cube(2.0), 3.0, (2.0, 2.0, 2.0), (0.0, 0.0, 1.0),
                     (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3, (0.0,) * 3, (0.0,) * 3,
                     False, material),))


def body(**changes):
    """Load one body, a cube unless told otherwise, and return it."""
    entry = {'name': 'a', 'cube': {'edge': 0.2}, 'mass': 1, **changes}
    return load_scene({'bodies': [entry]}).bodies[0]


def test_every_value_is_a_python_float():
    loaded = body(mass=np.float32(0.5), position=np.array([1, 2, 3]), velocity=(np.int64(4), 5, 6))
    assert (loaded.mass, loaded.position, loaded.velocity) == (0.5, (1, 2, 3), (4, 5, 6))
    assert {type(value) for value in (loaded.mass, *loaded.position, *loaded.velocity,
                                      *loaded.inertia, loaded.shape.edge)} == {float}


@pytest.mark.parametrize('rpy, expected', [
    ([pi / 2, 0, 0], [sqrt(0.5), 0, 0, sqrt(0.5)]),
    ([0, pi / 2, 0], [0, sqrt(0.5), 0, sqrt(0.5)]),
    ([0, 0, pi / 2], [0, 0, sqrt(0.5), sqrt(0.5)]),
    # about x first, then about the fixed z: their quaternions multiplied by hand
    ([pi / 2, 0, pi / 2], [0.5, 0.5, 0.5, 0.5]),
])
def test_roll_pitch_yaw_about_fixed_axes(rpy, expected):
    assert body(rpy=rpy).orientation == pytest.approx(expected, abs=1e-15)


def test_a_quaternion_rounded_by_hand_is_normalised():
    assert body(orientation=[0, 0, 0.7071, 0.7071]).orientation == pytest.approx(
        (0, 0, sqrt(0.5), sqrt(0.5)), abs=1e-15)
    exact = (0.5, 0.5, -0.5, 0.5)
    assert body(orientation=exact).orientation == exact


def test_one_moment_of_inertia_stands_for_three():
    assert body(inertia=0.25).inertia == (0.25, 0.25, 0.25)


def test_an_inertia_on_the_limit_is_possible():
    # a thin plate: the moment about its normal is the sum of the two others
    assert body(inertia=[0.1, 0.2, 0.3]).inertia == (0.1, 0.2, 0.3)


def test_a_fixed_body_needs_no_mass():
    fixed = load_scene({'bodies': [{'name': 'a', 'cube': {'edge': 1}, 'fixed': True}]}).bodies[0]
    assert fixed.fixed and fixed.mass > 0


@pytest.mark.parametrize('text, expected', [
    ('1e-3', 0.001), ('1E3', 1000), ('.5', 0.5), ('5.', 5), ('+2', 2), ('012', 12),
    ('1.5e+2', 150), ('1.e1', 10), ('"0.5"', None), ('1_000', None), ('0b1', None)])
def test_numbers_are_those_of_yaml_1_2(text, expected):
    source = f'bodies: [{{name: a, cube: {{edge: 0.2}}, mass: {text}}}]\n'
    if expected is None:
        with pytest.raises(ValueError, match='number greater than 0'):
            load_scene(source)
    else:
        assert load_scene(source).bodies[0].mass == expected


@pytest.mark.parametrize('name', ['yes', 'no', 'on', 'off', 'y', '2026-01-01', '12:30', '=', '-x'])
def test_names_that_yaml_1_1_takes_for_something_else(name):
    assert load_scene(f'bodies: [{{name: {name}, cube: {{edge: 1}}, mass: 1}}]\n'
                      ).bodies[0].name == name


def test_aliases_and_merged_mappings():
    scene = load_scene("""
bodies:
  - &first {name: a, cube: &shape {edge: 0.2}, mass: &m 2, position: [0, 0, 0]}
  - {name: b, cube: *shape, mass: *m, position: [1, 0, 0]}
  - {<<: *first, name: c, position: [2, 0, 0]}
  - {name: d, position: [3, 0, 0], <<: [{mass: 7}, *first]}
""")
    assert [each.name for each in scene.bodies] == ['a', 'b', 'c', 'd']
    assert [each.position[0] for each in scene.bodies] == [0, 1, 2, 3]
    assert [each.mass for each in scene.bodies] == [2, 2, 2, 7]
    assert {each.shape for each in scene.bodies} == {Cube(0.2)}


BLOCK = {'name': 'a', 'cube': {'edge': 0.2}, 'mass': 1, 'position': [1, 2, 3],
         'velocity': [1, 0, 0]}


def test_repeat_runs_along_x_then_y_then_z():
    repeat = {'count': [2, 3, 2], 'spacing': [0.5, 1, -2]}
    bodies = load_scene({'bodies': [{**BLOCK, 'repeat': repeat}]}).bodies
    assert [each.name for each in bodies] == [f'a_{index}' for index in range(12)]
    assert [each.position for each in bodies] == [
        (1 + 0.5 * i, 2 + j, 3 - 2.0 * k) for k in range(2) for j in range(3) for i in range(2)]
    assert {each.velocity for each in bodies} == {(1, 0, 0)}


def test_jitter_is_bounded_and_repeatable():
    def positions(**changes):
        repeat = {'count': [10, 10, 10], 'spacing': [1, 1, 1], **changes}
        bodies = load_scene({'bodies': [{**BLOCK, 'repeat': repeat}]}).bodies
        return np.array([each.position for each in bodies])

    moved = positions(jitter=0.1, seed=1) - positions()
    assert np.abs(moved).max() <= 0.1 + 1e-15
    # 3000 uniform draws on (-0.1, 0.1): standard deviation 0.1 / sqrt(3), here within 5 sigma
    assert abs(moved.std() - 0.1 / sqrt(3)) < 0.003
    assert (positions(jitter=0.1, seed=1) == positions(jitter=0.1, seed=1)).all()
    assert (positions(jitter=0.1, seed=1) != positions(jitter=0.1, seed=2)).all()
