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

"""Every refusal of a scene is one line that names the place, what was given, what is allowed."""

import copy
import os
import re

from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
from rigid_sim_ros.engine.model import Scene
from rigid_sim_ros.scene import load, load_scene, SceneError, shipped_scenes
from rigid_sim_ros.scene.bodies import BODY_KEYS
from rigid_sim_ros.scene.load import PLANE_KEYS, SCENE_KEYS
from rigid_sim_ros.scene.sources import scene_text

BODY = 'name: a, cube: {edge: 0.2}'
FULL = BODY + ', mass: 1'


def refusal(source):
    with pytest.raises(SceneError) as refused:
        load_scene(source)
    message = str(refused.value)
    assert len(message.splitlines()) == 1
    return message


def assert_refused(text, *expected):
    message = refusal(text + '\n')
    for pattern in expected:
        assert re.search(pattern, message), f'{pattern!r} is not in: {message}'


# what stands in the braces of one body: what the message has to say
BODIES = {
    '': ['number 1: name is missing'],
    'cube: {edge: 1}, mass: 1': ['body number 1: name is missing'],
    FULL + ', colour: red': ["body 'a': colour: unknown key; allowed are name, cube, box"],
    FULL + ', velocty: [0, 0, 0]': [r'velocty: unknown key \(did you mean velocity'],
    FULL + ', 3: 4': ['3: unknown key'],
    FULL + ', null: 4': ['nothing: unknown key'],
    'name: 7, cube: {edge: 1}, mass: 1': ['body number 1: name: 7 is not .* text .*quotes'],
    'name: "", cube: {edge: 1}, mass: 1': ["body '': name: '' is not .* text of 1 to 200"],
    'name: " a", cube: {edge: 1}, mass: 1': ['name: .* without spaces at its ends'],
    r'name: "a\nb", cube: {edge: 1}, mass: 1': [r"name: 'a\\nb' is not .* printable"],
    f'name: {"x" * 201}, cube: {{edge: 1}}, mass: 1': ['name: .*xxx. is not .* 1 to 200'],
    'name: a, mass: 1': ["body 'a': the shape is missing; one of cube, box, sphere"],
    FULL + ', sphere: {radius: 1}': ['cube and sphere: given together; only one of'],
    'name: a, cube: 0.2, mass: 1': ['cube: 0.2 is not allowed; must be a mapping .* edge'],
    'name: a, cube: {}, mass: 1': ['cube.edge is missing'],
    'name: a, cube: {size: 1}, mass: 1': ['cube.size: unknown key; allowed are edge'],
    'name: a, cube: {edge: 0}, mass: 1': ['cube.edge: 0 is not .* greater than 0'],
    'name: a, cube: {edge: -1}, mass: 1': ['cube.edge: -1 is not .* greater than 0'],
    'name: a, cube: {edge: .nan}, mass: 1': ['cube.edge: nan is not'],
    'name: a, cube: {edge: 1e-31}, mass: 1': ['cube.edge: 1e-31 is not .*1e-30'],
    'name: a, box: {size: 1}, mass: 1': ['box.size: 1 is not .* list of 3'],
    'name: a, box: {size: [1, 2]}, mass: 1': [r'box.size: \[1, 2\] is not .* list of 3'],
    'name: a, box: {size: [1, 0, 1]}, mass: 1': [r'box.size: \[1, 0, 1\] is not'],
    'name: a, sphere: {radius: true}, mass: 1': ['sphere.radius: true is not'],
    BODY: ["body 'a': mass or density is missing"],
    BODY + ', mass: 1, density: 1': ['mass and density: given together'],
    BODY + ', mass: -1': ['mass: -1 is not .* greater than 0'],
    BODY + ', mass: 0': ['mass: 0 is not'],
    BODY + ', mass: .inf': ['mass: inf is not'],
    BODY + ', mass: "1"': ["mass: '1' is not .* number"],
    BODY + ', mass: true': ['mass: true is not .* number'],
    BODY + ', mass: ': ['mass: nothing is not'],
    BODY + ', mass: 1:30': ["mass: '1:30' is not .* number"],
    BODY + ', mass: 0x10': ["mass: '0x10' is not .* number"],
    BODY + ', mass: 1' + '0' * 400: ['mass: inf is not'],
    BODY + ', mass: 1' + '0' * 200: ['mass: 10+.* is not'],
    BODY + ', density: -1': ['density: -1 is not'],
    'name: a, sphere: {radius: 1e20}, density: 1': ['mass .* follow from size and density'],
    FULL + ', inertia: [1, 1, 2.1]': [r'inertia: \[1, 1, 2.1\] is not .* sum of the two others'],
    FULL + ', inertia: 0': ['inertia: 0 is not'],
    FULL + ', inertia: [1, 1]': [r'inertia: \[1, 1\] is not'],
    FULL + ', inertia: [1, 1, .nan]': ['inertia: .*nan.* is not'],
    FULL + ', position: 1': ['position: 1 is not .* list of 3 finite numbers'],
    FULL + ', position: [1, 2, 3, 4]': ['position: .* is not .* list of 3'],
    FULL + ', position: [1, 2, x]': ["position: .*'x'.* is not .* list of 3"],
    FULL + ', position: [1, 2, .inf]': ['position: .*inf.* is not'],
    FULL + ', position: [1, 2, 1e31]': ['position: .*1e.31.* is not .* at most 1e.30'],
    FULL + ', position: {x: 1}': ["position: {'x': 1} is not"],
    FULL + ', orientation: [0, 0, 0, 1.002]': ['orientation: .* length 1 .* is 1.002'],
    FULL + ', orientation: [0, 0, 0, 0]': ['orientation: .* length is 0'],
    FULL + ', orientation: [0, 0, 1]': ['orientation: .* quaternion .x, y, z, w'],
    FULL + ', orientation: [0, 0, 0, .nan]': ['orientation: .*nan'],
    FULL + ', orientation: [0, 0, 0, 1], rpy: [0, 0, 0]': ['orientation and rpy: given together'],
    FULL + ', rpy: [0, 0]': ['rpy: .* list of 3'],
    FULL + ', velocity: [0, true, 0]': ['velocity: .* is not'],
    FULL + ', angular_velocity: fast': ["angular_velocity: 'fast' is not"],
    FULL + ', force: [0, 0, .nan]': ['force: .*nan'],
    FULL + ', torque: []': [r'torque: \[\] is not'],
    FULL + ', fixed: yes': ["fixed: 'yes' is not allowed; must be true or false"],
    FULL + ', fixed: 1': ['fixed: 1 is not allowed; must be true or false'],
    BODY + ', fixed: true, velocity: [1, 0, 0]': [r'velocity: .* \[0, 0, 0\] for a fixed body'],
    BODY + ', fixed: true, torque: [1, 0, 0]': [r'torque: .* \[0, 0, 0\] for a fixed body'],
    FULL + ', material: rubber': ["body 'a': material: 'rubber' .* restitution, friction"],
    FULL + ', material: {restitution: 1.1}': ['material.restitution: 1.1 is not .* 0 to 1'],
    FULL + ', material: {friction: -0.1}': ['material.friction: -0.1 is not .* 0 or more'],
    FULL + ', material: {restitution_speed: .inf}': ['material.restitution_speed: inf is not'],
    FULL + ', material: {rolling_friction: -1}': ['rolling_friction: -1 is not .* 0 or more'],
    FULL + ', material: {bounce: 1}': ['material.bounce: unknown key'],
    FULL + ', repeat: 3': ['repeat: 3 is not .* mapping'],
    FULL + ', repeat: {count: [1, 1, 1]}': ['repeat.spacing is missing'],
    FULL + ', repeat: {spacing: [1, 1, 1]}': ['repeat.count is missing'],
    FULL + ', repeat: {count: [1, 1, 1], spacing: [1, 1, 1], step: 1}': ['repeat.step: unknown'],
    FULL + ', repeat: {count: [0, 1, 1], spacing: [1, 1, 1]}': ['repeat.count: .* 1 or more'],
    FULL + ', repeat: {count: [1.5, 1, 1], spacing: [1, 1, 1]}': ['repeat.count: .* integers'],
    FULL + ', repeat: {count: 8, spacing: [1, 1, 1]}': ['repeat.count: 8 is not'],
    FULL + ', repeat: {count: [99999, 99999, 99999], spacing: [1, 1, 1]}':
        ['repeat.count: .* at most 100000 bodies'],
    FULL + ', repeat: {count: [1, 1, 1], spacing: [1, 1, 1], jitter: -1}': ['repeat.jitter: -1'],
    FULL + ', repeat: {count: [1, 1, 1], spacing: [1, 1, 1], seed: -1}': ['repeat.seed: -1'],
    FULL + ', repeat: {count: [1, 1, 1], spacing: [1, 1, 1], seed: 1.5}': ['repeat.seed: 1.5'],
    FULL + ', repeat: {count: [2, 1, 1], spacing: [0.15, 1, 1]}':
        ["body 'a_0': position: overlaps 'a_1' by 0.05 m .* at most 0.0001 m"],
}

