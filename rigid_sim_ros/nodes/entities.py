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

"""Bodies that come, go and are moved while a session runs; every refusal leaves all as it was."""

from dataclasses import replace
import re

from rigid_sim_ros.engine import CommandError
from rigid_sim_ros.engine.commands import unit_quaternion, vector
from rigid_sim_ros.nodes.commands import largest
from rigid_sim_ros.nodes.counted_warnings import near_names, shown
from rigid_sim_ros.scene import load_scene, SceneError, values
from rigid_sim_ros.scene.overlap import deepest_overlap
from rigid_sim_ros.scene.yaml_values import parse_yaml

SOME_NAME = 'body'
"""What a body is called that comes without a name."""

MOST_REPEATS = 4
"""
Repeats in a pattern, each of which multiplies the ways to match a name by its length at most. A
repeated group would raise them to its power, and searching could take for ever.
"""


class EntityError(ValueError):
    """What was asked for cannot be done; the text is one line."""


class UnknownEntity(EntityError):
    """There is no such body."""


class NameTaken(EntityError):
    """There is a body or plane of that name already."""


class BadDescription(EntityError):
    """The description of a body cannot be read, or does not describe one body."""


class BadState(EntityError):
    """A pose or velocity is none: numbers that are not finite or too large, a zero quaternion."""


class BadPlace(EntityError):
    """There is no room for the body where it shall be."""


def described_body(text, uri):
    """
    Return the `model.Body` that a description holds; raises `BadDescription`.

    The description is `text`, or what is at `uri`: a scene file or the name of a shipped scene
    with one body, or what stands for one body in a scene file, with or without its name.
    """
    try:
        bodies = load_scene(_described_scene(text) if text else uri).bodies
    except SceneError as error:
        raise BadDescription(str(error)) from error
    if len(bodies) != 1:
        raise BadDescription(f'the description has {len(bodies)} bodies; one is needed')
    return bodies[0]


def _searcher(pattern):
    """Return the function that finds a regular expression; raises `EntityError`."""
    try:
        found = re.compile(pattern).search
    except (re.error, OverflowError, RecursionError) as error:
        raise EntityError(f'{shown(pattern)} is no regular expression: {error}') from error
    # without what is meant literally
    plain = re.sub(r'\\.|\[\^?\]?[^]]*\]', 'x', pattern, flags=re.DOTALL)
    if re.search(r'\)\s*[*+{]', plain) or len(re.findall('[*+?{]', plain)) > MOST_REPEATS:
        raise EntityError(f'{shown(pattern)} may take for ever to look for: at most '
                          f'{MOST_REPEATS} repeats are allowed, and none of a group in ()')
    return found


def _described_scene(text):
    """Return what `load_scene` takes for a description; raises `SceneError`."""
    content = parse_yaml(text, 'description')
    if not isinstance(content, dict):
        # read as a whole scene, it is refused in the words for that
        return text + '\n'
    return content if 'bodies' in content else {'bodies': [{'name': SOME_NAME, **content}]}


class Entities:
    """The bodies of a session, moving and fixed, by name."""

    def __init__(self, session):
        self._session = session

    @property
    def names(self):
        """Return the names of all bodies, in scene order."""
        return tuple(body.name for body in self._session.simulation.scene.bodies)

    def matching(self, pattern):
        """Return the names in which a regular expression is found; raises `EntityError`."""
        found = _searcher(pattern)
        return tuple(name for name in self.names if found(name))

    def body(self, name):
        """Return a body as it is now, a `model.Body`; raises `UnknownEntity`."""
        simulation = self._session.simulation
        found = next((body for body in simulation.scene.bodies if body.name == name), None)
        if found is None:
            raise UnknownEntity(f'no body is named {shown(name)}; '
                                + near_names(name, self.names))
        return found if found.fixed else self._now([found])[0]

    def spawn(self, body, name='', rename=False, **changes):
        """
        Add a body under a name (its own if empty), or one like it if that is taken; return it.

        The changes are as in `place`. Raises `NameTaken`, `BadState`, `BadPlace`, or
        `BadDescription` for what is no name, or a shape that the method does not know.
        """
        taken = frozenset(self._session.simulation.all_names)
        name = name or body.name
        if name in taken:
            if not rename:
                raise NameTaken(f'there is something named {shown(name)} already')
            number = 1
            while f'{name}_{number}' in taken:
                number += 1
            name = f'{name}_{number}'
        try:
            body = replace(body, name=values.name(name), **_checked(changes))
        except values.NotAllowed as error:
            raise BadDescription(f'name is {shown(name)}; must be {error}') from error
        self._check_place(body)
        try:
            self._session.add(body)
        except CommandError as error:
            raise BadDescription(str(error)) from error
        return name

    def delete(self, name):
        """Take a body out; raises `UnknownEntity`."""
        self.body(name)
        self._session.remove(name)

    def place(self, name, **changes):
        """
        Give a moving body other values of `model.Body` at once; raises `EntityError`.

        The changes are of position, orientation, velocity and angular_velocity.
        """
        body = self.body(name)
        if body.fixed:
            raise EntityError(f'{shown(name)} is fixed')
        changed = replace(body, **_checked(changes))
        self._check_place(changed)
        self._session.place(name, changed.position, changed.orientation, changed.velocity,
                            changed.angular_velocity)

    def check_reset(self):
        """
        Raise `BadPlace` if bodies would overlap after a reset that keeps the bodies there are.

        Each begins where it once began: there may have been room one after the other only.
        """
        overlap = deepest_overlap(self._session.simulation.scene)
        if overlap:
            raise BadPlace(f'{_overlap_text(overlap)} where both began: delete one of them, '
                           'or reset what was spawned too')

    def _now(self, bodies):
        """Return moving bodies with the motion and the wrench they have now."""
        simulation = self._session.simulation
        row = {name: number for number, name in enumerate(simulation.names)}
        columns = {
            'position': simulation.position, 'orientation': simulation.orientation,
            'velocity': simulation.linear_velocity,
            'angular_velocity': simulation.angular_velocity,
            'force': simulation.force, 'torque': simulation.torque}
        return [replace(body, **{field: tuple(values[row[body.name]].tolist())
                                 for field, values in columns.items()}) for body in bodies]

    def _check_place(self, body):
        """Refuse a body that would overlap another one or a plane, as a scene file does."""
        scene = self._session.simulation.scene
        others = [other for other in scene.bodies if other.name != body.name]
        moving = self._now([other for other in others if not other.fixed])
        if body.fixed:
            # it may stand in the ground and in others that are fixed
            scene, others = replace(scene, planes=()), moving
        else:
            others = [*moving, *(other for other in others if other.fixed)]
        # with all others fixed, only their overlaps with this one are looked for
        overlap = deepest_overlap(replace(scene, bodies=(
            replace(body, fixed=False), *(replace(other, fixed=True) for other in others))))
        if overlap:
            raise BadPlace(_overlap_text(overlap))


def _overlap_text(overlap):
    return f'{overlap[0]} would overlap {overlap[1]} by {overlap[2]:.3g} m'


def _checked(changes):
    """Return values of `model.Body` as tuples of numbers of sense; raises `BadState`."""
    try:
        checked = {field: tuple((unit_quaternion(value) if field == 'orientation'
                                 else vector(field, value)).tolist())
                   for field, value in changes.items()}
    except CommandError as error:
        raise BadState(str(error)) from error
    for field, numbers in checked.items():
        if max(map(abs, numbers)) > largest(field):
            raise BadState(f'{field} is {list(numbers)}; allowed: at most {largest(field):g} '
                           'either way')
    return checked
