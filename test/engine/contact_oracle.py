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
A plain, slow, readable solver of the contact problem: the oracle of the quick ones.

It shares nothing with them but the statement of the problem. Gauss-Seidel, row by row, with the
compliance of `solvers.canonical` far larger and refined away in many passes.
"""

from math import hypot

import numpy as np


def oracle(response, free, friction, floor=None, compliance=0.05, accuracy=1e-13):
    """Return the canonical force (3k,) of a contact problem; arguments as `ContactProblem`."""
    count = len(friction)
    floor = np.zeros(count) if floor is None else floor
    diagonal = response.diagonal()
    soft = compliance * diagonal[:count].mean()
    force = np.concatenate((floor, np.zeros(2 * count)))
    scale = np.abs(free).max()
    for _ in range(2000):
        reference = force.copy()
        for _ in range(20000):
            largest = 0.0
            for i in range(count):
                normal, first, second = i, count + i, 2 * count + i

                def pull(row):
                    return (free[row] + response[row] @ force
                            + soft * (force[row] - reference[row]))

                before = force[[normal, first, second]]
                step = 1 / (diagonal[normal] + soft)
                force[normal] = max(floor[i], force[normal] - step * pull(normal))
                # one common step for both, so that the projection on the disc is the right one
                step = 1 / (diagonal[first] + diagonal[second] + 2 * soft)
                one, two = force[first] - step * pull(first), force[second] - step * pull(second)
                limit, length = friction[i] * force[normal], hypot(one, two)
                factor = limit / length if length > limit else 1.0
                force[first], force[second] = one * factor, two * factor
                change = np.abs(force[[normal, first, second]] - before).max()
                largest = max(largest, change * diagonal[normal])
            if largest <= 0.1 * accuracy * scale:
                break
        if soft * np.abs(force - reference).max() <= accuracy * scale:
            break
    return force


def violation(response, free, friction, force, floor=0.0):
    """
    Return the largest violation of the contact conditions, each stated as in a textbook.

    Forces count relative to the largest, motions relative to what such a force can do.
    """
    normal, first, second = force.reshape(3, -1)
    motion_n, motion_1, motion_2 = (free + response @ force).reshape(3, -1)
    force_scale = np.abs(force).max() or 1.0
    motion_scale = max(np.abs(free).max(), np.abs(response).max() * force_scale)
    extra, friction_force = normal - floor, np.hypot(first, second)
    sliding = np.hypot(motion_1, motion_2)
    # maximal dissipation: the friction opposes the sliding, with all it has
    shortfall = friction * normal * sliding + first * motion_1 + second * motion_2
    return max(
        -extra.min() / force_scale,
        -motion_n.min() / motion_scale,
        np.abs(extra * motion_n).max() / (force_scale * motion_scale),
        (friction_force - friction * normal).max() / force_scale,
        np.abs(shortfall).max() / (force_scale * motion_scale))
