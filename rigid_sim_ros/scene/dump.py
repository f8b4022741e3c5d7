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

"""A scene as the text of a scene file."""

from collections import Counter
from dataclasses import fields
from itertools import chain
import json

from rigid_sim_ros.engine.model import Body, Material
from rigid_sim_ros.engine.shapes import SHAPES
from rigid_sim_ros.scene.bodies import SHAPE_KEYS, UNUSED_MASS

_SHAPE_NAMES = {shape: name for name, shape in SHAPES.items()}

_VECTORS = ('position', 'orientation', 'velocity', 'angular_velocity', 'force', 'torque')


def dump_scene(scene):
    """
    Return YAML text, one body a line, that `load_scene` takes back to an equal scene.

    Numbers are written so that they come back to the last bit, and what has its default value
    is left out. Written directly, as PyYAML takes seconds for thousands of bodies; names are
    quoted as in JSON, which YAML reads the same.
    """
    usage = Counter(item.material for item in chain(scene.planes, scene.bodies))
    common = usage.most_common(1)[0][0] if usage else Material()
    lines = [f'gravity: {_vector(scene.gravity)}',
             f'material: {_material(common)}',
             f'impact_law: {scene.impact_law}']
    for key, items, write in (('planes', scene.planes, _plane), ('bodies', scene.bodies, _body)):
        lines.append(f'{key}:' if items else f'{key}: []')
        lines += [f'- {{{", ".join(write(item, common))}}}' for item in items]
    return '\n'.join(lines) + '\n'


def _number(value):
    text = repr(float(value))
    # YAML 1.1 readers take 1e-05 for text, and 1.0e-05 for the number
    return text.replace('e', '.0e') if 'e' in text and '.' not in text else text


def _vector(values):
    return f'[{", ".join([_number(value) for value in values])}]'


def _material(material):
    given = [field.name for field in fields(material)
             if field.name in ('restitution', 'friction') or getattr(material, field.name)]
    return '{' + ', '.join(
        f'{name}: {_number(getattr(material, name))}' for name in given) + '}'


def _name(name):
    return f'name: {json.dumps(name, ensure_ascii=False)}'


def _plane(plane, common):
    fields = [_name(plane.name), f'normal: {_vector(plane.normal)}',
              f'offset: {_number(plane.offset)}']
    if plane.material != common:
        fields.append(f'material: {_material(plane.material)}')
    return fields


def _body(body, common):
    fields = [_name(body.name), _shape(body.shape)]
    if not (body.fixed and body.mass == UNUSED_MASS):
        fields.append(f'mass: {_number(body.mass)}')
    if tuple(body.inertia) != body.shape.inertia(body.mass):
        fields.append(f'inertia: {_vector(body.inertia)}')
    for key in _VECTORS:
        value = getattr(body, key)
        if value != getattr(Body, key):
            fields.append(f'{key}: {_vector(value)}')
    if body.fixed:
        fields.append('fixed: true')
    if body.material != common:
        fields.append(f'material: {_material(body.material)}')
    return fields


def _shape(shape):
    name = _SHAPE_NAMES[type(shape)]
    parameters = []
    for key in SHAPE_KEYS[name]:
        value = getattr(shape, key)
        text = _vector(value) if isinstance(value, tuple) else _number(value)
        parameters.append(f'{key}: {text}')
    return f'{name}: {{{", ".join(parameters)}}}'
