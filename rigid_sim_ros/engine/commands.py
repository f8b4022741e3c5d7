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

"""What is asked of a command before it may change a state; every refusal is one line."""

from difflib import get_close_matches
from math import inf
from numbers import Real

import numpy as np


LARGEST = 1e30
"""Largest number in a command, in SI units, as in a scene: squares and products stay finite."""


class CommandError(ValueError):
    """A command that cannot be carried out; nothing was changed. The text is one line."""


def shown(value):
    """Return a value as one short line of text."""
    return ' '.join(repr(value).split())[:80]


def duration_in_seconds(value):
    """Return a real number, or an array of shape () with one, as a float; ValueError if not."""
    number = value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value
    try:
        seconds = float(number) if isinstance(number, (float, Real)) else -1.0
    except OverflowError:
        seconds = inf
    if not 0 <= seconds < inf:
        raise ValueError(f'duration is {shown(value)} s; allowed: a finite number, 0 or more')
    return seconds


def column_of_moving(name, columns, moving_names):
    """
    Return the column of a moving body.

    `columns` maps all names to columns, `moving_names` are those that move, in order. Raises
    `CommandError`, with the near names if there is no such body.
    """
    column = columns.get(name) if isinstance(name, str) else None
    if column is None:
        raise CommandError(f'no body is named {shown(name)}{near_names(name, moving_names)}')
    if column >= len(moving_names):
        raise CommandError(f'{name!r} does not move: it is fixed or a plane')
    return column


def unit_quaternion(value):
    """Return a quaternion x, y, z, w as an array (4,) of unit length, or raise `CommandError`."""
    quaternion = vector('orientation', value, 4)
    length = np.sqrt(quaternion @ quaternion)
    if not 0 < length < inf:
        raise CommandError(f'orientation is {shown(value)}; allowed: a quaternion x, y, z, w '
                           'that is not zero')
    return quaternion / length


def near_names(name, names):
    """Return text that tells the names closest to a wrong one, or the first few."""
    close = get_close_matches(str(name)[:80], names, n=3)
    if close:
        return f'; near names: {", ".join(close)}'
    more = ', ...' if len(names) > 5 else ''
    return f'; names: {", ".join(names[:5])}{more}'


def vector(what, value, size=3):
    """Return numbers as an array (size,), or raise `CommandError`."""
    return _checked(what, value, (size,))


def vector_rows(what, value, count):
    """Return numbers as an array (count, 3), or raise `CommandError`."""
    return _checked(what, value, (count, 3))


def index_rows(value, count):
    """Return rows (k,) of `count`, all of them for None, or raise `CommandError`."""
    if value is None:
        return np.arange(count)
    try:
        indices = np.asarray(value)
    except ValueError:
        indices = np.empty(())
    if indices.ndim != 1 or len(indices) and indices.dtype.kind not in 'iu':
        raise CommandError(f'indices is {shown(value)}; allowed: whole numbers, shape (k,)')
    indices = indices.astype(np.intp)
    if len(indices) and not (0 <= indices.min() and indices.max() < count):
        raise CommandError(f'indices is {shown(value)}; allowed: 0 to {count - 1}')
    if len(np.unique(indices)) < len(indices):
        raise CommandError(f'indices is {shown(value)}; allowed: each body once')
    return indices


def _checked(what, value, shape):
    """Return finite numbers as an array of this shape, or raise `CommandError`."""
    try:
        given = np.asarray(value)
    except ValueError:
        given = np.empty((), dtype=object)
    if given.dtype.kind not in 'iuf':
        raise CommandError(f'{what} is {shown(value)}; allowed: numbers, shape {shape}')
    array = given.astype(float)
    if array.shape != shape:
        raise CommandError(f'{what} has the shape {array.shape}; allowed: {shape}')
    if not np.isfinite(array).all():
        raise CommandError(f'{what} is {shown(value)}; allowed: finite numbers')
    if not (np.abs(array) <= LARGEST).all():
        raise CommandError(f'{what} is {shown(value)}; allowed: at most {LARGEST:g} either way')
    return array
