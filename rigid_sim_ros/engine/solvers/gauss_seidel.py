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
Gauss-Seidel: contact after contact, each solved exactly with the others held.

Slow on redundant contacts but hardly ever lost: what Newton's method falls back on for a guess.
"""

from rigid_sim_ros.engine.solvers.single import solve_one


def sweeps(problem, matrix, free, force, count):
    """
    Return the force (3k,) after `count` sweeps from a guess.

    The matrix is the response with its compliance, `free` the free motion that goes with it.
    Known slip is not used: the direction is found.
    """
    contacts = problem.count
    force = force.copy()
    diagonal = matrix.reshape(3, contacts, 3, contacts)
    index = range(contacts)
    blocks = [diagonal[:, i, :, i] for i in index]
    responses = [tuple(block[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]].tolist())
                 for block in blocks]
    own = [slice(i, None, contacts) for i in index]
    friction, floor = problem.friction.tolist(), problem.floor.tolist()
    for _ in range(count):
        for i in index:
            others = free[own[i]] + matrix[own[i]] @ force - blocks[i] @ force[own[i]]
            force[own[i]] = solve_one(responses[i], others.tolist(), friction[i], floor[i])
    return force
