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
The method this engine is for: formulas in flight, impacts at their instant, steps in contact.

A body is in flight, in lasting contact or asleep. In flight its motion is a formula, evaluated
when it is read and searched for the first touch. At a touch the impulses of all touching points
are found together. Bodies that go on touching are stepped, island by island, until they part or
come to rest; what rests is left alone until something wakes it.
"""

import numpy as np

from rigid_sim_ros.engine.broad_phase import candidate_pairs
from rigid_sim_ros.engine.cascade import Cascade
from rigid_sim_ros.engine.columns import columns_of
from rigid_sim_ros.engine.encounters import Encounters
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.islands import Islands
from rigid_sim_ros.engine.methods.flight_state import FlightState
from rigid_sim_ros.engine.methods.read_ahead import ReadAhead
from rigid_sim_ros.engine.touches import Touches


class Exact:
    """Flight, impacts, lasting contact and sleep, each body and island in its own regime."""

    def __init__(self, world, state, time):
        self.time = time
        self._world = world
        self._force, self._torque = state.force, state.torque
        self._acceleration = world.acceleration(state.force)
        self._flights = Flights(world.bodies.inertia)
        self._touches = Touches(world, self._flights, state)
        self._cascade = Cascade(world.bodies.moving_count)
        self._encounters = Encounters(world, self._flights)
        self._islands = Islands(world, self._flights)
        self._read_ahead = ReadAhead(self._flights, world)
        self._state = None
        self._begin(np.arange(world.bodies.count), time, state)
        # who was in lasting contact goes on in it
        lasting = np.isin(np.arange(world.bodies.moving_count), world.lasting_pairs.bodies)
        self._encounters.fly(np.flatnonzero(~lasting), time)
        self._islands.add(np.flatnonzero(lasting))

    @property
    def state(self):
        """All of the state at this time, evaluated when it is first read."""
        if self._state is None:
            self._state = FlightState(self._flights, self._read_ahead, self.time, self._force,
                                      self._torque)
        return self._state

    @property
    def asleep(self):
        """Whether each moving body rests and is skipped, (n,) bool."""
        return self._islands.asleep.copy()

    # -- time ----------------------------------------------------------------------------------

    def advance(self, duration, until_collision=False):
        """
        Advance by `duration` [s]: flights from touch to touch, islands in steps.

        If `until_collision`, not beyond the first touch at which bodies come together.
        """
        end = self.time + duration
        if not self._islands.active and not self._encounters.active:
            # everything rests: what has been read of it stays true
            self.time = end
        while self.time < end:
            if self._islands.active:
                self._step_islands(self._islands.step_end(self.time, end), until_collision)
            else:
                self.time = self._fly(end, until_collision)
                self._state = None
            if until_collision and self._world.events.struck:
                return

    def _step_islands(self, end, until_collision):
        """Advance everything to `end` [s] or to the first touch before it that lasts."""
        self._gather(end)
        members = np.flatnonzero(self._islands.touching)
        flies = self._encounters.active
        end = self._fly(end, until_collision)
        changes = end <= self.time or self._step(members, end)
        self.time = end
        if flies or changes:
            self._state = None
        else:
            # its columns of members have been replaced, and nobody else moves
            self._state.time = end

    def _gather(self, end):
        """Put those that may meet a body in lasting contact before `end` [s] in with it."""
        while True:
            flying, sleeping = self._islands.reached(self.time, end, self.state,
                                                     self._encounters.involved(end))
            joining = np.concatenate((flying, self._islands.wake(sleeping)))
            if not len(joining):
                return
            # and those that may meet one of them, in turn
            self._encounters.hide(joining)
            self._islands.add(joining)

    def _fly(self, end, until_collision):
        """
        Follow the flights to `end` [s], or to a touch that lasts; return when that is.

        Or to the first at which bodies come together, if no more than that is asked for.
        """
        while (touch := self._encounters.next_touch(end)) is not None:
            if self._touch(*touch) or until_collision and self._world.events.struck:
                return touch[0]
        return end

    def _touch(self, time, body_a, body_b):
        """Resolve the touch of pairs (p,) at `time` [s]; return whether any of it lasts."""
        resolve = self._touches.resolve
        ended = self._cascade.ended(time, body_a, body_b)
        if ended is not None:
            (body_a, body_b), resolve = ended, self._touches.settle
        struck = np.array(sorted({index for index in (*body_a.tolist(), *body_b.tolist())
                                  if index < self._world.bodies.moving_count}))
        woken = self._islands.wake(struck)
        if len(woken):
            struck = np.union1d(struck, woken)
            body_a, body_b = self._with_supports(time, woken, body_a, body_b)
        touch = resolve(time, struck, body_a, body_b)
        self._flights.begin(struck, time, touch.position, touch.orientation, touch.linear,
                            touch.angular, self._acceleration[:, struck],
                            self._torque[:, struck])
        stays = touch.stays | self._islands.touching[struck]
        stay, part = struck[stays], struck[~stays]
        if len(part):
            self._encounters.fly(part, time, np.array((body_a, body_b)))
        if len(stay):
            self._encounters.hide(stay)
            self._islands.add(stay)
        return len(stay) > 0

    def _with_supports(self, time, woken, body_a, body_b):
        """Return pairs (p,) and those of bodies that woke (k,) with each other and the fixed."""
        bodies = self._world.bodies
        a, b = candidate_pairs(bodies, self._flights.translation(time)[0])
        awoke = np.zeros(bodies.count, dtype=bool)
        awoke[woken] = True
        fixed = np.arange(bodies.count) >= bodies.moving_count
        ours = (awoke[a] & (awoke[b] | fixed[b])) | (awoke[b] & fixed[a])
        pairs = np.unique(np.array((np.append(body_a, a[ours]), np.append(body_b, b[ours]))),
                          axis=1)
        return pairs[0], pairs[1]

    def _step(self, members, end):
        """
        Step these bodies (k,) to `end` [s], and see who parts and who comes to rest.

        Return whether anybody does.
        """
        state = self.state
        parting, resting = self._islands.advance(members, self.time, end, state)
        columns = columns_of(members)
        self._flights.hold(
            members, end, state.position[:, columns], state.orientation[:, columns],
            state.linear_velocity[:, columns], state.angular_velocity[:, columns],
            self._acceleration[:, columns])
        if len(parting):
            self._begin(parting, end, state)
            self._encounters.fly(parting, end)
        if len(resting):
            self._lay_down(resting, end)
        return len(parting) > 0 or len(resting) > 0

    def _lay_down(self, indices, time):
        """Bodies (k,) lie still from `time` [s] on, whatever forces act on them."""
        still = np.zeros((3, len(indices)))
        self._flights.begin(indices, time, *self._flights.poses(time, indices), still, still,
                            still, still)
        self._encounters.rest(indices, time)

    # -- commands ------------------------------------------------------------------------------

    def set_motion(self, indices, **values):
        """Give bodies (k,) new values (., k) of the quantities named, fields of `State`."""
        state = self.state
        for quantity, columns in values.items():
            state.change(quantity, indices, columns)
        if 'position' in values or 'orientation' in values:
            self._islands.displace()
        self._restart(indices)

    def set_wrench(self, indices, force, torque):
        """Hold these forces and torques (3, k) on bodies (k,)."""
        changed = ((self._force[:, indices] != force) | (self._torque[:, indices] != torque))
        changed = changed.any(axis=0)
        if not changed.any():
            return
        indices = indices[changed]
        state = self.state
        state.change('force', indices, force[:, changed])
        state.change('torque', indices, torque[:, changed])
        self._force, self._torque = state.force, state.torque
        self._acceleration = self._world.acceleration(self._force)
        self._restart(indices[~self._islands.bear(indices, state)])

    # -- inside --------------------------------------------------------------------------------

    def _begin(self, indices, time, state):
        """Begin flights of bodies (k,) at `time` [s] with the columns of a state."""
        self._flights.begin(
            indices, time, state.position[:, indices], state.orientation[:, indices],
            state.linear_velocity[:, indices], state.angular_velocity[:, indices],
            self._acceleration[:, indices], self._torque[:, indices])

    def _restart(self, indices):
        """Go on from the changed state of bodies (k,)."""
        if not len(indices):
            return
        woken = self._islands.wake(indices)
        self._encounters.hide(woken)
        indices = np.union1d(indices, woken)
        self._begin(indices, self.time, self.state)
        flying = indices[~self._islands.touching[indices]]
        if len(flying):
            self._encounters.fly(flying, self.time)
