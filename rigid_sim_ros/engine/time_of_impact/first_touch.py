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

"""First touches of pairs of any kinds."""

import numpy as np

from rigid_sim_ros.engine.bodies import PLANE
from rigid_sim_ros.engine.narrow_phase import PairGroups, PAIRS
from rigid_sim_ros.engine.narrow_phase.solids import smaller_size
from rigid_sim_ros.engine.time_of_impact.march import march
from rigid_sim_ros.engine.time_of_impact.pair_lines import PairLines
from rigid_sim_ros.engine.time_of_impact.plain_boxes import box_box
from rigid_sim_ros.engine.time_of_impact.plain_lines import (
    box_plane, PlainBody, sphere_box, sphere_plane, sphere_sphere)
from rigid_sim_ros.engine.time_of_impact.plain_march import march_one

FEW = 8
"""Up to so many pairs are searched one by one in plain floats, which is faster (measured)."""

PLAIN_LINES = {('box', 'box'): box_box, ('box', PLANE): box_plane, ('sphere', 'box'): sphere_box,
               ('sphere', PLANE): sphere_plane, ('sphere', 'sphere'): sphere_sphere}
"""The same rows as `pair_lines.LINES`."""


def first_touches(bodies, flights, pairs_a, pairs_b, start, end, guarded):
    """
    Return when [s], (p,), each pair first touches; infinite where it does not by `end`.

    Two bodies touch from the first time at or after `start` at which they do not separate any
    more along any axis while some of their vertices approach each other. So

    - bodies that overlap and approach at `start` touch at `start`; those that overlap and
      recede are watched from there on, and touch when they approach before they have parted;
    - bodies in resting or sliding contact (no gap, no approach) touch at `start` too, within
      some 1e-9 s: whether that is an event or lasting contact is for the caller to say;
    - a guarded pair (it touches now and was just resolved) touches again only where it is deeper
      than 1e-10 of its size, until it has been apart by 1e-9 of it: with no approach speed left
      and an acceleration g into each other this is after sqrt(2e-10 size / g), not at once;
    - what hovers within 1e-9 of its size of a touch for 128 steps of the march, neither coming
      nor going, counts as touching then. So the search ends, whatever the motion.

    The size of a pair is the smaller bounding radius; a graze within rounding is a touch.

    Parameters
    ----------
    bodies : Bodies
        Which bodies there are.
    flights : Flights
        How they move.
    pairs_a, pairs_b : (p,) int
        Which may touch.
    start : float or (p,) [s]
        When the search begins.
    end : float [s]
        When it ends.
    guarded : (p,) bool
        Which of the pairs touch at the start and were just resolved.

    """
    start = np.full(len(pairs_a), start, dtype=float)
    if len(pairs_a) <= FEW:
        return np.array([
            first_touch(bodies, flights, int(a), int(b), float(began), end, untold)
            for a, b, began, untold in zip(pairs_a, pairs_b, start, guarded)])
    times = np.full(len(pairs_a), np.inf)
    for group in PairGroups(bodies, pairs_a, pairs_b).groups:
        where = group.where
        lines = PairLines(group.kinds, flights, group.a, group.b, start[where].min(), end)
        times[where], rest, reached, armed = march(
            lines, smaller_size(group.a, group.b), start[where], end, guarded[where], FEW)
        for place, pair in enumerate(rest.tolist()):
            times[where[pair]] = _first_touch(
                bodies, flights, group.a.index.item(pair), group.b.index.item(pair),
                reached.item(place), end, armed[:, place].tolist())
    return times


def first_touch(bodies, flights, a, b, start, end, guarded):
    """Return the first touch [s] of one pair, in plain floats: `first_touches`."""
    return _first_touch(bodies, flights, a, b, start, end, [not guarded])


def _first_touch(bodies, flights, a, b, start, end, armed):
    """Return the first touch [s] of one pair some of whose lines are armed."""
    kinds = bodies.kinds[a], bodies.kinds[b]
    if kinds not in PAIRS:
        a, b, kinds = b, a, kinds[::-1]
    if kinds not in PAIRS:
        raise ValueError(f'{kinds[1]} and {kinds[0]} cannot meet; allowed: {list(PAIRS)}')
    one = PlainBody(bodies, flights, a, start, end)
    if kinds[1] == PLANE:
        other = bodies.plane_normal[:, b].tolist(), bodies.plane_offset.item(b)
        size = one.radius
    else:
        other = PlainBody(bodies, flights, b, start, end),
        size = min(one.radius, other[0].radius)
    return march_one(PLAIN_LINES[kinds](one, *other, end), size, start, end, armed)
