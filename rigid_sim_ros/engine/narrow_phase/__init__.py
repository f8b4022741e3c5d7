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
Where bodies touch: contact points and signed distances of pairs of shapes.

One file a pair of shapes, one row of `table.PAIRS` each.
"""

import numpy as np

from rigid_sim_ros.engine.narrow_phase.kinematics import gap_acceleration_bias
from rigid_sim_ros.engine.narrow_phase.pair_groups import PairGroups, swap
from rigid_sim_ros.engine.narrow_phase.plain_pairs import contacts_of_one, PLAIN_TESTS
from rigid_sim_ros.engine.narrow_phase.table import PairOfShapes, PAIRS

__all__ = ['find_contacts', 'gap_acceleration_bias', 'PairGroups', 'PairOfShapes', 'PAIRS',
           'separations', 'swap']


def find_contacts(bodies, pairs_a, pairs_b, position, orientation, margin):
    """Return `PairGroups.find_contacts` of pairs, (p,) int, that are looked at only once."""
    if len(pairs_a) == 1:
        a, b = int(pairs_a[0]), int(pairs_b[0])
        # one body that lands: the commonest call, ten times faster without arrays
        if (bodies.kinds[a], bodies.kinds[b]) in PLAIN_TESTS:
            return contacts_of_one(bodies, a, b, position, orientation,
                                   float(np.ravel(margin)[0]))
    return PairGroups(bodies, pairs_a, pairs_b).find_contacts(position, orientation, margin)


def separations(bodies, pairs_a, pairs_b, position, orientation):
    """Return `PairGroups.separations` of pairs, (p,) int, that are looked at only once."""
    return PairGroups(bodies, pairs_a, pairs_b).separations(position, orientation)
