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
The conditions of one contact as equations, with their derivatives (Alart and Curnier 1991).

Each condition is 'force equals its projection on what is allowed'. In plain floats, contact after
contact: three times faster than arrays for the few contacts `newton` is meant for.
"""

from functools import lru_cache
from math import sqrt

import numpy as np


def linearise(force, motion, constants):
    """
    Return one contact's equations: 3 residuals, 5 derivatives by motion, 7 by force.

    The places they have in the matrices are those of `places`.
    """
    normal, first, second = force
    motion_n, motion_1, motion_2 = motion
    step_n, step_t, friction, floor, slip_1, slip_2 = constants
    if normal - floor > step_n * motion_n:
        head, motion_nn, force_nn = step_n * motion_n, step_n, 0.0
    else:
        head, motion_nn, force_nn = normal - floor, 0.0, 1.0
    limit, grows = (friction * normal, friction) if normal > 0.0 else (0.0, 0.0)
    if slip_1 or slip_2:
        return (head, first + limit * slip_1, second + limit * slip_2,
                motion_nn, 0.0, 0.0, 0.0, 0.0,
                force_nn, 1.0, 0.0, 0.0, 1.0, grows * slip_1, grows * slip_2)
    target_1, target_2 = first - step_t * motion_1, second - step_t * motion_2
    length = sqrt(target_1 * target_1 + target_2 * target_2)
    if length <= limit:
        return (head, step_t * motion_1, step_t * motion_2,
                motion_nn, step_t, 0.0, 0.0, step_t,
                force_nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    unit_1, unit_2 = target_1 / length, target_2 / length
    # derivative of the projection by its target: across the direction only
    turn = limit / length
    turn_11, turn_22 = turn * unit_2 * unit_2, turn * unit_1 * unit_1
    turn_12 = -turn * unit_1 * unit_2
    return (head, first - limit * unit_1, second - limit * unit_2,
            motion_nn, step_t * turn_11, step_t * turn_12, step_t * turn_12, step_t * turn_22,
            force_nn, 1.0 - turn_11, -turn_12, -turn_12, 1.0 - turn_22,
            -grows * unit_1, -grows * unit_2)


def sticking(motion, constants):
    """Return `linearise` at the floor's motion for a contact that sticks if it is closed."""
    motion_n, motion_1, motion_2 = motion
    step_n, step_t, friction, floor, slip_1, slip_2 = constants
    closes = motion_n < 0.0
    normal = (step_n * motion_n, step_n, 0.0) if closes else (0.0, 0.0, 1.0)
    head, motion_nn, force_nn = normal
    limit = friction * floor
    if not closes and floor <= 0.0:
        slip_1 = slip_2 = friction = 0.0
    elif not (slip_1 or slip_2):
        return (head, step_t * motion_1, step_t * motion_2, motion_nn, step_t, 0.0, 0.0, step_t,
                force_nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return (head, limit * slip_1, limit * slip_2, motion_nn, 0.0, 0.0, 0.0, 0.0,
            force_nn, 1.0, 0.0, 0.0, 1.0, friction * slip_1, friction * slip_2)


@lru_cache(maxsize=64)
def places(count):
    """Return where derivatives by motion (5, k) and force (7, k) go in flat (3k, 3k) matrices."""
    contact = np.arange(count)

    def place(row, column):
        return (row * count + contact) * 3 * count + column * count + contact

    tangential = [place(1, 1), place(1, 2), place(2, 1), place(2, 2)]
    return (np.array([place(0, 0), *tangential]),
            np.array([place(0, 0), *tangential, place(1, 0), place(2, 0)]))
