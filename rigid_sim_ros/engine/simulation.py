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

from difflib import get_close_matches
from math import inf

import numpy as np

from rigid_sim_ros.engine import diagnostics
from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.events import EventLog
from rigid_sim_ros.engine.methods import METHODS
from rigid_sim_ros.engine.state import state_of
from rigid_sim_ros.engine.work import Work
from rigid_sim_ros.engine.world import World


class CommandError(ValueError):
    """A command that cannot be carried out; nothing was changed. The text is one line."""


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
        if method not in METHODS:
            raise ValueError(f'method is {method!r}; allowed: {", ".join(METHODS)}')
        if not 0 < max_step < inf:
            raise ValueError(f'max_step is {max_step!r} s; allowed: a positive number')
        self.scene = scene
        self.method = method
        self.max_step = float(max_step)
        self.reset()

    def reset(self):
        """Go back to the start: the scene's state, time zero, no collisions, no work done."""
        bodies = bodies_of(self.scene)
        self._events = EventLog()
        self._world = World(bodies, np.array(self.scene.gravity, dtype=float),
                            self.scene.impact_law, self.max_step, self._events, Work())
        self._method = METHODS[self.method](self._world, state_of(self.scene), 0.0)
        self._collisions = self._events.take()
        self._index = {name: index for index, name in enumerate(bodies.names)}

    # -- time ----------------------------------------------------------------------------------

    @property
    def time(self):
        """Simulated time since the start [s]."""
        return self._method.time

    def advance(self, duration):
        """Advance by exactly `duration` [s], zero or more; `collisions` are then those of it."""
        if not 0 <= duration < inf:
            raise ValueError(f'duration is {duration!r} s; allowed: zero or a positive number')
        if duration > 0:
            self._method.advance(float(duration))
        self._collisions = self._events.take()

    # -- what can be read ----------------------------------------------------------------------

    @property
    def names(self):
        """Names of the moving bodies in scene order: the order of all rows, tuple of str."""
        return self._world.bodies.names[:self._world.bodies.moving_count]

    @property
    def all_names(self):
        """The names, then fixed bodies, then planes: what `body_a` and `body_b` index."""
        return self._world.bodies.names

    @property
    def position(self):
        """Centres of mass [m], (n, 3)."""
        return self._rows(self._method.state.position)

    @property
    def orientation(self):
        """Unit quaternions x, y, z, w, body to world, (n, 4)."""
        return self._rows(self._method.state.orientation)

    @property
    def linear_velocity(self):
        """Velocities of the centres of mass [m/s], (n, 3), world axes."""
        return self._rows(self._method.state.linear_velocity)

    @property
    def angular_velocity(self):
        """Angular velocities [rad/s], (n, 3), world axes."""
        return self._rows(self._method.state.angular_velocity)

    @property
    def force(self):
        """Held forces besides gravity [N], (n, 3), world axes."""
        return self._rows(self._method.state.force)

    @property
    def torque(self):
        """Held torques [N m], (n, 3), world axes."""
        return self._rows(self._method.state.torque)

    @property
    def collisions(self):
        """Events of the last advance in order of time: an array of dtype `events.COLLISION`."""
        return self._collisions

    @property
    def asleep(self):
        """Whether each body rests and is skipped until something wakes it, (n,) bool."""
        return self._method.asleep

    @property
    def work(self):
        """What has been done since the start: a `work.Work` of counters."""
        return self._world.work

    def energy(self):
        """Return the kinetic and gravitational energy [J], zero at rest at the origin."""
        return diagnostics.energy(self._world.bodies, self._world.gravity, self._method.state)

    def momentum(self):
        """Return the momentum (3,) of all moving bodies [kg m/s]."""
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
        index = self._moving_index(name)
        force = _vector('force', force)
        torque = _vector('torque', torque)
        self._method.set_wrench(np.array([index]), force[:, None], torque[:, None])

    def set_velocity(self, name, linear=None, angular=None):
        """
        Set the linear [m/s] and angular [rad/s] velocity of a body at once; None leaves it.

        Raises `CommandError` as `apply_wrench` does.
        """
        index = self._moving_index(name)
        values = {}
        if linear is not None:
            values['linear_velocity'] = _vector('linear velocity', linear)[:, None]
        if angular is not None:
            values['angular_velocity'] = _vector('angular velocity', angular)[:, None]
        self._set_motion(index, values)

    def set_pose(self, name, position=None, orientation=None):
        """
        Place a body at a position [m] and an orientation (x, y, z, w) at once; None leaves it.

        The quaternion is normalised. Raises `CommandError` as `apply_wrench` does, and if the
        quaternion is zero.
        """
        index = self._moving_index(name)
        values = {}
        if position is not None:
            values['position'] = _vector('position', position)[:, None]
        if orientation is not None:
            quaternion = _vector('orientation', orientation, 4)
            length = np.sqrt(quaternion @ quaternion)
            if not 0 < length < inf:
                raise CommandError(f'orientation is {orientation!r}; allowed: a quaternion '
                                   'x, y, z, w that is not zero')
            values['orientation'] = (quaternion / length)[:, None]
        self._set_motion(index, values)

    def apply_wrenches(self, forces, torques):
        """Hold forces [N] and torques [N m], (n, 3), on all moving bodies until replaced."""
        count = self._world.bodies.moving_count
        forces, torques = _rows('forces', forces, count), _rows('torques', torques, count)
        self._method.set_wrench(np.arange(count), forces.T, torques.T)

    def set_velocities(self, linear, angular):
        """Set the velocities [m/s], [rad/s], (n, 3), of all moving bodies at once."""
        count = self._world.bodies.moving_count
        linear, angular = _rows('linear', linear, count), _rows('angular', angular, count)
        self._method.set_motion(np.arange(count), linear_velocity=linear.T,
                                angular_velocity=angular.T)

    # -- inside --------------------------------------------------------------------------------

    def _rows(self, columns):
        """Return the moving bodies' columns of an array (c, n) as rows that cannot be written."""
        rows = columns[:, :self._world.bodies.moving_count].T
        rows.flags.writeable = False
        return rows

    def _set_motion(self, index, values):
        if values:
            self._method.set_motion(np.array([index]), **values)

    def _moving_index(self, name):
        """Return the column of a moving body, or raise `CommandError` with the near names."""
        index = self._index.get(name)
        if index is None:
            raise CommandError(f'no body is named {str(name)[:80]!r}{_near(name, self.names)}')
        if index >= self._world.bodies.moving_count:
            raise CommandError(f'{name!r} does not move: it is fixed or a plane')
        return index


def _near(name, names):
    """Return text that tells the names closest to a wrong one, or the first few."""
    close = get_close_matches(str(name)[:80], names, n=3)
    if close:
        return f'; near names: {", ".join(close)}'
    more = ', ...' if len(names) > 5 else ''
    return f'; names: {", ".join(names[:5])}{more}'


def _vector(what, value, size=3):
    """Return numbers as an array (size,), or raise `CommandError`."""
    return _checked(what, value, (size,))


def _rows(what, value, count):
    """Return numbers as an array (count, 3), or raise `CommandError`."""
    return _checked(what, value, (count, 3))


def _checked(what, value, shape):
    """Return finite numbers as an array of this shape, or raise `CommandError`."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise CommandError(f'{what} is {value!r:.80}; allowed: numbers, shape {shape}') from None
    if array.shape != shape:
        raise CommandError(f'{what} has the shape {array.shape}; allowed: {shape}')
    if not np.isfinite(array).all():
        raise CommandError(f'{what} is {value!r:.80}; allowed: finite numbers')
    return array
