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
Constant torque on a body with three equal moments of inertia.

The rate is then known, w(t) = w0 + (torque / moment) t in world axes, and q' = w q / 2 is linear.
"""

import numpy as np

from rigid_sim_ros.engine.flight.fixed_axis import ROUNDING
from rigid_sim_ros.engine.flight.series import (
    coefficient_rows, frame_of, from_rows, into_frame, out_of_frame, polynomial)

ORDER = 48
"""Highest order of the series; most end earlier, by size."""

LEAST_ORDER = 16
"""Order from which on the size of the terms is looked at: none end before."""

REACH = 3.0
"""
Half the angle [rad] a stride reaches. More means fewer strides of more orders, and rounding grows
as e^reach; about the least cost, measured, and the least error.
"""

NEGLIGIBLE = 3e-17
"""Size of the terms of two consecutive orders at which a series ends."""

START, RATE, GROWTH, FRAME, SPIN = 0, slice(1, 4), slice(4, 7), slice(7, 11), slice(11, 15)
"""A body's constants: start [s]; rate there and its growth, world axes; frame; see `first`."""

KEPT = 11
"""Count of the constants that the table keeps before the series."""

ROW_COUNT = KEPT + 4 * (ORDER + 1)
"""Rows of the table of a stride."""


def first(functions, time, moments, quaternion, rate, torque):
    """
    Return (constants, state) of a rotation at its start, in world axes.

    The state is the pair (a, b) in the frame. The constants end with the rate in the frame: the
    two components across the torque, the one along it and the growth of that.
    """
    frame, magnitude = frame_of(functions, torque)
    a, b, (x, y, z) = into_frame(frame, quaternion, rate)
    growth = tuple(component / moments[0] for component in torque)
    return (time, *rate, *growth, *frame, x, y, z, magnitude / moments[0]), (a, b)


def stride(functions, constants, time, state):
    """
    Return (end [s], unit [s], series of a and of c = conj(b), next state) of a stride.

    With the rate (across, along + growth t) in the frame, `across` complex, q' = w q / 2 reads
    a' = (i w3 a - across c) / 2 and c' = (conj(across) a - i w3 c) / 2. The series are in the
    fraction of the stride, which is the unit, and end by the size of their terms: an order chosen
    from the reach alone falls short where the growth dominates, as the terms then fall like
    (reach / 2)^(k/2) / (k/2)! only.
    """
    x, y, along, growth = constants[SPIN]
    across = x + 1j * y
    along = along + growth * (time - constants[START])
    speed = functions.hypot(abs(across), along)
    # half the angle is at most (speed + |growth| length / 2) length / 2
    length = 4 * REACH / (speed + functions.sqrt(speed * speed + 8 * REACH * abs(growth)))
    # the end is to be a time that floats can hold, or its rounding would turn the body
    end = time + length
    length = end - time
    turn, drift = 0.5j * along * length, 0.5j * growth * length * length
    across = 0.5 * across * length
    back = across.conjugate()
    a, c = state[0], state[1].conjugate()
    series_a, series_c = [a], [c]
    last_a = last_c = 0 * a
    size = 1.0
    for order in range(1, ORDER + 1):
        scale = 1 / order
        a, last_a, c, last_c = (
            scale * (turn * a - across * c + drift * last_a), a,
            scale * (back * a - turn * c - drift * last_c), c)
        series_a.append(a)
        series_c.append(c)
        if order >= LEAST_ORDER:
            last_size, size = size, functions.largest(abs(a) + abs(c))
            if size < NEGLIGIBLE and last_size < NEGLIGIBLE:
                break
    a, c = sum(reversed(series_a)), sum(reversed(series_c))
    scale = 1 / functions.hypot(abs(a), abs(c))
    return end, length, (series_a, series_c), (a * scale, c.conjugate() * scale)


def rows(constants, unit, series):
    """Return what the table keeps of a stride, a list of `ROW_COUNT` floats or arrays."""
    return [*constants[:KEPT], *coefficient_rows(series, ORDER)]


def orientations(functions, table, fraction):
    """Return the quaternions, (4, k), from `rows` (rows, k) at fractions (k,) of the units."""
    a, c = from_rows(table[KEPT:], 2, fraction)
    return out_of_frame(functions, table[FRAME], a, c.conjugate())


def rates(functions, table, time, fraction):
    """Return the world rates, (3, k), from `rows` (rows, k) at one time."""
    return table[RATE] + table[GROWTH] * (time - table[START])


def motion_of_one(functions, constants, unit, series, time, fraction):
    """Return quaternion and world rate of one body in plain floats."""
    a, c = (polynomial(one, fraction) for one in series)
    elapsed = time - constants[START]
    return (out_of_frame(functions, constants[FRAME], a, c.conjugate()),
            tuple(rate + growth * elapsed
                  for rate, growth in zip(constants[RATE], constants[GROWTH])))


def bounds(constants, start, end):
    """Return upper bounds of |w| and |dw/dt|, (k,), of bodies (., k) between times (k,)."""
    rate, growth = constants[RATE], constants[GROWTH]
    ends = (rate + growth * (np.where(np.isinf(time), 0.0, time) - constants[START])
            for time in (start, end))
    # the rate moves along a line, so it is largest at an end
    largest = np.maximum(*(np.sqrt((vector * vector).sum(axis=0)) for vector in ends))
    return (np.where(np.isinf(end), np.inf, ROUNDING * largest),
            ROUNDING * np.sqrt((growth * growth).sum(axis=0)))
