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

"""What hangs together, and what has the same label."""

import numpy as np

import pytest

from rigid_sim_ros.engine.graph import alike, component_labels


@pytest.mark.parametrize('labels', [(), (3,), (2, -1, 2, 0, -1, 2), (5, 5, 5)])
def test_what_is_alike_is_found_in_order(labels):
    """Each label once, ascending, with all the places it is at."""
    found = alike(np.array(labels, dtype=int))
    assert [label for label, _ in found] == sorted(set(labels))
    assert all(isinstance(label, int) for label, _ in found)
    for label, places in found:
        assert places.tolist() == [place for place, one in enumerate(labels) if one == label]


@pytest.mark.parametrize('seed', range(5))
def test_labels_are_the_least_of_what_hangs_together(seed):
    """As a search from each node finds it."""
    random = np.random.default_rng(seed)
    count = 30
    ends = random.integers(count, size=(2, 20))
    neighbours = {node: set() for node in range(count)}
    for one, other in ends.T.tolist():
        neighbours[one].add(other)
        neighbours[other].add(one)

    def reached(node):
        seen, ahead = {node}, [node]
        while ahead:
            more = neighbours[ahead.pop()] - seen
            seen |= more
            ahead += more
        return seen

    assert component_labels(count, *ends).tolist() == [min(reached(n)) for n in range(count)]
