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

"""Conserved quantities of a state: what a test or a user checks a simulation by."""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.broad_phase import candidate_pairs
from rigid_sim_ros.engine.narrow_phase import separations


def spin_momentum(bodies, orientation, angular_velocity):
    """Return the angular momenta (3, n) about the centres of mass [kg m^2/s], world axes."""
    turn = rotation.matrix(orientation)
    body_rate = rotation.transform_transposed(turn, angular_velocity)
    return rotation.transform(turn, bodies.inertia * body_rate)


def kinetic_energy(bodies, orientation, linear_velocity, angular_velocity):
    """Return the kinetic energies (n,) of the moving bodies [J]; columns are theirs alone."""
    mass = 1 / bodies.inverse_mass[:bodies.moving_count]
    body_rate = rotation.transform_transposed(rotation.matrix(orientation), angular_velocity)
    inertia = bodies.inertia[:, :bodies.moving_count]
    return 0.5 * (mass * rotation.dot(linear_velocity, linear_velocity)
                  + rotation.dot(inertia * body_rate, body_rate))


def energy(bodies, gravity, state):
    """
    Return the total kinetic and potential energy [J] of the moving bodies, a float.

    The potential is that of gravity, -m g . x, zero at the origin; held forces have none.
    """
    moving = slice(0, bodies.moving_count)
    mass = 1 / bodies.inverse_mass[moving]
    kinetic = kinetic_energy(bodies, state.orientation[:, moving],
                             state.linear_velocity[:, moving], state.angular_velocity[:, moving])
    return float(np.sum(kinetic - mass * (gravity @ state.position[:, moving])))


def momentum(bodies, state):
    """Return the sum of the momenta of the moving bodies [kg m/s], (3,), world axes."""
    moving = slice(0, bodies.moving_count)
    return state.linear_velocity[:, moving] @ (1 / bodies.inverse_mass[moving])


def angular_momentum(bodies, state):
    """Return the total angular momentum (3,) about the origin [kg m^2/s], world axes."""
    moving = slice(0, bodies.moving_count)
    orbital = rotation.cross(state.position[:, moving], state.linear_velocity[:, moving])
    spin = spin_momentum(bodies, state.orientation, state.angular_velocity)[:, moving]
    return orbital @ (1 / bodies.inverse_mass[moving]) + spin.sum(axis=1)


def penetration(bodies, state):
    """Return how deep the deepest pair of bodies overlaps [m], a float; zero if none does."""
    a, b = candidate_pairs(bodies, state.position)
    gaps = separations(bodies, a, b, state.position, state.orientation)
    return max(0.0, -float(gaps.min(initial=0.0)))
