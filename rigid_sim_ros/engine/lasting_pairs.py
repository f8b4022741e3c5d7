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

"""Which pairs are in lasting contact: the events of its beginning and its end."""

import numpy as np

from rigid_sim_ros.engine.events import BEGIN, END, GONE


class _Seen:
    """The contacts of an island after its last step."""

    def __init__(self, contacts):
        self.contacts = contacts

    def of_same_pairs(self, contacts):
        """Return whether contacts, in columns of the same island, are of the same pairs."""
        mine = self.contacts
        return (mine.body_a is contacts.body_a and mine.body_b is contacts.body_b
                or np.array_equal(mine.body_a, contacts.body_a)
                and np.array_equal(mine.body_b, contacts.body_b))


class LastingPairs:
    """The pairs that touch at the end of a step, told apart from those before."""

    def __init__(self):
        """Start with none."""
        self._last_seen = {}
        """By pair (a, b): the `_Seen` it was last seen in, and which contact of that it is."""
        self._by_island = {}
        """By island: the `_Seen` of its contacts after its last step."""

    @property
    def bodies(self):
        """Return the bodies in these pairs, (k,) int."""
        return np.unique(np.array([*self._last_seen], dtype=int))

    def renumbered(self, numbers):
        """Return the same pairs with other numbers (n,) of bodies, without those that are gone."""
        other = LastingPairs()
        for (a, b), last in self._last_seen.items():
            pair = int(numbers[a]), int(numbers[b])
            if GONE not in pair:
                other._last_seen[pair] = last
        return other

    def keep(self, islands):
        """Note that there are no other islands any more than these."""
        self._by_island = {island: self._by_island[island] for island in islands
                           if island in self._by_island}

    def update(self, time, island, contacts):
        """Note what began and what ended by `time` [s]; contacts are in columns of the island."""
        seen = self._by_island.get(island)
        if seen is not None and seen.of_same_pairs(contacts):
            seen.contacts = contacts
            return
        self._by_island[island] = seen = _Seen(contacts)
        body_a, body_b = island.columns[contacts.body_a], island.columns[contacts.body_b]
        rows = {pair: row for row, pair in enumerate(zip(body_a.tolist(), body_b.tolist()))}
        members = set(island.members.tolist())
        before = {pair for pair in self._last_seen if not members.isdisjoint(pair)}
        for pair in sorted(rows.keys() - before):
            _note(island.world.events, time, pair, BEGIN, seen, rows[pair])
        for pair in sorted(before - rows.keys()):
            _note(island.world.events, time, pair, END, *self._last_seen.pop(pair))
        self._last_seen.update((pair, (seen, row)) for pair, row in rows.items())


def _note(events, time, pair, kind, seen, row):
    contacts = seen.contacts
    events.append(time, *pair, kind, contacts.point[:, row], contacts.normal[:, row])
