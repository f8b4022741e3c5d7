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
Rotation without torque of bodies with unequal moments, in closed form.

A body's constants fill one column of a table, so that many bodies are evaluated together, one
body in plain floats, or one body at many times, by the same lines.
"""

import numpy as np

from rigid_sim_ros.engine.flight import hyperbolic, trigonometric
from rigid_sim_ros.engine.flight.fixed_axis import ROUNDING
from rigid_sim_ros.engine.flight.functions import ARRAYS, FLOATS
from rigid_sim_ros.engine.flight.packed_columns import PackedColumns
from rigid_sim_ros.engine.flight.plain_rotation import (
    normalized, product, to_body, to_world)
from rigid_sim_ros.engine.flight.polhode import polhode_of_many, polhode_of_one

START, RATE, RATE_BOUND, DERIVATIVE_BOUND, WORLD, BODY_RATE, MOTION = (
    0, slice(1, 4), 4, 5, slice(6, 22), slice(22, 31), slice(31, None))
"""
Rows of a table: start [s]; world rate there [rad/s]; bounds of |w| and |dw/dt|; the matrix (4, 4)
from a pair's four parts to the quaternion; that (3, 3) from the unit momentum to the body rate;
constants of the form.
"""

LEADING = 31
"""Count of rows before the constants of the form."""

HYPERBOLIC_BELOW = 0.03
"""k'^2 below which the hyperbolic form takes over; near it both have the same error."""

FEW = 12
"""Up to so many bodies, constants are made one by one in plain floats: faster, measured."""


class FreeRotations:
    """The rotations of all bodies that turn freely, in two tables, one a form."""

    def __init__(self, body_count):
        """Make tables of none of 0 to `body_count` - 1."""
        self._forms = tuple((form, PackedColumns(LEADING + form.ROW_COUNT, body_count))
                            for form in (trigonometric, hyperbolic))

    @property
    def count(self):
        """Count of bodies of this kind."""
        return sum(table.count for _, table in self._forms)

    def begin_one(self, body, time, moments, quaternion, rate, torque):
        """Start one rotation: unit quaternion and world rate in plain floats; no torque."""
        polhode = polhode_of_one(moments, to_body(quaternion, rate))
        new, old = self._forms
        if polhode.complementary < HYPERBOLIC_BELOW:
            new, old = old, new
        form, table = new
        old[1].remove(body)
        table.put_one(body, _column(FLOATS, form, polhode, time, quaternion, rate))

    def begin(self, bodies, time, moments, quaternion, rate, torque):
        """Start rotations of bodies (k,); arrays (3, k), (4, k); no torque."""
        if len(bodies) <= FEW:
            for place, body in enumerate(bodies.tolist()):
                self.begin_one(body, time, *(values[:, place].tolist() for values in (
                    moments, quaternion, rate, torque)))
            return
        polhode = polhode_of_many(moments, np.array(to_body(quaternion, rate)))
        near = polhode.complementary < HYPERBOLIC_BELOW
        for (form, table), chosen in zip(self._forms, (~near, near)):
            for body in bodies[~chosen].tolist():
                table.remove(body)
            if chosen.any():
                columns = _column(ARRAYS, form, polhode.chosen(chosen), time,
                                  quaternion[:, chosen], rate[:, chosen])
                table.put(bodies[chosen], np.array(np.broadcast_arrays(*columns)))

    def remove(self, body):
        """Forget a body."""
        for _, table in self._forms:
            table.remove(body)

    def write_orientations(self, time, indices, out):
        """Write the quaternions of those of `indices` (k,) that are here to `out` (4, k)."""
        for form, places, columns in self._selected(indices):
            pair = _unit_pair(ARRAYS, form.pair(ARRAYS, columns[MOTION], time - columns[START]))
            out[:, places] = _orientations(columns, pair)

    def write_rates(self, time, indices, out):
        """Write the world rates of those of `indices` (k,) that are here to `out` (3, k)."""
        for form, places, columns in self._selected(indices):
            elapsed = time - columns[START]
            pair = _unit_pair(ARRAYS, form.pair(ARRAYS, columns[MOTION], elapsed))
            matrix = columns[BODY_RATE].reshape(3, 3, -1)
            body_rate = (matrix * np.array(_momentum(pair))).sum(axis=1)
            # at the start, as given: momentum to rate loses digits in very thin bodies
            out[:, places] = np.where(elapsed == 0, columns[RATE],
                                      to_world(_orientations(columns, pair), body_rate))

    def write_rate_bounds(self, indices, start, end, out):
        """Write upper bounds of |w| to `out` (k,) for those of `indices` (k,) that are here."""
        for _, places, columns in self._selected(indices):
            out[places] = columns[RATE_BOUND]

    def write_rate_derivative_bounds(self, indices, start, end, out):
        """Write upper bounds of |dw/dt| to `out` (k,), as `write_rate_bounds`."""
        for _, places, columns in self._selected(indices):
            out[places] = columns[DERIVATIVE_BOUND]

    def motion_of_one(self, body, time):
        """Return quaternion and world rate of one body in plain floats."""
        form, table = self._form_of(body)
        column = table.column(body)
        elapsed = time - column[START]
        pair = _unit_pair(FLOATS, form.pair(FLOATS, column[MOTION], elapsed))
        x, y, z, w = _applied(column[WORLD], pair)
        scale = 1.5 - 0.5 * (x * x + y * y + z * z + w * w)
        quaternion = x * scale, y * scale, z * scale, w * scale
        if elapsed == 0:
            return quaternion, tuple(column[RATE])
        return quaternion, to_world(quaternion, _applied(column[BODY_RATE], _momentum(pair)))

    def orientations_of_one(self, body, times):
        """Return the quaternions of one body at times (K,), (4, K)."""
        form, table = self._form_of(body)
        column = table.column(body)
        pair = form.pair(ARRAYS, column[MOTION], times - column[START])
        return _orientations(np.array(column)[:, None], _unit_pair(ARRAYS, pair))

    # -- inside --------------------------------------------------------------------------------

    def _form_of(self, body):
        trigonometric_form, hyperbolic_form = self._forms
        return trigonometric_form if body in trigonometric_form[1] else hyperbolic_form

    def _selected(self, indices):
        """Yield, for each form, where its members are in `indices` and their columns."""
        for form, table in self._forms:
            if table.count:
                places, columns = table.select(indices)
                if len(places):
                    yield form, places, columns


