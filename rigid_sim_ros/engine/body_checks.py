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
"""What is asked of a body before it may join a simulation that is running."""

from dataclasses import fields
from numbers import Real

from rigid_sim_ros.engine.commands import CommandError, LARGEST, shown, vector
from rigid_sim_ros.engine.model import Body, Material
from rigid_sim_ros.engine.shapes import Shape

UNIT = 1e-6
"""By how much the square of a unit quaternion may differ from one."""

TRIANGLE = 1e-9
"""Of a sum of two moments of inertia: by how much the third may be larger, for rounding."""


def check_body(body):
    """Raise `CommandError` unless this is a `model.Body` with values that can be simulated."""
    if not isinstance(body, Body):
        raise CommandError(f'body is {shown(body)}; allowed: a model.Body, as in the bodies of '
                           'what load_scene returns')
    if not (isinstance(body.name, str) and body.name):
        raise CommandError(f'the name of a body is {shown(body.name)}; allowed: text')
    label = f'body {shown(body.name)}:'
    if not isinstance(body.shape, Shape):
        raise CommandError(f'{label} shape is {shown(body.shape)}; allowed: a Shape')
    for what in ('position', 'velocity', 'angular_velocity', 'force', 'torque'):
        vector(f'{label} {what}', getattr(body, what))
    quaternion = vector(f'{label} orientation', body.orientation, 4)
    if abs(quaternion @ quaternion - 1.0) > UNIT:
        raise CommandError(f'{label} orientation is {shown(body.orientation)}; allowed: a unit '
                           'quaternion x, y, z, w')
    _check_mass(label, body)
    _check_material(label, body.material)


def _check_mass(label, body):
    """Raise `CommandError` unless mass, moments of inertia and size are those of a body."""
    moments = sorted(vector(f'{label} inertia', body.inertia).tolist())
    for what, values in (('mass', [body.mass]), ('inertia', moments),
                         ('half_extents', body.shape.half_extents)):
        for value in values:
            if not (isinstance(value, Real) and 0.0 < value <= LARGEST):
                raise CommandError(f'{label} {what} is {shown(value)}; allowed: above 0, at most '
                                   f'{LARGEST:g}')
    if moments[2] > (moments[0] + moments[1]) * (1.0 + TRIANGLE):
        raise CommandError(f'{label} inertia is {shown(body.inertia)}; allowed: no moment larger '
                           'than the other two together')


def _check_material(label, material):
    """Raise `CommandError` unless all coefficients are within their ranges."""
    for field in fields(Material):
        value = getattr(material, field.name, None)
        most = 1.0 if field.name == 'restitution' else LARGEST
        if not (isinstance(value, Real) and 0.0 <= value <= most):
            raise CommandError(f'{label} {field.name} is {shown(value)}; allowed: 0 to {most:g}')
