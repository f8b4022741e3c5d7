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
"""Whether members of a pile stand that touch nothing else that moves: all of them at once."""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.friction import mixed_friction, tangents
from rigid_sim_ros.engine.lasting_contact.scales import EQUILIBRIUM
from rigid_sim_ros.engine.solvers.canonical import COMPLIANCE
from rigid_sim_ros.engine.solvers.rows import mass_scale, scaled_rows

MOST_CONTACTS = 16
"""Contacts of a member up to which its system is solved directly."""

PASSES = 3
"""Each takes what the compliance leaves down by `COMPLIANCE`; `EQUILIBRIUM` is far above that."""


def lone_members(labels, of_contact, calm):
    """
    Return [(members (g,), contacts (g, k))] of lone calm ones, with as many contacts together.

    Calm are those of a mask (m,). A lone member has a label of `labels` (m,) to itself, which is
    its index, and contacts: `of_contact` (K,) are the labels of theirs.
    """
    count = len(labels)
    alone = calm & (np.bincount(labels, minlength=count) == 1)
    touching = np.bincount(of_contact, minlength=count)
    places = np.argsort(of_contact, kind='stable')
    first = np.cumsum(touching) - touching
    lone = []
    for number in np.unique(touching[alone]).tolist():
        if 0 < number <= MOST_CONTACTS:
            members = np.flatnonzero(alone & (touching == number))
            lone.append((members, places[first[members, None] + np.arange(number)]))
    return lone


def standing(island, free, scales, motion, contacts, members):
    """
    Return which members (g,) bool contacts (g k,) hold, if all of them press and stick.

    The contacts are those of each member, k in a row, with what does not move. What is not found
    to be held so may be held otherwise: `rest.stands` looks for that.
    """
    bodies, count = island.bodies, contacts.count // len(members)
    rows, scale, frames = _rows(bodies, motion, contacts, np.repeat(members, count))
    rows = rows.reshape(3, len(members), count, 6).transpose(1, 0, 2, 3).reshape(
        len(members), 3 * count, 6)
    scale, frames = scale[:, ::count], frames[:, :, ::count]
    pull = free.kicked(motion.stopped(), 1.0)
    scaled = np.concatenate((pull.linear[:, members], rotation.transform_transposed(
        frames, pull.angular[:, members]))) / scale
    force = _forces(rows, scaled.T[:, :, None])
    left = (scaled + (rows.transpose(0, 2, 1) @ force)[:, :, 0].T) * scale
    normal, first, second = force.reshape(len(members), 3, count).transpose(1, 0, 2)
    limit = mixed_friction(bodies.friction[contacts.body_a], bodies.friction[contacts.body_b])
    limit = limit.reshape(len(members), count) * normal
    holds = (normal >= 0) & (first * first + second * second <= limit * limit)
    allowed = EQUILIBRIUM * scales.acceleration
    return (holds.all(axis=1) & (np.abs(left[:3]).max(axis=0) <= allowed)
            & (np.abs(left[3:]).max(axis=0) * bodies.bounding_radius[members] <= allowed))


def _rows(bodies, motion, contacts, owner):
    """
    Return what contacts (K,) do to the bodies (K,) they belong to, which stand on the others.

    As `scaled_rows` (3, K, 6), with the `mass_scale` (6, K) and rotation matrices (3, 3, K).
    """
    axes = np.stack((contacts.normal, *tangents(contacts.normal)))
    frames = rotation.matrix(motion.orientation[:, owner])
    scale = mass_scale(bodies, owner)
    side = np.where(contacts.body_b == owner, 1.0, -1.0)
    arm = contacts.point - motion.position[:, owner]
    return scaled_rows(axes, arm, frames, side * scale), scale, frames


def _forces(rows, pull):
    """Return the forces (g, 3k, 1) that stop a scaled motion (g, 6, 1) by rows (g, 3k, 6)."""
    response = rows @ rows.transpose(0, 2, 1)
    size = response.shape[1]
    diagonal = response.reshape(len(rows), -1)[:, ::size + 1]
    compliance = COMPLIANCE * diagonal[:, :size // 3].mean(axis=1)[:, None, None]
    inverse = np.linalg.inv(response + compliance * np.eye(size))
    free = rows @ pull
    force = np.zeros_like(free)
    for _ in range(PASSES):
        force = inverse @ (compliance * force - free)
    return force
