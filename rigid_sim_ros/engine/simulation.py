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

from copy import deepcopy
from dataclasses import replace
from itertools import accumulate, repeat
from math import inf
from numbers import Real

import numpy as np

from rigid_sim_ros.engine.bodies import bodies_of, names_of
from rigid_sim_ros.engine.body_checks import check_body
from rigid_sim_ros.engine.commands import (
    column_of_moving, CommandError, duration_in_seconds, index_rows, shown, unit_quaternion,
    vector, vector_rows)
from rigid_sim_ros.engine.events import EventLog, GONE, renumbered
from rigid_sim_ros.engine.lasting_pairs import LastingPairs
from rigid_sim_ros.engine.methods import METHODS
from rigid_sim_ros.engine.model import Scene
from rigid_sim_ros.engine.readings import Readings
from rigid_sim_ros.engine.state import state_after, state_of
from rigid_sim_ros.engine.work import Work
from rigid_sim_ros.engine.world import World


class Simulation(Readings):
    """
    A scene in motion.

    Vectors are in world axes, SI units, radians; quaternions x, y, z, w, body to world. What can
    be read of it is in `Readings`. It can be copied (by `copy`) and pickled at any time: the copy
    goes its own way, and to the same end to the last bit if it is told the same.

    Parameters
    ----------
    scene : model.Scene
        What to simulate; made by `rigid_sim_ros.scene.load_scene`.
    method : str
        'exact' (default): flight as a formula, impacts at their instant, steps in lasting contact
        only. 'stepped': every body in semi-implicit steps. 'report': the student report's engine,
        which refuses spheres with a ValueError.
    max_step : float
        Longest step [s] of lasting contact, or of everything in the two methods that step.

    """

    def __init__(self, scene, method='exact', max_step=1 / 240):
        if not isinstance(scene, Scene):
            raise TypeError(f'scene is {shown(scene)}; allowed: a Scene, as load_scene returns')
        if method not in METHODS:
            raise ValueError(f'method is {method!r}; allowed: {", ".join(METHODS)}')
        if not (isinstance(max_step, Real) and 0 < max_step < inf):
            raise ValueError(f'max_step is {shown(max_step)} s; allowed: a positive number')
        self._method_name, self._max_step = method, float(max_step)
        self._start, self._duration = scene, 0.0
        self._told_times = None
        self.reset()

    def reset(self):
        """
        Go back to the start: the scene this was made of, time zero, no collisions, no work done.

        Bodies added since are gone, bodies removed are back.
        """
        self._events, self._work = EventLog(), Work()
        self._collisions = self._events.take()
        self._build(self._start, state_of(self._start), 0.0, LastingPairs())

    def __copy__(self):
        """Return a copy that goes its own way: half of one would move with this."""
        return deepcopy(self)

    # -- time ----------------------------------------------------------------------------------

    def advance(self, duration, until_collision=False):
        """
        Advance by exactly `duration` [s], zero or more; `collisions` are then those of it.

        If `until_collision`, not beyond the first impact, which is included; contact that begins
        softly, or was there, is none. Method 'exact' stops at its instant if one of the bodies was
        in flight, and at the end of the step (`max_step` at most) if both were in lasting contact;
        the others stop at the end of their step.

        ArithmeticError and numpy.linalg.LinAlgError say that a motion has outgrown the numbers it
        is computed with, as speeds of 1e30 m/s do: only `reset` helps then.
        """
        seconds = duration_in_seconds(duration)
        if seconds > 0:
            self._duration = seconds
            self._method.advance(seconds, until_collision)
        self._collisions = self._events.take()

    def expect_times(self, coming_times):
        """
        Say at which times [s] states will be read: `coming_times(count)` gives the next few.

        What is read is the same to the bit, but takes less time if the durations vary.
        """
        self._told_times = coming_times

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

        `collisions` are from now on as if it had been there all the time. Raises `CommandError` if
        the name is taken, a number is not one a body can have, or the method does not know the
        shape. What it overlaps with pushes it away.
        """
        check_body(body)
        if body.name in self._index:
            raise CommandError(f'there is already something named {shown(body.name)}')
        self._change_scene((*self._scene.bodies, body))

    def remove(self, name):
        """
        Take a body, moving or fixed, out at once; raises `CommandError` if there is none.

        Out of `collisions` too.
        """
        remaining = tuple(body for body in self._scene.bodies if body.name != name)
        if len(remaining) == len(self._scene.bodies):
            raise CommandError(f'no body is named {shown(name)}')
        self._change_scene(remaining)

    # -- inside --------------------------------------------------------------------------------

    def _build(self, scene, state, time, lasting_pairs):
        """Simulate this scene from this state and time [s] on; or raise and change nothing."""
        bodies = bodies_of(scene)
        world = World(
            bodies, np.array(scene.gravity, dtype=float), scene.impact_law, self._max_step,
            self._events, lasting_pairs, self._work, self._coming_times)
        self._method = METHODS[self._method_name](world, state, time)
        self._scene, self._world = scene, world
        self._index = {name: index for index, name in enumerate(bodies.names)}

    def _change_scene(self, bodies):
        """Go on with other bodies; those that were there before go on as they are."""
        scene = replace(self._scene, bodies=bodies)
        index = {name: number for number, name in enumerate(names_of(scene))}
        numbers = np.array([index.get(name, GONE) for name in self.all_names], dtype=int)
        try:
            self._build(scene, state_after(self._method.state, self._index, scene), self.time,
                        self._world.lasting_pairs.renumbered(numbers))
        except ValueError as error:
            raise CommandError(str(error)) from None
        self._collisions = renumbered(self._collisions, numbers)
        self._events.renumber(numbers)

    def _coming_times(self, count):
        """Return the next times [s], as told, or if the last duration is repeated, added up."""
        if self._told_times is not None:
            return self._told_times(count)
        return list(accumulate(repeat(self._duration, count), initial=self.time))[1:]

    def _set_motion(self, indices, values):
        if values and len(indices):
            self._method.set_motion(indices, **values)
