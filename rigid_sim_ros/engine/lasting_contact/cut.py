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

"""Impacts within a step of lasting contact: which they are, when, and what they do."""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.friction import mixed_restitution
from rigid_sim_ros.engine.impacts import resolve_impact
from rigid_sim_ros.engine.lasting_contact import scales as units
from rigid_sim_ros.engine.lasting_contact.step import second_half, velocity_across

_MAX_ROUNDS = 50
_ROUNDING = 1e-13
"""Of the length scale, for a gap, and of the step, for a time: where a search ends."""


def fast(motion, contacts, speed):
    """Return which contacts (k,) bool approach faster than `speed` [m/s]."""
    return rotation.dot(velocity_across(contacts, motion), contacts.normal) < -speed


def impacts_in(motion, contacts, gap, speed):
    """Return the contacts with gaps below `gap` [m] that approach faster than `speed` [m/s]."""
    contacts = contacts.select(np.flatnonzero(contacts.separation < gap))
    return contacts.select(fast(motion, contacts, speed)) if contacts.count else contacts


def gap_function(island, hits, motion, step, speed):
    """
    Return a function of a `Motion`: the gap [m] of what hits, of the pairs of `hits` (k).

    It is the smallest of the contacts that approach faster than `speed` [m/s]: others of the same
    pair may be closed all the time. `motion` is that after the step [s] in which they hit.
    """
    pairs = island.pairs_of(hits)
    approach = -rotation.dot(velocity_across(hits, motion), hits.normal)
    margin = 2 * step * float(approach.max())

    def gap(motion):
        island.world.work.narrow_phases += len(pairs.pairs_a)
        contacts = pairs.find_contacts(motion.position, motion.orientation, margin)
        return float(contacts.separation[fast(motion, contacts, speed)].min(initial=margin))

    return gap


def time_of_impact(trial, gap, step, length):
    """
    Return (time [s], motion) at which a gap closes within a step.

    `trial(time)` returns the motion after that time, `gap(motion)` the gap, which is negative
    after the whole step. The search is the Illinois method (Dowell and Jarratt 1971), which keeps
    a bracket. If the gap is closed at the start, that is the time.
    """
    low, high = 0.0, step
    motion = trial(low)
    gap_low, gap_high = gap(motion), gap(trial(high))
    if gap_low <= 0.0:
        return low, motion
    side = 0
    for _ in range(_MAX_ROUNDS):
        time = (low * gap_high - high * gap_low) / (gap_high - gap_low)
        motion = trial(time)
        found = gap(motion)
        if abs(found) <= _ROUNDING * length or high - low <= _ROUNDING * step:
            break
        if found > 0.0:
            low, gap_low = time, found
            gap_high *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            high, gap_high = time, found
            gap_low *= 0.5 if side == -1 else 1.0
            side = -1
    return time, motion


def resolve(island, motion, contacts, scales, limits, time, rebounds):
    """
    Return the motion after the impact of all contacts that are closed, and note its events.

    What was touching before is first given the forces it has missed since the last half step, so
    that it does not yield before it is hit. Without `rebounds` all restitution is zero.
    """
    world, bodies = island.world, island.bodies
    contacts = contacts.select(
        np.flatnonzero(contacts.separation < units.IMPACT_GAP * scales.length))
    if not contacts.count:
        return motion
    slow = contacts.select(~fast(motion, contacts, 0.5 * limits.impact_speed))
    motion = second_half(island, motion, slow)
    restitution = mixed_restitution(
        bodies.restitution[contacts.body_a], bodies.restitution[contacts.body_b]).max()
    threshold = np.inf
    if rebounds and restitution > 0:
        threshold = max(0.5 * limits.impact_speed, units.STICK * scales.speed / restitution)
    impact = resolve_impact(bodies, contacts, motion.position, motion.orientation, motion.linear,
                            motion.angular, world.impact_law, threshold)
    world.work.impacts += 1
    columns = island.columns
    for row in np.flatnonzero(impact.speed > 0.5 * limits.impact_speed):
        world.events.append(
            time, columns[contacts.body_a[row]], columns[contacts.body_b[row]], IMPACT,
            contacts.point[:, row], contacts.normal[:, row], impact.impulse[:, row],
            impact.speed[row])
    return motion.struck(impact.touched, impact.linear, impact.angular)
