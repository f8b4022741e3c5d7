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
Pairs of spheres that overlap, by a grid of cells as wide as the spheres.

Few spheres are compared all with all. Many are sorted by the number of their cell, and whole rows
of three neighbouring cells are found at once by binary search (a hash grid, Teschner et al. 2003,
with sorted numbers in the place of the hash table). Spheres of very different sizes have a grid
for each size, in which those of the size look for all that are not larger.
"""

from functools import lru_cache

import numpy as np

BRUTE_FORCE_PAIRS = 2048
"""Up to so many pairs all are compared: faster than a grid (measured)."""

SIZE_CLASS = 4.0
"""Radii within this factor of each other share a grid."""

_CELLS_PER_AXIS = 2 ** 20
_WIDER = 1 + 1e-9
"""Cells are wider than the spheres by far more than rounding can move one across a border."""

# rows of three cells along x, as steps in (y, z): all neighbours, and the later half of them
_ALL_ROWS = np.array([(y, z) for z in (-1, 0, 1) for y in (-1, 0, 1)])
_LATER_ROWS = np.array([(0, 0), (1, 0), (-1, 1), (0, 1), (1, 1)])


def spheres_with_spheres(center, radius):
    """Return all pairs a < b, (p,) int each, of spheres (3, n), (n,) [m] that overlap."""
    count = len(radius)
    if count * (count - 1) // 2 <= BRUTE_FORCE_PAIRS:
        return _overlapping(center, radius, center, radius, *_all_pairs(count))
    found = []
    size_class = _size_classes(radius)
    for size in np.unique(size_class).tolist():
        same = np.flatnonzero(size_class == size)
        smaller = np.flatnonzero(size_class < size)
        cell = 2 * radius[same].max()
        one, other = _neighbours_within(center[:, same], cell)
        found.append((same[one], same[other]))
        if len(smaller):
            one, other = _neighbours_between(center[:, same], center[:, smaller], cell)
            found.append((same[one], smaller[other]))
    a, b = (np.concatenate(side) for side in zip(*found))
    a, b = _overlapping(center, radius, center, radius, a, b)
    return np.minimum(a, b), np.maximum(a, b)


def spheres_with_others(center, radius, other_center, other_radius):
    """
    Return all pairs, (p,) int each, of a sphere (3, n), (n,) and an other (3, m), (m,) [m].

    Only those that overlap; the first number counts the spheres, the second the others.
    """
    sides = (center, radius), (other_center, other_radius)
    count, other_count = len(radius), len(other_radius)
    if count * other_count <= BRUTE_FORCE_PAIRS:
        a = np.repeat(np.arange(count), other_count)
        b = np.tile(np.arange(other_count), count)
        return _overlapping(*sides[0], *sides[1], a, b)
    found = []
    size_class = _size_classes(np.concatenate((radius, other_radius)))
    size_class, other_class = size_class[:count], size_class[count:]
    for size in np.unique(np.concatenate((size_class, other_class))).tolist():
        for asking, asked, swap in ((size_class == size, other_class <= size, False),
                                    (other_class == size, size_class < size, True)):
            asking, asked = np.flatnonzero(asking), np.flatnonzero(asked)
            if len(asking) and len(asked):
                (one, one_radius), (other, _) = sides[::-1] if swap else sides
                a, b = _neighbours_between(one[:, asking], other[:, asked],
                                           2 * one_radius[asking].max())
                found.append((asked[b], asking[a]) if swap else (asking[a], asked[b]))
    a, b = (np.concatenate(side) for side in zip(*found))
    return _overlapping(*sides[0], *sides[1], a, b)


@lru_cache(maxsize=8)
def _all_pairs(count):
    return np.triu_indices(count, 1)


def _size_classes(radius):
    """Return a whole number for each radius: within a number radii differ by SIZE_CLASS only."""
    return np.floor(np.log(radius / radius.min()) * (1 / np.log(SIZE_CLASS))).astype(int)


def _overlapping(center, radius, other_center, other_radius, a, b):
    """Return those of the pairs whose spheres overlap."""
    square = 0
    for axis, other_axis in zip(center, other_center):
        between = other_axis.take(b) - axis.take(a)
        square = square + between * between
    reach = radius.take(a) + other_radius.take(b)
    near = np.flatnonzero(square < reach * reach)
    return a[near], b[near]


def _cell_numbers(low, high, cell):
    """Return a function from centers (3, n) to cell numbers (n,), and the steps along y and z."""
    cell = max(cell * _WIDER, (high - low).max() / _CELLS_PER_AXIS)
    # an empty border keeps rows that start or end outside from wrapping around
    shape = ((high - low) / cell).astype(np.int64) + 3
    step_y, step_z = shape[0], shape[0] * shape[1]

    def number(center):
        x, y, z = ((center - low[:, np.newaxis]) * (1 / cell)).astype(np.int64) + 1
        return x + step_y * y + step_z * z
    return number, step_y, step_z


def _neighbours_within(center, cell):
    """Return all pairs in the same or neighbouring cells, each once, in no particular order."""
    number, step_y, step_z = _cell_numbers(center.min(axis=1), center.max(axis=1), cell)
    key = number(center)
    order = np.argsort(key)
    key = key[order]
    begin, end = _rows(key, key, _LATER_ROWS @ (step_y, step_z))
    begin[0] = np.arange(1, len(key) + 1)  # in the own row, those further on
    return _expanded(begin, end, order, order)


def _neighbours_between(center, other_center, cell):
    """Return all pairs of a sphere and an other in the same or neighbouring cells."""
    low = np.minimum(center.min(axis=1), other_center.min(axis=1))
    high = np.maximum(center.max(axis=1), other_center.max(axis=1))
    number, step_y, step_z = _cell_numbers(low, high, cell)
    other_key = number(other_center)
    other_order = np.argsort(other_key)
    key = number(center)
    order = np.argsort(key)
    begin, end = _rows(key[order], other_key[other_order], _ALL_ROWS @ (step_y, step_z))
    return _expanded(begin, end, order, other_order)


def _rows(key, other_key, steps):
    """
    Return where in the sorted `other_key` each sorted `key`'s rows of three cells begin and end.

    Arrays (rows, n). Searched once for each occupied cell.
    """
    first = np.flatnonzero(np.diff(key, prepend=-1))
    middle = key[first] + steps[:, np.newaxis]
    begin = np.searchsorted(other_key, middle - 1)
    end = np.searchsorted(other_key, middle + 1, side='right')
    cell = np.repeat(np.arange(len(first)), np.diff(first, append=len(key)))
    return begin.take(cell, axis=1), end.take(cell, axis=1)


def _expanded(begin, end, order, other_order):
    """Return each sphere with each other in its ranges, as numbers before the sorting."""
    counts = (end - begin).ravel()
    a = np.repeat(np.broadcast_to(order, begin.shape).ravel(), counts)
    before = np.cumsum(counts) - counts
    b = other_order[np.arange(len(a)) + np.repeat(begin.ravel() - before, counts)]
    return a, b
