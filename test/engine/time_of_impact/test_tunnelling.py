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

"""Small, fast bodies against plates 1 mm thick: none passes."""

from flying import Flying

import numpy as np

import pytest

from rigid_sim_ros.engine.rotation import rotate
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.engine.time_of_impact import first_touches

THICKNESS = 1e-3
PLATE = 0.5  # [m], side


def throws(rng, count, round_share=0.5):
    """
    Return `Flying` of `count` bodies and then as many plates, and where the bodies cross them.

    Each body is thrown at a plate of its own, at 10 to 1e5 m/s, spinning, from any direction not
    too much along it, so that its centre would cross the middle of the plate well inside.
    """
    size = 10 ** rng.uniform(-3.5, -1.5, count)
    shapes = [Sphere(edge / 2) if rng.random() < round_share else Cube(edge) for edge in size]
    plates = [Box((PLATE, PLATE, THICKNESS))] * count
    q = rng.normal(size=(4, 2 * count))
    q /= np.sqrt((q * q).sum(axis=0))
    target = np.zeros((3, count))
    target[:2] = rng.uniform(-0.25 * PLATE, 0.25 * PLATE, (2, count))
    direction = rng.normal(size=(3, count))
    slope = np.maximum(np.abs(direction[2]), 0.3 * np.hypot(direction[0], direction[1]))
    direction[2] = np.copysign(slope, direction[2])
    direction /= np.sqrt((direction * direction).sum(axis=0))
    speed = 10 ** rng.uniform(1, 5, count)
    crossing = rng.uniform(0.2, 1.0, count)
    local = target - direction * speed * crossing
    place = rng.normal(size=(3, count))
    velocity = rotate(q[:, count:], direction * speed)
    position = place + rotate(q[:, count:], local)
    spin = rng.normal(size=(3, count)) * 10 ** rng.uniform(0, 2.5, count)
    still = np.zeros((3, count))
    flying = Flying(shapes + plates,
                    position=np.concatenate((position, place), axis=1).T,
                    velocity=np.concatenate((velocity, still), axis=1).T,
                    spin=np.concatenate((spin, still), axis=1).T, orientation=q.T)
    return flying, crossing, speed * np.abs(direction[2])


def check_none_passes(rng, count):
    flying, crossing, closing = throws(rng, count)
    a, b = np.arange(count), np.arange(count, 2 * count)
    # from a little before the bounding spheres meet, as a simulation would
    start = crossing - (PLATE + 0.1) / closing
    times = first_touches(flying.bodies, flying.flights, a, b, start, 2.0,
                          np.zeros(count, dtype=bool))
    # the side is as far from the centre as the half edge, at least, and the bounding radius
    edge, radius = flying.bodies.half_extents[0, :count], flying.bodies.bounding_radius[:count]
    latest, earliest = (crossing - (reach + THICKNESS / 2) / closing for reach in (edge, radius))
    assert (times <= latest + 1e-12).all()
    assert (times >= earliest - 1e-12).all()


def test_thousands_of_throws():
    check_none_passes(np.random.default_rng(1), 3000)


@pytest.mark.stress
@pytest.mark.parametrize('seed', range(100))
def test_a_million_throws(seed):
    check_none_passes(np.random.default_rng(1000 + seed), 10_000)
