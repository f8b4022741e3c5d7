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

"""Bodies that are put elsewhere while they are in lasting contact, or asleep in it."""

import numpy as np
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.scene import load_scene

GRAVITY = 9.81
EDGE = 0.2


def cubes(places, friction=0.5):
    """Return a scene of cubes of 1 kg on a plane, with their centres at places x [m]."""
    return load_scene({
        'material': {'friction': friction, 'restitution': 0.0},
        'planes': [{'name': 'ground', 'normal': [0, 0, 1], 'offset': 0.0}],
        'bodies': [{'name': f'cube_{index}', 'cube': {'edge': EDGE}, 'mass': 1.0,
                    'position': [place, 0, EDGE / 2]} for index, place in enumerate(places)]})


@pytest.mark.parametrize('max_step', [1 / 240, 0.01])
@pytest.mark.parametrize('count', [1, 3, 9, 30])
@pytest.mark.parametrize('seconds', [0.02, 1.0])
def test_a_body_lifted_out_of_a_row_falls_back(count, max_step, seconds):
    """Awake or asleep, one of cubes side by side: free fall, z = z0 - g t^2 / 2, then rest."""
    # with friction a turn by rounding jams what falls between others without any clearance
    simulation = Simulation(cubes(EDGE * np.arange(count), friction=0.0), max_step=max_step)
    simulation.advance(seconds)
    index, lift = count // 2, 0.05
    simulation.set_pose(f'cube_{index}', position=(EDGE * index, 0, EDGE / 2 + lift))
    simulation.advance(0.05)
    fallen = EDGE / 2 + lift - GRAVITY * 0.05 ** 2 / 2
    assert simulation.position[index, 2] == pytest.approx(fallen, abs=1e-7)
    simulation.advance(0.5)
    np.testing.assert_allclose(simulation.position[:, 2], EDGE / 2, atol=1e-5)


@pytest.mark.parametrize('max_step', [1 / 240, 0.01])
@pytest.mark.parametrize('others', [0, 30])
def test_a_body_put_onto_others_that_slide_does_not_sink_in(others, max_step):
    """From one pair of sliding cubes onto another, which it was not near: it stands there."""
    places = [0.0, EDGE, 2.0, 2.0 + EDGE, *(5.0 + np.arange(others))]
    simulation = Simulation(cubes(places), max_step=max_step)
    simulation.set_velocities(linear=np.tile((0, 0.2, 0), (4, 1)), indices=np.arange(4))
    simulation.advance(0.02)
    simulation.set_pose('cube_0', position=(2.0, 0.004, 1.5 * EDGE))
    for _ in range(20):
        simulation.advance(0.01)
        assert simulation.penetration() < 1e-3 * EDGE
    assert simulation.position[0, 2] == pytest.approx(1.5 * EDGE, abs=1e-5)


@pytest.mark.parametrize('depth', [0.001, 0.02])
def test_a_body_put_into_the_ground_among_others_comes_out(depth):
    """A cube of a sleeping row of nine: what overlaps is pushed out, whoever made it."""
    simulation = Simulation(cubes(EDGE * np.arange(9)), max_step=0.01)
    simulation.advance(1.0)
    simulation.set_pose('cube_4', position=(4 * EDGE, 0, EDGE / 2 - depth))
    simulation.advance(1.0)
    assert simulation.penetration() < 1e-3 * EDGE


@pytest.mark.parametrize('rolling_friction', [0.0, 0.01])
@pytest.mark.parametrize('orientation', [(0, 0, 0, 1), (0.1, 0.2, 0.3, 0.9)])
def test_a_body_put_under_the_ground_comes_out(orientation, rolling_friction):
    """A cube with all its corners below the plane: it ends up on one of its faces."""
    material = {'friction': 0.5, 'rolling_friction': rolling_friction}
    scene = load_scene({
        'material': material, 'planes': [{'name': 'ground', 'normal': [0, 0, 1]}],
        'bodies': [{'name': 'cube_0', 'cube': {'edge': EDGE}, 'mass': 1.0,
                    'position': [0, 0, EDGE / 2]}]})
    simulation = Simulation(scene)
    simulation.advance(1.0)
    simulation.set_pose('cube_0', position=(0, 0, -0.5), orientation=orientation)
    simulation.advance(2.0)
    # in steps a gap counts as closed that is less than a fifth of one's fall, g h^2
    closed = GRAVITY / 240 ** 2 / 5 if rolling_friction else 1e-9
    assert simulation.position[0, 2] == pytest.approx(EDGE / 2, abs=closed)
    assert simulation.asleep.all()