def _column(functions, form, polhode, time, quaternion, rate):
    """Return all constants of a rotation, a list of floats or of arrays (k,)."""
    constants = form.rows(functions, polhode)
    w, x, y, z = _unit_pair(functions, form.pair(functions, constants, 0.0 * rate[0]))
    # the frame of the momentum is so placed that the start is exact
    world = normalized(functions, product(product(quaternion, polhode.axes), (-x, -y, -z, w)))
    p, q, r, s = polhode.axes
    columns = [product(product(world, unit), (-p, -q, -r, s)) for unit in UNITS]
    return [time, *rate, *(bound * ROUNDING for bound in polhode.rate_bounds(functions)),
            *(column[row] for row in range(4) for column in columns),
            *polhode.body_rates(functions), *constants]


UNITS = ((0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))
"""The quaternions w, x, y, z: the order of a pair's parts, see `_unit_pair`."""


def _unit_pair(functions, pair):
    """Return w, x, y, z = Re a, Re b, Im b, Im a of a pair turned by its phase, unit length."""
    a, b, c, d, phase = pair
    scale = 1 / functions.sqrt(a * a + b * b + c * c + d * d)
    cosine, sine = functions.cos(phase) * scale, functions.sin(phase) * scale
    return (a * cosine - b * sine, c * cosine - d * sine, c * sine + d * cosine,
            a * sine + b * cosine)


def _momentum(pair):
    """Return the unit momentum along axes 1, 2, 3: the Hopf map, where the phase drops out."""
    w, x, y, z = pair
    return 2 * (x * z - w * y), 2 * (w * x + y * z), w * w + z * z - x * x - y * y


def _orientations(columns, pair):
    """Return the quaternions, (4, k), of pairs of arrays (k,)."""
    matrix = columns[WORLD].reshape(4, 4, -1)
    w, x, y, z = pair
    quaternion = matrix[:, 0] * w + matrix[:, 1] * x + matrix[:, 2] * y + matrix[:, 3] * z
    # the matrix is orthogonal to rounding only; one Newton step for 1 / length
    quaternion *= 1.5 - 0.5 * (quaternion * quaternion).sum(axis=0)
    return quaternion


def _applied(matrix, vector):
    """Return a matrix, given as one list of rows, times a vector, in plain floats."""
    width = len(vector)
    return tuple(sum(matrix[start + column] * vector[column] for column in range(width))
                 for start in range(0, len(matrix), width))
