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
What a pile remembers from one set of contacts to the next: impulses, and who has not moved.

Islands are made anew as bodies move, contacts as they wear out. The impulses of the last step
start the solver off again, point by nearest point of the same pair; they save time and cannot
matter once it has converged. Being quiet is having stayed in the same place for a while, whatever
tremor there is.
"""

import numpy as np

MATCH = 0.2
"""Of the length scale: an old point this near to a new one is the same."""


class Impulses:
    """
    Impulses of contact points, (k) of them, by pair.

    Parameters
    ----------
    keys : (k,) int
        One number a pair; equal ones next to each other.
    points, impulses : (3, k)
        Places [m] and impulses [N s] on b, world axes.

    """

    def __init__(self, keys, points, impulses):
        """See the class."""
        starts = np.flatnonzero(np.diff(keys, prepend=-1))
        sizes = np.diff(starts, append=len(keys))
        pairs = np.repeat(np.arange(len(starts)), sizes)
        places = np.arange(len(keys)) - starts[pairs]
        order = np.argsort(keys[starts])
        rank = np.empty(len(starts), dtype=int)
        rank[order] = np.arange(len(starts))
        self._keys = keys[starts][order]
        room = sizes.max(initial=0)
        self._points = np.full((3, len(starts), room), np.inf)
        self._impulses = np.zeros((3, len(starts), room))
        self._points[:, rank[pairs], places] = points
        self._impulses[:, rank[pairs], places] = impulses

    def at(self, keys, points, reach):
        """Return the impulses (3, k) of the nearest points of the same pairs within `reach`."""
        result = np.zeros(points.shape)
        if not len(self._keys):
            return result
        place = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        known = np.flatnonzero(self._keys[place] == keys)
        place = place[known]
        away = self._points[:, place] - points[:, known, None]
        square = (away * away).sum(axis=0)
        nearest = np.argmin(square, axis=1)
        rows = np.arange(len(known))
        near = square[rows, nearest] < reach * reach
        result[:, known[near]] = self._impulses[:, place[near], nearest[near]]
        return result


class Quiet:
    """
    Since when each body has been where it is.

    Parameters
    ----------
    members : (m,) int
        Indices of the bodies in the scene.

    """

    def __init__(self, members):
        """See the class."""
        self.members = members
        self._position = np.full((3, len(members)), np.inf)
        self._orientation = np.zeros((4, len(members)))
        self._since = np.zeros(len(members))

    def take_over(self, older):
        """Know what another knew of the same bodies."""
        _, mine, theirs = np.intersect1d(self.members, older.members, return_indices=True)
        self._position[:, mine] = older._position[:, theirs]
        self._orientation[:, mine] = older._orientation[:, theirs]
        self._since[mine] = older._since[theirs]

    def forget(self, members):
        """Count from now on for these bodies (k,) of the scene: somebody disturbs them."""
        self._position[:, np.isin(self.members, members)] = np.inf

    def durations(self, time, motion, radius, way):
        """
        Return for how long [s] bodies have been where they are, (m,).

        That is to `way` [m], turning counted at the radius (m,) [m].
        """
        count = len(self.members)
        position, orientation = motion.position[:, :count], motion.orientation[:, :count]
        step = position - self._position
        turn = 1.0 - np.abs((orientation * self._orientation).sum(axis=0))
        # 1 - |cos(half the angle)| is an eighth of the square of a small angle
        moved = (step * step).sum(axis=0) + 8.0 * turn * radius * radius > way * way
        if moved.any():
            self._position[:, moved] = position[:, moved]
            self._orientation[:, moved] = orientation[:, moved]
            self._since[moved] = time
        return time - self._since