# whole files
FILES = {
    'gravity: [0, 0, -9.81]': ['bodies is missing'],
    'bodies: {}': ['bodies: {} is not allowed; must be a list'],
    'bodies:': ['bodies: nothing is not allowed; must be a list'],
    'bodies: [a]': ["body number 1: 'a' is not allowed; must be a mapping"],
    'bodies: []\nplane: []': [r'plane: unknown key \(did you mean planes'],
    'bodies: []\ngravity: -9.81': ['gravity: -9.81 is not .* list of 3'],
    'bodies: []\nimpact_law: possion':
        [r"impact_law: 'possion' is not .* one of poisson, newton, stronge \(did you mean poiss"],
    'bodies: []\nimpact_law: [1]': ['impact_law: .* one of poisson'],
    'bodies: []\nmaterial: {friction: .nan}': ['material.friction: nan is not'],
    'bodies: []\nplanes: ground': ["planes: 'ground' is not allowed; must be a list"],
    'bodies: []\nplanes: [{normal: [0, 0, 1]}]': ['plane number 1: name is missing'],
    'bodies: []\nplanes: [{name: p, height: 1}]': ["plane 'p': height: unknown key"],
    'bodies: []\nplanes: [{name: p, normal: [0, 0, 2]}]': ["plane 'p': normal: .* length is 2"],
    'bodies: []\nplanes: [{name: p, offset: [1]}]': [r"plane 'p': offset: \[1\] is not"],
    'bodies: []\nplanes: [{name: p, material: {friction: a}}]':
        ["plane 'p': material.friction: 'a'"],
    'bodies: []\nplanes: [{name: p}, {name: p}]': ["name: 'p' is given twice"],
    f'planes: [{{name: a}}]\nbodies: [{{{FULL}, position: [0, 0, 9]}}]': ["name: 'a' is given tw"],
    f'bodies: [{{{FULL}}}, {{{FULL}, position: [9, 9, 9]}}]': ["name: 'a' is given twice"],
    f'bodies: [{{{FULL}, repeat: {{count: [2, 1, 1], spacing: [1, 1, 1]}}}},'
    ' {name: a_1, cube: {edge: 0.1}, mass: 1, position: [9, 9, 9]}]': ["'a_1' is given twice"],
    f'planes: [{{name: floor}}]\nbodies: [{{{FULL}}}]':
        ["body 'a': position: overlaps 'floor' by 0.1 m at the start"],
    '- a': [r"\['a'\] is not allowed; must be a mapping with the keys gravity"],
    '': ['nothing is not allowed; must be a mapping'],
    '# nothing': ['nothing is not allowed; must be a mapping'],
    'just text': ["'just text' is not allowed; must be a mapping"],
    'bodies: [': ['line 2, column 1: not valid YAML'],
    'bodies: []\n\tgravity: 1': ['line 2, column 1: not valid YAML'],
    'bodies: []\nbodies: []': ["line 2, column 1: .* the key 'bodies' is given twice"],
    f'bodies:\n- {{{FULL},\n   mass: 2}}': ["line 3, column 4: .* the key 'mass' is given twice"],
    'bodies: [] \n---\nbodies: []': ['line 2, column 1: .* a second document'],
    'bodies: !!seq []': ['line 1, column 9: .* tag'],
    'bodies: !!python/object:os.system []': ['line 1, column 9: .* tag'],
    'gravity: !!str 3': ['line 1, column 10: .* tag'],
    'bodies: *nowhere': ['line 1, column 9: .*alias .nowhere has no anchor'],
    'bodies: &a [*a]': ['line 1, column 13: .*alias .a has no anchor'],
    '? [a]\n: 1': ['line 1, .* a key must be a word'],
    '? {a: 1}\n: 1': ['line 1, .* a key must be a word'],
    '<<: 3\nbodies: []': ['line 1, column 5: .* << takes a mapping'],
    'bodies: \x00': ['not valid YAML'],
    'bodies: \ud800': ['not valid YAML'],
    'bodies: ' + '[' * 100_000: ['nested deeper than 20'],
    '- ' * 100_000: ['nested deeper than 20'],
    '{a: ' * 100_000: ['nested deeper than 20'],
}


