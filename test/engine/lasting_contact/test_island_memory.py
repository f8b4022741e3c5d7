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

"""What islands remember when they are found anew."""

from types import SimpleNamespace

import numpy as np
from rigid_sim_ros.engine.lasting_contact.near import memory_of


def test_islands_take_over_the_impulses_of_their_own_pairs_only():
    first = SimpleNamespace(
        impulses={'first': ([(0, 5), (0, 5), (1, 0)], np.arange(9.0).reshape(3, 3))})
    second = SimpleNamespace(impulses={'first': ([(2, 5)], np.full((3, 1), 7.0))})
    islands = [first, second]
    # found anew many times, each made of both: memory that all took over would double each time
    for _ in range(40):
        islands = [SimpleNamespace(impulses=memory_of(islands, *np.array(pairs).T))
                   for pairs in ([(0, 5), (0, 1)], [(2, 5)])]
    pairs, world = islands[0].impulses['first']
    assert pairs == [(0, 5), (0, 5), (1, 0)]
    np.testing.assert_array_equal(world, np.arange(9.0).reshape(3, 3))
    pairs, world = islands[1].impulses['first']
    assert pairs == [(2, 5)]
    np.testing.assert_array_equal(world, np.full((3, 1), 7.0))
