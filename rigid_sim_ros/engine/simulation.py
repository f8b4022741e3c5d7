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

"""A simulation: what users of the engine hold in their hands."""

from dataclasses import replace
from itertools import accumulate, repeat
from math import inf
from numbers import Real

import numpy as np

from rigid_sim_ros.engine import diagnostics
from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.commands import (
    column_of_moving, CommandError, index_rows, unit_quaternion, vector, vector_rows)
from rigid_sim_ros.engine.events import EventLog
from rigid_sim_ros.engine.methods import METHODS
from rigid_sim_ros.engine.model import Scene
from rigid_sim_ros.engine.state import state_after, state_of
from rigid_sim_ros.engine.work import Work
from rigid_sim_ros.engine.world import World


class Simulation:
    """
    A scene in motion.

    Vectors are in world axes, SI units, radians; quaternions x, y, z, w, body to world. Rows of
    all arrays are the moving bodies in the order of `names`. What a property returned stays as it
    was when the simulation goes on.

    Parameters
    ----------
    scene : model.Scene
        What to simulate; made by `rigid_sim_ros.scene.load_scene`.
    method : str
        'exact' (default): flight as a formula, impacts at their instant, steps in lasting contact
        only. 'stepped': every body in semi-implicit steps. 'report': the student report's engine.
    max_step : float
        Longest step [s] of lasting contact, or of everything in the two methods that step.

    """

    def __init__(self, scene, method='exact', max_step=1 / 240):
        if not isinstance(scene, Scene):
            raise TypeError(f'scene is {scene!r:.80}; allowed: a Scene, as load_scene returns')
        if method not in METHODS:
            raise ValueError(f'method is {method!r}; allowed: {", ".join(METHODS)}')
        if not 0 < max_step < inf:
            raise ValueError(f'max_step is {max_step!r} s; allowed: a positive number')
        self.method, self.max_step = method, float(max_step)
        self._start, self._duration = scene, 0.0
        self._coming_times = self._times_if_repeated
        self.reset()

    def reset(self):
        """
        Go back to the start: the scene this was made of, time zero, no collisions, no work done.

        Bodies added since are gone, bodies removed are back.
        """
        self._events, self._work = EventLog(), Work()
        self._collisions = self._events.take()
        self._build(self._start, state_of(self._start), 0.0)

    # -- time ----------------------------------------------------------------------------------

    @property
    def time(self):
        """Return how much time has been simulated since the start [s]."""
        return self._method.time

    def advance(self, duration, until_collision=False):
        """
        Advance by exactly `duration` [s], zero or more; `collisions` are then those of it.

        If `until_collision`, not beyond the first impact, which is included; contact that begins
        softly, or was there, is none. Method 'exact' stops at its instant if one of the bodies was
        in flight, and at the end of the step (`max_step` at most) if both were in lasting contact;
        the others stop at the end of their step.
        """
        if not (isinstance(duration, (float, Real)) and 0 <= duration < inf):
            raise ValueError(f'duration is {duration!r} s; allowed: a finite number, 0 or more')
        if duration > 0:
            self._duration = duration
            self._method.advance(float(duration), until_collision)
        self._collisions = self._events.take()

    def expect_times(self, coming_times):
        """
        Say at which times [s] states will be read: `coming_times(count)` gives the next few.

        What is read is the same to the bit, but takes less time if the durations vary.
        """
        self._coming_times = coming_times

    # -- what can be read ----------------------------------------------------------------------

    @property
    def names(self):
        """Return the names of the moving bodies in scene order, the order of all rows."""
        return self._world.bodies.names[:self._world.bodies.moving_count]

    @property
    def all_names(self):
        """Return `names`, then fixed bodies, then planes: what `body_a` and `body_b` index."""
        return self._world.bodies.names

    @property
    def position(self):
        """Return the centres of mass [m], (n, 3)."""
        return self._rows(self._method.state.position)

    @property
    def orientation(self):
        """Return unit quaternions x, y, z, w, body to world, (n, 4)."""
        return self._rows(self._method.state.orientation)

    @property
    def linear_velocity(self):
        """Return the velocities of the centres of mass [m/s], (n, 3), world axes."""
        return self._rows(self._method.state.linear_velocity)

    @property
    def angular_velocity(self):
        """Return the angular velocities [rad/s], (n, 3), world axes."""
        return self._rows(self._method.state.angular_velocity)

    @property
    def force(self):
        """Return the held forces besides gravity [N], (n, 3), world axes."""
        return self._rows(self._method.state.force)

    @property
    def torque(self):
        """Return the held torques [N m], (n, 3), world axes."""
        return self._rows(self._method.state.torque)

    @property
    def collisions(self):
        """Return the events of the last advance in order of time, of dtype `events.COLLISION`."""
        return self._collisions

    @property
    def asleep(self):
        """Return whether each body rests and is skipped until something wakes it, (n,) bool."""
        return self._method.asleep

    @property
    def work(self):
        """Return what has been done since the start: a `work.Work` of counters."""
        return self._work

    @property
    def scene(self):
        """Return the `model.Scene` with the bodies there are now, each as it was at the start."""
        return self._scene

    def energy(self):
        """Return the kinetic and gravitational energy [J], zero at rest at the origin."""
        return diagnostics.energy(self._world.bodies, self._world.gravity, self._method.state)

    def momentum(self):
        """Return the momentum of all moving bodies [kg m/s], (3,)."""
        return diagnostics.momentum(self._world.bodies, self._method.state)

    def angular_momentum(self):
        """Return the angular momentum (3,) of all moving bodies about the origin [kg m^2/s]."""
        return diagnostics.angular_momentum(self._world.bodies, self._method.state)

    def penetration(self):
        """Return how deep the deepest pair of bodies overlaps [m], zero if none does."""
        return diagnostics.penetration(self._world.bodies, self._method.state)

    # -- commands ------------------------------------------------------------------------------

    def apply_wrench(self, name, force=(0, 0, 0), torque=(0, 0, 0)):
        """
        Hold a force [N] and a torque [N m] on a body's centre of mass until replaced.

        Raises `CommandError` if the name is not that of a moving body or a number is not finite.
        """
        index = column_of_moving(name, self._index, self.names)
        force, torque = vector('force', force), vector('torque', torque)
        self._method.set_wrench(np.array([index]), force[:, None], torque[:, None])

    def set_velocity(self, name, linear=None, angular=None):
        """
        Set the linear [m/s] and angular [rad/s] velocity of a body at once; None leaves it.

        Raises `CommandError` as `apply_wrench` does.
        """
        index = column_of_moving(name, self._index, self.names)
        values = {}
        if linear is not None:
            values['linear_velocity'] = vector('linear velocity', linear)[:, None]
        if angular is not None:
            values['angular_velocity'] = vector('angular velocity', angular)[:, None]
        self._set_motion(np.array([index]), values)

    def set_pose(self, name, position=None, orientation=None):
        """
        Place a body at a position [m] and an orientation (x, y, z, w) at once; None leaves it.

        The quaternion is normalised. Raises `CommandError` as `apply_wrench` does, and if the
        quaternion is zero.
        """
        index = column_of_moving(name, self._index, self.names)
        values = {}
        if position is not None:
            values['position'] = vector('position', position)[:, None]
        if orientation is not None:
            values['orientation'] = unit_quaternion(orientation)[:, None]
        self._set_motion(np.array([index]), values)

    def apply_wrenches(self, forces, torques, indices=None):
        """
        Hold forces [N] and torques [N m], (n, 3), on all moving bodies until replaced.

        Or (k, 3) on those of `indices`, (k,), rows of `names`. Raises `CommandError` if a shape
        is another, an index is no row or given twice, or a number is not finite.
        """
        indices = index_rows(indices, self._world.bodies.moving_count)
        forces = vector_rows('forces', forces, len(indices))
        torques = vector_rows('torques', torques, len(indices))
        if len(indices):
            self._method.set_wrench(indices, forces.T, torques.T)

    def set_velocities(self, linear=None, angular=None, indices=None):
        """
        Set the velocities [m/s], [rad/s], (n, 3), of all moving bodies at once; None leaves them.

        Or (k, 3) of those of `indices`, as in `apply_wrenches`.
        """
        indices = index_rows(indices, self._world.bodies.moving_count)
        values = {}
        if linear is not None:
            values['linear_velocity'] = vector_rows('linear', linear, len(indices)).T
        if angular is not None:
            values['angular_velocity'] = vector_rows('angular', angular, len(indices)).T
        self._set_motion(indices, values)

    def add(self, body):
        """
        Add a `model.Body`, as it is, at once; a row is added to all arrays.

        Raises `CommandError` if the name is taken.
        """
        if body.name in self._index:
            raise CommandError(f'there is already something named {body.name!r}')
        self._change_scene((*self._scene.bodies, body))

    def remove(self, name):
        """Take a body, moving or fixed, out at once; raises `CommandError` if there is none."""
        remaining = tuple(body for body in self._scene.bodies if body.name != name)
        if len(remaining) == len(self._scene.bodies):
            raise CommandError(f'no body is named {str(name)[:80]!r}')
        self._change_scene(remaining)

    # -- inside --------------------------------------------------------------------------------

    def _build(self, scene, state, time):
        """Simulate this scene from this state and time [s] on."""
        self._scene, bodies = scene, bodies_of(scene)
        self._world = World(
            bodies, np.array(scene.gravity, dtype=float), scene.impact_law, self.max_step,
            self._events, self._work, lambda count: self._coming_times(count))
        self._method = METHODS[self.method](self._world, state, time)
        self._index = {name: index for index, name in enumerate(bodies.names)}

    def _change_scene(self, bodies):
        """Go on with other bodies; those that were there before go on as they are."""
        scene = replace(self._scene, bodies=bodies)
        self._build(scene, state_after(self._method.state, self._index, scene), self.time)

    def _times_if_repeated(self, count):
        """Return the next times [s] if the last duration is repeated, added up as it is."""
        return list(accumulate(repeat(self._duration, count), initial=self.time))[1:]

    def _rows(self, columns):
        """Return the moving bodies' columns of an array (c, n) as rows that cannot be written."""
        rows = columns[:, :self._world.bodies.moving_count].T
        rows.flags.writeable = False
        return rows

    def _set_motion(self, indices, values):
        if values and len(indices):
            self._method.set_motion(indices, **values)
