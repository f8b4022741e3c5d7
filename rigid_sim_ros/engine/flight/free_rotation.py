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
body in plain floats, by the same lines.
"""

from functools import partial
from math import cos, sin, sqrt

import numpy as np

from rigid_sim_ros.engine.flight import hyperbolic, trigonometric
from rigid_sim_ros.engine.flight.fixed_axis import ROUNDING
from rigid_sim_ros.engine.flight.functions import ARRAYS, cosine_and_sine, FLOATS
from rigid_sim_ros.engine.flight.packed_columns import PackedColumns
from rigid_sim_ros.engine.flight.plain_rotation import (
    normalized, product, to_body, to_unit_length, to_world)
from rigid_sim_ros.engine.flight.polhode import polhode_of_many, polhode_of_one

START, RATE, RATE_BOUND, DERIVATIVE_BOUND, WORLD, BODY_RATE, MOTION = (
    0, slice(1, 4), 4, 5, slice(6, 22), slice(22, 31), slice(31, None))
"""
Rows of a table: start [s]; world rate there [rad/s]; bounds of |w| and |dw/dt|; the matrix (4, 4)
from the parts of a pair, Re a, Im a, Re b, Im b, to the quaternion; that (3, 3) from the unit
momentum to the body rate; constants of the form.
"""

LEADING = 31
"""Count of rows before the constants of the form."""

HYPERBOLIC_BELOW = 0.03
"""k'^2 below which the hyperbolic form takes over; near it both have the same error."""

FEW = 12
"""Up to so many bodies, constants are made one by one in plain floats: faster, measured."""


FEW_SAMPLES = 8
"""Up to so many bodies, evaluation is faster one by one in plain floats, measured."""


FORMS = trigonometric, hyperbolic
"""The forms, in the order of the tables."""


class FreeRotations:
    """The rotations of all bodies that turn freely, in two tables, one a form."""

    def __init__(self, body_count):
        """Make tables of none of 0 to `body_count` - 1."""
        self._tables = tuple(PackedColumns(LEADING + form.ROW_COUNT, body_count)
                             for form in FORMS)

    @property
    def count(self):
        """Count of bodies of this kind."""
        return sum(table.count for table in self._tables)

    def begin_one(self, body, time, moments, quaternion, rate, torque):
        """Start one rotation: unit quaternion and world rate in plain floats; no torque."""
        polhode = polhode_of_one(moments, to_body(quaternion, rate))
        new, old = zip(FORMS, self._tables)
        if polhode.complementary < HYPERBOLIC_BELOW:
            new, old = old, new
        form, table = new
        old[1].remove(body)
        constants = form.rows(FLOATS, polhode)
        first = _unit_pair(*form.pair(constants, 0.0))
        leading = _leading(FLOATS, polhode, first, time, quaternion, rate)
        table.put_one(body, leading + constants)

    def begin(self, bodies, time, moments, quaternion, rate, torque):
        """Start rotations of bodies (k,); arrays (3, k), (4, k); no torque."""
        if len(bodies) <= FEW:
            for place, body in enumerate(bodies.tolist()):
                self.begin_one(body, time, *(values[:, place].tolist() for values in (
                    moments, quaternion, rate, torque)))
            return
        polhode = polhode_of_many(moments, np.array(to_body(quaternion, rate)))
        near = polhode.complementary < HYPERBOLIC_BELOW
        for (form, table), chosen in zip(zip(FORMS, self._tables), (~near, near)):
            for body in table.members(bodies[~chosen]).tolist():
                table.remove(body)
            if chosen.any():
                here = polhode.chosen(chosen)
                constants = np.array(np.broadcast_arrays(*form.rows(ARRAYS, here)))
                first = _unit_pairs(*form.pairs(constants, 0.0))
                leading = _leading(ARRAYS, here, first, time, quaternion[:, chosen],
                                   rate[:, chosen])
                table.put(bodies[chosen], np.vstack((
                    np.array(np.broadcast_arrays(*leading)), constants)))

    def remove(self, body):
        """Forget a body."""
        for table in self._tables:
            table.remove(body)

    def write_orientations(self, time, indices, out):
        """Write the quaternions of those of `indices` (k,) that are here to `out` (4, k)."""
        for form, places, columns in self._selected(indices):
            if len(places) <= FEW_SAMPLES:
                for place, column in zip(places.tolist(), columns.T.tolist()):
                    out[:, place] = _motion(form, _split(column), time)[0]
            else:
                pairs = _unit_pairs(*form.pairs(columns[MOTION], time - columns[START]))
                out[:, places] = _orientations(columns[WORLD], pairs)

    def write_rates(self, time, indices, out):
        """Write the world rates of those of `indices` (k,) that are here to `out` (3, k)."""
        for form, places, columns in self._selected(indices):
            if len(places) <= FEW_SAMPLES:
                for place, column in zip(places.tolist(), columns.T.tolist()):
                    out[:, place] = _motion(form, _split(column), time)[1]
            else:
                out[:, places] = _motions(form, columns, time)[1]

    def write_motions(self, times, indices, orientation, rate):
        """Write quaternions (4, k) and world rates (3, k) of bodies (k,) at their own times."""
        for form, places, columns in self._selected(indices):
            orientation[:, places], rate[:, places] = _motions(form, columns, times[places])

    def write_bounds(self, indices, start, end, rate, derivative):
        """Write upper bounds of |w| and |dw/dt|, (k,) each, at any time of bodies (k,)."""
        for _, places, columns in self._selected(indices):
            rate[places] = columns[RATE_BOUND]
            derivative[places] = columns[DERIVATIVE_BOUND]

    def trajectory(self, body):
        """Return quaternion and world rate of one body as a function of time."""
        form, table = self._form_of(body)
        return partial(_motion, form, _split(table.column(body)))

    def bounds_of_one(self, body, start, end):
        """Return upper bounds of |w| and |dw/dt| of one body."""
        _, table = self._form_of(body)
        column = table.column(body)
        return column[RATE_BOUND], column[DERIVATIVE_BOUND]

    # -- inside --------------------------------------------------------------------------------

    def _form_of(self, body):
        place = 0 if body in self._tables[0] else 1
        return FORMS[place], self._tables[place]

    def _selected(self, indices):
        """Yield, for each form, where its members are in `indices` and their columns."""
        for form, table in zip(FORMS, self._tables):
            if table.count:
                places, columns = table.select(indices)
                if len(places):
                    yield form, places, columns


