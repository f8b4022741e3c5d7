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


"""Energy of few bodies at the end of a step: what lifts them is paid for, or does not happen."""

from dataclasses import replace

from island_run import body, ground, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine.model import Material
from rigid_sim_ros.engine.shapes import Box, Cube

EDGE = 0.2
SUNK = 5e-5


def sunk_column(count, velocity=0.0, **values):
    """Return cubes on top of each other on the ground, each sunk a little into what is below."""
    material = Material(0.0, 0.5, **values)
    return IslandRun(
        [body(f'cube_{level}', Cube(EDGE), material=material, velocity=(velocity, 0.0, 0.0),
              position=(0.0, 0.0, (level + 0.5) * EDGE - (level + 1) * SUNK))
         for level in range(count)], [ground(material=material)])


def overlap(run):
    """Return the deepest overlap [m] in an island."""
    motion = run.island.gather(run.state)
    return -run.island.find_contacts(motion, EDGE).separation.min()


@pytest.mark.parametrize('resistance', [0.0, 0.001])
@pytest.mark.parametrize('count', [1, 2, 5])
def test_what_rests_sunk_is_not_lifted_for_nothing(count, resistance):
    """As a pile may leave it, with no energy to pay; one cube by itself and several."""
    run = sunk_column(count, rolling_friction=resistance)
    before, start = run.energy(), run.state.position.copy()
    for _ in range(10):
        outcome = run.step()
        assert run.energy() <= before + 1e-15
    assert outcome.resting.all()
    np.testing.assert_allclose(run.state.position, start, atol=1e-9)
    assert outcome.contacts.separation.min() == pytest.approx(-SUNK, rel=1e-6)


@pytest.mark.parametrize('count', [2, 5])
def test_what_slides_sunk_is_lifted_out_of_its_motion(count):
    """Friction takes energy that pushes overlaps out; in no step there is more than before."""
    run = sunk_column(count, velocity=1.0)
    for _ in range(10):
        before = run.energy()
        run.step()
        assert run.energy() < before
    assert overlap(run) < 1e-8 * EDGE


@pytest.mark.parametrize('friction', [0.0, 0.5])
def test_what_parts_sunk_is_lifted_out_of_its_motion(friction):
    """A cube that jumps off another in which it has sunk: nothing presses, and yet it pays."""
    run = IslandRun(
        [body('lower', Cube(EDGE), position=(0.0, 0.0, 0.5 * EDGE)),
         body('upper', Cube(EDGE), position=(0.0, 0.0, 1.5 * EDGE - SUNK),
              velocity=(0.0, 0.0, 0.005))], friction=friction, gravity=(0.0, 0.0, -0.1))
    before = run.energy()
    run.step()
    assert run.energy() <= before + 1e-15
    assert overlap(run) < 1e-8 * EDGE


def test_one_cube_slides_on_at_the_level_to_which_it_has_sunk():
    """By v t - mu g t^2 / 2, as there is no other law for it; flat, and no higher."""
    run = sunk_column(1, velocity=1.0)
    run.run(0.1)
    x, y, z = run.state.position[:, 0]
    assert x == pytest.approx(0.1 - 0.5 * 0.5 * 9.81 * 0.01, rel=1e-9)
    assert y == pytest.approx(0.0, abs=1e-12)
    assert z == pytest.approx(0.5 * EDGE - SUNK, rel=1e-12)


def leaning_column(seed, step=1 / 240, **values):
    """Return two to five boxes of unlike masses that fall onto each other, slightly askew."""
    random = np.random.default_rng(seed)
    bodies = []
    for level in range(int(random.integers(2, 6))):
        turn = random.normal(size=4) * (0.002, 0.002, 0.002, 0.0) + (0.0, 0.0, 0.0, 1.0)
        shape = Box((0.2, 0.14, 0.18)) if random.random() < 0.5 else Cube(EDGE)
        bodies.append(body(
            f'box_{level}', shape, float(10 ** random.uniform(-0.5, 0.5)),
            position=(*(0.003 * random.normal(size=2)).tolist(), 0.11 + 0.212 * level),
            orientation=tuple(turn / np.linalg.norm(turn)), velocity=(0.0, 0.0, -0.3)))
    material = Material(0.5, 0.5, **values)
    return IslandRun([replace(each, material=material) for each in bodies],
                     [ground(material=material)], step=step)


@pytest.mark.parametrize('seed', [8, 22])
def test_what_resists_spin_keeps_faces_where_they_are(seed):
    """Boxes with rolling friction that lie down on four corners, not only the one resisted."""
    run = leaning_column(seed, step=0.01, rolling_friction=0.002, pivoting_friction=0.002)
    for _ in range(60):
        run.step()
        assert overlap(run) < 1e-7


def test_a_cascade_of_impacts_leaves_no_deep_overlap():
    """A column of four in a step of 1/100 s with more than twenty impacts."""
    run = leaning_column(12, step=0.01, rolling_friction=0.002, pivoting_friction=0.002)
    deepest, most = 0.0, 0
    for _ in range(20):
        before = run.world.work.impacts
        run.step()
        deepest = max(deepest, overlap(run))
        most = max(most, run.world.work.impacts - before)
    assert deepest < 1e-9 * EDGE
    assert most > 16


@pytest.mark.parametrize('seed', [0, 1, 2, 3, 6, 9])
def test_what_stops_rocking_gains_nothing(seed):
    """Forces end within the step: to carry bodies on by how they changed would lift them."""
    run = leaning_column(seed)
    first = run.energy()
    for _ in range(120):
        before = run.energy()
        run.step()
        assert run.energy() - before < 1e-13 * first
