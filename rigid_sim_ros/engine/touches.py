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

"""Touches at the end of flights: which points meet, their impulses, and who goes on touching."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.friction import mixed_restitution
from rigid_sim_ros.engine.graph import contact_groups
from rigid_sim_ros.engine.impacts import resolve_impact
from rigid_sim_ros.engine.narrow_phase import find_contacts

TOUCH_MARGIN = 1e-9
"""
Points closer than this part of the smaller body meet at the same instant: a face that lands flat
lands with all its corners. Instants are found some 1e-13 as well as that.
"""

STICK_SPEED = 1e-3
"""
Points that part slower than this, times the root of acceleration times size, stay in contact. The
error it makes in a motion is of its second order (the bounces left out take as long as it says).
The acceleration is the largest of any point: a spinning body comes back to what it has hit without
gravity too, and bounces as often as one that falls.
"""

ELASTIC_STICK_SPEED = 1e-5
"""The same where nothing is lost in a rebound: bounces hardly get smaller, and energy is kept."""


class Touch(NamedTuple):
    """What a touch leaves behind."""

    position: np.ndarray
    """(3, m) of the bodies given [m]; what they leave the touch with, as all that follows."""

    orientation: np.ndarray
    """(4, m)"""

    linear: np.ndarray
    """(3, m) [m/s], world axes."""

    angular: np.ndarray
    """(3, m) [rad/s], world axes."""

    stays: np.ndarray
    """(m,) bool: which go on touching something."""


def stick_speed(bodies, acceleration, angular, contacts):
    """Return the speed [m/s] below which contacts of these bodies do not part again."""
    involved = {*contacts.body_a.tolist(), *contacts.body_b.tolist()}
    involved = [index for index in involved if bodies.inverse_mass[index] > 0]
    pull, rate = acceleration[:, involved], angular[:, involved]
    radius = bodies.bounding_radius[involved]
    strongest = (np.sqrt((pull * pull).sum(axis=0)) + (rate * rate).sum(axis=0) * radius).max()
    restitution = mixed_restitution(bodies, contacts.body_a, contacts.body_b)
    stick = STICK_SPEED if restitution.min() < 1 else ELASTIC_STICK_SPEED
    return stick * sqrt(strongest * radius.max())


class Touches:
    """Resolves touches; keeps arrays of all columns, in which only those involved are filled."""

    def __init__(self, world, flights):
        self._world = world
        self._flights = flights
        count = world.bodies.count
        self._position = np.zeros((3, count))
        self._orientation = np.zeros((4, count))
        self._orientation[3] = 1.0
        self._linear = np.zeros((3, count))
        self._angular = np.zeros((3, count))

    def resolve(self, time, indices, body_a, body_b, margin=TOUCH_MARGIN):
        """
        Return the `Touch` of the moving bodies (m,) whose pairs (p,) may touch at `time` [s].

        Groups of bodies that have nothing to do with each other are solved by themselves. Impulses
        are noted as events.
        """
        self._place(time, np.array(sorted(
            {*indices.tolist(), *body_a.tolist(), *body_b.tolist()})))
        bodies = self._world.bodies
        size = np.minimum(bodies.bounding_radius[body_a], bodies.bounding_radius[body_b])
        self._world.work.narrow_phases += len(body_a)
        contacts = find_contacts(bodies, body_a, body_b, self._position, self._orientation,
                                 margin * size)
        stays = np.zeros(bodies.count, dtype=bool)
        for group in contact_groups(bodies, contacts):
            self._apply(time, group, stays)
        return Touch(self._position[:, indices], self._orientation[:, indices],
                     self._linear[:, indices], self._angular[:, indices], stays[indices])

    def _place(self, time, columns):
        """Fill in the poses and velocities of these bodies (k,)."""
        self._position[:, columns], self._orientation[:, columns] = (
            self._flights.poses(time, columns))
        self._linear[:, columns], self._angular[:, columns] = (
            self._flights.velocities(time, columns))

    def _apply(self, time, contacts, stays):
        """Apply the impulses of one group's contacts, and mark the bodies that stay together."""
        threshold = stick_speed(self._world.bodies, self._flights.acceleration, self._angular,
                                contacts)
        if self._parting_speed(contacts).min() < 0.0:
            self._strike(time, contacts, threshold)
        lasting = self._parting_speed(contacts) <= threshold
        stays[contacts.body_a[lasting]] = True
        stays[contacts.body_b[lasting]] = True

    def _strike(self, time, contacts, threshold):
        """Apply the impulses of contacts, and note those faster than a threshold [m/s]."""
        world = self._world
        impact = resolve_impact(world.bodies, contacts, self._position, self._orientation,
                                self._linear, self._angular, world.impact_law, threshold)
        self._linear[:, impact.touched] += impact.linear
        self._angular[:, impact.touched] += impact.angular
        world.work.impacts += 1
        for row in np.flatnonzero(impact.speed > threshold):
            world.events.append(
                time, contacts.body_a[row], contacts.body_b[row], IMPACT, contacts.point[:, row],
                contacts.normal[:, row], impact.impulse[:, row], impact.speed[row])

    def _parting_speed(self, contacts):
        """Return the speeds (k,) [m/s] at which contact points part along their normals."""
        a, b = contacts.body_a, contacts.body_b
        motion = [self._linear[:, body] + rotation.cross(
            self._angular[:, body], contacts.point - self._position[:, body]) for body in (a, b)]
        return rotation.dot(contacts.normal, motion[1] - motion[0])
