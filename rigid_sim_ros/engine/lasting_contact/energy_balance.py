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
What the end of a step puts right for bodies that touch: how far forces carried them, and energy.

Contact forces only take energy away, or none, but a step of second order keeps to that but for
the cube of its length, and what pushes overlaps out lifts bodies. What a group of touching bodies
has gained beyond the work of held forces is taken out of its velocities, all of them in the same
proportion: no contact that was at rest moves, none that parts or slides does so in another
direction. Where all contacts stick, on something fixed that is rough, they do no work at all, and
what has got lost is given back.

Slowed alone, bodies that tip over would come late by more than what they gained was worth: energy
comes from half steps that know nothing of how forces change on the way. Where contacts stick that
is first put right, by the third term of the series of the motion: h^3 / 6 times the change of the
accelerations per time.

Left alone is the part of the motion that contacts cannot change: with nothing fixed in touch that
of the group as one rigid body, which has its momentum and angular momentum; on fixed faces without
friction what of it goes along all of them, and turns about their normal. The rest is orthogonal to
it: the kinetic energy is that of the one and the other.
"""

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.graph import connected
from rigid_sim_ros.engine.lasting_contact.motion import Motion
from rigid_sim_ros.engine.lasting_contact.near import Near
from rigid_sim_ros.engine.lasting_contact.step import Push, second_half, Trial

_ROUNDING = 1e-15
"""Of the kinetic energy: a change that is none."""

_MOST = 0.1
"""Of the kinetic energy: what may be given back. More is no error of a step."""

_STILL = 1e-5
"""Of the speed above which contacts are known to slide: what sticks has less."""

_PARALLEL = 1e-9
"""Of 1: how far normals of the same direction may differ."""


class Ending(NamedTuple):
    """The end of a step."""

    trial: Trial
    """The step."""

    before: Motion
    """At its end but for the impulses of the second half."""

    after: Motion
    """With them."""

    impulse: np.ndarray
    """(3, k) [N s], contact axes: those of the second half; None if there are none."""

    near: Near
    """The contacts there."""

    push: Push
    """How overlaps have been pushed out there, if energy allows; None if they have not."""

    @property
    def halves(self):
        """Return [(contacts near, impulses, velocities across)] of the halves with impulses."""
        halves = [(self.trial.near, self.trial.impulse, self.trial.across)]
        if self.impulse is not None:
            halves.append((self.near, self.impulse, self.near.across(self.after)))
        return halves[self.trial.impulse is None:]


def ending_of(trial, before, near, which, push=None):
    """Return the `Ending` of a step, with the impulses of its second half at contacts (m,) int."""
    return Ending(trial, before, *second_half(before, near, which, trial.step), near, push)


class Group(NamedTuple):
    """Bodies that act on each other, or are pushed out of each other."""

    members: list
    """(m,) int"""

    rough: bool
    """Whether they press on something fixed with friction."""

    walls: np.ndarray
    """(3, w): the normals of what is fixed that they press on."""

    slip: float
    """
    [m/s]: how fast contacts slide, or part, on the average of the normal forces on a body; of the
    body with which that is most. Light ones slide on heavy ones that stick. Infinite where some
    are pushed that do not press.
    """


def balanced(ending, slide_speed, carry=True):
    """
    Return (motion, contacts near it) at the end of a step, with the energy that is to be there.

    Parameters
    ----------
    ending : Ending
        As it is without.
    slide_speed : float [m/s]
        See `step.Limits`.
    carry : bool
        Whether bodies may still be moved; not where something is just to hit.

    """
    groups = _groups(ending)
    if not groups:
        return ending.after, ending.near
    still = _STILL * slide_speed
    sticking = [group.rough and group.slip <= still for group in groups]
    motion, near = ending.after, ending.near
    shift = ending.push.shift if ending.push else np.zeros((2, *motion.linear.shape))
    if carry and any(sticking):
        motion, near, carried = _carried(ending, [
            body for group, sticks in zip(groups, sticking) if sticks for body in group.members])
        shift = shift + carried
    free, trial = ending.trial.free, ending.trial
    energy = free.kinetic_energy(motion)
    gain = energy - free.kinetic_energy(trial.start) - free.work(trial.start, motion, trial.step)
    for group, sticks in zip(groups, sticking):
        rise, there = (float(values[group.members].sum()) for values in (gain, energy))
        if rise > _ROUNDING * there or sticks and _ROUNDING * there < -rise < _MOST * there:
            motion, unpaid = slowed(free, motion, group, rise)
            if unpaid > _ROUNDING * rise:
                motion, near = _taken_back(free, motion, near, group.members, shift, unpaid)
    return motion, near


def _groups(ending):
    """Return the `Group`s of bodies that press on each other, or are pushed, in a step."""
    pairs, normals, forces, slips = [], [], [], []
    for near, impulse, across in ending.halves:
        pressing = np.flatnonzero(impulse[0] > 0.0)
        across = across[:, pressing]
        pairs += [near.body_pairs[place] for place in pressing.tolist()]
        normals += near.contacts.normal[:, pressing].T.tolist()
        forces += impulse[0, pressing].tolist()
        slips += np.sqrt(rotation.dot(across, across)).tolist()
    if ending.push:
        known, near = set(pairs), ending.push.near
        only = [place for place in ending.push.which.tolist()
                if near.body_pairs[place] not in known]
        pairs += [near.body_pairs[place] for place in only]
        normals += near.contacts.normal[:, only].T.tolist()
        forces += [1.0] * len(only)
        slips += [inf] * len(only)
    bodies = ending.near.island.bodies
    count, result = bodies.moving_count, []
    for places in connected(pairs, count):
        places = places.tolist()
        walls = [place for place in places if max(pairs[place]) >= count]
        result.append(Group(
            sorted({body for place in places for body in pairs[place] if body < count}),
            any(bodies.friction.item(a) > 0 and bodies.friction.item(b) > 0
                for a, b in (pairs[place] for place in walls)),
            np.array([normals[place] for place in walls]).reshape(-1, 3).T,
            _slip([(body, forces[place], slips[place]) for place in places
                   for body in pairs[place] if body < count])))
    return result


def _slip(touches):
    """Return the `slip` of a `Group` of (body, normal force, speed across) of its contacts."""
    force, flow = {}, {}
    for body, normal, speed in touches:
        force[body] = force.get(body, 0.0) + normal
        flow[body] = flow.get(body, 0.0) + normal * speed
    return max(flow[body] / force[body] for body in force)


def _carried(ending, members):
    """
    Return (motion, contacts near it) at the end, as forces that change carry bodies (m,).

    And by how much, (2, 3, n) [m], [rad].
    """
    trial, before, after = ending.trial, ending.before, ending.after
    free, half = trial.free, 0.5 * trial.step
    # what forces do in half a step, late less early; held ones do the same but for turning
    late_linear = after.linear - before.linear - (trial.struck.linear - trial.kicked.linear)
    late_angular = (after.angular - before.angular + free.turned_by_torques(after, half)
                    - (trial.struck.angular - trial.kicked.angular)
                    - free.turned_by_torques(trial.start, half))
    shift = np.zeros((2, *after.linear.shape))
    shift[0, :, members] = (trial.step / 3.0) * late_linear[:, members].T
    shift[1, :, members] = (trial.step / 3.0) * late_angular[:, members].T
    motion = after.moved(np.arange(shift.shape[2]), *shift)
    return motion, ending.near.shifted(motion, *shift), shift


def _taken_back(free, motion, near, members, shift, unpaid):
    """
    Return (motion, contacts near it) with so much of a shift undone that an energy [J] is paid.

    Of the bodies (m,) int only, and no more than all of what lifts them against held forces.
    Overlaps that a pile has left, of bodies that come to rest, may have nothing else to pay for
    being pushed out: they stay. Nor may what is carried on gain, where forces end on the way.
    """
    own = np.zeros_like(shift)
    own[:, :, members] = shift[:, :, members]
    lifted = -float((free.mass * rotation.dot(free.acceleration, own[0])).sum())
    if lifted <= 0.0:
        return motion, near
    own *= -min(1.0, unpaid / lifted)
    motion = motion.moved(np.arange(own.shape[2]), *own)
    return motion, near.shifted(motion, *own)


def slowed(free, motion, group, rise):
    """
    Return the motion with a group's velocities slowed down by an energy [J], or less.

    And what is left of that [J].
    """
    members = group.members
    kept = np.zeros((2, 3, len(members))) if group.rough else _kept(free, motion, group)
    linear, angular = np.zeros((2, *motion.linear.shape))
    linear[:, members] = motion.linear[:, members] - kept[0]
    angular[:, members] = motion.angular[:, members] - kept[1]
    energy = float(free.kinetic_energy(
        Motion(motion.position, motion.orientation, linear, angular)).sum())
    less = 1.0 - (sqrt(1.0 - rise / energy) if rise < energy else 0.0)
    return Motion(motion.position, motion.orientation, motion.linear - less * linear,
                  motion.angular - less * angular), max(0.0, rise - energy)


def _kept(free, motion, group):
    """
    Return the velocities (3, m), (3, m) of a group's members that no contact changes.

    They are those of one rigid body, of the same momentum and angular momentum as far as smooth
    walls leave it alone.
    """
    members = group.members
    directions, sizes, _ = np.linalg.svd(group.walls)
    across = directions[:, :int((sizes > _PARALLEL).sum())]
    # with walls of one direction bodies turn about that, with several not at all
    axes = (np.eye(3), across, np.zeros((3, 0)), np.zeros((3, 0)))[across.shape[1]]
    mass, tensors = free.mass[members], free.inertia_tensors(motion, members)
    linear, position = motion.linear[:, members], motion.position[:, members]
    momentum, arms = linear @ mass, position - (position @ mass / mass.sum())[:, None]
    spin = (rotation.cross(arms, mass * linear).sum(axis=1)
            + np.einsum('ijn,jn->i', tensors, motion.angular[:, members]))
    inertia = (tensors.sum(axis=2) + mass @ rotation.dot(arms, arms) * np.eye(3)
               - (arms * mass) @ arms.T)
    velocity = (momentum - across @ (across.T @ momentum)) / mass.sum()
    rate = np.repeat((axes @ np.linalg.solve(axes.T @ inertia @ axes, axes.T @ spin))[:, None],
                     len(members), axis=1)
    return velocity[:, None] + rotation.cross(rate, arms), rate