@pytest.mark.parametrize('body', BODIES)
def test_bodies(body):
    assert_refused(f'bodies:\n- {{{body}}}', '^scene: body ', *BODIES[body])


@pytest.mark.parametrize('text', FILES)
def test_whole_files(text):
    assert_refused(text, '^scene: ', *FILES[text])


def test_one_hundred_thousand_bodies_in_all(monkeypatch):
    block = 'name: b, cube: {edge: 0.2}, mass: 1, ' \
            'repeat: {count: [100, 100, 10], spacing: [1, 1, 1]}'
    assert_refused(f'bodies: [{{{FULL}}}, {{{block}}}]',
                   r"body 'b': repeat.count: \[100, 100, 10\] is not .* at most 100000 bodies")
    monkeypatch.setattr(load, 'MAX_BODIES', 1)
    assert_refused(f'bodies: [{{{FULL}}}, {{{FULL}}}]', 'bodies: more than 1; must be at most 1')


def test_alias_bomb_is_refused_at_once():
    text = 'gravity: &a [1, 1]\n' + ''.join(
        f'k{level}: &{chr(98 + level)} [{", ".join(["*" + chr(97 + level)] * 9)}]\n'
        for level in range(9))
    assert_refused(text + 'bodies: *j', 'k0: unknown key')


