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

"""A cube that tips over its lower edge: an upside-down pendulum, in elliptic functions."""

import mpmath


def tipping_angle(time, start, edge, gravity):
    """
    Return the angle [rad] of the diagonal from the vertical, at a time [s] after rest.

    The edge stays where it is. With d the half diagonal of a face and k^2 = g d / (r^2 + d^2),
    r^2 = edge^2 / 6, the angle from hanging, pi - angle, is a pendulum's of amplitude pi - start:
    sin(phi / 2) = m cd(k t, m), m = sin((pi - start) / 2) (Lawden 1989, section 5.1).
    """
    with mpmath.workdps(30):
        rate = mpmath.sqrt(_stiffness(edge, gravity))
        modulus = mpmath.sin((mpmath.pi - start) / 2)
        sine = modulus * mpmath.ellipfun('cd', rate * mpmath.mpf(time), m=modulus ** 2)
        return float(mpmath.pi - 2 * mpmath.asin(sine))


def landing_time(start, edge, gravity):
    """Return the time [s] from rest until the face is on the ground, the angle pi / 4."""
    with mpmath.workdps(30):
        modulus = mpmath.sin((mpmath.pi - start) / 2)
        ratio = mpmath.sin(3 * mpmath.pi / 8) / modulus
        # cd(u) = sn(K - u)
        quarter = mpmath.ellipk(modulus ** 2)
        rest = mpmath.ellipf(mpmath.asin(ratio), modulus ** 2)
        return float((quarter - rest) / mpmath.sqrt(_stiffness(edge, gravity)))


def _stiffness(edge, gravity):
    """Return g d / (r^2 + d^2) [1/s^2] of a solid cube about its edge."""
    edge = mpmath.mpf(edge)
    half_diagonal = edge / mpmath.sqrt(2)
    return gravity * half_diagonal / (edge ** 2 / 6 + half_diagonal ** 2)
