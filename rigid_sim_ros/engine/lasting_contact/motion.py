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

"""The motion of an island's bodies: what a step changes, and how they move between contacts."""

from dataclasses import dataclass, replace

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.lasting_contact.turning import turned


@dataclass(frozen=True)
class Motion:
    """
    Poses and velocities of all columns of an island's own `Bodies`: those that move, then others.

    Never written into: what changes it makes a new one.
    """

    position: np.ndarray
    """(3, n) [m]."""

    orientation: np.ndarray
    """(4, n)."""

    linear: np.ndarray
    """(3, n) [m/s]; zero of what does not move."""

    angular: np.ndarray
    """(3, n) [rad/s], world axes; likewise."""

    def same(self, other):
        """Return whether this is the same motion to the last bit."""
        return (np.array_equal(self.position, other.position)
                and np.array_equal(self.linear, other.linear)
                and np.array_equal(self.orientation, other.orientation)
                and np.array_equal(self.angular, other.angular))

    def struck(self, touched, linear, angular):
        """Return the motion with changes (3, m) of the velocities of bodies `touched` (m,)."""
        after_linear, after_angular = self.linear.copy(), self.angular.copy()
        after_linear[:, touched] += linear
        after_angular[:, touched] += angular
        return Motion(self.position, self.orientation, after_linear, after_angular)

    def stopped(self, which=None):
        """Return the motion with all velocities zero, or those of the first (m,) that are True."""
        if which is None:
            zeros = np.zeros_like(self.linear)
            return Motion(self.position, self.orientation, zeros, zeros)
        linear, angular = self.linear.copy(), self.angular.copy()
        linear[:, :len(which)][:, which] = 0.0
        angular[:, :len(which)][:, which] = 0.0
        return Motion(self.position, self.orientation, linear, angular)

    def moved(self, touched, linear, angular):
        """Return the motion with bodies `touched` (m,) moved by (3, m) and turned by (3, m)."""
        position, orientation = self.position.copy(), self.orientation.copy()
        position[:, touched] += linear
        orientation[:, touched] = rotation.normalize(rotation.multiply(
            rotation.from_rotation_vector(angular), orientation[:, touched]))
        return Motion(position, orientation, self.linear, self.angular)


