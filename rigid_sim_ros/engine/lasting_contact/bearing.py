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
What sleeps under other forces: if its contacts hold it none the less, nothing has to wake.

Bodies that rest on each other sleep together. A force on one of them changes what the contacts
have to hold, not what they can.
"""

import numpy as np

from rigid_sim_ros.engine.lasting_contact.rest import MOST_CONTACTS, Support


class Bearing:
    """
    Some members (m,) int of an `Island` that have come to rest on contacts in its columns.

    Made for all that falls asleep, so nothing is worked out before a force changes.
    """

    def __init__(self, island, members, contacts):
        """See the class."""
        self._island = island
        self._members = members
        self._contacts = contacts
        self._support = None

    def holds(self, state):
        """
        Return whether they rest under the forces of a `State` of the whole scene, in its poses.

        Where there are very many contacts, or one with a body that sleeps elsewhere, that is not
        said.
        """
        island = self._island
        if self._support is None:
            mine = self._mine()
            if not 0 < mine.count <= MOST_CONTACTS or self._leans(mine):
                return False
            self._support = Support(island, island.gather(state), mine)
        free = island.free_motion(state)
        return self._support.holds(free, island.scales(free), self._members)

    def _mine(self):
        """Return the contacts of these members."""
        contacts = self._contacts
        return contacts.select(np.isin(contacts.body_a, self._members)
                               | np.isin(contacts.body_b, self._members))

    def _leans(self, contacts):
        """Return whether contacts are with a body that can move, and is none of these."""
        moving = self._island.world.bodies.moving_count
        either = np.concatenate((contacts.body_a, contacts.body_b))
        others = either[~np.isin(either, self._members)]
        return bool((self._island.columns[others] < moving).any())
