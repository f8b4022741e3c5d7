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

from math import inf
from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.friction import surfaces_of
from rigid_sim_ros.engine.graph import contact_groups, group_numbers, lone_contacts
from rigid_sim_ros.engine.impacts import (
    one_contact, resolve_impact, resolve_one, separate_contacts)
from rigid_sim_ros.engine.narrow_phase import find_contacts
from rigid_sim_ros.engine.stick_speed import stick_speed, stick_speeds

FEW = 8
"""Up to so many bodies are placed one by one in plain floats, which is faster (measured)."""

FEW_ALONE = 3
"""The same of contacts that share no body."""

MANY = 16
"""More contacts than that are looked through for groups that only touch, all at once."""

TOUCH_MARGIN = 1e-9
"""
Points closer than this part of the smaller body meet at the same instant: a face that lands flat
lands with all its corners. Instants are found some 1e-13 as well as that.
"""

MOST_MARGIN = 0.1
"""The largest margin: an instant is a number, and in a rounding of it fast bodies go far."""


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


class Touches:
    """
    Resolves touches; keeps arrays of all columns, of which those involved are filled in.

    Parameters
    ----------
    world : World
    flights : Flights
    state : State
        Where bodies that do not move are.

    """

    def __init__(self, world, flights, state):
        """See the class."""
        self._world = world
        self._flights = flights
        self._position = state.position.copy()
        self._orientation = state.orientation.copy()
        self._linear = state.linear_velocity.copy()
        self._angular = state.angular_velocity.copy()

    def resolve(self, time, indices, body_a, body_b):
        """
        Return the `Touch` of the moving bodies (m,) whose pairs (p,) may touch at `time` [s].

        Groups of bodies that have nothing to do with each other are solved by themselves. Impulses
        are noted as events.
        """
        contacts = self._contacts(time, indices, body_a, body_b)
        return self._touch(indices, self._apply_all(time, contacts))

    def settle(self, time, indices, body_a, body_b):
        """Return the same of bodies that do not rebound."""
        contacts = self._contacts(time, indices, body_a, body_b)
        stays = np.zeros(self._world.bodies.count, dtype=bool)
        for group in contact_groups(self._world.bodies, contacts):
            self._apply(time, group, stays, slowest=inf)
        return self._touch(indices, stays)

    def _contacts(self, time, indices, body_a, body_b):
        """Fill in what moving bodies (m,) do and return the contacts of pairs (p,) at `time`."""
        self._place(time, indices)
        bodies = self._world.bodies
        size = np.minimum(bodies.bounding_radius[body_a], bodies.bounding_radius[body_b])
        margin = TOUCH_MARGIN
        contacts = self._find(body_a, body_b, margin * size)
        while not contacts.count:
            # late and fast, bodies are further apart than that at any number next to the instant
            margin *= 10.0
            if margin > MOST_MARGIN:
                raise ArithmeticError(f'bodies are too fast to tell where they touch at {time} s')
            contacts = self._find(body_a, body_b, margin * size)
        return contacts

    def _touch(self, indices, stays):
        """Return the `Touch` of moving bodies (m,) given which of all (n,) bool stay together."""
        return Touch(*(values.take(indices, axis=-1) for values in (
            self._position, self._orientation, self._linear, self._angular, stays)))

    def _find(self, body_a, body_b, margin):
        """Return the contacts of pairs (p,) with gaps below margins (p,) [m]."""
        self._world.work.narrow_phases += len(body_a)
        return find_contacts(self._world.bodies, body_a, body_b, self._position,
                             self._orientation, margin)

    def _place(self, time, indices):
        """Fill in the poses and velocities of these bodies (k,)."""
        if len(indices) <= FEW:
            for index in indices.tolist():
                (self._position[:, index], self._orientation[:, index], self._linear[:, index],
                 self._angular[:, index]) = self._flights.motion(index, time)
            return
        self._position[:, indices], self._orientation[:, indices] = (
            self._flights.poses(time, indices))
        self._linear[:, indices], self._angular[:, indices] = (
            self._flights.velocities(time, indices))

    def _apply_all(self, time, contacts):
        """Apply the impulses of all contacts; return which of all bodies (n,) stay together."""
        bodies = self._world.bodies
        stays = np.zeros(bodies.count, dtype=bool)
        lone = lone_contacts(bodies, contacts)
        if lone.all():
            self._apply_alone(time, contacts, stays)
            return stays
        if lone.any():
            self._apply_alone(time, contacts.select(lone), stays)
            contacts = contacts.select(~lone)
        if contacts.count > MANY:
            contacts = self._approaching(contacts, stays)
        for group in contact_groups(bodies, contacts):
            self._apply(time, group, stays)
        return stays

    def _approaching(self, contacts, stays):
        """
        Return the contacts of groups that have one that approaches.

        Of the others mark the bodies that stay together, as `_apply` does for each group.
        """
        bodies = self._world.bodies
        parting = self._parting_speed(contacts)
        groups = group_numbers(bodies, contacts)
        approach = np.zeros(len(groups), dtype=bool)
        approach[groups[parting < 0.0]] = True
        approach = approach[groups]
        lasting = ~approach & (parting <= stick_speeds(
            bodies, self._flights.acceleration, self._angular, contacts.body_a, contacts.body_b,
            groups))
        stays[contacts.body_a[lasting]] = stays[contacts.body_b[lasting]] = True
        return contacts.select(approach)

    def _apply_alone(self, time, contacts, stays):
        """Apply the impulses of contacts that share no body, and mark those that stay together."""
        few = contacts.count <= FEW_ALONE
        (self._apply_one_by_one if few else self._apply_together)(time, contacts, stays)

    def _apply_one_by_one(self, time, contacts, stays):
        """Apply the impulses of contacts that share no body, in plain floats."""
        world = self._world
        motion = self._position, self._orientation, self._linear, self._angular
        for a, b, point, normal in zip(
                contacts.body_a.tolist(), contacts.body_b.tolist(),
                contacts.point.T.tolist(), contacts.normal.T.tolist()):
            contact = one_contact(world.bodies, a, b, point, normal, *motion)
            threshold = stick_speed(world.bodies, self._flights.acceleration, self._angular,
                                    (a,), (b,))
            parting = contact.velocity[0]
            if parting < 0.0:
                impulse = resolve_one(contact.response, contact.velocity, contact.friction,
                                      surfaces_of(world.bodies, a, b), world.impact_law, threshold)
                world.work.impacts += 1
                if -parting > threshold:
                    world.events.append(time, a, b, IMPACT, point, normal,
                                        contact.world(impulse), -parting)
                parting = contact.parting_speed(impulse)
                for index, linear, angular in contact.changes(impulse):
                    self._linear[:, index] += linear
                    self._angular[:, index] += angular
            if parting <= threshold:
                stays[a] = stays[b] = True

    def _apply_together(self, time, contacts, stays):
        """Do the same with arrays, but for the law itself."""
        world, bodies = self._world, self._world.bodies
        contact = separate_contacts(bodies, contacts, self._position, self._orientation,
                                    self._linear, self._angular)
        threshold = stick_speeds(bodies, self._flights.acceleration, self._angular,
                                 contacts.body_a, contacts.body_b)
        impulse = np.zeros((3, contacts.count))
        speed = -contact.velocity[0]
        response, velocity = (np.array(rows).T.tolist() for rows in (
            contact.response, contact.velocity))
        struck = np.flatnonzero(speed > 0.0)
        for row in struck.tolist():
            surfaces = surfaces_of(bodies, contacts.body_a.item(row), contacts.body_b.item(row))
            impulse[:, row] = resolve_one(
                response[row], velocity[row], contact.friction.item(row), surfaces,
                world.impact_law, threshold.item(row))
        world.work.impacts += len(struck)
        for index, linear, angular in contact.changes(impulse):
            # what is fixed is listed many times, and does not change
            moves = index < bodies.moving_count
            self._linear[:, index[moves]] += np.array(linear)[:, moves]
            self._angular[:, index[moves]] += np.array(angular)[:, moves]
        self._note(time, contacts, np.array(contact.world(impulse)), speed, threshold)
        lasting = contact.parting_speed(impulse) <= threshold
        stays[contacts.body_a[lasting]] = stays[contacts.body_b[lasting]] = True

    def _apply(self, time, contacts, stays, slowest=0.0):
        """
        Apply the impulses of one group's contacts, and mark the bodies that stay together.

        What approaches no faster than `slowest` [m/s] does not rebound, whatever stays otherwise.
        """
        threshold = stick_speed(self._world.bodies, self._flights.acceleration, self._angular,
                                contacts.body_a.tolist(), contacts.body_b.tolist())
        if self._parting_speed(contacts).min() < 0.0:
            self._strike(time, contacts, threshold, max(threshold, slowest))
        lasting = self._parting_speed(contacts) <= threshold
        stays[contacts.body_a[lasting]] = True
        stays[contacts.body_b[lasting]] = True

    def _strike(self, time, contacts, threshold, slowest):
        """
        Apply the impulses of contacts, and note those faster than a threshold [m/s].

        Those no faster than `slowest` [m/s] do not rebound.
        """
        world = self._world
        impact = resolve_impact(world.bodies, contacts, self._position, self._orientation,
                                self._linear, self._angular, world.impact_law, slowest)
        self._linear[:, impact.touched] += impact.linear
        self._angular[:, impact.touched] += impact.angular
        world.work.impacts += 1
        self._note(time, contacts, impact.impulse, impact.speed, threshold)

    def _note(self, time, contacts, impulse, speed, threshold):
        """Note those of contacts (k,) with an impulse (3, k) that approached fast enough."""
        for row in np.flatnonzero(speed > threshold).tolist():
            self._world.events.append(
                time, contacts.body_a[row], contacts.body_b[row], IMPACT, contacts.point[:, row],
                contacts.normal[:, row], impulse[:, row], speed[row])

    def _parting_speed(self, contacts):
        """Return the speeds (k,) [m/s] at which contact points part along their normals."""
        a, b = contacts.body_a, contacts.body_b
        motion = [self._linear[:, body] + rotation.cross(
            self._angular[:, body], contacts.point - self._position[:, body]) for body in (a, b)]
        return rotation.dot(contacts.normal, motion[1] - motion[0])
