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
Who may meet whom in flight, and when: so that nothing is looked at before it can matter.

Every pair that may ever touch has a time before which it cannot: first that at which the bounding
spheres meet, then, once the flights have been searched, the instant of the first touch itself.
A simulation only ever asks for the earliest.
"""

from functools import partial
from math import inf, nextafter

import numpy as np

from rigid_sim_ros.engine.broad_phase import meeting_time, meeting_times, swept_pairs
from rigid_sim_ros.engine.time_of_impact import first_touch, first_touches

SEARCH_WINDOW = 0.25
"""
Flights are searched for a touch at least this far ahead [s]. Longer finds more touches that a
change of flight makes worthless, shorter searches the same arc more often.
"""

LOOKAHEAD = 10.0
"""Pairs that meet later than so long from now [s] are looked at closer when that time comes."""

LISTED_PAIRS = 1000
"""
Of more new pairs than this those are not listed, and all are looked through by then: each change
of a flight lists a pair with everybody.
"""

FOREVER = 1e300
"""Later than any time [s] that is asked for; what can never meet is due at infinity."""

FEW, FEW_BOUNDS = 8, 12
"""Up to so many pairs are searched, or bounded, one by one: faster (measured)."""

RENEWED_PAIRS = 20_000
"""If new flights make more pairs than this, the whole list is made again by the broad phase."""


class Encounters:
    """The pairs of bodies in flight and whatever they may hit; rows of parallel arrays."""

    def __init__(self, world, flights):
        self._world = world
        self._flights = flights
        bodies = world.bodies
        self._flying = np.zeros(bodies.count, dtype=bool)
        self._solid = np.arange(bodies.count) >= bodies.moving_count
        self.active = False
        """Whether any body is in flight."""
        self._horizon = np.inf
        self._next = np.inf
        """The earliest time [s] at which there is anything to do."""
        self.body_a = self.body_b = np.zeros(0, dtype=int)
        self.due = np.zeros(0)
        """(p,) [s]: the pair does not touch before; its touch itself where `found`."""
        self.found = self._guarded = np.zeros(0, dtype=bool)

    # -- what the method tells -----------------------------------------------------------------

    def fly(self, indices, time, guarded=None):
        """
        Watch these bodies (k,), whose flights began at `time` [s].

        `guarded` holds the bodies a and b, (2, g), of pairs that touch now and were just told
        apart: they count as touching only once they are, below, deeper than rounding.
        """
        self._flying[indices] = self._solid[indices] = True
        self.active = self.active or len(indices) > 0
        if len(indices) * int(self._solid.sum()) > RENEWED_PAIRS:
            self._renew(indices, time)
        else:
            self._replace(indices, *self._pairs_with(indices), time)
        if guarded is not None and guarded.size:
            self._guard(guarded)

    def rest(self, indices, time):
        """Let bodies (k,) lie still from `time` [s] on: what flies may hit them."""
        self._flying[indices] = False
        self.active = bool(self._flying.any())
        self._solid[indices] = True
        self._replace(indices, *self._pairs_with(indices), time)

    def hide(self, indices):
        """Nothing in flight meets these bodies (k,) until they fly or rest."""
        self._keep(self._without(indices))
        self._flying[indices] = self._solid[indices] = False
        self.active = bool(self._flying.any())

    # -- what it asks --------------------------------------------------------------------------

    def next_touch(self, end):
        """Return the instant [s] of the first touch by `end` and its pairs a, b (p,), or None."""
        while self._next <= end:
            time = self._next
            if time == self._horizon:
                self._renew(self.body_a[:0], time)
                continue
            first = (self.due == time).nonzero()[0]
            if self.found[first].all():
                return time, self.body_a[first], self.body_b[first]
            self._search(end)
        return None

    def involved(self, end):
        """Return the bodies (k,) of all pairs that may touch by `end` [s], each once."""
        if self._next > end:
            return self.body_a[:0]
        soon = self.due <= end
        return np.union1d(self.body_a[soon], self.body_b[soon])

    # -- inside --------------------------------------------------------------------------------

    def _search(self, end):
        """Find the first touches of pairs that may touch until `end`, or when to look again."""
        # nobody needs to know yet what comes after the first touch of all
        first = self.due[self.found].min(initial=np.inf)
        soon = min(end, self._next + SEARCH_WINDOW, first)
        rows = ((self.due <= soon) & ~self.found).nonzero()[0]
        self._world.work.touch_searches += len(rows)
        search = self._search_few if len(rows) <= FEW else self._search_many
        search(rows, min(max(end, soon + SEARCH_WINDOW), first))
        self._next = min(self.due.min(), self._horizon)

    def _search_few(self, rows, until):
        """Search pairs (q,) one by one, none for longer than to the first touch found."""
        for due, row in sorted(zip(self.due[rows].tolist(), rows.tolist())):
            if due > until:
                break
            a, b = self.body_a[row:row + 1], self.body_b[row:row + 1]
            time = first_touch(self._world.bodies, self._flights, a.item(), b.item(), due, until,
                               self._guarded.item(row))
            self.found[row] = time < inf
            if time < inf:
                until = time
            else:
                time = self._after(a, b, until).item()
            self.due[row] = time

    def _search_many(self, rows, until):
        """Search pairs (q,) all at once."""
        a, b = self.body_a[rows], self.body_b[rows]
        times = first_touches(self._world.bodies, self._flights, a, b, self.due[rows], until,
                              self._guarded[rows])
        found = np.isfinite(times)
        self.found[rows] = found
        if not found.all():
            times[~found] = self._after(a[~found], b[~found], until)
        self.due[rows] = times

    def _after(self, a, b, time):
        """Return when, (p,) [s], pairs that do not touch until and at `time` may."""
        return np.maximum(self._bounds(a, b, time), nextafter(time, inf))

    def _bounds(self, a, b, time, later=inf):
        """
        Return the times [s], (p,), from `time` on, before which pairs cannot touch.

        Those `later` than so long may be earlier than they need be, but not within it.
        """
        self._world.work.pair_bounds += len(a)
        if len(a) <= FEW_BOUNDS:
            fall = partial(self._flights.fall, time)
            return np.array([time + meeting_time(self._world.bodies, *pair, fall)
                             for pair in zip(a.tolist(), b.tolist())])
        center, velocity = self._flights.translation(time)
        return time + meeting_times(self._world.bodies, a, b, center, velocity,
                                    self._flights.acceleration, later)

    def _pairs_with(self, indices):
        """Return the bodies a and b, (p,) each, of all pairs of these with what they may meet."""
        others = self._solid.nonzero()[0]
        if len(indices) == 1:
            others = others[(others != indices[0]) & (self._flying[indices[0]]
                                                      | self._flying[others])]
            return np.minimum(others, indices[0]), np.maximum(others, indices[0])
        indices = np.sort(indices)
        a = np.repeat(indices, len(others))
        b = np.tile(others, len(indices))
        listed = np.zeros(len(self._solid), dtype=bool)
        listed[indices] = True
        # a pair of two of these is met twice: keep it once
        keep = (self._flying[a] | self._flying[b]) & np.where(listed[b], a < b, True)
        a, b = a[keep], b[keep]
        return np.minimum(a, b), np.maximum(a, b)

    def _renew(self, changed, time):
        """
        List all pairs that may meet before a new horizon.

        What is known of pairs stays known, but for those of bodies `changed` (k,).
        """
        kept = self._without(changed)
        # of what never meets again, only those whose spheres still overlap would be listed anew
        never = (kept & (self.due > FOREVER)).nonzero()[0]
        kept[never] = self._bounds(self.body_a[never], self.body_b[never], time) <= time
        self._keep(kept)
        center, velocity = self._flights.translation(time)
        a, b, horizon = swept_pairs(self._world.bodies, self._flying, self._solid, center,
                                    velocity, self._flights.acceleration)
        self._horizon = time + horizon
        count = len(self._solid)
        new = ~np.isin(a * count + b, self.body_a * count + self.body_b)
        self._replace(changed[:0], a[new], b[new], time)

    def _replace(self, indices, a, b, time):
        """List pairs in the place of those of bodies (k,), but none due after the horizon."""
        due = self._bounds(a, b, time, LOOKAHEAD)
        if len(a) > LISTED_PAIRS and ((due > time + LOOKAHEAD) & (due <= FOREVER)).any():
            self._horizon = min(self._horizon, time + LOOKAHEAD)
        near = due <= min(self._horizon, FOREVER)
        columns = [a[near], b[near], due[near], *np.zeros((2, np.count_nonzero(near)), dtype=bool)]
        keep = self._without(indices)
        if keep.any():
            columns = [np.concatenate((old[keep], new))
                       for old, new in zip(self._columns(), columns)]
        self._put(*columns)

    def _without(self, indices):
        """Return which pairs, (p,) bool, have none of these bodies (k,)."""
        if len(indices) == 1:
            return (self.body_a != indices) & (self.body_b != indices)
        gone = np.zeros(len(self._solid), dtype=bool)
        gone[indices] = True
        return ~(gone[self.body_a] | gone[self.body_b])

    def _keep(self, which):
        """Take all other pairs off the list."""
        if not which.all():
            self._put(*(column[which] for column in self._columns()))

    def _guard(self, pairs):
        """Mark listed pairs, given as bodies (2, g), as just told apart."""
        if len(pairs[0]) <= FEW:
            for a, b in zip(*pairs.tolist()):
                self._guarded |= (self.body_a == min(a, b)) & (self.body_b == max(a, b))
            return
        count = len(self._solid)
        pairs = pairs.min(axis=0) * count + pairs.max(axis=0)
        self._guarded |= np.isin(self.body_a * count + self.body_b, pairs)

    def _columns(self):
        return self.body_a, self.body_b, self.due, self.found, self._guarded

    def _put(self, body_a, body_b, due, found, guarded):
        self.body_a, self.body_b, self.due = body_a, body_b, due
        self.found, self._guarded = found, guarded
        self._next = min(due.min(initial=np.inf), self._horizon)
