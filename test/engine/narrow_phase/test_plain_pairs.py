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

"""Pairs tested one by one in plain floats, against the same pairs in arrays."""

from dataclasses import fields

from arrangements import bodies, random_orientations

import numpy as np

import pytest

from rigid_sim_ros.engine.contacts import Contacts, EDGES, FACE_A, FACE_B
from rigid_sim_ros.engine.narrow_phase import pair_groups, PairGroups


@pytest.fixture(name='both')
def pair_groups_of_both_kinds(monkeypatch):
    """Return all pairs of six boxes and a plane, each by itself: plain, and in arrays."""
    random = np.random.default_rng(0)
    constants = bodies(random.uniform(0.2, 1.2, (6, 3)), planes=[((0, 0, 1), 0.0)])
    pairs = list(zip(*np.triu_indices(7, 1)))
    both = []
    for few in (1, 0):
        monkeypatch.setattr(pair_groups, 'FEW', few)
        both.append([PairGroups(constants, [a], [b]) for a, b in pairs])
        for each in both[-1]:
            assert all((group.plain is None) == (few == 0) for group in each.groups)
    return both


@pytest.mark.parametrize('aligned', [False, True])
def test_plain_pairs_are_those_in_arrays(both, aligned):
    """The same contacts in the same order, and the same distances, apart and overlapping."""
    random = np.random.default_rng(1)
    features = set()
    for trial in range(30):
        position = random.uniform(-0.8, 0.8, (3, 7))
        orientation = random_orientations(random, 7)
        if aligned:
            # flush faces and parallel edges, upright or turned about z alone
            position = np.round(2 * position) / 2
            orientation[:2] = 0.0
            orientation[2] *= trial % 2
            orientation /= np.linalg.norm(orientation, axis=0)
        orientation[:, 6] = (0, 0, 0, 1)
        for plain, arrays in zip(*both):
            np.testing.assert_allclose(plain.separations(position, orientation),
                                       arrays.separations(position, orientation), atol=1e-12)
            found = plain.find_contacts(position, orientation, 0.01)
            expected = arrays.find_contacts(position, orientation, 0.01)
            assert found.count == expected.count
            for field in fields(Contacts):
                np.testing.assert_allclose(getattr(found, field.name),
                                           getattr(expected, field.name), atol=1e-12)
            features |= set(expected.feature.tolist())
    assert features == ({FACE_A, FACE_B} if aligned else {FACE_A, FACE_B, EDGES})
