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

"""Reading a whole scene: planes, bodies, and what they must fulfil together."""

from itertools import chain

from rigid_sim_ros.engine.impacts import IMPACT_LAWS
from rigid_sim_ros.engine.model import Material, Plane, Scene
from rigid_sim_ros.scene import values
from rigid_sim_ros.scene.bodies import body_label, MAX_BODIES, read_bodies, read_material
from rigid_sim_ros.scene.errors import SceneError, shown
from rigid_sim_ros.scene.overlap import deepest_overlap
from rigid_sim_ros.scene.sources import scene_text
from rigid_sim_ros.scene.values import Section
from rigid_sim_ros.scene.yaml_values import parse_yaml

SCENE_KEYS = ('gravity', 'material', 'impact_law', 'planes', 'bodies')
PLANE_KEYS = ('name', 'normal', 'offset', 'material')


def load_scene(source):
    """
    Return the `model.Scene` that a scene file describes, every value checked.

    Parameters
    ----------
    source : str, pathlib.Path or dict
        The path of a YAML file (a Path, or a text with a / or ending in .yaml), the name of a
        shipped scene, the YAML itself (a text with a line break), or the mapping it would hold.

    Raises
    ------
    SceneError
        One line: file, body, key, the value given and what is allowed.

    """
    if isinstance(source, dict):
        return _read_scene(source, 'scene')
    text, label = scene_text(source)
    return _read_scene(parse_yaml(text, label), label)


def _read_scene(content, label):
    section = Section(content, label, SCENE_KEYS, required=('bodies',))
    material = read_material(section, Material())
    planes = tuple(_read_plane(entry, index, label, material)
                   for index, entry in enumerate(_entries(section, 'planes')))
    bodies = _read_all_bodies(section, label, material)
    scene = Scene(
        bodies=bodies, planes=planes,
        gravity=section.read('gravity', values.vector, Scene.gravity),
        impact_law=section.read('impact_law', values.choice(*IMPACT_LAWS), Scene.impact_law))
    _check_names(scene, label)
    _check_overlaps(scene, label)
    return scene


def _entries(section, key):
    entries = section.values.get(key, ())
    if not isinstance(entries, (list, tuple)):
        raise section.refused(key, entries, 'a list')
    return entries


def _read_plane(entry, index, label, material):
    section = Section(entry, body_label(entry, index, label, 'plane'), PLANE_KEYS,
                      required=('name',))
    return Plane(name=section.read('name', values.name),
                 normal=section.read('normal', values.unit_vector, Plane.normal),
                 offset=section.read('offset', values.number, Plane.offset),
                 material=read_material(section, material))


def _read_all_bodies(section, label, material):
    bodies = []
    for index, entry in enumerate(_entries(section, 'bodies')):
        room = MAX_BODIES - len(bodies)
        if room == 0:
            raise SceneError(f'{label}: bodies: more than {MAX_BODIES}; must be at most '
                             f'{MAX_BODIES} in all')
        bodies += read_bodies(entry, index, label, material, room)
    return tuple(bodies)


def _check_names(scene, label):
    seen = set()
    for each in chain(scene.planes, scene.bodies):
        if each.name in seen:
            raise SceneError(f'{label}: name: {shown(each.name)} is given twice; bodies (copies '
                             'by repeat too) and planes must all have different names')
        seen.add(each.name)


def _check_overlaps(scene, label):
    found = deepest_overlap(scene)
    if found:
        name_a, name_b, depth, tolerance = found
        raise SceneError(f'{label}: body {shown(name_a)}: position: overlaps {shown(name_b)} by '
                         f'{depth:.3g} m at the start; at most {tolerance:.3g} m is allowed')