class FreeMotion:
    """
    What bodies do without contact under constant forces: second order, symmetric in time.

    With unequal moments the angular momentum is what the half steps carry; rates follow from it
    and the attitude, so that without contact it is kept to rounding.

    Parameters
    ----------
    bodies : Bodies
    acceleration, torque : (3, n) [m/s^2], [N m]
        Held, of all columns, world axes.

    """

    def __init__(self, bodies, acceleration, torque):
        self.acceleration = acceleration
        self.torque = torque
        moves = bodies.inverse_mass > 0
        self.mass = moves / np.where(moves, bodies.inverse_mass, 1.0)
        """(n,) [kg], zero of what does not move."""
        self._inertia = bodies.inertia
        self._inverse_inertia = bodies.inverse_inertia
        self._turns = []
        """The attitudes that were asked for last, and their rotation matrices."""
        moments = bodies.inertia[:, :bodies.moving_count]
        self._plain = bool((moments == moments[0]).all()) and not torque.any()

    def angular_acceleration(self, motion):
        """Return what torques and the gyroscopic term give, (3, n) [rad/s^2], world axes."""
        if self._plain:
            return np.zeros_like(motion.angular)
        turn = self._turn(motion.orientation)
        rate = rotation.transform_transposed(turn, motion.angular)
        torque = (rotation.transform_transposed(turn, self.torque)
                  - rotation.cross(rate, self._inertia * rate))
        return rotation.transform(turn, self._inverse_inertia * torque)

    def kinetic_energy(self, motion):
        """Return the kinetic energies (n,) [J], zero of what does not move."""
        rate = motion.angular
        if not self._plain:
            rate = rotation.transform_transposed(self._turn(motion.orientation), rate)
        return 0.5 * (self.mass * rotation.dot(motion.linear, motion.linear)
                      + rotation.dot(self._inertia * rate, rate))

    def work(self, start, end, time, rates=None):
        """
        Return what held forces and torques have done between two motions, (n,) [J].

        That of torques is to second order in the time [s]: at the mean of the rates (3, n) of
        both, which is exact if they change evenly, or at those given [rad/s].
        """
        work = self.mass * rotation.dot(self.acceleration, end.position - start.position)
        if self.torque.any():
            if rates is None:
                rates = 0.5 * (start.angular + end.angular)
            work += time * rotation.dot(self.torque, rates)
        return work

    def turned_by_torques(self, motion, time):
        """Return what the held torques alone change rates (3, n) [rad/s] by in a time [s]."""
        if not self.torque.any():
            return np.zeros_like(motion.angular)
        turn = self._turn(motion.orientation)
        return time * rotation.transform(turn, self._inverse_inertia * (
            rotation.transform_transposed(turn, self.torque)))

    def inertia_tensors(self, motion, which):
        """Return the moments (3, 3, m) [kg m^2] of bodies (m,) about their centres, world axes."""
        turn = rotation.matrix(motion.orientation[:, which])
        return (turn[:, None] * turn * self._inertia[:, which]).sum(axis=2)

    def displaced(self, motion, linear, angular):
        """
        Return a motion with its first m bodies moved by (3, m) and turned by (3, m).

        With unequal moments rates turn along, as about other axes of a body they would be of
        another energy.
        """
        count = linear.shape[1]
        moved = motion.moved(np.arange(count), linear, angular)
        if self._plain:
            return moved
        rates = motion.angular.copy()
        rates[:, :count] = rotation.transform(
            rotation.matrix(rotation.from_rotation_vector(angular)), rates[:, :count])
        return replace(moved, angular=rates)

    def kicked(self, motion, time):
        """Return the motion after forces have acted for `time` [s] and nothing has moved."""
        angular = motion.angular
        if not self._plain:
            angular = angular + time * self.angular_acceleration(motion)
        return Motion(motion.position, motion.orientation,
                      motion.linear + time * self.acceleration, angular)

    def drifted(self, start, kicked, struck, time):
        """
        Return the motion after a drift of `time` [s] and the other half of a step's forces.

        A step goes from `start` by `kicked` for half the time to `struck`, which has the impulses
        of contacts in addition; the bodies drift at the velocities of that.
        """
        position = struck.position + time * struck.linear
        orientation, angular = self.turned(start, kicked, struck, time)
        return Motion(position, orientation, struck.linear + 0.5 * time * self.acceleration,
                      angular)

    def turned(self, start, kicked, struck, time, passing=None):
        """
        Return the attitudes (4, n) and rates (3, n) at the end of a step of `time` [s].

        The angular momentum is that of `start`, what contacts gave from `kicked` to `struck`, and
        the torques'. On the way the bodies turn at the mean rates of `passing`, if it is given and
        `kicked` is after the whole of the step's forces, not half of them.
        """
        if self._plain:
            turn = rotation.from_rotation_vector(time * (passing or struck).angular)
            return (rotation.normalize(rotation.multiply(turn, start.orientation)),
                    struck.angular)
        given = start.angular + struck.angular - kicked.angular
        # less what the torques give on the way by themselves
        on_the_way = given if passing is None else (
            passing.angular - 0.5 * (kicked.angular - start.angular))
        orientation = turned(start.orientation, on_the_way, self._inertia, self._inverse_inertia,
                             self.torque, time)
        before, after = self._turn(start.orientation), self._turn(orientation)
        momentum = rotation.transform(before, self._inertia * rotation.transform_transposed(
            before, given)) + time * self.torque
        return orientation, rotation.transform(
            after, self._inverse_inertia * rotation.transform_transposed(after, momentum))

    def _turn(self, orientation):
        """Return the rotation matrices of attitudes (4, n), which nobody writes into."""
        for known, turn in self._turns:
            if known is orientation:
                return turn
        turn = rotation.matrix(orientation)
        self._turns = [(orientation, turn), *self._turns[:2]]
        return turn
