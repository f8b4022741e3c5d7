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
What the bodies are commanded to do, and when: velocities at once, wrenches held until replaced.

Nothing here knows ROS: the node makes a `Command` of each message, and whoever simulates a
recording again makes them of what was recorded. A command takes effect at a simulated time, never
at a moment of wall time, so the same commands at the same simulated times give the same states to
the last bit.
"""

from dataclasses import dataclass
from heapq import heappop, heappush
from typing import Optional

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.nodes.counted_warnings import near_names, shown
from rigid_sim_ros.nodes.pacing import NANOSECONDS

LARGEST_VALUE = 1e9
"""
Largest component of a command, in SI units. Far beyond anything a rigid body does, and far enough
below the end of the number range that products of a few such numbers stay finite.
"""

LARGEST_VELOCITY = 1e6
"""
The same of velocities [m/s], [rad/s]: among bodies that spin faster a search for the next touch
looks at turn after turn, and does not end in any time.
"""


def largest(quantity):
    """Return the largest component allowed of a quantity, by the name of its field."""
    return LARGEST_VELOCITY if quantity.endswith('velocity') else LARGEST_VALUE


FARTHEST_AHEAD = 86400 * NANOSECONDS
"""How far ahead of simulated time a command may be stamped [ns]. More is wall time by mistake."""

MOST_PENDING = 100_000
"""Commands that can wait for their time."""

NEVER = 2 ** 63 - 1  # [ns], a time that does not come

WORLD_AXES, BODY_AXES = 'world', 'body'
"""The axes of the vectors in a command."""

QUANTITIES = ('force', 'torque', 'linear_velocity', 'angular_velocity')

_HELD = ('force', 'torque')


class Refused(ValueError):
    """A command that is not carried out; nothing was changed."""

    def __init__(self, kind, describe):
        """Refuse with a kind to count by, and a function that makes the text for the user."""
        super().__init__(kind)
        self.kind = kind
        self.describe = describe


@dataclass(frozen=True)
class Command:
    """What k named bodies shall do; a quantity that is None is left as it is."""

    names: tuple
    """Of the bodies, (k,)."""

    force: Optional[np.ndarray] = None
    """To hold on the centres of mass [N], (k, 3)."""

    torque: Optional[np.ndarray] = None
    """To hold [N m], (k, 3)."""

    linear_velocity: Optional[np.ndarray] = None
    """To set at once [m/s], (k, 3)."""

    angular_velocity: Optional[np.ndarray] = None
    """To set at once [rad/s], (k, 3)."""

    def given(self):
        """Return the quantities given, as a dict of name and array."""
        return {name: getattr(self, name) for name in QUANTITIES
                if getattr(self, name) is not None}


class Commands:
    """
    Carries out commands on a simulation, each when its simulated time has come.

    Attributes that may be changed between two commands: `axes`, one of `WORLD_AXES` and
    `BODY_AXES`, and `timeout`, the simulated time [s] after which a wrench gives way to what the
    scene holds on the body; zero for never.
    """

    def __init__(self, simulation):
        self._simulation = simulation
        self.axes = WORLD_AXES
        self.timeout = 0.0
        self.taken = 0
        """Commands carried out so far."""
        self.on_refused = lambda reason: None
        """Called with the `Refused` of a command that cannot be carried out when its time is."""
        self.clear()

    def clear(self):
        """Forget what is pending and who holds what: the simulation was reset."""
        self._pending = []
        self._count = 0
        self._rows = {}
        # [ns], when the scene's wrench takes the place of what is held on each body
        self._release_at = {quantity: np.zeros(0, dtype=np.int64) for quantity in _HELD}
        self.change_bodies()

    def change_bodies(self):
        """Go on with the bodies the simulation has now; what is pending stays."""
        simulation = self._simulation
        names, before = simulation.names, self._rows
        self._rows = {name: row for row, name in enumerate(names)}
        self._known = ((), None)
        moving = [body for body in simulation.scene.bodies if not body.fixed]
        self._scene_wrench = {
            quantity: np.array([getattr(body, quantity) for body in moving]).reshape(-1, 3)
            for quantity in _HELD}
        for quantity, times in self._release_at.items():
            self._release_at[quantity] = np.array(
                [times[before[n]] if n in before else NEVER for n in names], dtype=np.int64)
        self._find_next_release()

    @property
    def pending(self):
        """How many commands wait for their time."""
        return len(self._pending)

    @property
    def next_time(self):
        """Return the simulated time [ns] of the next that is to be done, or `NEVER`."""
        return min(self._pending[0][0] if self._pending else NEVER, self._next_release)

    def carry_out(self, command, now):
        """Carry out a command at `now` [ns], the simulation's time; or raise `Refused`."""
        self._check(command)
        self.carry_out_due(now)  # first, so that all has an order, which a recording can tell
        self._apply(command, now)

    def schedule(self, command, time, rank, now, then=lambda time: None):
        """
        Carry out a command when simulated time reaches `time` [ns]; or raise `Refused`.

        A time that is past is the same as `now` [ns], which is that of the simulation. When the
        command has been carried out, `then(time)` is called.
        Commands of one time are carried out in order of `rank`, and of arrival if that is equal
        too: what arrives over different topics has no order of its own.
        """
        self._check(command)
        if time > now + FARTHEST_AHEAD:
            raise Refused('too far ahead', lambda: (
                f'command stamped {time / NANOSECONDS:.6g} s refused: simulated time is '
                f'{now / NANOSECONDS:.6g} s, and stamps are simulated time (at most '
                f'{FARTHEST_AHEAD // NANOSECONDS} s ahead)'))
        if len(self._pending) >= MOST_PENDING:
            raise Refused('too many pending', lambda: (
                f'command refused: {MOST_PENDING} commands are already waiting for their time'))
        time = max(time, now)

        def action():
            self._apply(command, time)
            then(time)

        self._count += 1
        heappush(self._pending, (time, rank, self._count, action))

    def carry_out_due(self, now):
        """
        Carry out everything pending whose time is `now` [ns] or earlier.

        A command to a body that was removed while it waited is given to `on_refused`.
        """
        while self.next_time <= now:
            if not self._pending or self._next_release <= self._pending[0][0]:
                self._release()
                continue
            try:
                heappop(self._pending)[-1]()
            except Refused as reason:
                self.on_refused(reason)

    def _check(self, command):
        if not command.names:
            raise Refused('empty', lambda: 'command refused: it names no body')
        given = command.given()
        if not given:
            raise Refused('empty', lambda: (
                'command refused: it has neither wrenches nor velocities'))
        self._rows_of(command.names)
        for quantity, values in given.items():
            self._check_values(quantity, command.names, values)

    def _check_values(self, quantity, names, values):
        limit = largest(quantity)
        if np.abs(values).max() <= limit:
            return
        # NaN compares false above, so it ends here too
        finite = np.isfinite(values).all()
        bad = ~(np.abs(values) <= limit)
        row = int(np.argmax(bad.any(axis=1)))
        allowed = 'finite numbers' if not finite else f'at most {limit:g} either way'
        raise Refused('not finite' if not finite else 'too large', lambda: (
            f'command to {shown(names[row])} refused: {quantity.replace("_", " ")} is '
            f'{values[row].tolist()}; allowed: {allowed}'))

    def _rows_of(self, names):
        """Return the rows (k,) of names, or raise `Refused`; the last names are remembered."""
        if names is not self._known[0]:
            for name in names:
                if name not in self._rows:
                    raise self._unknown(name)
            if len(set(names)) < len(names):
                twice = next(name for name in names if names.count(name) > 1)
                raise Refused('named twice', lambda: (
                    f'command refused: it names {shown(twice)} more than once'))
            self._known = (names, np.array([self._rows[name] for name in names]))
        return self._known[1]

    def _unknown(self, name):
        simulation = self._simulation
        if not name:
            return Refused('unknown body', lambda: (
                'command refused: header.frame_id is empty; it names the body; '
                + near_names(name, simulation.names)))
        if name in simulation.all_names:
            return Refused('fixed body', lambda: (
                f'command to {shown(name)} refused: it is fixed and takes none'))
        return Refused('unknown body', lambda: (
            f'command refused: no body is named {shown(name)}; '
            + near_names(name, simulation.names)))

    def _apply(self, command, now):
        rows = self._rows_of(command.names)
        self.taken += 1
        given = command.given()
        if self.axes == BODY_AXES:
            turn = self._simulation.orientation[rows].T
            given = {name: rotation.rotate(turn, values.T).T for name, values in given.items()}
        linear, angular = given.get('linear_velocity'), given.get('angular_velocity')
        if linear is not None or angular is not None:
            self._simulation.set_velocities(linear, angular, rows)
        held = {name: given[name] for name in _HELD if name in given}
        if held:
            self._hold(rows, held)
            if self.timeout > 0 or self._next_release < NEVER:
                self._set_release(rows, held, now)

    def _set_release(self, rows, quantities, now):
        """Let what is held from `now` [ns] on end in time; the times set before are void."""
        time = now + round(self.timeout * NANOSECONDS) if self.timeout > 0 else NEVER
        for quantity in quantities:
            self._release_at[quantity][rows] = time
        self._find_next_release()

    def _find_next_release(self):
        self._next_release = min(
            int(times.min(initial=NEVER)) for times in self._release_at.values())

    def _release(self):
        """Hold again what the scene holds, where the next release is."""
        for quantity, times in self._release_at.items():
            rows = np.flatnonzero(times == self._next_release)
            times[rows] = NEVER
            if len(rows):
                self._hold(rows, {quantity: self._scene_wrench[quantity][rows]})
        self._find_next_release()

    def _hold(self, rows, held):
        """Replace the quantities given, force and torque or one of them, on the rows."""
        simulation = self._simulation
        values = {name: held.get(name, getattr(simulation, name)[rows]) for name in _HELD}
        simulation.apply_wrenches(values['force'], values['torque'], rows)


def body_command(name, **quantities):
    """Return the `Command` to one body, with vectors (3,) of `QUANTITIES`."""
    return Command((name,), **{quantity: np.asarray(vector, dtype=float).reshape(1, 3)
                               for quantity, vector in quantities.items()})
