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
Every body, every step: the semi-implicit Euler method of game engines, for comparison.

Velocities first, by the forces and by the impulses of all contacts at the start of the step, then
poses by the new velocities: first order. Impacts happen at the end of a step, and what they leave
of overlap is pushed out of positions. Nothing sleeps.
"""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.broad_phase import candidate_pairs
from rigid_sim_ros.engine.events import IMPACT
from rigid_sim_ros.engine.graph import contact_groups
from rigid_sim_ros.engine.impacts import resolve_impact
from rigid_sim_ros.engine.methods.stepping import Stepping
from rigid_sim_ros.engine.narrow_phase import find_contacts
from rigid_sim_ros.engine.solvers import contact_rows, ContactProblem, solve

TOUCH_MARGIN = 5e-3
"""
Points closer than this part of the smaller body touch. Pushing out is right to first order only:
with a smaller margin what it leaves apart is not found again, and falls through the ground.
"""

ALLOWED_OVERLAP = 1e-3
"""Overlap that is left, in parts of the smaller body, so that what rests goes on touching."""


class Stepped(Stepping):
    """Semi-implicit steps of all bodies."""

    def step(self, dt):
        """Take one step of `dt` [s]."""
        self._accelerate(dt)
        groups = self._contact_groups()
        for contacts in groups:
            self._apply_impulses(contacts, dt)
        self._move(dt)
        for contacts in self._contact_groups() if groups else ():
            self._push_out(contacts)

    def _accelerate(self, dt):
        """Add what forces, torques and the gyroscopic term do to velocities."""
        bodies, state = self._world.bodies, self.state
        turn = rotation.matrix(state.orientation)
        rate = rotation.transform_transposed(turn, state.angular_velocity)
        torque = (rotation.transform_transposed(turn, state.torque)
                  - rotation.cross(rate, bodies.inertia * rate))
        rate = rate + dt * bodies.inverse_inertia * torque
        state.linear_velocity = (
            state.linear_velocity + dt * self._world.acceleration(state.force))
        state.angular_velocity = rotation.transform(turn, rate)

    def _move(self, dt):
        """Move by the new velocities."""
        state = self.state
        state.position = state.position + dt * state.linear_velocity
        turn = rotation.from_rotation_vector(dt * state.angular_velocity)
        state.orientation = rotation.normalize(rotation.multiply(turn, state.orientation))

    def _contact_groups(self):
        """Return the contacts of these poses, a `Contacts` for each group of bodies."""
        bodies, state = self._world.bodies, self.state
        a, b = candidate_pairs(bodies, state.position)
        some_moves = (bodies.inverse_mass[a] > 0) | (bodies.inverse_mass[b] > 0)
        a, b = a[some_moves], b[some_moves]
        self._world.work.narrow_phases += len(a)
        if not len(a):
            return []
        size = np.minimum(bodies.bounding_radius[a], bodies.bounding_radius[b])
        contacts = find_contacts(bodies, a, b, state.position, state.orientation,
                                 TOUCH_MARGIN * size)
        return contact_groups(bodies, contacts)

    def _apply_impulses(self, contacts, dt):
        """Apply the impulses of one group's contacts; only what is fast rebounds."""
        world, state = self._world, self.state
        # what a body gains in two steps is no impact
        involved = np.union1d(contacts.body_a, contacts.body_b)
        gain = world.acceleration(state.force)[:, involved]
        threshold = 2 * dt * np.sqrt(rotation.dot(gain, gain).max())
        impact = resolve_impact(world.bodies, contacts, state.position, state.orientation,
                                state.linear_velocity, state.angular_velocity, world.impact_law,
                                threshold)
        state.linear_velocity[:, impact.touched] += impact.linear
        state.angular_velocity[:, impact.touched] += impact.angular
        world.work.impacts += 1
        for row in np.flatnonzero(impact.speed > threshold):
            world.events.append(
                self.time, contacts.body_a[row], contacts.body_b[row], IMPACT,
                contacts.point[:, row], contacts.normal[:, row], impact.impulse[:, row],
                impact.speed[row])

    def _push_out(self, contacts):
        """Move the bodies of one group apart by their overlap, without friction."""
        bodies, state = self._world.bodies, self.state
        size = np.minimum(*(bodies.bounding_radius[side]
                            for side in (contacts.body_a, contacts.body_b)))
        overlap = contacts.separation + ALLOWED_OVERLAP * size
        if not (overlap < 0).any():
            return
        rows = contact_rows(bodies, contacts, state.position, state.orientation)
        zeros = np.zeros(contacts.count)
        problem = ContactProblem(rows.response(), np.concatenate((overlap, zeros, zeros)), zeros,
                                 zeros, np.zeros((2, contacts.count)))
        linear, angular = rows.change(solve(problem).force)
        state.position[:, rows.touched] += linear
        turned = rotation.multiply(rotation.from_rotation_vector(angular),
                                   state.orientation[:, rows.touched])
        state.orientation[:, rows.touched] = rotation.normalize(turned)
