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
The response of many contacts as blocks, a pair of bodies each, where a dense matrix is too large.

With two products with the Jacobian NumPy does all pairs at once. Pairs are grouped by how many
contact points they have room for. The Jacobian is scaled by M^-1/2, so that masses appear nowhere.
"""

import numpy as np

POINTS = (1, 2, 4, 8, 16, 32)
"""Contact points a block has room for: a pair goes where it fits."""

MANY_PAIRS = 500
"""Pairs from which on blocks are quicker than contacts by themselves."""


class Block:
    """
    Pairs of bodies with up to c contact points each, p pairs; rows without a contact are zero.

    Parameters
    ----------
    slots : (p, 2) int
        Of the two bodies; what does not move has the last slot of all.
    rows : (p, 3c, 12)
        J M^-1/2: c normals, c first, c second tangents; six columns for either body.
    start : int
        Where its p * c points start in flat arrays.

    """

    def __init__(self, slots, rows, start):
        """See the class."""
        pairs, count = rows.shape[0], rows.shape[1] // 3
        self.part = slice(start, start + pairs * count)
        self.shape = pairs, count
        self.slots = slots
        self.places = (6 * slots[:, :, None] + np.arange(6)).reshape(pairs, 12)
        self.flat_places = self.places.ravel()
        self.rows = np.ascontiguousarray(rows)
        self.work = np.empty((pairs, 3 * count))


class BlockRows:
    """
    The rows of a list of `Block` as one flat vector: all normals, all first, all second tangents.

    Parameters
    ----------
    blocks : list of Block
    slots : int
        Bodies that move, and one for all that do not.

    """

    def __init__(self, blocks, slots):
        """See the class."""
        self._blocks = blocks
        self.size = 6 * slots
        self.count = sum(block.shape[0] * block.shape[1] for block in blocks)

    def select(self, kept):
        """Return the rows of some contacts (k,) bool: of a pair all or none."""
        blocks, start = [], 0
        for block in self._blocks:
            pairs, count = block.shape
            of_pair = kept[block.part].reshape(pairs, count)[:, 0]
            if of_pair.any():
                blocks.append(Block(block.slots[of_pair], block.rows[of_pair], start))
                start = blocks[-1].part.stop
        return BlockRows(blocks, self.size // 6)

    def motion(self, velocity):
        """Return how all rows move, (3k,), for scaled velocities, flat (6 slots,)."""
        result = np.empty((3, self.count))
        for block in self._blocks:
            found = np.matmul(block.rows, velocity.take(block.places)[:, :, None])
            pairs, count = block.shape
            result[:, block.part].reshape(3, pairs, count)[:] = found.reshape(
                pairs, 3, count).transpose(1, 0, 2)
        return result.ravel()

    def momentum(self, force):
        """Return the scaled velocities, flat (6 slots,), that forces (3k,) make."""
        force = force.reshape(3, -1)
        result = np.zeros(self.size)
        for block in self._blocks:
            pairs, count = block.shape
            work = block.work
            work.reshape(pairs, 3, count)[:] = force[:, block.part].reshape(
                3, pairs, count).transpose(1, 0, 2)
            # a row times the matrix: a quarter quicker than the transposed one times a column
            each = np.matmul(work[:, None, :], block.rows)
            result += np.bincount(block.flat_places, each.ravel(), self.size)
        return result

    def response(self, force):
        """Return the motion (3k,) that forces (3k,) make."""
        return self.motion(self.momentum(force))
