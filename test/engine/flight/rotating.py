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

"""Flights for tests: single bodies, exact comparison with stored results, conserved quantities."""

from fractions import Fraction
import json
from math import sqrt

import numpy as np
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.flight import Flights

from reference_rotations import DATA  # noqa: I100

CASES = json.loads(DATA.read_text())
"""Rotations to 30 digits, see `reference_rotations`."""

INPUTS = 'moments', 'quaternion', 'rate', 'torque'


def case(name):
    """Return the stored rotation of this name."""
    return next(one for one in CASES if one['name'] == name)


def cases(*words):
    """Return those whose name holds any of the words."""
    return [one for one in CASES if any(word in one['name'] for word in words)]


def flights_of(rows, copies=1):
    """Return flights begun at once at time 0 at the origin, one body a row, each so often."""
    moments, quaternion, rate, torque = (
        np.repeat(np.array([row[key] for row in rows], dtype=float).T, copies, axis=1)
        for key in INPUTS)
    count = moments.shape[1]
    zero = np.zeros((3, count))
    flights = Flights(moments)
    flights.begin(np.arange(count), 0.0, zero, quaternion, zero, rate, zero, torque)
    return flights


def angle_error(quaternion, exact):
    """Return the angle [rad] between a quaternion of floats and one of digits, exactly."""
    x, y, z, w = map(Fraction, map(float, quaternion))
    a, b, c, d = map(Fraction, exact[:4])
    vector = (w * a - x * d - y * c + z * b, w * b - y * d - z * a + x * c,
              w * c - z * d - x * b + y * a)
    scalar = w * d + x * a + y * b + z * c
    return 2 * np.arctan2(sqrt(sum(part * part for part in vector)), abs(float(scalar)))


def begin_one(flights, body, time, **given):
    """Begin a flight of one body; what is not given is zero, or the identity."""
    zero = (0.0, 0.0, 0.0)
    values = {'position': zero, 'orientation': (0.0, 0.0, 0.0, 1.0), 'linear_velocity': zero,
              'angular_velocity': zero, 'acceleration': zero, 'torque': zero, **given}
    flights.begin(np.array([body]), time, *(
        np.array(value, dtype=float)[:, None] for value in values.values()))


def poses_at_times(flights, body, times):
    """Return positions (3, K) and quaternions (4, K) of one body at times (K,)."""
    return flights.motions(np.full(len(times), body), times)[:2]


def momentum_and_energy(moments, quaternion, rate):
    """Return angular momenta (3, k), world axes, and rotational energies (k,)."""
    body_rate = rotation.rotate(rotation.conjugate(quaternion), rate)
    momentum = moments * body_rate
    return rotation.rotate(quaternion, momentum), 0.5 * (momentum * body_rate).sum(axis=0)


def random_quaternions(random, count):
    """Return unit quaternions (4, count)."""
    return rotation.normalize(random.normal(size=(4, count)))