@pytest.mark.parametrize('source, expected', [
    ('ten_cube', r"no shipped scene is named 'ten_cube' \(did you mean ten_cubes"),
    ('', "no shipped scene is named ''; they are drift, "),
    ('./missing.yaml', '^missing.yaml: no such file$|^./missing.yaml: no such file$'),
    ('missing.yaml', '^missing.yaml: no such file$'),
    ('missing.yml', '^missing.yml: no such file$'),
    ('/dev/null', '^/dev/null: not a regular file'),
    ('/', '^/: a folder'),
    ('a/\0.yaml', 'cannot be read|no such file'),
    ('x' * 5000 + '.yaml', 'cannot be read: File name too long'),
])
def test_sources(source, expected):
    assert re.search(expected, refusal(source))


def test_an_unknown_name_lists_all_shipped_scenes():
    assert ', '.join(shipped_scenes()) in refusal('nonsense')


def test_other_types_are_a_mistake_of_the_caller():
    with pytest.raises(TypeError, match='not list'):
        load_scene([])


def test_path_may_begin_at_home(tmp_path, monkeypatch):
    monkeypatch.setenv('HOME', str(tmp_path))
    assert refusal('~/here.yaml') == f'{tmp_path}/here.yaml: no such file'
    (tmp_path / 'here.yaml').write_text('bodies: []')
    assert load_scene('~/here.yaml').bodies == ()


