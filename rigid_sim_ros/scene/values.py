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
The values of a scene file: what each kind of value may be, and reading them by key.

A reader takes a plain value and returns it as the model wants it, or raises `NotAllowed` with
what is allowed; `Section` adds file, body, key and the value given. Numbers are limited to
`LARGEST` in size; sizes, masses and inertias may not be below its inverse either.
"""

from math import isfinite, sqrt
from numbers import Integral, Real

import numpy as np
from rigid_sim_ros.engine.commands import LARGEST
from rigid_sim_ros.scene.errors import listed, nearest, SceneError, shown

UNIT_TOLERANCE = 1e-3
"""A vector this near to unit length is taken as rounded by hand, and normalised."""

UNIT_ROUNDING = 8 * np.finfo(float).eps
"""|q|^2 this near to 1 is a unit quaternion already, and kept to the bit."""

LONGEST_NAME = 200
"""Characters; names travel in every message of a collision."""


class NotAllowed(ValueError):
    """A value is not what is allowed; the text says what is."""


class Section:
    """
    One mapping of a scene, read key by key.

    Parameters
    ----------
    value
        What was given; refused unless it is a mapping with known keys only.
    label : str
        File and body, the start of every message.
    known, required : iterable of str
        The keys it may and must have.
    prefix : str
        Where the mapping stands, in front of a key: 'cube.'.

    """

    def __init__(self, value, label, known, required=(), prefix=''):
        if not isinstance(value, dict):
            place = f'{prefix[:-1]}: ' if prefix else ''
            raise SceneError(f'{label}: {place}{shown(value)} is not allowed; must be a mapping '
                             f'with the keys {listed(known)}')
        self.values, self.label, self.prefix = value, label, prefix
        for key in value:
            if key not in known:
                raise SceneError(f'{label}: {prefix}{_key_text(key)}: unknown key'
                                 f'{nearest(key, known)}; allowed are {listed(known)}')
        for key in required:
            if key not in value:
                raise SceneError(f'{label}: {prefix}{key} is missing')

    def __contains__(self, key):
        return key in self.values

    def read(self, key, reader, default=None):
        """Return the value of a key as `reader` gives it, or `default` if the key is absent."""
        if key not in self.values:
            return default
        try:
            return reader(self.values[key])
        except NotAllowed as error:
            raise self.refused(key, self.values[key], error) from None

    def refused(self, key, value, allowed):
        """Return the SceneError for a key whose value is not what is allowed."""
        return SceneError(f'{self.label}: {self.prefix}{key}: {shown(value)} is not allowed; '
                          f'must be {allowed}')

    def at_most_one(self, *keys):
        """Return which of the keys is given, or None; refuse two of them."""
        given = [key for key in keys if key in self.values]
        if len(given) > 1:
            raise SceneError(f'{self.label}: {self.prefix}{" and ".join(given)}: given together; '
                             f'only one of {listed(keys)} is allowed')
        return given[0] if given else None


def _key_text(key):
    return key if isinstance(key, str) and key.isprintable() and len(key) < 60 else shown(key)


def _is_number(value):
    # bool is an int in Python, but `mass: true` is a slip
    return isinstance(value, Real) and not isinstance(value, (bool, np.bool_))


def _finite(value):
    """Return a finite float, or None for anything else."""
    if type(value) is float:
        return value if isfinite(value) else None
    if not _is_number(value):
        return None
    try:
        value = float(value)
    except OverflowError:
        return None
    return value if isfinite(value) else None


def number(value):
    """Read a finite number."""
    result = _finite(value)
    if result is None or abs(result) > LARGEST:
        raise NotAllowed(f'a finite number, at most {LARGEST:g} in size')
    return result


def positive(value):
    """Read a number above zero."""
    result = _finite(value)
    if result is None or not 1 / LARGEST <= result <= LARGEST:
        raise NotAllowed(f'a number greater than 0 ({1 / LARGEST:g} to {LARGEST:g})')
    return result


def not_negative(value):
    """Read a number of zero or more."""
    result = _finite(value)
    if result is None or not 0 <= result <= LARGEST:
        raise NotAllowed('a finite number, 0 or more')
    return result


def fraction(value):
    """Read a number from 0 to 1."""
    result = _finite(value)
    if result is None or not 0 <= result <= 1:
        raise NotAllowed('a number from 0 to 1')
    return result


def truth(value):
    """Read true or false."""
    if not isinstance(value, (bool, np.bool_)):
        raise NotAllowed('true or false')
    return bool(value)


def seed(value):
    """Read an integer that seeds NumPy's default_rng."""
    if not (_is_number(value) and isinstance(value, Integral) and 0 <= value < 2 ** 64):
        raise NotAllowed('an integer, 0 or more')
    return int(value)


