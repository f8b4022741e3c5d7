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
A simulation on the node's clock: integer nanoseconds, states at whole periods, commands on time.

Nothing here knows ROS or wall time, so a run is the same however fast it is driven.
"""

from math import ceil

import numpy as np

from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.model import Scene
from rigid_sim_ros.nodes.commands import Commands
from rigid_sim_ros.nodes.pacing import NANOSECONDS, PublishGrid
from rigid_sim_ros.recording.journal import (
    encode_add, encode_place, encode_remove, encode_reset, encode_until_collision)
from rigid_sim_ros.scene import dump_scene


class Session:
    """
    Drives a simulation from state to state and hands each to `publish`.

    Parameters
    ----------
    simulation : engine.Simulation
        What to drive.
    publish_rate : float
        States per second of simulated time [Hz].
    publish : callable
        Called as `publish(time, collisions)` when the simulation stands at a time [ns] that is
        to be published, with the events (dtype `events.COLLISION`) since the last one.
    time : int
        The node's simulated time [ns] at which the scene begins.

    """

    def __init__(self, simulation, publish_rate, publish, time=0):
        self.simulation = simulation
        simulation.expect_times(self._coming_times)
        self.commands = Commands(simulation)
        self.paused = False
        self.pause_on_collision = False
        self._publish = publish
        self._grid = PublishGrid(publish_rate)
        self._time = time
        self.advanced = 0
        """Time [ns] simulated so far, whatever resets have done to `time`."""
        # node time at which the simulation's own clock was zero; not zero after a reset that
        # keeps time running
        self._origin = time
        self._added = []
        self._removed = []
        self.on_bodies_changed = lambda: None
        """Called when bodies were added or removed, before the next state is published."""
        self.on_note = lambda line: None
        """Called with a line of `recording.journal` for all that is done besides commands."""
        self.on_begin = lambda lines: None
        """Called when the scene begins again, with lines that tell what bodies it has now."""

    @property
    def time(self):
        """Return the node's simulated time [ns]: the stamp of the state the simulation is in."""
        return self._time

    @property
    def next_time(self):
        """Return the next time [ns] to be published."""
        return self._grid.after(self._time)

    def set_publish_rate(self, rate):
        """Publish `rate` states per simulated second [Hz], counted from now."""
        self._grid = PublishGrid(rate, self._time)

    def publish_now(self):
        """Publish the state as it is, without simulating; for when it changed otherwise."""
        self._publish(self._time, self.simulation.collisions[:0])

    def advance(self):
        """
        Simulate to the next time on the grid and publish it.

        If `pause_on_collision`, only to the first collision on the way, and pause there.
        """
        self.advance_to(self._grid.after(self._time), self.pause_on_collision)

    def step(self, duration, stop=lambda: False):
        """
        Simulate `duration` [s], rounded to nanoseconds, and publish every state on the way.

        The last state is published too if it is not on the grid. `stop()` is asked between two
        states; if it is true the rest is left out.
        """
        end = self._time + max(1, round(duration * NANOSECONDS))
        while self._time < end and not stop():
            self.advance_to(min(self.next_time, end))

    def add(self, body):
        """Add a `model.Body` at once; raises `CommandError` if its name is taken."""
        self.simulation.add(body)
        self._added.append(body)
        self._take_bodies(_line_of_added(body))

    def remove(self, name):
        """Take a body out at once; raises `CommandError` if there is none of that name."""
        self.simulation.remove(name)
        remaining = [body for body in self._added if body.name != name]
        if len(remaining) == len(self._added):
            self._removed.append(name)
        self._added = remaining
        self._take_bodies(encode_remove(name))

    def place(self, name, position, orientation, velocity, angular_velocity):
        """Give a moving body another pose and velocity at once; raises `CommandError`."""
        self.simulation.set_pose(name, position, orientation)
        self.simulation.set_velocity(name, velocity, angular_velocity)
        self.on_note(encode_place(name, position, orientation, velocity, angular_velocity))
        self.publish_now()

    @property
    def added_names(self):
        """Return the names of the bodies that were added since the start, a tuple."""
        return tuple(body.name for body in self._added)

    def reset(self, time_from_zero, keep_bodies=False):
        """
        Begin again with the scene as loaded, and publish that; pending commands are dropped.

        Simulated time runs on, or begins at zero again. If `keep_bodies`, bodies added begin
        again as they were when added, and those removed stay away.
        """
        added, removed = self._added, self._removed
        self._added, self._removed = [], []
        self.on_note(encode_reset(time_from_zero, keep_bodies))
        self.simulation.reset()
        self.commands.clear()
        if keep_bodies:
            for name in removed:
                self.simulation.remove(name)
            for body in added:
                self.simulation.add(body)
            self._added, self._removed = added, removed
            self.commands.change_bodies()
        if time_from_zero:
            self._time = 0
        self._origin = self._time
        self.on_begin([*map(encode_remove, self._removed), *map(_line_of_added, self._added)])
        if added or removed:
            self.on_bodies_changed()
        self.publish_now()

    def advance_to(self, end, until_collision=False):
        """
        Simulate to `end` [ns], carry out what falls due before it, and publish.

        If `until_collision`, only as far as `Simulation.advance` goes then, and pause there; the
        stamp is the next whole nanosecond.
        """
        parts = []
        while True:
            self.commands.carry_out_due(self._time)
            stop = min(end, self.commands.next_time)
            collided = self._simulate_to(stop, until_collision)
            parts.append(self.simulation.collisions)
            if collided or stop == end:
                break
        if collided:
            self.paused = True
            self.on_note(encode_until_collision(end))
        collisions = parts[0] if len(parts) == 1 else np.concatenate(parts)
        if len(collisions) and self._origin:
            collisions = collisions.copy()
            collisions['time'] += self._origin / NANOSECONDS
        self._publish(self._time, collisions)

    def _take_bodies(self, line):
        self.on_note(line)
        self.commands.change_bodies()
        self.on_bodies_changed()
        self.publish_now()

    def _simulate_to(self, time, until_collision):
        """Simulate to `time` [ns], or to the first collision; tell whether there was one."""
        simulation = self.simulation
        # from the difference to the simulation's own clock, so that rounding does not add up
        target = (time - self._origin) / NANOSECONDS
        simulation.advance(max(0.0, target - simulation.time), until_collision)
        if simulation.method != 'exact':
            # that one raises errors of its own, and its poses are not evaluated for nothing
            self._check_finite(time)
        collided = until_collision and IMPACT in simulation.collisions['kind']
        if collided:
            time = min(time, self._origin + ceil(simulation.time * NANOSECONDS))
        self.advanced += time - self._time
        self._time = time
        return collided

    def _coming_times(self, count):
        """Return the simulation's own times [s] of the next `count` states to be published."""
        return [(time - self._origin) / NANOSECONDS
                for time in self._grid.following(self._time, count)]

    def _check_finite(self, time):
        """Raise FloatingPointError if a state has numbers that are none."""
        simulation = self.simulation
        for what in ('position', 'orientation', 'linear_velocity', 'angular_velocity'):
            finite = np.isfinite(getattr(simulation, what))
            if not finite.all():
                name = simulation.names[int(np.argmin(finite.all(axis=1)))]
                raise FloatingPointError(
                    f'the {what.replace("_", " ")} of {name} is no number any more at '
                    f'{time / NANOSECONDS:.9g} s; method {simulation.method!r} with max_step '
                    f'{simulation.max_step:g} s cannot follow this motion')


def _line_of_added(body):
    return encode_add(dump_scene(Scene(bodies=(body,))))
