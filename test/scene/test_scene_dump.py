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

"""A dumped scene is loaded back equal, to the last bit of every number."""

from hypothesis import given, HealthCheck, settings, strategies as st
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.scene import dump_scene, load_scene
import yaml

NUMBER = st.floats(-1e6, 1e6).map(lambda value: value + 0.0)
VECTOR = st.tuples(NUMBER, NUMBER, NUMBER)
POSITIVE = st.one_of(st.floats(1e-6, 1e6), st.sampled_from([1e-05, 0.1, 1.0, 1e22]))
SIDE = st.floats(1e-3, 2)
SHAPE = st.one_of(st.builds(Cube, SIDE), st.builds(Sphere, SIDE),
                  st.builds(Box, st.tuples(SIDE, SIDE, SIDE)))
MATERIAL = st.builds(Material, st.floats(0, 1), st.floats(0, 1e3))
# printable characters only, no spaces at the ends: what names are made of
NAME = st.text(min_size=1, max_size=10).filter(
    lambda text: text.isprintable() and text == text.strip())
TURN = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(x * x for x in q) > 0.01)


def unit(values):
    length = sum(value * value for value in values) ** 0.5
    return tuple(value / length for value in values)


@st.composite
def bodies(draw, name, place):
    shape = draw(SHAPE)
    mass = draw(POSITIVE)
    if draw(st.booleans()):
        inertia = shape.inertia(mass)
    else:
        a, b, c = draw(st.tuples(POSITIVE, POSITIVE, POSITIVE))
        inertia = (a + b, b + c, c + a)
    motion = {} if draw(st.booleans()) else {
        'velocity': draw(VECTOR), 'angular_velocity': draw(VECTOR),
        'force': draw(VECTOR), 'torque': draw(VECTOR)}
    x, y, z = draw(st.tuples(*[st.floats(-1, 1)] * 3))
    return Body(name=name, shape=shape, mass=mass, inertia=inertia,
                position=(x + 10 * place, y, z + 100), orientation=unit(draw(TURN)),
                fixed=not motion and draw(st.booleans()), material=draw(MATERIAL), **motion)


@st.composite
def scenes(draw):
    names = draw(st.lists(NAME, unique=True, max_size=6))
    plane_count = draw(st.integers(0, len(names)))
    return Scene(
        bodies=tuple(draw(bodies(name, place)) for place, name in enumerate(names[plane_count:])),
        planes=tuple(Plane(name, (0.0, 0.0, 1.0), draw(st.floats(-9, 9)), draw(MATERIAL))
                     for name in names[:plane_count]),
        gravity=draw(VECTOR), impact_law=draw(st.sampled_from(['poisson', 'newton', 'stronge'])))


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(scenes())
def test_round_trip(scene):
    text = dump_scene(scene)
    assert load_scene(text) == scene
    # what other YAML readers see: the same numbers, not texts
    plain = yaml.safe_load(text)
    assert [entry['position'] for entry in plain['bodies']] == [
        list(body.position) for body in scene.bodies]
    assert tuple(plain['gravity']) == scene.gravity


def test_text_for_readers():
    scene = load_scene({
        'planes': [{'name': 'ground'}],
        'bodies': [{'name': 'a', 'cube': {'edge': 0.2}, 'mass': 1, 'position': [0, 0, 1],
                    'velocity': [1e-5, 0, 0]},
                   {'name': 'b', 'sphere': {'radius': 1}, 'fixed': True, 'position': [3, 0, 1],
                    'material': {'friction': 0, 'restitution_speed': 0.5}}]})
    assert dump_scene(scene) == """\
gravity: [0.0, 0.0, -9.81]
material: {restitution: 0.3, friction: 0.5}
impact_law: poisson
planes:
- {name: "ground", normal: [0.0, 0.0, 1.0], offset: 0.0}
bodies:
- {name: "a", cube: {edge: 0.2}, mass: 1.0, position: [0.0, 0.0, 1.0], \
velocity: [1.0e-05, 0.0, 0.0]}
- {name: "b", sphere: {radius: 1.0}, position: [3.0, 0.0, 1.0], fixed: true, \
material: {restitution: 0.3, friction: 0.0, restitution_speed: 0.5}}
"""


def test_a_scene_of_nothing():
    assert load_scene(dump_scene(Scene())) == Scene()
