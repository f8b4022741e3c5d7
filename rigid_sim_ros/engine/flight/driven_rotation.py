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
Rotation under constant torque: a chain of power series, a stride of time each.

No closed form is known. The chain is extended as far as it has been asked for; each stride starts
from the state at the end of the one before. States that time has passed are forgotten but for the
first, so a chain takes no more memory the longer it is; who asks for an earlier time has it made
again from the start. How a stride is made is in `strides`, one law for equal moments and one for
unequal ones.
"""

from bisect import bisect_right
from functools import partial

import numpy as np

from rigid_sim_ros.engine.flight import equal_moments, unequal_moments
from rigid_sim_ros.engine.flight.functions import ARRAYS, FLOATS
from rigid_sim_ros.engine.flight.packed_columns import PackedColumns

KEPT_STRIDES = 16
"""Series kept of one body: searches go back and forth within few strides."""

KEPT_STATES = 64
"""States that time has passed and that are kept of one body."""

FEW = 8
"""Up to so many bodies, strides are made one by one in plain floats: faster, measured."""

MOST_STRIDES = 200_000
"""Strides of the latest length that one request may need: a few seconds or tens of them."""

BEGIN, END, SCALE = 0, 1, 2
"""Rows of the table: times [s] of a stride, one over its unit, then what the law keeps."""

LEADING = 3
"""Count of rows before those of the law."""


class Chain:
    """
    The strides of one body: start times and states of the latest, and the series of a few.

    The number of a stride is its place among the latest, so it holds until `forget` is called.
    """

    def __init__(self, make_stride, constants, time, state):
        """Begin with a state at a time; `constants` and `state` are those of `make_stride`."""
        self._make_stride = make_stride
        self.constants = constants
        self._first = time, state
        self._restart()

    def _restart(self):
        time, state = self._first
        self.times = [time]
        self.states = [state]
        self._strides = {}

    def forget(self, time):
        """Forget the states before `time`, if there are many: it is asked for, and later ones."""
        number = self.locate(time)
        if number > KEPT_STATES:
            del self.times[:number], self.states[:number]

    def locate(self, time):
        """Return the number of the stride that holds `time`, or of the last one begun."""
        if time < self.times[0] and self.times[0] != self._first[0]:
            self._restart()
        return max(bisect_right(self.times, time) - 1, 0)

    def append(self, time, state):
        """Note where the next stride begins."""
        self.times.append(time)
        self.states.append(state)

    def stride(self, number):
        """Return (unit [s], series) of a stride that is begun, made again if not kept."""
        stride = self._strides.get(self.times[number])
        if stride is None:
            end, unit, series, state = self._make_stride(
                FLOATS, self.constants, self.times[number], self.states[number])
            if number == len(self.times) - 1:
                self.append(end, state)
            if len(self._strides) >= KEPT_STRIDES:
                self._strides.clear()
            stride = self._strides[self.times[number]] = unit, series
        return stride

    def reach(self, time):
        """Return the number of the stride that holds `time`, extending the chain to it."""
        number = self.locate(time)
        while self.times[-1] <= time:
            number = len(self.times) - 1
            self.stride(number)
            self.refuse_endless(time)
        return number

    def refuse_endless(self, time):
        """Raise OverflowError if the chain would need too many strides more to reach `time`."""
        last = self.times[-1] - self.times[-2]
        if time - self.times[-1] > MOST_STRIDES * last:
            raise OverflowError(
                f'a rotation under torque is too fast to be followed to {time} s: it turns by '
                f'about a radian in {last} s at {self.times[-1]} s, and at most {MOST_STRIDES} '
                'times as long is allowed at once')


class DrivenRotations:
    """The rotations of all bodies under torque that follow one law, see below."""

    _law = None

    def __init__(self, body_count):
        """Make a table of none of 0 to `body_count` - 1."""
        self._chains = {}
        self._table = PackedColumns(LEADING + self._law.ROW_COUNT, body_count)

    @property
    def count(self):
        """Count of bodies of this kind."""
        return len(self._chains)

    def begin_one(self, body, time, moments, quaternion, rate, torque):
        """Start one rotation: unit quaternion, world rate and torque in plain floats."""
        constants, state = self._law.first(FLOATS, time, moments, quaternion, rate, torque)
        self._start(body, time, constants, state)

    def begin(self, bodies, time, moments, quaternion, rate, torque):
        """Start rotations of bodies (k,); arrays (3, k), (4, k)."""
        constants, state = self._law.first(ARRAYS, time, moments, quaternion, rate, torque)
        constants = zip(*(np.broadcast_to(row, len(bodies)).tolist() for row in constants))
        states = zip(*(row.tolist() for row in state))
        for body, of_body, first in zip(bodies.tolist(), constants, states):
            self._start(body, time, of_body, first)

    def remove(self, body):
        """Forget a body."""
        self._chains.pop(body, None)
        self._table.remove(body)

    def write_orientations(self, time, indices, out):
        """Write the quaternions of those of `indices` (k,) that are here to `out` (4, k)."""
        places, table, fraction = self._current(time, indices)
        if len(places):
            out[:, places] = self._law.orientations(ARRAYS, table, fraction)

    def write_rates(self, time, indices, out):
        """Write the world rates of those of `indices` (k,) that are here to `out` (3, k)."""
        places, table, fraction = self._current(time, indices)
        if len(places):
            out[:, places] = self._law.rates(ARRAYS, table, time, fraction)

    def write_motions(self, times, indices, orientation, rate):
        """
        Write quaternions (4, k) and world rates (3, k) of bodies (k,) at their own times.

        One by one: a body may be listed at several times, in different strides.
        """
        for place in self._table.select(indices)[0].tolist():
            orientation[:, place], rate[:, place] = self._motion_of_one(
                int(indices[place]), times.item(place))

    def write_bounds(self, indices, start, end, rate, derivative):
        """Write upper bounds of |w| and |dw/dt|, (k,) each, of those of bodies (k,) here."""
        places = self._table.select(indices)[0]
        if len(places):
            constants = _rows(self._chains[body].constants for body in indices[places].tolist())
            start, end = (np.broadcast_to(time, len(indices))[places] for time in (start, end))
            rate[places], derivative[places] = self._law.bounds(constants, start, end)

    def trajectory(self, body):
        """Return quaternion and world rate of one body as a function of time."""
        return partial(self._motion_of_one, body)

    def bounds_of_one(self, body, start, end):
        """Return upper bounds of |w| and |dw/dt| of one body between two times [s]."""
        constants = _rows([self._chains[body].constants])
        return tuple(bound.item() for bound in self._law.bounds(
            constants, *(np.array([time]) for time in (start, end))))

    # -- inside --------------------------------------------------------------------------------

    def _motion_of_one(self, body, time):
        """Return quaternion and world rate of one body in plain floats."""
        chain = self._chains[body]
        number = chain.reach(time)
        unit, series = chain.stride(number)
        fraction = (time - chain.times[number]) / unit
        return self._law.motion_of_one(FLOATS, chain.constants, unit, series, time, fraction)

    def _start(self, body, time, constants, state):
        self._chains[body] = Chain(self._law.stride, constants, time, state)
        column = [0.0] * (LEADING + self._law.ROW_COUNT)
        # a stride that holds no time: it is made when it is first asked for
        column[END] = -np.inf
        self._table.put_one(body, column)

    def _current(self, time, indices):
        """
        Return where the members are in `indices` (k,), and their strides that hold `time`.

        Places (m,), what the law keeps in the table (rows, m), fractions of the units (m,).
        """
        places, columns = self._table.select(indices)
        stale = (time < columns[BEGIN]) | (time >= columns[END])
        if stale.any():
            bodies = places if indices is None else indices[places]
            self._load(bodies[stale], time)
            places, columns = self._table.select(indices)
        return places, columns[LEADING:], (time - columns[BEGIN]) * columns[SCALE]

    def _load(self, bodies, time):
        """Put the strides that hold `time` into the table, extending the chains to them."""
        if len(bodies) <= FEW:
            for body in bodies.tolist():
                chain = self._chains[body]
                chain.forget(time)
                number = chain.reach(time)
                unit, series = chain.stride(number)
                self._table.put_one(body, [
                    chain.times[number], chain.times[number + 1], 1 / unit,
                    *self._law.rows(chain.constants, unit, series)])
            return
        while len(bodies):
            bodies = bodies[self._extend(bodies, time)]

    def _extend(self, bodies, time):
        """Make a stride for each of many bodies; return which of them, (k,), need more."""
        chains = [self._chains[body] for body in bodies.tolist()]
        for chain in chains:
            chain.forget(time)
        numbers = [chain.locate(time) for chain in chains]
        begin = np.array([chain.times[number] for chain, number in zip(chains, numbers)])
        state = _rows(chain.states[number] for chain, number in zip(chains, numbers))
        constants = _rows(chain.constants for chain in chains)
        end, unit, series, state = self._law.stride(ARRAYS, constants, begin, state)
        ends = end.tolist()
        states = zip(*(row.tolist() for row in state))
        for place, (chain, number, last) in enumerate(zip(chains, numbers, states)):
            if number == len(chain.times) - 1:
                chain.append(ends[place], last)
                chain.refuse_endless(time)
            ends[place] = chain.times[number + 1]
        end = np.array(ends)
        holds = ~(end <= time)
        if holds.any():
            columns = [begin, end, 1 / unit, *self._law.rows(constants, unit, series)]
            self._table.put(bodies[holds], np.array(columns)[:, holds])
        return ~holds


class EqualMoments(DrivenRotations):
    """Those of bodies with equal moments."""

    _law = equal_moments


class UnequalMoments(DrivenRotations):
    """Those of bodies with unequal moments."""

    _law = unequal_moments


def _rows(columns):
    """Return tuples, one a body, as an array (quantities, bodies)."""
    return np.array(list(columns)).T
