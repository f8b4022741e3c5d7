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

"""The attitude in exact arithmetic, against elliptic functions and another integrator."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from rigid_sim_ros.benchmark.references.rotation import attitudes
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

INERTIA = (13.0, 10.0, 5.0)


def elliptic_rates(time, inertia, rate):
    """
    Return the body rates of a free body by Jacobi's functions, for falling moments and w2 = 0.

    Landau and Lifshitz, Mechanics, section 37 (37.8 to 37.11), with the axes in reverse order.
    """
    i1, i2, i3 = map(mpmath.mpf, inertia)
    w1, _, w3 = map(mpmath.mpf, rate)
    energy, momentum = i1 * w1 ** 2 + i3 * w3 ** 2, (i1 * w1) ** 2 + (i3 * w3) ** 2
    assert momentum > energy * i2
    speed = mpmath.sqrt((i1 - i2) * (momentum - energy * i3) / (i1 * i2 * i3))
    modulus = (i2 - i3) * (energy * i1 - momentum) / ((i1 - i2) * (momentum - energy * i3))
    sn, cn, dn = (mpmath.ellipfun(name, speed * time, m=modulus) for name in ('sn', 'cn', 'dn'))
    amplitude = mpmath.sqrt((energy * i1 - momentum) / (i2 * (i1 - i2)))
    # I2 w2' = (I3 - I1) w3 w1
    return [w1 * dn, -mpmath.sign(w1 * w3) * amplitude * sn, w3 * cn]


def test_angular_momentum_stays_where_elliptic_functions_say():
    rate, times = (4.0, 0.0, 1.5), (0.5, 2.0, 4.0)
    for time, orientation in zip(times, attitudes(INERTIA, rate, times)):
        with mpmath.workdps(30):
            body = np.array(elliptic_rates(time, INERTIA, rate), dtype=float)
        momentum = Rotation.from_quat(orientation).apply(np.array(INERTIA) * body)
        np.testing.assert_allclose(momentum, np.array(INERTIA) * rate, atol=1e-13 * 60)


@pytest.mark.parametrize('torque', [(0.0, 0.0, 0.0), (0.5, -0.25, 0.75)])
def test_attitude_is_that_of_another_integrator(torque):
    inertia, rate = np.array(INERTIA), np.array([1.0, 1.5, 0.5])

    def derivative(time, state):
        attitude = Rotation.from_quat(state[:4])
        momentum = inertia * rate + np.array(torque) * time
        x, y, z = attitude.apply(momentum, inverse=True) / inertia
        a, b, c, w = state[:4]
        return 0.5 * np.array([w * x + b * z - c * y, w * y + c * x - a * z,
                               w * z + a * y - b * x, -a * x - b * y - c * z])

    solved = solve_ivp(derivative, (0, 5), [0, 0, 0, 1.0], method='DOP853', rtol=1e-12, atol=1e-12)
    expected = Rotation.from_quat(solved.y[:, -1])
    actual = Rotation.from_quat(attitudes(INERTIA, tuple(rate), (5.0,), torque)[0])
    # the other integrator's own error
    assert (expected.inv() * actual).magnitude() < 1e-10


def test_a_cube_turns_about_its_spin():
    spin = (1.0, 2.0, -2.0)
    x, y, z, w = attitudes((0.5, 0.5, 0.5), spin, (3.0,))[0]
    half = 3.0 * 3.0 / 2
    expected = [*(np.array(spin) / 3.0 * np.sin(half)), np.cos(half)]
    np.testing.assert_allclose((x, y, z, w), expected, atol=1e-15)


def test_torque_along_the_spin_gives_the_parabola_of_angles():
    z, w = attitudes((2.0, 2.0, 2.0), (0.0, 0.0, 1.0), (4.0,), (0.0, 0.0, 3.0))[0][2:]
    angle = 1.0 * 4.0 + 1.5 * 4.0 ** 2 / 2
    assert (z, w) == pytest.approx((np.sin(angle / 2), np.cos(angle / 2)), abs=1e-15)


def test_it_does_not_matter_where_the_motion_is_cut():
    near_middle = (5e-9, 5.0, 5e-9)
    at_once = attitudes(INERTIA, near_middle, (6.0,))
    in_parts = attitudes(INERTIA, near_middle, tuple(Fraction(k, 7) * 6 for k in range(1, 8)))
    np.testing.assert_allclose(in_parts[-1], at_once[0], atol=1e-16)
