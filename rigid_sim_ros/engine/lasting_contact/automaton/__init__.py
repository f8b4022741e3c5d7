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
Lasting contact of one body on one plane: a hybrid automaton, of high order and in plain floats.

The rest of the engine knows bodies in world axes, as columns of arrays; here they become numbers
in the frame of the plane, and back.
"""

from math import sqrt

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.bodies import PLANE
from rigid_sim_ros.engine.contacts import Contacts, FACE_A, FACE_B, ROUND
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.friction import mixed_friction, surfaces_of
from rigid_sim_ros.engine.lasting_contact import scales as units
from rigid_sim_ros.engine.lasting_contact.automaton.automaton import Automaton
from rigid_sim_ros.engine.lasting_contact.automaton.contact_state import TOUCH
from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import dot, PlaneBody
from rigid_sim_ros.engine.lasting_contact.scales import Scales


class OnPlane:
    """
    One body, the first column of an `Island`, over one plane of its pairs.

    Parameters
    ----------
    island : Island
        Of one member.
    pair : int
        Which of the island's pairs is that of the body and the plane.

    """

    def __init__(self, island, pair):
        """See the class."""
        bodies = island.bodies
        self._island = island
        self._swapped = island.pairs.pairs_b[pair] == 0
        self._plane = int(island.pairs.pairs_a[pair] + island.pairs.pairs_b[pair])
        normal = bodies.plane_normal[:, self._plane]
        self._offset = float(bodies.plane_offset[self._plane])
        self._sunk = 0.0
        """How deep [m] it has begun in the plane, and stays."""
        self._upright = bool(normal[2] == 1.0)
        # the shortest turn of the normal to z; half a turn about x where it points down
        turn = np.array((normal[1], -normal[0], 0.0, 1.0 + normal[2]))
        if turn[3] < 1e-8:
            turn = np.array((1.0, 0.0, 0.0, 0.0))
        self._turn = turn / sqrt(turn @ turn)
        self._back = rotation.conjugate(self._turn)
        self._member = int(island.members[0])
        self._radius = bodies.bounding_radius.item(0)
        self._inverse_mass = bodies.inverse_mass.item(0)
        self._inertia = bodies.inertia[:, 0].tolist()
        self._friction = float(mixed_friction(bodies.friction[0], bodies.friction[self._plane]))
        self._resistance = (float(bodies.rolling_friction[[0, self._plane]].max()),
                            float(bodies.pivoting_friction[[0, self._plane]].max()))
        self._surfaces = surfaces_of(bodies, 0, self._plane)
        self._corners = []
        if bodies.kinds[0] != 'sphere':
            x, y, z = bodies.half_extents[:, 0].tolist()
            self._corners = [(a * x, b * y, c * z) for a in (-1, 1) for b in (-1, 1)
                             for c in (-1, 1)]
        self._constants = {}
        """What does not change about contacts, by how many there are."""
        self._automaton = None
        self._began = 0.0
        """When it did [s]."""
        self._left = None
        """The `_arrays` of the state that the last call left."""

    def advance(self, state, start, duration):
        """
        Advance by `duration` [s] from time `start` [s].

        Returns (closed contacts in columns of the island, resting) and puts the body's columns
        into the `State`; or returns None and leaves all as it was, if there are too many events.
        """
        if self._automaton is None or not self._is_left(state):
            # somebody else has moved the body or changed the forces on it
            self._automaton, self._began = self._begun(state), start
        automaton = self._automaton
        if not automaton.advance(start + duration - self._began):
            self._automaton = None
            return None
        scales = automaton.scales
        resting = automaton.resting(units.REST * scales.speed,
                                    units.EQUILIBRIUM * scales.acceleration)
        numbers = automaton.now
        if resting:
            self._automaton, numbers = None, [*numbers[:7], *[0.0] * 6]
        self._note(automaton.take_hits())
        self._put(numbers, state)
        self._left = _arrays(state)
        return self._contacts(automaton), resting

    def _begun(self, state):
        """
        Return an `Automaton` that begins in a `State`.

        If that has sunk into the plane by as little as steps of piles leave, it goes on at that
        level: nobody would pay for lifting it.
        """
        body = self._body(state)
        scales = Scales(self._radius, dot(body.acceleration, body.acceleration) ** 0.5)
        self._sunk = 0.0
        numbers = self._numbers(state)
        sunk = -min(body.gaps(numbers))
        if TOUCH < sunk / scales.length <= units.DEEP:
            self._sunk = sunk
            numbers[2] += sunk
        return Automaton(body, numbers, scales, units.STICK * scales.speed,
                         self._surfaces, self._island.world.impact_law)

    def _is_left(self, state):
        """Return whether the body's columns of a `State` are as the last call left them."""
        member = self._member
        return all(now is then or now[:, member].tolist() == then[:, member].tolist()
                   for now, then in zip(_arrays(state), self._left))

    # -- frames --------------------------------------------------------------------------------

    def _body(self, state):
        """Return the `PlaneBody` under the forces in a `State`."""
        member = self._member
        gravity = self._island.world.gravity.tolist()
        force = state.force[:, member].tolist()
        torque = state.torque[:, member].tolist()
        acceleration = [g + self._inverse_mass * f for g, f in zip(gravity, force)]
        return PlaneBody(self._corners, self._radius, self._inverse_mass, self._inertia,
                         self._to_plane(acceleration), self._to_plane(torque), self._friction,
                         *self._resistance)

    @property
    def _level(self):
        """Return how high [m] the plane is as far as the body is concerned."""
        return self._offset - self._sunk

    def _to_plane(self, vector):
        """Return a world vector (3,) in the frame of the plane, as floats."""
        return vector if self._upright else rotation.rotate(self._turn, vector).tolist()

    def _to_world(self, vector):
        """Return a vector (3,) in the frame of the plane in world axes."""
        return vector if self._upright else rotation.rotate(self._back, vector)

    def _numbers(self, state):
        """Return the state of the body as 13 floats."""
        member = self._member
        orientation = state.orientation[:, member]
        if not self._upright:
            orientation = rotation.multiply(self._turn, orientation)
        x, y, z = self._to_plane(state.position[:, member].tolist())
        return [x, y, z - self._level, *orientation.tolist(),
                *self._to_plane(state.linear_velocity[:, member].tolist()),
                *self._to_plane(state.angular_velocity[:, member].tolist())]

    def _put(self, numbers, state):
        """Put the body's 13 floats into a `State`."""
        x, y, z = numbers[:3]
        orientation = numbers[3:7]
        if not self._upright:
            orientation = rotation.multiply(self._back, orientation)
        member = self._member
        state.change('position', member, self._to_world((x, y, z + self._level)))
        state.change('orientation', member, orientation)
        state.change('linear_velocity', member, self._to_world(numbers[7:10]))
        state.change('angular_velocity', member, self._to_world(numbers[10:]))

    # -- what others want to know --------------------------------------------------------------

    def _note(self, hits):
        """Note the impacts of the automaton as events."""
        island = self._island
        work = island.world.work
        normal = -island.bodies.plane_normal[:, self._plane]
        sign = -1.0
        a, b = island.columns[0], island.columns[self._plane]
        if self._swapped:
            a, b, normal, sign = b, a, -normal, 1.0
        work.impacts += len({hit.time for hit in hits})
        for hit in hits:
            x, y, z = hit.point
            point = self._to_world((x, y, z + self._level))
            island.world.events.append(
                self._began + hit.time, a, b, IMPACT, point, normal,
                sign * np.array(self._to_world(hit.impulse)), hit.speed)

    def _contacts(self, automaton):
        """Return the closed contacts, in columns of the island."""
        body, closed, numbers = automaton.body, automaton.closed, automaton.now
        if not closed:
            return Contacts.none()
        x, y, z = numbers[:3]
        points = [self._to_world((x + a, y + b, z + c + self._level))
                  for a, b, c in body.arms(body.turn(numbers), closed)]
        count = len(closed)
        if count not in self._constants:
            self._constants[count] = self._constants_of(count)
        body_a, body_b, normal, feature, zeros = self._constants[count]
        return Contacts(body_a, body_b, np.array(points).T, normal, zeros[0] - self._sunk,
                        feature, zeros, zeros)

    def _constants_of(self, count):
        """Return the bodies, normals and features of so many contacts, and their edges: none."""
        body_a, body_b = np.zeros(count, dtype=int), np.full(count, self._plane)
        normal = np.repeat(-self._island.bodies.plane_normal[:, self._plane, None], count, axis=1)
        feature = np.full(count, FACE_B if self._corners else ROUND)
        if self._swapped:
            body_a, body_b, normal = body_b, body_a, -normal
            feature[feature == FACE_B] = FACE_A
        return body_a, body_b, normal, feature, np.zeros((3, count))


