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
Whether an island is at rest: slow, and in equilibrium without moving.

Being slow is not enough, for what rocks or tips is slow at its turning point. The static problem
asks what contact forces can hold: forces act for a second on bodies at rest, all contacts are
solved as an impact, and what velocity is left is the acceleration they cannot hold.
"""

import numpy as np

from rigid_sim_ros.engine.lasting_contact import scales as units
from rigid_sim_ros.engine.lasting_contact.step import second_half


def at_rest(island, free, scales, motion, contacts):
    """Return whether the island rests in this `Motion` on these touching contacts."""
    count = island.member_count
    radius = island.bodies.bounding_radius[:count]
    linear, angular = motion.linear[:, :count], motion.angular[:, :count]
    slow = units.REST * scales.speed
    if (np.abs(linear).max() > slow or (np.abs(angular) * radius).max() > slow
            or not contacts.count):
        return False
    left = second_half(island, free.kicked(motion.stopped(), 1.0), contacts)
    allowed = units.EQUILIBRIUM * scales.acceleration
    return (np.abs(left.linear[:, :count]).max() <= allowed
            and (np.abs(left.angular[:, :count]) * radius).max() <= allowed)
