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

"""Columns of numbers for a set of bodies that changes, without gaps: what is evaluated at once."""

import numpy as np

ABSENT = -1


class PackedColumns:
    """A table with one column a member; a member that leaves is replaced by the last one."""

    def __init__(self, row_count, body_count):
        """Make a table of no members out of bodies 0 to body_count - 1."""
        self.count = 0
        self._slots = np.full(body_count, ABSENT)
        self._bodies = np.empty(0, dtype=int)
        self._columns = np.empty((row_count, 0))

    @property
    def bodies(self):
        """Return the members, (count,)."""
        return self._bodies[:self.count]

    @property
    def columns(self):
        """Their numbers, (rows, count), in the same order."""
        return self._columns[:, :self.count]

    def __contains__(self, body):
        return self._slots.item(body) != ABSENT

    def column(self, body):
        """Return the numbers of one member as a list of floats."""
        return self._columns[:, self._slots.item(body)].tolist()

    def select(self, indices):
        """
        Return which of `indices` (k,) are members, (m,), and their numbers, (rows, m).

        None stands for all members: these themselves and all numbers.
        """
        if indices is None:
            return self.bodies, self.columns
        slots = self._slots[indices]
        places = np.flatnonzero(slots != ABSENT)
        return places, self._columns.take(slots[places], axis=1)

    def members(self, bodies):
        """Return those of bodies (k,) that are members, (m,)."""
        return bodies[self._slots[bodies] != ABSENT]

    def put(self, bodies, columns):
        """Set the numbers (rows, k) of bodies (k,), new members or not."""
        slots = self._slots[bodies]
        new = bodies[slots == ABSENT]
        if len(new):
            self._reserve(self.count + len(new))
            self._bodies[self.count:self.count + len(new)] = new
            self._slots[new] = np.arange(self.count, self.count + len(new))
            self.count += len(new)
            slots = self._slots[bodies]
        self._columns[:, slots] = columns

    def put_one(self, body, column):
        """Set the numbers of one body, a new member or not."""
        slot = self._slots.item(body)
        if slot == ABSENT:
            slot = self.count
            self._reserve(slot + 1)
            self._bodies[slot] = body
            self._slots[body] = slot
            self.count += 1
        self._columns[:, slot] = column

    def remove(self, body):
        """Drop one member; nothing happens if it is none."""
        slot = self._slots.item(body)
        if slot == ABSENT:
            return
        self.count -= 1
        last = self._bodies[self.count]
        self._bodies[slot] = last
        self._columns[:, slot] = self._columns[:, self.count]
        self._slots[last] = slot
        self._slots[body] = ABSENT

    def _reserve(self, count):
        """Make room for so many columns, doubling."""
        capacity = len(self._bodies)
        if count > capacity:
            capacity = max(count, 2 * capacity, 4)
            self._bodies = _grown(self._bodies, capacity)
            self._columns = _grown(self._columns, capacity)


def _grown(array, capacity):
    """Return a copy with room for more along the last axis."""
    result = np.empty(array.shape[:-1] + (capacity,), dtype=array.dtype)
    result[..., :array.shape[-1]] = array
    return result


def columns_of(table, indices):
    """Return the columns `indices` of a table, an array (k,) or a slice: a view if a slice."""
    return table[:, indices] if isinstance(indices, slice) else table.take(indices, axis=1)