def _arrays(state):
    """Return the arrays of a `State`, forces included; nobody writes into them."""
    return (state.position, state.orientation, state.linear_velocity, state.angular_velocity,
            state.force, state.torque)


def plane_of(island, state, duration):
    """
    Return which pair of an `Island` of one is the only one that matters, or None.

    It is that of the body and a plane, if nothing else can be touched in the duration [s], and
    if nothing resists the body's spin or it is a ball.
    """
    if island.resists_spin and not _is_plain_ball(island.bodies):
        return None
    pairs = island.pairs
    count = len(pairs.pairs_a)
    pair = 0
    if count > 1:
        motion = island.gather(state)
        near = np.flatnonzero(
            pairs.separations(motion.position, motion.orientation)
            < 2 * island.reach(island.free_motion(state), motion, duration)[0])
        pair = int(near[0]) if near.size else 0
        if near.size > 1:
            return None
    if not count:
        return None
    other = pairs.pairs_a[pair] + pairs.pairs_b[pair]
    return pair if island.bodies.kinds[other] == PLANE else None


def _is_plain_ball(bodies):
    """Return whether the first body is a ball of equal moments."""
    moments = bodies.inertia[:, 0]
    return bodies.kinds[0] == 'sphere' and bool((moments == moments[0]).all())
