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

"""The motion of bodies between contacts, evaluated at any time and never stepped."""

import numpy as np

from rigid_sim_ros.engine.columns import columns_of
from rigid_sim_ros.engine.flight.driven_rotation import EqualMoments, UnequalMoments
from rigid_sim_ros.engine.flight.fixed_axis import BLOCK, FixedAxisRotations
from rigid_sim_ros.engine.flight.free_rotation import FreeRotations
from rigid_sim_ros.engine.flight.functions import ARRAYS, FLOATS
from rigid_sim_ros.engine.flight.plain_rotation import normalized
from rigid_sim_ros.engine.flight.recycled_arrays import RecycledArrays
from rigid_sim_ros.engine.flight.staying_axes import staying_axes, staying_axis
from rigid_sim_ros.engine.flight.translations import Translations

FIXED_AXIS, FREE, DRIVEN_EQUAL, DRIVEN_UNEQUAL = range(4)
"""Kinds of rotation: about an axis that stays, without torque, with it by the moments."""

FEW = 8
"""Up to so many flights are begun one by one in plain floats, which is faster (measured)."""

STILL = (0.0, 0.0, 1.0), 0.0, 0.0
"""Axis, speed and growth in the table of fixed axes of a body whose rotation is elsewhere."""


class Flights:
    """
    The motion of n bodies between contacts: every column has its own start time.

    Each body's flight is given by its state at a start time, a constant acceleration of its
    centre of mass and a constant torque, all in world axes. Poses and velocities at later times
    are evaluated from these alone, so the error does not depend on how often they are asked for.
    Before the first `begin` every body rests at the origin with the identity as orientation.

    A body belongs to one of three kinds of rotation, by moments, rates and torque: about a
    fixed axis (sine and cosine), free (theta functions) or driven (power series, stride by
    stride). A kind with no body costs nothing.
    """

    def __init__(self, inertia):
        """Make flights of n bodies with principal moments `inertia`, (3, n) [kg m^2]."""
        self._inertia = np.array(inertia, dtype=float)
        self._moments = self._inertia.T.tolist()
        count = self._inertia.shape[1]
        self._kind = np.zeros(count, dtype=np.int8)
        self._arrays = RecycledArrays()
        self._translations = Translations(count)
        self._fixed_axis = FixedAxisRotations(count)
        self._others = {FREE: FreeRotations(count),
                        DRIVEN_EQUAL: EqualMoments(count),
                        DRIVEN_UNEQUAL: UnequalMoments(count)}
        self._present = ()
        self.changes = 0
        """How often any motion was begun or held: what was evaluated before still holds if not."""

    @property
    def axes_stay(self):
        """Whether all bodies turn about axes that stay, if at all."""
        return not self._present

    @property
    def acceleration(self):
        """Accelerations of the centres of mass as begun, (3, n) [m/s^2], world axes."""
        return self._translations.acceleration

    def begin(self, indices, time, position, orientation, linear_velocity, angular_velocity,
              acceleration, torque):
        """
        Start new flights of the bodies `indices`, (k,), at `time` [s], all in world axes.

        Positions (3, k) [m], unit quaternions (4, k), velocities (3, k) [m/s], [rad/s],
        accelerations of the centre of mass (3, k) [m/s^2] and torques (3, k) [N m]; the last
        two stay constant through the flight.
        """
        self.changes += 1
        if len(indices) <= FEW:
            for index, *columns in zip(indices.tolist(), *(values.T.tolist() for values in (
                    position, orientation, linear_velocity, angular_velocity, acceleration,
                    torque))):
                self._begin_one(index, time, *columns)
            return
        self._translations.begin(indices, time, position, linear_velocity, acceleration)
        moments = self._inertia[:, indices]
        quaternion = np.stack(normalized(ARRAYS, orientation))
        axis, speed, growth, stays = staying_axes(moments, quaternion, angular_velocity, torque)
        self._fixed_axis.begin(indices, quaternion, angular_velocity, axis,
                               np.where(stays, speed, 0.0), np.where(stays, growth, 0.0))
        equal = (moments[0] == moments[1]) & (moments[0] == moments[2])
        driven = np.where(equal, DRIVEN_EQUAL, DRIVEN_UNEQUAL)
        kind = np.where(stays, FIXED_AXIS, np.where(torque.any(axis=0), driven, FREE))
        self._leave(indices, kind)
        for number, rotations in self._others.items():
            chosen = kind == number
            if chosen.any():
                rotations.begin(indices[chosen], time, moments[:, chosen], quaternion[:, chosen],
                                angular_velocity[:, chosen], torque[:, chosen])
        self._note_present()

    def hold(self, indices, time, position, orientation, linear_velocity, angular_velocity,
             acceleration):
        """
        Keep the state at `time` [s] of bodies (k,) that are not in flight, to the last bit.

        Arguments as for `begin`, indices in ascending order. What is asked for at other times
        than this is not their motion.
        """
        self.changes += 1
        columns = columns_of(indices)
        self._translations.begin(columns, time, position, linear_velocity, acceleration)
        self._fixed_axis.hold(columns, orientation, angular_velocity)
        if self._present:
            self._leave(indices, np.full(len(indices), FIXED_AXIS))
            self._note_present()

    def poses(self, time, indices=None):
        """
        Return positions (3, k) [m] and unit quaternions (4, k) at `time` [s].

        Of the bodies `indices`, (k,), or of all n; no body may start later than `time`.
        """
        count = len(self._kind) if indices is None else len(indices)
        position, orientation = self._arrays.take(3, count), self._arrays.take(4, count)
        if indices is None and count > BLOCK:
            for start in range(0, count, BLOCK):
                block = slice(start, start + BLOCK)
                self._write_poses(time, block, position[:, block], orientation[:, block])
        else:
            self._write_poses(time, indices, position, orientation)
        for rotations in self._present:
            rotations.write_orientations(time, indices, orientation)
        return position, orientation

    def poses_together(self, times):
        """
        Return positions (K, 3, n) [m] and unit quaternions (K, 4, n) of all n at times (K,) [s].

        Only while `axes_stay`. To the last bit what `poses` returns for each of the times.
        """
        count = len(self._kind)
        position = self._arrays.take(3 * len(times), count).reshape(-1, 3, count)
        orientation = self._arrays.take(4 * len(times), count).reshape(-1, 4, count)
        self._write_poses(times[:, None, None], None, position, orientation)
        return position, orientation

    def velocities(self, time, indices=None):
        """Return linear and angular velocities, (3, k) each, [m/s] and [rad/s], as `poses`."""
        elapsed = self._elapsed(time, indices)
        rate = self._fixed_axis.rates(elapsed, indices)
        if self._present:
            rate = rate.copy()
            for rotations in self._present:
                rotations.write_rates(time, indices, rate)
        return self._translations.velocities(elapsed, indices), rate

    def translation(self, time, indices=None):
        """Return positions (3, k) [m] and velocities (3, k) [m/s] only, as `poses`."""
        elapsed = self._elapsed(time, indices)
        position = np.empty((3, len(elapsed)))
        self._translations.positions(elapsed, indices, position)
        return position, self._translations.velocities(elapsed, indices)

    def motion(self, index, time):
        """
        Return the motion of one body at `time` [s] in plain floats, world axes.

        Position [m], unit quaternion, velocity [m/s] and rate [rad/s], as tuples.
        """
        return self.trajectory(index)(time)

    def fall(self, time, index):
        """Return position, velocity and acceleration of one centre of mass in plain floats."""
        table = self._translations
        position, velocity = table.trajectory(index)(time - table.start.item(index))
        return position, velocity, table.acceleration[:, index].tolist()

    def trajectory(self, index):
        """Return `motion` of one body as a function of time, until it begins another flight."""
        start = self._translations.start.item(index)
        kind = self._kind.item(index)
        move = self._translations.trajectory(index)
        fixed = kind == FIXED_AXIS
        turn = (self._fixed_axis if fixed else self._others[kind]).trajectory(index)

        def motion(time):
            position, velocity = move(time - start)
            quaternion, rate = turn(time - start if fixed else time)
            return position, quaternion, velocity, rate
        return motion

    def motions(self, indices, times):
        """
        Return the motions of bodies (k,), each at a time of its own (k,) [s], world axes.

        Positions (3, k) [m], unit quaternions (4, k), velocities (3, k) [m/s] and rates (3, k)
        [rad/s]. Bodies under torque are evaluated one by one.
        """
        elapsed = times - self._translations.start[indices]
        position = np.empty((3, len(elapsed)))
        orientation = np.empty((4, len(elapsed)))
        self._translations.positions(elapsed, indices, position)
        self._fixed_axis.orientations(elapsed, indices, orientation)
        rate = self._fixed_axis.rates(elapsed, indices)
        for rotations in self._present:
            rotations.write_motions(times, indices, orientation, rate)
        return position, orientation, self._translations.velocities(elapsed, indices), rate

    def rate_bound(self, indices, start, end):
        """
        Return upper bounds of the rate |w|, (k,) [rad/s], of bodies (k,) from `start` to `end`.

        Rigorous for the times [s] between; infinite if `end` is and the rate grows for ever.
        """
        return self._bounds(indices, start, end)[0]

    def rate_derivative_bound(self, indices, start, end):
        """Return upper bounds of |dw/dt|, (k,) [rad/s^2], in the same way as `rate_bound`."""
        return self._bounds(indices, start, end)[1]

    def bounds_of_one(self, index, start, end):
        """Return `rate_bound` and `rate_derivative_bound` of one body in plain floats."""
        kind = self._kind.item(index)
        if kind != FIXED_AXIS:
            return self._others[kind].bounds_of_one(index, start, end)
        began = self._translations.start.item(index)
        return self._fixed_axis.bounds_of_one(index, start - began, end - began)

    # -- inside --------------------------------------------------------------------------------

    def _bounds(self, indices, start, end):
        """Return bounds of |w| [rad/s] and |dw/dt| [rad/s^2], (k,) each."""
        began = self._translations.start[indices]
        rate, derivative = self._fixed_axis.bounds(indices, start - began, end - began)
        for rotations in self._present:
            rotations.write_bounds(indices, start, end, rate, derivative)
        return rate, derivative

    def _write_poses(self, time, indices, position, orientation):
        """Write poses of bodies (k,), a slice or None for all, as if all axes stayed."""
        elapsed = self._elapsed(time, indices)
        self._translations.positions(elapsed, indices, position)
        self._fixed_axis.orientations(elapsed, indices, orientation)

    def _begin_one(self, body, time, position, orientation, velocity, rate, acceleration, torque):
        """Start a flight of one body, vectors (3,) and (4,) in plain floats."""
        self._translations.begin_one(body, time, position, velocity, acceleration)
        moments = self._moments[body]
        quaternion = normalized(FLOATS, orientation)
        motion = staying_axis(moments, quaternion, rate, torque)
        if motion:
            kind = FIXED_AXIS
        elif not any(torque):
            kind = FREE
        else:
            kind = DRIVEN_EQUAL if moments[0] == moments[1] == moments[2] else DRIVEN_UNEQUAL
        self._fixed_axis.begin_one(body, quaternion, rate, motion or STILL)
        changes = kind != self._kind.item(body)
        if changes:
            self._leave([body], kind)
        if kind != FIXED_AXIS:
            self._others[kind].begin_one(body, time, moments, quaternion, rate, torque)
        if changes:
            self._note_present()

    def _leave(self, indices, kind):
        """Give bodies (k,) new kinds (k,) and take them out of the tables of their old ones."""
        changed = np.flatnonzero(self._kind[indices] != kind)
        for place in changed.tolist():
            body = int(indices[place])
            old = self._kind.item(body)
            if old != FIXED_AXIS:
                self._others[old].remove(body)
        self._kind[indices] = kind

    def _elapsed(self, time, indices):
        """Return the times [s] since the starts of bodies (k,), a slice or None for all."""
        start = self._translations.start
        return time - (start if indices is None else start[indices])

    def _note_present(self):
        """Note the kinds of rotation other than about a fixed axis that some body has."""
        self._present = tuple(
            rotations for rotations in self._others.values() if rotations.count)
