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
Constant torque on a body with unequal moments of inertia.

No closed form is known. Taylor series of high order (A. Jorba and M. Zou, A software package for
the numerical integration of ODEs by means of high-order Taylor methods, Experimental Mathematics
2005): order 20, about half the digits asked for times ln 10, and a stride such that the last terms
fall below `TOLERANCE`. Departures: the pair of complex numbers instead of the quaternion, which
makes eight convolutions an order of what are 21 in components; and the torque in body axes, which
is read off the pair instead of being integrated too.
"""

from math import sqrt
from operator import mul

import numpy as np

from rigid_sim_ros.engine.flight.fixed_axis import ROUNDING
from rigid_sim_ros.engine.flight.plain_rotation import to_body, to_world
from rigid_sim_ros.engine.flight.series import (
    coefficient_rows, frame_of, from_rows, into_frame, out_of_frame, polynomial)

ORDER = 20
"""Order of all series."""

TOLERANCE = 1e-16
"""
Size of the last terms at the end of a stride, in radians: truncation is then below rounding.
A hundred times more would make strides a quarter longer.
"""

LONGEST = 8.0
"""Longest stride, in the body's unit of time, for series that happen to vanish."""

TINIEST = 1e-300
"""Added to squares that may underflow, so that bounds hold for the smallest numbers too."""

START, FRAME, MOMENTS, MAGNITUDE, RATE, TORQUE = (
    0, slice(1, 5), slice(5, 8), 8, slice(9, 12), slice(12, 15))
"""A body's constants: start [s]; frame; moments; torque along the frame's z; rate, body axes;
torque at the start, body axes."""

KEPT = 5
"""Count of rows the table keeps before the series: frame and one over the unit of time."""

ROW_COUNT = KEPT + 8 * (ORDER + 1)
"""Rows of the table of a stride."""

A, B, CONJUGATE_A, ACROSS, CONJUGATE_ACROSS, ALONG = range(6)
LEFT = (ALONG, CONJUGATE_ACROSS, ACROSS, ALONG, ACROSS, ACROSS, CONJUGATE_A, CONJUGATE_A)
RIGHT = (A, B, A, B, ALONG, ACROSS, B, A)
"""The series that are multiplied: pair, rate across (w1 + i w2) and along axis 3, conjugates."""


def first(functions, time, moments, quaternion, rate, torque):
    """Return (constants, state) of a rotation at its start; rate and torque in world axes."""
    frame, magnitude = frame_of(functions, torque)
    a, b, _ = into_frame(frame, quaternion, rate)
    x, y, z = body_rate = to_body(quaternion, rate)
    constants = (time, *frame, *moments, magnitude, *body_rate, *to_body(quaternion, torque))
    return constants, (a, b, x + 1j * y, z)


def stride(functions, constants, time, state):
    """
    Return (end [s], unit [s], series, next state) of a stride from `time`.

    The series of a, b, w1 + i w2 and w3 are in (t - time) / unit, the rates in radians a unit.
    """
    magnitude = constants[MAGNITUDE]
    i1, i2, i3 = constants[MOMENTS]
    a, b, across, along = state
    unit = 1 / (functions.hypot(abs(across), abs(along)) + functions.sqrt(
        abs(magnitude) / functions.minimum(i1, functions.minimum(i2, i3))))
    push = magnitude * unit * unit
    products = (_Products if isinstance(unit, float) else _ManyProducts)(
        a, b, across * unit, along * unit)
    ratios = (i2 - i3) / i1, (i3 - i1) / i2, (i1 - i2) / i3
    # |a|^2 - |b|^2 = 2 |a|^2 - 1
    constant = -push / i3
    for order in range(1, ORDER + 1):
        (along_a, back_b, across_a, along_b, across_along, across_squared, turn,
         square) = products.last()
        scale = 1 / order
        half = 0.5 * scale
        products.append(
            half * (1j * along_a - back_b), half * (across_a - 1j * along_b),
            scale * (ratios[0] * across_along.imag - 2 * push / i1 * turn.imag
                     + 1j * (ratios[1] * across_along.real + 2 * push / i2 * turn.real)),
            scale * (0.5 * ratios[2] * across_squared.imag + 2 * push / i3 * square.real
                     + constant))
        constant = 0.0
    series = products.series
    end = time + unit * _reach(functions, series)
    fraction = (end - time) / unit
    a, b, across, along = (polynomial(one, fraction) for one in series)
    scale = 1 / functions.hypot(abs(a), abs(b))
    return end, unit, series, (a * scale, b * scale, across / unit, along.real / unit)


def rows(constants, unit, series):
    """Return what the table keeps of a stride, a list of `ROW_COUNT` floats or arrays."""
    return [*constants[FRAME], 1 / unit, *coefficient_rows(series, ORDER)]


def orientations(functions, table, fraction):
    """Return the quaternions, (4, k), from `rows` (rows, k) at fractions (k,) of the units."""
    a, b, _, _ = from_rows(table[KEPT:], 4, fraction)
    return out_of_frame(functions, table[FRAME_ROWS], a, b)


def rates(functions, table, time, fraction):
    """Return the world rates, (3, k), from `rows` (rows, k)."""
    a, b, across, along = from_rows(table[KEPT:], 4, fraction)
    quaternion = out_of_frame(functions, table[FRAME_ROWS], a, b)
    return np.array(to_world(quaternion, (across.real, across.imag, along.real))) * table[KEPT - 1]


def motion_of_one(functions, constants, unit, series, time, fraction):
    """Return quaternion and world rate of one body in plain floats."""
    a, b, across, along = (polynomial(one, fraction) for one in series)
    quaternion = out_of_frame(functions, constants[FRAME], a, b)
    rate = across.real / unit, across.imag / unit, along / unit
    return quaternion, to_world(quaternion, rate)


