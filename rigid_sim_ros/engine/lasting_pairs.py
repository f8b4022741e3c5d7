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

from rigid_sim_ros.engine.events import BEGIN, END


class LastingPairs:
    """The pairs that touch at the end of a step, told apart from those before."""

    def __init__(self, world):
        self._world = world
        self._last_seen = {}
        """By pair (a, b): a point and the normal, (3,) each, when it was last seen."""

    def update(self, time, island, contacts):
        """Note what began and what ended by `time` [s]; contacts are in columns of the island."""
        body_a, body_b = island.columns[contacts.body_a], island.columns[contacts.body_b]
        seen = {pair: row for row, pair in enumerate(zip(body_a.tolist(), body_b.tolist()))}
        members = set(island.members.tolist())
        before = {pair for pair in self._last_seen if not members.isdisjoint(pair)}
        for pair in sorted(seen.keys() - before):
            row = seen[pair]
            self._note(time, pair, BEGIN, contacts.point[:, row], contacts.normal[:, row])
        for pair in sorted(before - seen.keys()):
            self._note(time, pair, END, *self._last_seen.pop(pair))
        for pair, row in seen.items():
            self._last_seen[pair] = contacts.point[:, row], contacts.normal[:, row]

    def forget(self, time, indices):
        """Take bodies (k,) out of contact, after a command say, at `time` [s]."""
        gone = set(np.asarray(indices).tolist())
        for pair in sorted(pair for pair in self._last_seen if not gone.isdisjoint(pair)):
            self._note(time, pair, END, *self._last_seen.pop(pair))

    def _note(self, time, pair, kind, point, normal):
        self._world.events.append(time, *pair, kind, point, normal)