def name(value):
    """Read a name."""
    if not (isinstance(value, str) and value and value.isprintable()
            and value == value.strip() and len(value) <= LONGEST_NAME):
        raise NotAllowed(f'text of 1 to {LONGEST_NAME} printable characters without spaces at '
                         'its ends (in quotes if it looks like a number)')
    return value


def choice(*allowed):
    """Return a reader of one of several words."""
    def read(value):
        if not isinstance(value, str) or value not in allowed:
            raise NotAllowed(f'one of {listed(allowed)}{nearest(value, allowed)}')
        return value
    return read


def _sequence(value, count, element, allowed):
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, (list, tuple)) or len(value) != count:
        raise NotAllowed(allowed)
    try:
        return tuple([element(each) for each in value])
    except NotAllowed:
        raise NotAllowed(allowed) from None


def vector(value):
    """Read three finite numbers."""
    return _sequence(value, 3, number,
                     f'a list of 3 finite numbers, each at most {LARGEST:g} in size')


def sides(value):
    """Read three numbers above zero."""
    return _sequence(value, 3, positive, 'a list of 3 numbers greater than 0')


def zero_vector(value):
    """Read the (0, 0, 0) that a fixed body may have."""
    if any(vector(value)):
        raise NotAllowed('[0, 0, 0] for a fixed body, or left out')
    return (0.0, 0.0, 0.0)


def counts(value):
    """Read three integers of 1 or more."""
    def count(each):
        if not (_is_number(each) and isinstance(each, Integral) and each >= 1):
            raise NotAllowed('')
        return int(each)
    return _sequence(value, 3, count, 'a list of 3 integers, 1 or more')


def _unit(values, allowed):
    """Return the values divided by their length, which must be 1 already but for rounding."""
    square = sum(each * each for each in values)
    if abs(sqrt(square) - 1) > UNIT_TOLERANCE:
        raise NotAllowed(f'{allowed} of length 1 (within {UNIT_TOLERANCE:g}); '
                         f'its length is {sqrt(square):.6g}')
    if abs(square - 1) <= UNIT_ROUNDING:
        return values
    length = sqrt(square)
    return tuple([each / length for each in values])


def quaternion(value):
    """Read a unit quaternion x, y, z, w."""
    allowed = 'a quaternion [x, y, z, w]'
    return _unit(_sequence(value, 4, number, allowed + ' of length 1'), allowed)


def unit_vector(value):
    """Read a vector of unit length."""
    allowed = 'a vector [x, y, z]'
    return _unit(_sequence(value, 3, number, allowed + ' of length 1'), allowed)


def inertia(value):
    """
    Read one or three principal moments of inertia [kg m^2].

    No moment of a real body is larger than the sum of the two others: each is a sum of two of
    the three second moments of its mass (Goldstein, Classical Mechanics, section 5.3).
    """
    allowed = 'a number greater than 0, or a list of 3 of them, none larger than the sum of ' \
              'the two others'
    if _is_number(value):
        value = (value,) * 3
    moments = _sequence(value, 3, positive, allowed)
    # a thin plate has equality, up to rounding
    if 2 * max(moments) > sum(moments) * (1 + 1e-12):
        raise NotAllowed(allowed)
    return moments
