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
Impacts: what an instant's contact impulses do to velocities.

All contacts of a group of touching bodies are solved together, never one after the other, so that
a face landing flat stays flat. A law says what restitution means; a row of `IMPACT_LAWS` each.
Friction is Coulomb's, on impulses: a contact sticks at the end if that takes no more than the
friction coefficient times its normal impulse, and slides against all of that otherwise. Where
nothing is stated a contact's sliding is that at the end of the impact; 'stronge' follows it
through the impact, reversal included.

Balls in a row that touch each other: 'poisson' and 'newton' give what they say for all contacts
at one instant, which is not the familiar one-out-one-in. Of three equal balls, the first at speed
1, restitution 1, both laws give (-1/3, 2/3, 2/3). With gaps between them, however small, the
impacts are one after the other and give (0, 0, 1).
"""

from typing import NamedTuple

import numpy as np

from rigid_sim_ros.engine.friction import (
    mixed_friction, mixed_restitution, restitution_of_one, surfaces_of)
from rigid_sim_ros.engine.impacts import laws, stronge
from rigid_sim_ros.engine.impacts.one_contact import one_contact, separate_contacts
from rigid_sim_ros.engine.solvers import contact_rows

__all__ = ['Impact', 'IMPACT_LAWS', 'ImpactLaw', 'one_contact', 'resolve_impact', 'resolve_one',
           'separate_contacts']


class ImpactLaw(NamedTuple):
    """
    What a law gives for one contact in plain floats, and for several as arrays.

    Both take the response, the velocity across the contacts before, friction and restitution, and
    return the impulse in contact axes; see `solvers.problem` for shapes. For several the factor of
    the response may follow, `solvers.ContactRows.scaled`: it saves time.
    """

    one: callable
    many: callable


IMPACT_LAWS = {
    'poisson': ImpactLaw(laws.poisson_one, laws.poisson),
    'newton': ImpactLaw(laws.newton_one, laws.newton),
    'stronge': ImpactLaw(stronge.stronge_one, laws.newton),
}
"""Every impact law by the name it has in a scene file."""


class Impact(NamedTuple):
    """What an impact does."""

    touched: np.ndarray
    """(m,) int: the moving bodies in it, ascending."""

    linear: np.ndarray
    """(3, m) change of their linear velocity [m/s], world axes."""

    angular: np.ndarray
    """(3, m) change of their angular velocity [rad/s], world axes."""

    impulse: np.ndarray
    """(3, k) [N s] on body b of each contact, world axes."""

    speed: np.ndarray
    """(k,) approach [m/s] along the normal before, negative where they parted."""


def resolve_impact(bodies, contacts, position, orientation, linear_velocity, angular_velocity,
                   law, speed_threshold):
    """
    Return the `Impact` of contacts (one or more) at an instant.

    Poses and velocities are those of all bodies, (3, n) and (4, n), before the impact. `law` is a
    key of `IMPACT_LAWS`. Contacts that approach no faster than `speed_threshold` [m/s] do not
    rebound. Energy never grows: should a law raise it, all restitutions are lowered together
    until it does not.
    """
    if contacts.count == 1:
        motion = position, orientation, linear_velocity, angular_velocity
        return _impact_of_one(bodies, contacts, motion, law, speed_threshold)
    a, b = contacts.body_a, contacts.body_b
    rows = contact_rows(bodies, contacts, position, orientation)
    response = rows.response()
    velocity = rows.motion(linear_velocity, angular_velocity)
    speed = -velocity[:contacts.count]
    restitution = np.where(speed > speed_threshold, mixed_restitution(bodies, a, b, speed), 0.0)
    friction = mixed_friction(bodies.friction[a], bodies.friction[b])

    def attempt(share):
        impulse = IMPACT_LAWS[law].many(response, velocity, friction, share * restitution,
                                        rows.scaled)
        return impulse, laws.energy_change(response, velocity, impulse)

    impulse = laws.dissipating(attempt)
    return Impact(rows.touched, *rows.change(impulse), rows.world(impulse), speed)


def resolve_one(response, velocity, friction, surfaces, law, speed_threshold):
    """
    Return the impulse (3,) of one contact in contact axes, in plain floats.

    Arguments as for the laws of one contact; `surfaces` are `friction.surfaces_of` its bodies, the
    others as for `resolve_impact`.
    """
    speed = -velocity[0]
    restitution = restitution_of_one(surfaces, speed) if speed > speed_threshold else 0.0
    one = IMPACT_LAWS[law].one

    def attempt(share):
        impulse = one(response, velocity, friction, share * restitution)
        return impulse, laws.energy_change_of_one(response, velocity, impulse)

    return laws.dissipating(attempt)


def _impact_of_one(bodies, contacts, motion, law, speed_threshold):
    """Return the `Impact` of a single contact."""
    a, b = contacts.body_a.item(), contacts.body_b.item()
    contact = one_contact(bodies, a, b, contacts.point[:, 0].tolist(),
                          contacts.normal[:, 0].tolist(), *motion)
    impulse = resolve_one(contact.response, contact.velocity, contact.friction,
                          surfaces_of(bodies, a, b), law, speed_threshold)
    touched, linear, angular = zip(*sorted(contact.changes(impulse)))
    return Impact(np.array(touched), np.array(linear).T, np.array(angular).T,
                  np.array(contact.world(impulse))[:, None], np.array((-contact.velocity[0],)))
