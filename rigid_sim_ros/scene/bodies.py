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

"""One entry of `bodies` in a scene file: a body, or by `repeat` a block of copies."""

from dataclasses import fields, replace

import numpy as np
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.model import Body, Material
from rigid_sim_ros.engine.shapes import SHAPES
from rigid_sim_ros.scene import values
from rigid_sim_ros.scene.errors import listed, SceneError, shown
from rigid_sim_ros.scene.values import Section

MAX_BODIES = 100_000
"""Bodies in a scene, all copies counted: about the memory and patience of one process."""

UNUSED_MASS = 1.0
"""Mass [kg] of a fixed body that is given none; nothing depends on it."""

SHAPE_PARAMETERS = {'edge': values.positive, 'size': values.sides, 'radius': values.positive}
"""Reader of every parameter of a shape, by the name its constructor has for it."""

SHAPE_KEYS = {'cube': ('edge',), 'box': ('size',), 'sphere': ('radius',)}
"""Parameters of every shape, in the order of its constructor."""

BODY_KEYS = ('name', *SHAPES, 'mass', 'density', 'inertia', 'position', 'orientation', 'rpy',
             'velocity', 'angular_velocity', 'force', 'torque', 'fixed', 'material', 'repeat')


def read_bodies(entry, index, label, default_material, room=MAX_BODIES):
    """
    Return the bodies, a list, that one entry of `bodies` describes.

    Parameters
    ----------
    entry : dict
        The mapping in the file.
    index : int
        Its place in the list: what messages say until its name is known.
    label : str
        The file: the start of every message.
    default_material : Material
        The material of the scene, of which the body may override parts.
    room : int
        How many bodies the scene has room for.

    """
    section = Section(entry, body_label(entry, index, label), BODY_KEYS, required=('name',))
    name = section.read('name', values.name)
    shape = _read_shape(section)
    fixed = section.read('fixed', values.truth, False)
    mass, inertia = _read_inertia(section, shape, fixed)
    motion = values.zero_vector if fixed else values.vector
    body = Body(
        name=name, shape=shape, mass=mass, inertia=inertia,
        position=section.read('position', values.vector, Body.position),
        orientation=_read_orientation(section),
        velocity=section.read('velocity', motion, Body.velocity),
        angular_velocity=section.read('angular_velocity', motion, Body.angular_velocity),
        force=section.read('force', motion, Body.force),
        torque=section.read('torque', motion, Body.torque),
        fixed=fixed, material=read_material(section, default_material))
    return _repeated(section, body, room) if 'repeat' in section else [body]


def body_label(entry, index, label, kind='body'):
    """Return 'file: body 'name'', or 'file: body number 3' where there is no usable name."""
    name = entry.get('name') if isinstance(entry, dict) else None
    return f'{label}: {kind} ' + (shown(name) if isinstance(name, str) else f'number {index + 1}')


def read_material(section, default):
    """Return the Material of a section; what it leaves out is as in `default`."""
    if 'material' not in section:
        return default
    names = tuple(field.name for field in fields(Material))
    given = Section(section.values['material'], section.label, names,
                    prefix=section.prefix + 'material.')
    readers = {'restitution': values.fraction}
    return Material(**{name: given.read(name, readers.get(name, values.not_negative),
                                        getattr(default, name)) for name in names})


def _read_shape(section):
    kind = section.at_most_one(*SHAPES)
    if kind is None:
        raise SceneError(f'{section.label}: the shape is missing; one of {listed(SHAPES)}')
    keys = SHAPE_KEYS[kind]
    given = Section(section.values[kind], section.label, keys, required=keys, prefix=kind + '.')
    return SHAPES[kind](*[given.read(key, SHAPE_PARAMETERS[key]) for key in keys])


def _read_inertia(section, shape, fixed):
    """Return mass [kg] and principal moments [kg m^2]."""
    given = section.at_most_one('mass', 'density')
    if given is None and not fixed:
        raise SceneError(f'{section.label}: mass or density is missing')
    if given == 'density':
        mass = section.read('density', values.positive) * shape.volume
    else:
        mass = section.read('mass', values.positive, UNUSED_MASS)
    inertia = section.read('inertia', values.inertia, shape.inertia(mass))
    try:
        values.positive(mass)
        values.inertia(inertia)
    except values.NotAllowed:
        raise SceneError(f'{section.label}: mass {mass:g} kg and moments of inertia '
                         f'{listed(inertia)} kg m^2 follow from size and {given}; must be from '
                         f'{1 / values.LARGEST:g} to {values.LARGEST:g}') from None
    return mass, inertia


def _read_orientation(section):
    if section.at_most_one('orientation', 'rpy') == 'rpy':
        return rotation.from_rpy(*section.read('rpy', values.vector))
    return section.read('orientation', values.quaternion, Body.orientation)


def _repeated(section, body, room):
    """Return the copies: NAME_0, NAME_1, ..., x running fastest, then y, then z."""
    keys = ('count', 'spacing', 'jitter', 'seed')
    repeat = Section(section.values['repeat'], section.label, keys,
                     required=('count', 'spacing'), prefix='repeat.')
    counts = repeat.read('count', values.counts)
    copy_count = counts[0] * counts[1] * counts[2]
    if copy_count > room:
        raise repeat.refused('count', list(counts), f'at most {MAX_BODIES} bodies in all')
    spacing = repeat.read('spacing', values.vector)
    jitter = repeat.read('jitter', values.not_negative, 0.0)
    random = np.random.default_rng(repeat.read('seed', values.seed, 0))
    layer, row, column = np.unravel_index(np.arange(copy_count), counts[::-1])
    position = np.array(body.position) + np.stack((column, row, layer), axis=1) * spacing
    position += random.uniform(-1.0, 1.0, (copy_count, 3)) * jitter
    return [replace(body, name=f'{body.name}_{index}', position=tuple(place))
            for index, place in enumerate(position.tolist())]
