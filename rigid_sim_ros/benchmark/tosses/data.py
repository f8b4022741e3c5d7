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

"""Measured tosses, read from a file that the user has."""

from dataclasses import dataclass
import zipfile

import numpy as np

from rigid_sim_ros.benchmark.errors import BenchmarkError

ARRAYS = ('offset', 't', 'position', 'quaternion', 'edge_m', 'mass_kg', 'inertia_kg_m2',
          'gravity_m_s2')

LENGTH_SCALE = 0.978
"""
Measured lengths over true ones in the public data: a free flight falls with 0.978 g, and the cube
rests that much too low (both within 0.15 %).
"""


@dataclass(frozen=True)
class Toss:
    """One measured toss: k samples from free flight to rest on the plane z = 0."""

    times: np.ndarray
    """(k,) [s], from zero."""

    position: np.ndarray
    """(k, 3) [m], of the centre."""

    orientation: np.ndarray
    """(k, 4) x, y, z, w, body to world."""

    edge: float
    """[m]"""

    mass: float
    """[kg]"""

    moment: float
    """[kg m^2], about every axis."""

    gravity: float
    """[m/s^2]"""


def read_tosses(path, length_scale=LENGTH_SCALE):
    """
    Return the `Toss`es of a file, with true lengths.

    The file is a NumPy archive (.npz): samples of all tosses one after the other in `t` (N,),
    `position` (N, 3) and `quaternion` (N, 4; w, x, y, z), those of toss k from `offset[k]` to
    `offset[k + 1]`, and the numbers `edge_m`, `mass_kg`, `inertia_kg_m2`, `gravity_m_s2`.
    Raises `BenchmarkError` for anything else.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            missing = [name for name in ARRAYS if name not in file]
            if missing:
                raise BenchmarkError(f'{path} has no array {missing[0]!r}; '
                                     f'needed: {", ".join(ARRAYS)}')
            arrays = {name: file[name] for name in ARRAYS}
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise BenchmarkError(f'{path} is not an archive of tosses: {error}') from None
    try:
        return [_toss(arrays, slice(first, last), length_scale)
                for first, last in zip(arrays['offset'][:-1], arrays['offset'][1:])]
    except (IndexError, TypeError, ValueError) as error:
        raise BenchmarkError(f'{path} has arrays of other shapes: {error}') from None


def _toss(arrays, samples, length_scale):
    times = arrays['t'][samples]
    return Toss(times=times - times[0], position=arrays['position'][samples] / length_scale,
                orientation=arrays['quaternion'][samples][:, [1, 2, 3, 0]],
                edge=float(arrays['edge_m']), mass=float(arrays['mass_kg']),
                moment=float(arrays['inertia_kg_m2']), gravity=float(arrays['gravity_m_s2']))
