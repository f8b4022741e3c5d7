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
The impact laws of Newton and Poisson, for one contact and for many.

Newton: a contact that approaches at u leaves at e u or faster (Moreau 1988).

Poisson: the impulses without rebound first, then e times each normal impulse is added, and
friction is solved anew for the total; a contact that would close in this second phase is held
open by more impulse (Glocker and Pfeiffer 1995; they rebound the friction too, here it follows
Coulomb's law for the total). It is the default: for several contacts and with friction Newton's
law can create energy, and Poisson's did not in any throw tried.
"""

import numpy as np

from rigid_sim_ros.engine.solvers import ContactProblem, solve
from rigid_sim_ros.engine.solvers.canonical import ACCURACY
from rigid_sim_ros.engine.solvers.single import solve_one

_BISECTIONS = 40
"""Halvings of the interval in which the largest share of restitution is searched."""

_ROUNDING = 1e-14
"""Growth of energy, relative to the impulse's own work, that is rounding."""


def newton_one(response, velocity, friction, restitution):
    """Return the impulse (3,) of one contact; response and velocity as for `solve_one`."""
    normal, first, second = velocity
    free = normal * (1.0 + restitution) if normal < 0.0 else normal
    return solve_one(response, (free, first, second), friction)


def poisson_one(response, velocity, friction, restitution):
    """Return the impulse (3,) of one contact; response and velocity as for `solve_one`."""
    impulse = solve_one(response, velocity, friction)
    if restitution == 0.0 or impulse[0] == 0.0:
        return impulse
    return solve_one(response, velocity, friction, (1.0 + restitution) * impulse[0])


def newton(response, velocity, friction, restitution, factor=None):
    """Return the impulses (3k,) of k contacts in contact axes; e is (k,)."""
    count = len(friction)
    free = velocity.copy()
    free[:count] += restitution * np.minimum(velocity[:count], 0.0)
    return _without_floor(factor, response, free, friction)


def poisson(response, velocity, friction, restitution, factor=None):
    """Return the impulses (3k,) of k contacts in contact axes; e is (k,)."""
    count = len(friction)
    impulse = _without_floor(factor, response, velocity, friction)
    if not restitution.any():
        return impulse
    rebound = 1 + restitution
    floor = rebound * impulse[:count]
    # where nothing slides and all rebound alike, all of the impulse grows alike
    guess = (impulse.reshape(3, count) * rebound).ravel()
    return solve(_problem(response, velocity, friction, floor), guess).force


def energy_change(response, velocity, impulse):
    """Return (change [J], scale [J]) of the kinetic energy by impulses (3k,)."""
    work = impulse @ velocity
    return work + 0.5 * (impulse @ (response @ impulse)), abs(work)


def energy_change_of_one(response, velocity, impulse):
    """Return `energy_change` for one contact, in plain floats."""
    nn, n1, n2, r11, r12, r22 = response
    n, f1, f2 = impulse
    work = n * velocity[0] + f1 * velocity[1] + f2 * velocity[2]
    return work + (0.5 * (nn * n * n + r11 * f1 * f1 + r22 * f2 * f2)
                   + n1 * n * f1 + n2 * n * f2 + r12 * f1 * f2), abs(work)


def dissipating(attempt):
    """
    Return the impulse with the largest share of restitution, 0 to 1, that adds no energy.

    `attempt(share)` returns the impulse and its `energy_change`. Without restitution an impact
    never adds energy (Moreau 1988), so there is such a share.
    """
    impulse, (change, scale) = attempt(1.0)
    if change <= _ROUNDING * scale:
        return impulse
    low, high = 0.0, 1.0
    impulse, _ = attempt(low)
    for _ in range(_BISECTIONS):
        share = 0.5 * (low + high)
        candidate, (change, scale) = attempt(share)
        if change <= _ROUNDING * scale:
            low, impulse = share, candidate
        else:
            high = share
    return impulse


def _without_floor(factor, response, free, friction):
    """Return the impulses (3k,) that solve a problem without floor."""
    impulse = sticking(factor, free, friction)
    if impulse is None:
        impulse = solve(_problem(response, free, friction, np.zeros(len(friction)))).force
    return impulse


def sticking(factor, free, friction):
    """
    Return the impulses (3k,) with which all contacts stick, or None if not all can.

    The smallest ones: where there is a choice that is the canonical one, see `solvers.canonical`.
    The response is factor @ factor.T, of more rows than columns.
    """
    if factor is None or factor.shape[0] <= factor.shape[1]:
        return None
    try:
        inverse = np.linalg.inv(factor.T @ factor)
    except np.linalg.LinAlgError:
        return None
    impulse = -(factor @ (inverse @ (inverse @ (free @ factor))))
    left = free + factor @ (impulse @ factor)
    normal, first, second = impulse.reshape(3, -1)
    limit = friction * normal
    sticks = ((normal > 0).all() and (first * first + second * second <= limit * limit).all()
              and abs(left).max() <= ACCURACY * abs(free).max())
    return impulse if sticks else None


def _problem(response, free, friction, floor):
    """Return the contact problem of an impact: no sliding direction is known."""
    return ContactProblem(response, free, friction, floor, np.zeros((2, len(friction))))
