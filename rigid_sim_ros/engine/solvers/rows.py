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
What contact forces do to bodies: the map between contact axes and motions of bodies.

`ContactRows` holds, for k contacts, the 3k contact axes and the rows J sqrt(M^-1) of the scaled
Jacobian, so that the response is one product of a matrix with its own transpose: symmetric to the
last bit, and masses appear nowhere else.
"""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.friction import tangents

_NEXT, _AFTER = np.array((1, 2, 0)), np.array((2, 0, 1))


@dataclass
class ContactRows:
    """The axes of k contacts and what they do to the m moving bodies they touch."""

    touched: np.ndarray
    """(m,) int: the indices of the moving bodies, ascending."""

    axes: np.ndarray
    """(3, 3, k): axes[c] are the k world unit vectors (3, k) of row c: normal, tangents."""

    bodies: np.ndarray
    """(2k,) int: the bodies a, then the bodies b."""

    arms: np.ndarray
    """(3, 2k) [m] from the centres of these bodies to the contact points."""

    scaled: np.ndarray
    """(3k, 6m): the rows of J sqrt(M^-1); per body three linear columns, three in body axes."""

    scale: np.ndarray
    """(6m,): sqrt(M^-1), inverse masses and principal inverse moments."""

    frames: np.ndarray
    """
    (3, 3, m): rotation matrices of the touched bodies.

    None where all moments of each are equal: then body axes may be any, those of the world are.
    """

    @property
    def count(self):
        """Count of contacts."""
        return len(self.bodies) // 2

    def response(self):
        """Return the motion across the contacts per force, (3k, 3k)."""
        return self.scaled @ self.scaled.T

    def motion(self, linear, angular):
        """
        Return the motion across the contacts, (3k,), of motions (3, n) of all bodies.

        Velocities give the velocity of b minus that of a at the contact points. Accelerations
        give their linear part (without the centripetal one).
        """
        return self.components(self.across(linear, angular))

    def across(self, linear, angular):
        """Return `motion` in world axes, (3, k)."""
        count = self.count
        each = linear.take(self.bodies, axis=1) + rotation.cross(
            angular.take(self.bodies, axis=1), self.arms)
        return each[:, count:] - each[:, :count]

    def components(self, vectors):
        """Return world vectors (3, k) in contact axes, (3k,)."""
        axes = self.axes
        return (axes[:, 0] * vectors[0] + axes[:, 1] * vectors[1]
                + axes[:, 2] * vectors[2]).ravel()

    def world(self, force):
        """Return world vectors (3, k) of components (3k,) in contact axes."""
        normal, first, second = force.reshape(3, -1)
        return self.axes[0] * normal + self.axes[1] * first + self.axes[2] * second

    def change(self, force):
        """Return the changes (3, m) of linear and angular motion of the touched bodies."""
        change = ((force @ self.scaled) * self.scale).reshape(-1, 2, 3)
        angular = change[:, 1].T
        return change[:, 0].T, (angular if self.frames is None
                                else rotation.transform(self.frames, angular))


def contact_rows(bodies, contacts, position, orientation):
    """Return `ContactRows` for contacts and the poses (3, n) and (4, n) of all bodies."""
    count, moving = contacts.count, bodies.moving_count
    both = np.concatenate((contacts.body_a, contacts.body_b))
    touched = sorted({index for index in both.tolist() if index < moving})
    slots = np.full(bodies.count, len(touched))
    slots[touched] = np.arange(len(touched))
    slot = slots.take(both)
    touched = np.array(touched, dtype=int)
    scale = mass_scale(bodies, touched)
    axes = np.empty((3, 3, count))
    axes[0] = contacts.normal
    axes[1], axes[2] = tangents(contacts.normal)
    arms = (np.concatenate((contacts.point, contacts.point), axis=1)
            - position.take(both, axis=1))
    directions = np.concatenate((-axes, axes), axis=2)
    turns = (arms.take(_NEXT, axis=0) * directions.take(_AFTER, axis=1)
             - arms.take(_AFTER, axis=0) * directions.take(_NEXT, axis=1))
    frames = None
    if (scale[3] != scale[4]).any() or (scale[4] != scale[5]).any():
        frames = rotation.matrix(orientation.take(touched, axis=1))
        # what is fixed gets the axes of whoever is last, to no effect
        of_each = frames.take(np.minimum(slot, len(touched) - 1), axis=2)
        turns = (of_each[:, None] * turns.transpose(1, 0, 2)[:, :, None]).sum(axis=0)
    # one column of bodies too many takes what acts on fixed ones
    rows = np.zeros((3, count, len(touched) + 1, 6))
    size = np.concatenate((scale, np.zeros((6, 1))), axis=1).take(slot, axis=1)
    each = np.concatenate((directions, turns), axis=1) * size
    rows[:, np.arange(2 * count) % count, slot] = each.transpose(0, 2, 1)
    scaled = rows[:, :, :-1].reshape(3 * count, -1)
    return ContactRows(touched, axes, both, arms, scaled, scale.T.ravel(), frames)


def mass_scale(bodies, indices):
    """Return sqrt(M^-1) of bodies (m,): (6, m), three linear and three principal angular."""
    return np.sqrt(np.stack((*(bodies.inverse_mass[indices],) * 3,
                             *bodies.inverse_inertia[:, indices])))


def scaled_rows(axes, arm, frames, scale):
    """
    Return rows J sqrt(M^-1) of one side of contacts, (3, k, 6): contact axes, contacts, columns.

    Parameters
    ----------
    axes : (3, 3, k)
        axes[c] are the k unit vectors (3, k) of row c.
    arm : (3, k) [m]
        From the centre of the body to the point.
    frames : (3, 3, k)
        Rotation matrices of the body.
    scale : (6, k)
        Its `mass_scale`, negative for side a.

    """
    rows = np.empty((3, arm.shape[1], 6))
    rows[:, :, :3] = (axes * scale[:3]).transpose(0, 2, 1)
    # rotation.cross and transform_transposed want components first
    turn = rotation.transform_transposed(
        frames[:, :, None], rotation.cross(arm[:, None], axes.transpose(1, 0, 2)))
    rows[:, :, 3:] = (turn * scale[3:, None]).transpose(1, 2, 0)
    return rows
