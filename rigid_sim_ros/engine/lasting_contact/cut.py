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
Impacts within a step of lasting contact: which they are, when, and what they do.

A step that ends with something deeper than rounding is cut where that arrives. When it does is
first searched on the motion that was tried, features alone and contact forces held; then the step
is taken so far and looked at, and again if forces that are not quite constant have moved it.
"""

import numpy as np

from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.friction import mixed_restitution
from rigid_sim_ros.engine.impacts import resolve_impact
from rigid_sim_ros.engine.lasting_contact import scales as units
from rigid_sim_ros.engine.lasting_contact.arrival import dipping_time, meeting_time
from rigid_sim_ros.engine.lasting_contact.energy_balance import balanced, ending_of
from rigid_sim_ros.engine.lasting_contact.step import first_half, Trial

_MAX_ROUNDS = 50
_ROUNDING = 1e-13
"""Of the step: an interval that is not divided any more."""

_GAIN = 0.75
"""
An overlap that shrinks to no less than this part does not come from its time: it is one that the
step would close softly, and did not quite as it is not straight.
"""

SHORTEST = 1e-9
"""Part of a step that is not worth taking: bounds on velocities divide by it."""


def arriving(motion, near, gap, speed):
    """Return the contacts (m,) int with gaps below `gap` [m] approaching faster than `speed`."""
    closed = near.contacts.separation < gap
    if not closed.any():
        return np.zeros(0, dtype=int)
    return np.flatnonzero(closed & (near.approach(motion) > speed))


def impact_time(trial, end, end_near, scales, limits, dip):
    """
    Return about when [s] the first impact is in the step of a `Trial`, None if there is none.

    That is of contacts near its end which overlap there and approach, or are deep, or have been
    closed in between: what turns fast dips in and out again, by `dip` [m] at most.
    """
    contacts, overlap = end_near.contacts, units.OVERLAP * scales.length
    hits = _hitting(end, end_near, units.IMPACT_GAP * scales.length, limits, trial.near)
    if hits.size:
        return meeting_time(trial, end, contacts, hits.tolist(), overlap) or 0.5 * trial.step
    speed, parting = 0.5 * limits.impact_speed, -end_near.approach(end)
    rows = np.flatnonzero((parting > speed) & (contacts.separation < dip)).tolist()
    return dipping_time(trial, end, contacts, rows, parting, overlap, speed)


def _hitting(motion, near, gap, limits, before):
    """
    Return the contacts (m,) int that overlap by more than a gap [m] and approach, or are deep.

    Deeper than what counts as closed, and than any contact was `before` the step, it has hit in
    whatever direction it moves now.
    """
    arrived = arriving(motion, near, -gap, 0.5 * limits.impact_speed)
    deepest = max(limits.touch_gap, -float(before.contacts.separation.min(initial=0.0)))
    return np.union1d(arrived, near.closed(-deepest))


def first_impact(island, limits, overlap, margin, trial, time):
    """
    Return (the step so far, motion, contacts near it) at the first impact in a step.

    Parameters
    ----------
    island : Island
        Whose step it is.
    limits : step.Limits
        What counts as an impact, among others.
    overlap, margin : float [m]
        Gap, positive or negative, that counts as none; up to which contacts are found.
    trial : step.Trial
        The step.
    time : float [s]
        About when it is.

    """
    speed = 0.5 * limits.impact_speed
    near, low, high, latest, depth = trial.near, 0.0, trial.step, None, np.inf
    shortest = SHORTEST * trial.step
    for _ in range(_MAX_ROUNDS):
        if time is None or not low < time < high:
            time = 0.5 * (low + high)
        if time <= shortest:
            return Trial.of_no_time(trial.free, trial.start, near), trial.start, near
        tried = first_half(trial.free, trial.start, near, time, limits)
        motion = tried.end()
        around = island.near(motion, margin)
        hits = _hitting(motion, around, overlap, limits, near)
        if hits.size:
            before, depth = depth, -float(around.contacts.separation[hits].min())
            high, latest = time, (tried, motion, around)
            if depth > _GAIN * before or high - low <= _ROUNDING * trial.step:
                break
            time = meeting_time(tried, motion, around.contacts, hits.tolist(), overlap)
        elif arriving(motion, around, overlap, speed).size:
            return tried, motion, around
        else:
            low = time
            if latest is not None and high - low <= _ROUNDING * trial.step:
                break
            time = _extrapolated(time, motion, around, speed)
    return latest or (tried, motion, around)


def _extrapolated(time, motion, near, speed):
    """Return when [s] the first contact closes that approaches fast, at that speed, or None."""
    approach = near.approach(motion)
    fast = approach > speed
    if not fast.any():
        return None
    return time + float((near.contacts.separation[fast] / approach[fast]).min())


def resolve(trial, motion, near, scales, limits, time, rebounds):
    """
    Return the motion after the impact of all contacts that are closed, and note its events.

    What was touching before is first given the forces it has missed since the last half step, so
    that it does not yield before it is hit; the step until then, a `Trial`, ends with that.
    Without `rebounds` all restitution is zero.
    """
    closed = near.closed(units.IMPACT_GAP * scales.length)
    if not closed.size:
        return motion
    fast = near.approach(motion) > 0.5 * limits.impact_speed
    held = closed[~fast[closed]]
    motion, _ = balanced(ending_of(trial, motion, near, held), limits.slide_speed, carry=False)
    for group in near.groups(closed):
        if fast[group].any():
            motion = _struck(motion, near, group, scales, limits, time, rebounds)
    return motion


def _struck(motion, near, group, scales, limits, time, rebounds):
    """Return the motion after the impact of contacts (l,) int that act on each other."""
    island, contacts = near.island, near.contacts.select(group)
    world, bodies = island.world, island.bodies
    restitution = mixed_restitution(bodies, contacts.body_a, contacts.body_b).max()
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
