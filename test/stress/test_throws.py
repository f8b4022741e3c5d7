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
"""Bodies thrown at random: all come to rest on a face, whatever the restitution and friction."""

from dataclasses import replace
from math import sqrt

import numpy as np

import pytest

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.shapes import Box, Cube

from stress_scenes import several_thrown, throw, two_thrown

from watching import cpu_limit, Watch

ENERGY = 1e-8
"""What energy may rise by, in parts of its scale."""

LONGEST = 60.0
"""[s] in which bodies of a metre come to rest; with e = 0.9 and much friction it takes 30."""

CPU = 30.0
"""[s] a throw may take: what is stuck in bounces that get ever smaller takes for ever."""

SHAPES = {'cube': Cube(1.0), 'box': Box((0.5, 1.0, 1.5))}


def material(seed):
    """
    Return restitution and friction of a throw: each tenth of their ranges as often.

    With less friction than the least it takes minutes to slide to rest, as it should.
    """
    random = np.random.default_rng((7, seed))
    restitution = 0.9 * (seed % 10 + random.random()) / 10
    return restitution, max(0.02, (seed // 10 * 3 % 10 + random.random()) / 10)


def thrown(scene, longest=LONGEST):
    """Return the `Watch` of a scene that has come to rest."""
    watch = Watch(scene, interval=1 / 30)
    with cpu_limit(CPU):
        assert watch.run(longest, until_rest=True), 'not at rest'
    return watch


def tilt(simulation):
    """Return by how much no axis of each body is upright, (n,): the sine of the least angle."""
    turn = rotation.matrix(simulation.orientation.T)
    return np.sqrt(np.maximum(0.0, 1.0 - (turn[2] ** 2).max(axis=0)))


def seeds(few, many, telling=()):
    """Return test parameters: the first few and those that tell most, and the rest as stress."""
    return [seed if seed < few or seed in telling
            else pytest.param(seed, marks=pytest.mark.stress) for seed in range(many)]


@pytest.mark.parametrize('shape', SHAPES)
@pytest.mark.parametrize('seed', seeds(4, 350))
def test_a_body_comes_to_rest_on_a_face(shape, seed):
    """With the energy falling all the way, and nothing in the ground."""
    watch = thrown(throw(seed, *material(seed), SHAPES[shape]))
    assert tilt(watch.simulation) < 1e-6
    assert watch.energy_rise < ENERGY
    assert watch.penetration < 1e-6


@pytest.mark.parametrize('shape, restitution', [
    ('cube', 0.4), pytest.param('box', 0.0, marks=pytest.mark.stress)])
def test_on_ice_a_body_ends_flat_and_does_not_bounce(shape, restitution):
    """Without friction it slides on for ever, on a face."""
    watch = Watch(throw(5, restitution, 0.0, SHAPES[shape]), interval=1 / 10)
    with cpu_limit(CPU):
        watch.run(8.0)
    assert tilt(watch.simulation) < 1e-6
    assert abs(watch.simulation.linear_velocity[0, 2]) < 1e-9
    assert watch.energy_rise < ENERGY


@pytest.mark.parametrize('seed', seeds(3, 300, telling=(11, 50)))
def test_two_cubes_come_to_rest(seed):
    """Flung at each other above the ground: each on a face, or leaning on the other."""
    watch = thrown(two_thrown(seed, *material(seed)))
    leaning = tilt(watch.simulation) > 1e-6
    apart = np.linalg.norm(np.diff(watch.simulation.position, axis=0))
    # whoever leans has the other within reach
    assert not leaning.any() or apart < sqrt(3.0)
    assert watch.energy_rise < ENERGY
    assert watch.penetration < 1e-3


@pytest.mark.parametrize('count', [3, 4, 5, 6])
@pytest.mark.parametrize('seed', seeds(1, 25))
def test_several_cubes_never_gain_energy(count, seed):
    """Flung together from a ring above the ground; they come to rest."""
    watch = thrown(several_thrown(count, seed, *material(3 * seed + count)))
    assert watch.energy_rise < ENERGY
    assert watch.penetration < 1e-3


def relabelled(scene, seed):
    """Return the same scene with all cubes' corners numbered otherwise: turned onto themselves."""
    random = np.random.default_rng(seed)
    half = sqrt(0.5)
    bodies = []
    for body in scene.bodies:
        turn = np.array((0.0, 0.0, 0.0, 1.0))
        for axis in random.integers(0, 3, 4):
            quarter = np.array((0.0, 0.0, 0.0, half))
            quarter[axis] = half
            turn = rotation.multiply(turn, quarter)
        orientation = rotation.multiply(np.array(body.orientation), turn)
        bodies.append(replace(body, orientation=tuple(rotation.normalize(orientation).tolist())))
    return replace(scene, bodies=tuple(bodies))


@pytest.mark.parametrize('seed', seeds(2, 150, telling=(67, 125)))
def test_numbering_of_corners_does_not_move_a_cube(seed):
    """One body ends in the same place to 1e-9 m."""
    scene = throw(seed, 0.3 * (seed % 3), 0.1 + 0.2 * (seed % 5), SHAPES['cube'])
    place, other = (thrown(each).simulation.position for each in (scene, relabelled(scene, seed)))
    np.testing.assert_allclose(other, place, rtol=0, atol=1e-9)


@pytest.mark.parametrize('seed', seeds(1, 100, telling=(51,)))
def test_numbering_of_corners_and_bodies_does_not_move_two_cubes(seed):
    """Two bodies end in the same places to 1e-6 m, whichever comes first."""
    values = seed, 0.3 * (seed % 2), 0.3 + 0.2 * (seed % 2)
    place = thrown(two_thrown(*values)).simulation.position
    other = thrown(relabelled(two_thrown(*values, order=(1, 0)), seed)).simulation.position
    np.testing.assert_allclose(other[::-1], place, rtol=0, atol=1e-6)