def test_files(tmp_path):
    path = tmp_path / 'scene.yaml'
    assert refusal(path) == f'{path}: no such file'
    path.write_bytes(b'bodies: [] # caf\xe9\n')
    assert refusal(path) == f'{path}: not UTF-8 text: byte 0xe9 at offset 16'
    path.write_text('bodies: [1]')
    assert refusal(str(path)).startswith(f'{path}: body number 1: 1 is not allowed')
    path.write_text('bodies: []')
    assert load_scene(path) == Scene()
    path.write_bytes(b'\xef\xbb\xbfbodies: []')
    assert load_scene(path) == Scene()
    if os.getuid():
        path.chmod(0)
        assert refusal(path) == f'{path}: cannot be read: Permission denied'


SCALARS = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=3),
    st.sampled_from(['a', 'b', 'poisson', 0.2, 1, 10 ** 400, 1e308, 5e-324]))
CONTENT = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.lists(st.floats(-2, 2), min_size=3, max_size=4),
        st.dictionaries(st.sampled_from(
            [*SCENE_KEYS, *PLANE_KEYS, *BODY_KEYS, 'edge', 'size', 'radius', 'restitution',
             'friction', 'restitution_speed',
             'count', 'spacing', 'jitter', 'seed', 'x', 1]), inner, max_size=5)),
    max_leaves=10)

VALID = {
    'gravity': [0, 0, -9.81], 'material': {'restitution': 0.3, 'friction': 0.5},
    'impact_law': 'newton',
    'planes': [{'name': 'p', 'normal': [0, 0, 1], 'offset': -5.0, 'material': {'friction': 1}}],
    'bodies': [
        {'name': 'a', 'box': {'size': [1, 2, 3]}, 'mass': 1, 'inertia': [1, 1, 1],
         'position': [0, 0, 0], 'orientation': [0, 0, 0, 1], 'velocity': [0, 0, 0],
         'angular_velocity': [1, 2, 3], 'force': [0, 0, 0], 'torque': [0, 0, 0], 'fixed': False,
         'material': {'restitution': 0.5}},
        {'name': 'b', 'sphere': {'radius': 1}, 'density': 2, 'position': [9, 9, 9],
         'rpy': [1, 2, 3], 'repeat': {'count': [2, 1, 1], 'spacing': [3, 3, 3], 'jitter': 0.1,
                                      'seed': 3}}]}


def places(value, path=()):
    """Yield the paths of keys and indices to everything inside a value."""
    items = value.items() if isinstance(value, dict) else enumerate(value) \
        if isinstance(value, list) else ()
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(path=st.sampled_from(list(places(VALID))), value=CONTENT)
def test_any_wrong_value_anywhere_is_refused_in_one_line_or_loads(path, value):
    content = copy.deepcopy(VALID)
    inner = content
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    try:
        assert isinstance(load_scene(content), Scene)
    except SceneError as error:
        assert len(str(error).splitlines()) == 1
        assert len(str(error)) < 500


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_damaged_text_is_refused_in_one_line_or_loads(data):
    text = scene_text(data.draw(st.sampled_from(['real_toss', 'tower', 'ten_cubes'])))[0]
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = start + data.draw(st.integers(0, 5))
        inserted = data.draw(st.text('[]{}:,-&*!|>?"\'#%@ \n\t\0ae1.~', max_size=4))
        text = text[:start] + inserted + text[end:]
    try:
        assert isinstance(load_scene(text + '\n'), Scene)
    except SceneError as error:
        assert len(str(error).splitlines()) == 1