def _leading(functions, polhode, first, time, quaternion, rate):
    """Return the rows before those of the form, a list of floats or arrays (k,)."""
    w, z, x, y = first
    # the frame of the momentum is so placed that the start is exact
    world = normalized(functions, product(product(quaternion, polhode.axes), (-x, -y, -z, w)))
    x, y, z, w = world
    p, q, r, s = polhode.axes
    back = -p, -q, -r, s
    # q(t) = world pair conj(axes) is linear in the pair's parts: the images of w, z, x, y
    columns = [product(one, back) for one in (
        world, (y, -x, w, -z), (w, z, -y, -x), (-z, w, x, -y))]
    return [time, *rate, *(bound * ROUNDING for bound in polhode.rate_bounds(functions)),
            *(column[row] for row in range(4) for column in columns),
            *polhode.body_rates(functions)]


def _unit_pair(a, b, c, d, phase):
    """Return the parts of a pair turned by its phase, at unit length, in plain floats."""
    scale = 1 / sqrt(a * a + b * b + c * c + d * d)
    cosine, sine = cos(phase) * scale, sin(phase) * scale
    return (a * cosine - b * sine, a * sine + b * cosine,
            c * cosine - d * sine, c * sine + d * cosine)


def _unit_pairs(parts, phase):
    """Return the parts (4, k) of pairs turned by their phases (k,), at unit length."""
    waves = np.empty((2, len(phase)))
    cosine_and_sine(phase, waves)
    waves /= np.sqrt((parts * parts).sum(axis=0))
    turned = parts.take(SWAPPED, axis=0)
    turned *= waves[1]
    turned[0::2] *= -1.0
    parts *= waves[0]
    turned += parts
    return turned


SWAPPED = (1, 0, 3, 2)
"""Imaginary parts before real ones."""


def _momentum(w, z, x, y):
    """Return the unit momentum along axes 1, 2, 3: the Hopf map, where the phase drops out."""
    return 2 * (x * z - w * y), 2 * (w * x + y * z), w * w + z * z - x * x - y * y


def _orientations(matrices, pairs):
    """Return quaternions (4, k) from matrices (16, k) and the parts of pairs (4, k)."""
    return to_unit_length((matrices.reshape(4, 4, -1) * pairs).sum(axis=1))


def _split(column):
    """Return start, rate, world and body matrices and the form's constants of one body."""
    return column[START], tuple(column[RATE]), column[WORLD], column[BODY_RATE], column[MOTION]


def _motion(form, parts, time):
    """Return quaternion and world rate of one body in plain floats, `parts` by `_split`."""
    start, rate, world, body_rate, constants = parts
    elapsed = time - start
    w, z, x, y = _unit_pair(*form.pair(constants, elapsed))
    a, b, c, d, e, f, g, h, i, j, k, m, n, o, p, q = world
    quaternion = to_unit_length((
        a * w + b * z + c * x + d * y, e * w + f * z + g * x + h * y,
        i * w + j * z + k * x + m * y, n * w + o * z + p * x + q * y))
    # at the start, as given: momentum to rate loses digits in very thin bodies
    if elapsed == 0:
        return quaternion, rate
    first, second, third = _momentum(w, z, x, y)
    a, b, c, d, e, f, g, h, i = body_rate
    return quaternion, to_world(quaternion, (
        a * first + b * second + c * third, d * first + e * second + f * third,
        g * first + h * second + i * third))


def _motions(form, columns, time):
    """Return quaternions (4, k) and world rates (3, k) at one time or at times (k,)."""
    elapsed = time - columns[START]
    pairs = _unit_pairs(*form.pairs(columns[MOTION], elapsed))
    quaternion = _orientations(columns[WORLD], pairs)
    rate = (columns[BODY_RATE].reshape(3, 3, -1) * np.array(_momentum(*pairs))).sum(axis=1)
    return quaternion, np.where(elapsed == 0, columns[RATE], to_world(quaternion, rate))
