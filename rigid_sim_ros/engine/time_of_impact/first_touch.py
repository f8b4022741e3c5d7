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

from rigid_sim_ros.engine.narrow_phase import find_contacts, PairGroups
from rigid_sim_ros.engine.narrow_phase.solids import smaller_size
from rigid_sim_ros.engine.time_of_impact.march import march
from rigid_sim_ros.engine.time_of_impact.pair_lines import PairLines

TOUCH_MARGIN = 1e-9
"""Points nearer than this part of the size meet at the same instant."""


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
    flights : Flights
    pairs_a, pairs_b : (p,) int
    start : float or (p,) [s]
    end : float [s]
    guarded : (p,) bool

    """
    start = np.broadcast_to(np.asarray(start, dtype=float), np.shape(pairs_a))
    guarded = np.asarray(guarded, dtype=bool)
    times = np.full(len(pairs_a), np.inf)
    for group in PairGroups(bodies, pairs_a, pairs_b).groups:
        began = start[group.where]
        lines = PairLines(group.kinds, flights, group.a, group.b, began.min(), end)
        times[group.where] = march(lines, smaller_size(group.a, group.b), began, end,
                                   guarded[group.where])
    return times


def touching_contacts(bodies, flights, pairs_a, pairs_b, time):
    """
    Return all contact points of pairs (p,) that touch at `time` [s], as `Contacts`.

    Those within 1e-9 of the size of the pair: a face that lands flat lands with all its corners.
    """
    position, orientation = flights.poses(time)
    size = np.minimum(bodies.bounding_radius[pairs_a], bodies.bounding_radius[pairs_b])
    return find_contacts(bodies, pairs_a, pairs_b, position, orientation, TOUCH_MARGIN * size)
