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

"""What bounces in a pile gains no energy, whatever its moments of inertia."""

from island_run import body, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine.shapes import Box

STEP = 0.01


def bouncing_column(seed, restitution):
    """Return nine boxes, slightly askew above each other, that fall and turn."""
    random = np.random.default_rng(seed)
    bodies = []
    for level in range(9):
        turn = random.normal(size=4) * (0.02, 0.02, 0.02, 0.0) + (0.0, 0.0, 0.0, 1.0)
        x, y = 0.01 * random.normal(size=2)
        bodies.append(body(
            f'box_{level}', Box((0.2, 0.14, 0.18)), position=(x, y, 0.13 + 0.23 * level),
            orientation=tuple(turn / np.linalg.norm(turn)), velocity=(0.0, 0.0, -2.0),
            angular_velocity=tuple(0.3 * random.normal(size=3))))
    return IslandRun(bodies, step=STEP, restitution=restitution, friction=1.0)


@pytest.mark.parametrize('seed, restitution', [(5, 0.7), (4, 0.9), (1, 1.0), (3, 1.0)])
def test_bouncing_boxes_gain_no_energy(seed, restitution):
    """In no step more than the turning of boxes is wrong by, 1e-8 of what they have."""
    run = bouncing_column(seed, restitution)
    first = energy = run.energy()
    for _ in range(30):
        run.step()
        energy, before = run.energy(), energy
        assert energy - before < 1e-8 * first


def test_what_is_pushed_out_keeps_its_energy_of_motion():
    """Turned by a hundredth; about other axes than before it would have another by as much."""
    run = bouncing_column(0, 0.0)
    island = run.island
    free, motion = island.free_motion(run.state), island.gather(run.state)
    linear, angular = 0.01 * np.random.default_rng(0).normal(size=(2, 3, island.member_count))
    moved = free.displaced(motion, linear, angular)
    np.testing.assert_allclose(free.kinetic_energy(moved), free.kinetic_energy(motion),
                               rtol=1e-14)
    count = island.member_count
    np.testing.assert_allclose(moved.position[:, :count], motion.position[:, :count] + linear)
