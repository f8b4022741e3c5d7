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


"""Columns of a pile that touch nothing at first, solved apart from others."""

import numpy as np

import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.scene import load_scene


def columns(mass):
    """Return a simulation of 40 columns that lean, and of ten that fall beside them."""
    def cube(name, place, velocity):
        return {'name': name, 'cube': {'edge': 0.2}, 'mass': mass, 'position': place,
                'velocity': [0.0, velocity, 0.0]}
    bodies = [cube(f'cube_{place}_{level}', [
        0.6 * (place % 8) + 0.02 * (level % 2), 0.6 * (place // 8), 0.1 + 0.2 * level],
        0.3 * level) for place in range(40) for level in range(4)]
    bodies += [cube(f'late_{place}_{level}', [
        0.6 * place + 0.02 * (level % 2), -3.0, 0.2 + 0.2001 * level], 0.3 * level)
        for place in range(10) for level in range(3)]
    return Simulation(load_scene({
        'bodies': bodies, 'planes': [{'name': 'ground'}],
        'material': {'friction': 0.5, 'restitution': 0.0}}), max_step=1 / 240)


@pytest.mark.parametrize('mass', [2.0 ** -10, 2.0 ** 14])
def test_the_unit_of_mass_does_not_matter(mass):
    """Powers of two change no digit of any mass: the same to the bit."""
    runs = columns(1.0), columns(mass)
    for _ in range(96):
        for each in runs:
            each.advance(1 / 240)
    np.testing.assert_array_equal(runs[0].position, runs[1].position)
