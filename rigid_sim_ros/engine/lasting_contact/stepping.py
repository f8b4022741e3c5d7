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

"""Islands of few bodies stepped through time, to second order: steps cut where something hits."""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.lasting_contact import cut, scales as units
from rigid_sim_ros.engine.lasting_contact.energy_balance import balanced, ending_of
from rigid_sim_ros.engine.lasting_contact.rest import at_rest
from rigid_sim_ros.engine.lasting_contact.step import (
    first_half, Limits, push_out, Trial)

MOST_PARTS = 1000
"""Of a step; more are not worth it."""

_FASTER = 2
"""
How many times as fast as it may something must turn after an impact for the rest of a step to be
divided again: each time anew, bounces that get ever shorter would never be given up.
"""

_MOST_TURN = 0.5
"""[rad] in a part: what dips in and out again within goes in by 3 % of its radius at most."""


def advance_in_steps(island, state, start, duration):
    """
    Advance an `Island` by `duration` [s] from `start` [s]; return (closed contacts, resting).

    The duration is one step, or parts if something is so fast that it could pass through
    something thin, or hit something and be out of it again. The members' columns of the `State`
    of the whole scene are replaced.
    """
    free = island.free_motion(state)
    scales = island.scales(free)
    motion = island.gather(state)
    left, limits = duration, None
    while left > 0.0:
        # an impact may have made something faster, and little may be left
        step = left / _parts(island, free, motion, left)
        limits = limits or Limits.of(scales, step)
        motion, near, remains = _advance(island, free, scales, limits, motion,
                                         start + duration - left, step)
        island.world.work.contact_steps += 1
        left -= step - remains
    touching = near.closed(limits.touch_gap)
    resting = at_rest(free, scales, motion, near, touching)
    island.scatter(motion.stopped() if resting else motion, state)
    return near.contacts.select(touching), resting


def _advance(island, free, scales, limits, motion, time, step):
    """
    Return (motion, contacts near it, time left) after a step [s], cut where something hits.

    Time [s] is left if an impact has made something turn so fast that the rest takes parts.
    """
    overlap = units.OVERLAP * scales.length
    dip = _dip(island, motion, step)
    margin = limits.margin(step) + dip
    near = island.near(motion, margin)
    if cut.arriving(motion, near, overlap, limits.impact_speed).size:
        motion = cut.resolve(Trial.of_no_time(free, motion, near), motion, near, scales, limits,
                             time, rebounds=True)
    left = step
    for number in range(units.MAX_CUTS + 1):
        trial = first_half(free, motion, near, left, limits)
        end = trial.end()
        end_near = island.near(end, margin)
        hit = cut.impact_time(trial, end, end_near, scales, limits, dip)
        if hit is None or number == units.MAX_CUTS:
            left = 0.0
            break
        trial, motion, near = cut.first_impact(island, limits, overlap, margin, trial, hit)
        left -= trial.step
        motion = cut.resolve(trial, motion, near, scales, limits, time + step - left,
                             rebounds=number < units.MAX_BOUNCES)
        if left <= cut.SHORTEST * step:
            left = 0.0
        if not left or _turns(island, motion, left) > _FASTER:
            trial, end, end_near = Trial.of_no_time(free, motion, near), motion, near
            break
    end, end_near, push = _separated(end, end_near, scales, margin)
    closed = end_near.closed(limits.touch_gap)
    if closed.size:
        # what arrives fast just now is an impact, the first thing in the next step
        closed = closed[end_near.approach(end)[closed] <= limits.impact_speed]
    ending = ending_of(trial, end, end_near, closed, push)
    motion, near = balanced(ending, limits.slide_speed)
    island.remember(near, margin)
    return motion, near, left


def _separated(motion, near, scales, margin):
    """
    Return (motion, contacts near it, what is to be paid for) with overlaps pushed out.

    The last is a `Push` or None.
    """
    deepest = -float(near.contacts.separation.min(initial=0.0))
    if deepest <= units.OVERLAP * scales.length:
        return motion, near, None
    motion, push = push_out(motion, near)
    # contacts of bodies that hardly move need not be found again
    if deepest <= units.IMPACT_GAP * scales.length:
        return motion, near.shifted(motion, *push.shift), push
    return motion, near.island.near(motion, margin), (
        push if deepest <= units.DEEP * scales.length else None)


def parts_of(island, free, motion, duration):
    """Return how many parts a step needs so that nothing passes half of what is thinnest."""
    return _count(parts_of_pairs(island, free, motion, duration).max(initial=0.0))


def parts_of_pairs(island, free, motion, duration):
    """Return in how many parts, (p,) float, pairs of an island pass half of what is thinner."""
    pull = 2 * np.sqrt(rotation.dot(free.acceleration, free.acceleration).max())
    way = duration * (island.closing(motion) + duration * pull)
    return way / island.thickness


def _turns(island, motion, duration):
    """Return how many parts a step needs so that in none anything turns too far."""
    turning = duration * island.turning(motion) / island.bodies.bounding_radius
    return _count(turning.max() / _MOST_TURN)


def _dip(island, motion, step):
    """Return how far [m] two bodies that turn come together and part again in a step, at most."""
    turning = step * island.turning(motion)
    return 2 * float((turning * turning / (8 * island.bodies.bounding_radius)).max())


def _parts(island, free, motion, duration):
    """Return how many parts a step needs for either reason."""
    return max(parts_of(island, free, motion, duration), _turns(island, motion, duration))


def _count(parts):
    """Return a whole number of parts, no less than needed but for rounding."""
    return int(min(max(1.0, np.ceil(parts * (1 - 1e-9))), MOST_PARTS))