FRAME_ROWS = slice(0, 4)
"""Where `rows` has the frame."""


class _Products:
    """Series of one body and the convolutions of their last orders, in plain floats."""

    def __init__(self, a, b, across, along):
        self.series = [a], [b], [across], [along]
        self._conjugate_a, self._conjugate_across = [a.conjugate()], [across.conjugate()]
        # highest order first: what the others are multiplied by, term by term
        self._backward = [a], [b], [across], [along]

    def last(self):
        """Return the next coefficients of the products `LEFT` times `RIGHT`."""
        _, _, across, along = self.series
        back_a, back_b, back_across, back_along = self._backward
        conjugate_a = self._conjugate_a
        return (sum(map(mul, along, back_a)), sum(map(mul, self._conjugate_across, back_b)),
                sum(map(mul, across, back_a)), sum(map(mul, along, back_b)),
                sum(map(mul, across, back_along)), sum(map(mul, across, back_across)),
                sum(map(mul, conjugate_a, back_b)), sum(map(mul, conjugate_a, back_a)))

    def append(self, a, b, across, along):
        """Add an order."""
        for forward, backward, value in zip(self.series, self._backward, (a, b, across, along)):
            forward.append(value)
            backward.insert(0, value)
        self._conjugate_a.append(a.conjugate())
        self._conjugate_across.append(across.conjugate())


class _ManyProducts:
    """The same for arrays: factors side by side, so that all products are one call."""

    def __init__(self, a, b, across, along):
        shape = (len(LEFT), ORDER + 1, len(a))
        self._left, self._right = np.empty(shape, dtype=complex), np.empty(shape, dtype=complex)
        self._count = 0
        self.series = [], [], [], []
        self.append(a, b, across, along)

    def last(self):
        """Return the next coefficients of the products `LEFT` times `RIGHT`, (8, k)."""
        count = self._count
        return np.einsum('pok,pok->pk', self._left[:, :count], self._right[:, -count:])

    def append(self, a, b, across, along):
        """Add an order, to the right factors in front."""
        values = np.array((a, b, a.conjugate(), across, across.conjugate(), along))
        self._left[:, self._count] = values[LEFT, :]
        self._right[:, -1 - self._count] = values[RIGHT, :]
        self._count += 1
        for one, value in zip(self.series, (a, b, across, along)):
            one.append(value)


def bounds(constants, start, end):
    """
    Return upper bounds of |w| and |dw/dt|, (k,), of bodies (., k) between times (k,).

    By Euler's equations |dw/dt| is at most the torque over the least moment and the products of
    two rates with factors (I_j - I_k) / I_i, at most the largest of these times |w|^2 / sqrt 3.
    """
    moments, torque = constants[MOMENTS], constants[TORQUE]
    rate = _rate_bounds(moments, constants[RATE], torque,
                        np.maximum(start - constants[START], 0.0), end - constants[START])
    i1, i2, i3 = moments
    factor = np.max(np.abs(((i2 - i3) / i1, (i3 - i1) / i2, (i1 - i2) / i3)), axis=0)
    push = np.sqrt(_square(torque)) / moments.min(axis=0)
    return ROUNDING * rate, ROUNDING * (push + factor / sqrt(3) * rate * rate)


def _rate_bounds(moments, rate, torque, start, end):
    """
    Return upper bounds of |w|, (k,), from rates (3, k) at the start, in body axes.

    Three hold, the least is returned. With f = 1 / moment: |w| <= f_max |L|, where L moves along
    a line. |w| <= sqrt(f_max) e, where e = sqrt(2 T) grows at most by |torque| sqrt(f_max) a
    second, from de/dt = torque . w / e. And |w|^2 <= (f_max + f_min) e^2 - f_max f_min L^2, as the
    sum of L_i^2 f_i^2 for given sums L^2 of L_i^2 and e^2 of L_i^2 f_i is largest with all of
    L_i^2 at the two extreme f.
    """
    # without an end there is no bound; any finite time will do meanwhile
    for_ever = np.isinf(end)
    end = np.where(for_ever, start, end)
    most, least = 1 / moments.min(axis=0), 1 / moments.max(axis=0)
    # momentum and torque in the body's axes at the start: the directions do not matter here
    momentum = moments * rate
    square = np.maximum(_square(momentum + torque * start), _square(momentum + torque * end))
    push = _square(torque) + TINIEST
    nearest = np.clip(-(momentum * torque).sum(axis=0) / push, start, end)
    smallest = _square(momentum + torque * nearest)
    energy = (np.sqrt((momentum * rate).sum(axis=0)) + np.sqrt(push * most) * end) ** 2
    least_bound = np.minimum(np.minimum(most * most * square, most * energy),
                             (most + least) * energy - most * least * smallest)
    return np.where(for_ever, np.inf, np.sqrt(least_bound + TINIEST))


def _square(vector):
    """Return |v|^2, (k,), of vectors (3, k)."""
    return (vector * vector).sum(axis=0)


def _reach(functions, series):
    """Return the fraction at which the terms of the last two orders are the tolerance."""
    reach = LONGEST
    for order in (ORDER - 1, ORDER):
        size = functions.maximum(functions.hypot(abs(series[0][order]), abs(series[1][order])),
                                 functions.hypot(abs(series[2][order]), abs(series[3][order])))
        size = functions.maximum(size, TOLERANCE / LONGEST ** ORDER)
        reach = functions.minimum(reach, (TOLERANCE / size) ** (1 / order))
    return reach
