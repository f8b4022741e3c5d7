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

"""Impacts of one body on one plane, in plain floats where one point is hit."""

import numpy as np

from rigid_sim_ros.engine.impacts import IMPACT_LAWS, laws
from rigid_sim_ros.engine.lasting_contact.automaton.forces import (
    response_of, responses_of, rows_of, vectors_of)


def plane_impulses(body, turn, arms, velocities, restitutions, law):
    """
    Return the impulses (3,) on points with these velocities (3,), each with its restitution.

    The law is a key of `IMPACT_LAWS`. Energy never grows (see `laws.dissipating`).
    """
    if len(arms) == 1:
        response = response_of(body, turn, arms[0])
        x, y, z = velocities[0]

        def attempt(share):
            impulse = IMPACT_LAWS[law].one(response, (z, x, y), body.friction,
                                           share * restitutions[0])
            return impulse, laws.energy_change_of_one(response, (z, x, y), impulse)

        normal, first, second = laws.dissipating(attempt)
        return [(first, second, normal)]
    response, velocity = responses_of(body, turn, arms), rows_of(velocities)
    friction, restitution = np.full(len(arms), body.friction), np.array(restitutions)

    def attempt_all(share):
        impulse = IMPACT_LAWS[law].many(response, velocity, friction, share * restitution)
        return impulse, laws.energy_change(response, velocity, impulse)

    return vectors_of(laws.dissipating(attempt_all))
