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

"""Elliptic integrals and nomes against mpmath."""

import numpy as np
import pytest
from rigid_sim_ros.engine.flight.elliptic import (
    carlson_rf, complementary_nome, nome, quarter_period)
from rigid_sim_ros.engine.flight.functions import ARRAYS, FLOATS

mpmath = pytest.importorskip('mpmath')

ARGUMENTS = [(0.0, 1.0), (0.0, 1e-3), (1.0, 1.0), (0.3, 0.9), (1e-8, 0.5), (1e-30, 1e-20),
             (0.0, 1e-200), (1e-12, 1e-12)]


@pytest.mark.parametrize('x, y', ARGUMENTS)
def test_carlson_rf(x, y):
    exact = mpmath.elliprf(x, y, 1)
    assert abs(carlson_rf(FLOATS, x, y) - exact) < 4e-16 * exact


def test_carlson_rf_of_many():
    x, y = np.array(ARGUMENTS).T
    for value, a, b in zip(carlson_rf(ARRAYS, x, y), x, y):
        exact = mpmath.elliprf(a, b, 1)
        assert abs(float(value) - exact) < 6e-16 * exact


def test_carlson_rf_of_two_zeros_ends_with_a_large_value():
    assert 300 < carlson_rf(FLOATS, 0.0, 0.0) < 400


@pytest.mark.parametrize('complementary', [0.03, 0.1, 0.5, 0.99, 1 - 1e-9, 1.0])
def test_nome_and_quarter_period(complementary):
    with mpmath.workdps(40):
        square = 1 - mpmath.mpf(complementary)
        q = nome(FLOATS, float(square), complementary)
        exact = mpmath.qfrom(m=square)
        assert abs(q - exact) <= 1e-15 * exact
        assert abs(quarter_period(q) - mpmath.ellipk(square)) < 6e-16 * quarter_period(q)


@pytest.mark.parametrize('complementary', [0.0, 1e-200, 1e-30, 1e-8, 0.001, 0.0299])
def test_complementary_nome(complementary):
    with mpmath.workdps(250):
        exact = mpmath.qfrom(m=mpmath.mpf(complementary))
        q = complementary_nome(FLOATS, float(1 - mpmath.mpf(complementary)), complementary)
        assert abs(q - exact) <= 1e-15 * exact
