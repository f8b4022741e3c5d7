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

import numpy as np

from rigid_sim_ros.engine.broad_phase import meeting_times, swept_pairs
from rigid_sim_ros.engine.time_of_impact import first_touches

SEARCH_WINDOW = 0.25
"""
Flights are searched for a touch at least this far ahead [s]. Longer finds more touches that a
change of flight makes worthless, shorter searches the same arc more often.
"""

FOREVER = 1e300
"""Later than any time [s] that is asked for; what can never meet is due at infinity."""

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
        self._drop(indices)
        self._flying[indices] = self._solid[indices] = True
        self.active = bool(self._flying.any())
        if len(indices) * int(self._solid.sum()) > RENEWED_PAIRS:
            self._renew(time)
        else:
            self._append(*self._pairs_with(indices), time)
        if guarded is not None and guarded.size:
            self._guard(guarded)

    def rest(self, indices, time):
        """Let bodies (k,) lie still from `time` [s] on: what flies may hit them."""
        self._drop(indices)
        self._flying[indices] = False
        self.active = bool(self._flying.any())
        self._solid[indices] = True
        self._append(*self._pairs_with(indices), time)

    def hide(self, indices):
        """Nothing in flight meets these bodies (k,) until they fly or rest."""
        self._drop(indices)
        self._flying[indices] = self._solid[indices] = False
        self.active = bool(self._flying.any())

    # -- what it asks --------------------------------------------------------------------------

    def next_touch(self, end):
        """Return the instant [s] of the first touch by `end` and its pairs a, b (p,), or None."""
        while self._next <= end:
            time = self._next
            if time == self._horizon:
                self._renew(time)
                continue
            first = self.due == time
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
        rows = np.flatnonzero(~self.found & (self.due <= end))
        start = self.due[rows]
        until = max(end, float(start.max()) + SEARCH_WINDOW)
        a, b = self.body_a[rows], self.body_b[rows]
        self._world.work.touch_searches += len(rows)
        times = first_touches(self._world.bodies, self._flights, a, b, start, until,
                              self._guarded[rows])
        found = np.isfinite(times)
        times[~found] = self._bounds(a[~found], b[~found], until)
        self.found[rows] = found
        self.due[rows] = times
        self._next = min(self.due.min(), self._horizon)

    def _bounds(self, a, b, time):
        """Return the times [s], (p,), from `time` on, before which pairs cannot touch."""
        self._world.work.pair_bounds += len(a)
        center, velocity = self._flights.translation(time)
        return time + meeting_times(self._world.bodies, a, b, center, velocity,
                                    self._flights.acceleration)

    def _pairs_with(self, indices):
        """Return the bodies a and b, (p,) each, of all pairs of these with what they may meet."""
        others = np.flatnonzero(self._solid)
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

    def _renew(self, time):
        """Start the list again with all pairs that may meet before a new horizon."""
        self._drop(np.flatnonzero(self._flying))
        center, velocity = self._flights.translation(time)
        a, b, horizon = swept_pairs(self._world.bodies, self._flying, self._solid, center,
                                    velocity, self._flights.acceleration)
        self._horizon = time + horizon
        self._append(a, b, time)

    def _append(self, a, b, time):
        """List pairs, unless they cannot meet before the horizon."""
        due = self._bounds(a, b, time)
        near = due <= min(self._horizon, FOREVER)
        self._put(np.concatenate((self.body_a, a[near])), np.concatenate((self.body_b, b[near])),
                  np.concatenate((self.due, due[near])),
                  np.concatenate((self.found, np.zeros(near.sum(), dtype=bool))),
                  np.concatenate((self._guarded, np.zeros(near.sum(), dtype=bool))))

    def _drop(self, indices):
        """Take the pairs of these bodies off the list."""
        if not len(self.due):
            return
        gone = np.zeros(len(self._solid), dtype=bool)
        gone[indices] = True
        keep = ~(gone[self.body_a] | gone[self.body_b])
        self._put(self.body_a[keep], self.body_b[keep], self.due[keep], self.found[keep],
                  self._guarded[keep])

    def _guard(self, pairs):
        """Mark listed pairs, given as bodies (2, g), as just told apart."""
        for a, b in np.sort(pairs, axis=0).T.tolist():
            self._guarded |= (self.body_a == a) & (self.body_b == b)

    def _put(self, body_a, body_b, due, found, guarded):
        self.body_a, self.body_b, self.due = body_a, body_b, due
        self.found, self._guarded = found, guarded
        self._next = min(due.min(initial=np.inf), self._horizon)
