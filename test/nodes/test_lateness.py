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

"""How late most of many things were, against the numbers sorted."""

import numpy as np
import pytest
from rigid_sim_ros.nodes.lateness import FINEST, Lateness, STEPS


@pytest.mark.parametrize('fraction', [0.5, 0.9, 0.99, 1.0])
def test_quantile_is_that_of_the_numbers_or_one_step_more(fraction):
    values = np.random.default_rng(4).lognormal(-7.0, 2.0, 10_000)
    lateness = Lateness()
    for value in values:
        lateness.add(value)
    exact = np.sort(values)[int(np.ceil(fraction * len(values))) - 1]
    assert exact <= lateness.quantile(fraction) * (1 + 1e-12) < exact * 2 ** (1 / STEPS) + FINEST
    assert lateness.count == len(values)


def test_memory_depends_on_the_range_only():
    lateness = Lateness()
    for value in [-1.0, 0.0, *np.linspace(1e-6, 1.0, 5000)]:
        lateness.add(value)
    # a second is 2^20 times as long as what is not told apart
    assert len(lateness._counts) <= 20 * STEPS + 1
