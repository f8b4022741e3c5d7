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
"""What is put right at the end of a step: energy, and what contacts leave alone."""

from island_run import body, ground, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine import diagnostics, rotation
from rigid_sim_ros.engine.lasting_contact.energy_balance import Group, slowed
from rigid_sim_ros.engine.lasting_contact.motion import Motion
from rigid_sim_ros.engine.model import Material
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere

WALLS = {'none': np.zeros((3, 0)), 'one': np.array([(0.0, 0.6, 0.8)]).T,
         'one, twice': np.array([(0.0, 0.6, 0.8), (0.0, 0.6, 0.8)]).T,
         'a corner': np.array([(0.0, 0.6, 0.8), (1.0, 0.0, 0.0)]).T}


def three_bodies():
    """Return the island of three bodies tumbling about, and their `Motion`."""
    random = np.random.default_rng(1)
    bodies = []
    for name, shape in (('a', Box((0.3, 0.7, 1.1))), ('b', Cube(1.0)), ('c', Sphere(0.4))):
        turn = random.normal(size=4)
        bodies.append(body(name, shape, random.uniform(1, 5),
                           position=tuple(random.normal(size=3)),
                           orientation=tuple(turn / np.linalg.norm(turn)),
                           velocity=tuple(random.normal(size=3)),
                           angular_velocity=tuple(random.normal(size=3))))
    run = IslandRun(bodies, friction=0.0)
    return run.island, run.island.gather(run.state), run.state


def momenta(island, motion, state):
    """Return the momentum and the angular momentum about the origin, of a `Motion`."""
    columns = island.members
    state.change('linear_velocity', columns, motion.linear[:, :3])
    state.change('angular_velocity', columns, motion.angular[:, :3])
    return (diagnostics.momentum(island.world.bodies, state),
            diagnostics.angular_momentum(island.world.bodies, state))


@pytest.mark.parametrize('walls', WALLS)
def test_energy_is_taken_out_of_what_contacts_change(walls):
    """All of it; momentum stays but into walls, angular momentum but about axes in them."""
    island, motion, state = three_bodies()
    free, normals = island.free_motion(state), WALLS[walls]
    after, _ = slowed(free, motion, Group([0, 1, 2], False, normals, 0.0), 0.3)
    lost = (free.kinetic_energy(motion) - free.kinetic_energy(after)).sum()
    assert lost == pytest.approx(0.3, rel=1e-12)
    (before, spin_before), (momentum, spin) = (
        momenta(island, each, state) for each in (motion, after))
    change, spin_change = momentum - before, spin - spin_before
    along = np.eye(3) - normals @ np.linalg.pinv(normals)
    np.testing.assert_allclose(along @ change, 0, atol=1e-13)
    # about the common centre of mass, as walls push on that
    mass = free.mass[:3]
    centre = motion.position[:, :3] @ mass / mass.sum()
    spin_change -= np.cross(centre, change)
    if walls == 'none':
        np.testing.assert_allclose(spin_change, 0, atol=1e-13)
    elif walls != 'a corner':
        assert normals[:, 0] @ spin_change == pytest.approx(0, abs=1e-13)
    if walls != 'none':
        assert np.abs(change).max() > 1e-3


def test_contacts_at_rest_stay_so_when_bodies_are_slowed():
    """Two bodies that move as one, and a third: between the two nothing slides, whatever walls."""
    island, motion, state = three_bodies()
    rate = np.array((0.3, -0.7, 0.5))[:, None]
    linear, angular = motion.linear.copy(), motion.angular.copy()
    linear[:, :2] = rotation.cross(np.repeat(rate, 2, axis=1), motion.position[:, :2])
    angular[:, :2] = rate
    motion = Motion(motion.position, motion.orientation, linear, angular)
    point = np.array((0.2, 0.4, -0.1))[:, None]
    for rough, normals in [(True, WALLS['one']), *((False, each) for each in WALLS.values())]:
        after, _ = slowed(island.free_motion(state), motion,
                          Group([0, 1, 2], rough, normals, 0.0), 0.1)
        velocity = after.linear[:, :2] + rotation.cross(
            after.angular[:, :2], point - after.position[:, :2])
        np.testing.assert_allclose(velocity[:, 0], velocity[:, 1], atol=1e-14)
        assert np.abs(after.angular[:, 0] - motion.angular[:, 0]).max() > 1e-5


def falling(step):
    """Return a box that falls about an edge, on another: no point of it slides."""
    tilt = 0.15
    place = (0.15 * np.cos(tilt) - 0.5 * np.sin(tilt), 0.0,
             0.4 + 0.15 * np.sin(tilt) + 0.5 * np.cos(tilt))
    return IslandRun([
        body('slab', Box((4.0, 4.0, 0.4)), 1000.0, position=(0, 0, 0.2)),
        body('box', Box((0.3, 0.5, 1.0)), position=place,
             orientation=(0, -np.sin(tilt / 2), 0, np.cos(tilt / 2)))],
        step=step, friction=2.0)


@pytest.mark.parametrize('step', [1 / 60, 1 / 240])
def test_what_only_sticks_keeps_its_energy(step):
    """To rounding, while it falls."""
    run = falling(step)
    energy = run.energy()
    for _ in range(round(0.1 / step)):
        run.step()
        assert run.energy() == pytest.approx(energy, rel=1e-14)
    assert abs(run.state.angular_velocity[1, 1]) > 0.1


def test_held_forces_do_work_and_no_more():
    """A cube pulled up a slope by its edge, over another body: energy less work never rises."""
    run = IslandRun([
        body('slab', Box((9.0, 4.0, 0.4)), 50.0, position=(0, 0, 0.2)),
        body('cube', Cube(0.5), position=(-2, 0, 0.65), velocity=(1, 0.3, 0),
             angular_velocity=(0, 0, 3.0))], step=1 / 240, friction=0.4)
    force = np.array(((0, 0, 0), (7.0, -2.0, 3.0)), dtype=float).T
    run.state.change('force', np.array((0, 1)), force)
    lowest = np.inf
    for _ in range(120):
        run.step()
        energy = run.energy() - (force * run.state.position[:, :2]).sum()
        assert energy < lowest + 1e-12
        lowest = min(lowest, energy)


def test_on_ice_bodies_that_push_each_other_keep_their_momentum():
    """A box that tips onto another without friction anywhere: sideways nothing may happen."""
    run = IslandRun([
        body('low', Box((1.0, 1.0, 0.5)), 2.0, position=(0, 0, 0.25), velocity=(0.4, 0.2, 0)),
        body('high', Box((2.0, 0.4, 0.2)), 1.0, position=(0.55, 0.1, 0.6),
             velocity=(0.4, 0.2, 0))], planes=[ground(material=Material(0, 0.0))],
        step=1 / 240, friction=0.0)
    spin = diagnostics.angular_momentum(run.world.bodies, run.state)[2]
    lowest = energy = run.energy()
    for _ in range(120):
        run.step()
        energy = run.energy()
        assert energy < lowest + 1e-12
        lowest = min(lowest, energy)
    np.testing.assert_allclose(diagnostics.momentum(run.world.bodies, run.state)[:2],
                               (1.2, 0.6), rtol=1e-13)
    # pushing overlaps out may move bodies sideways a little
    assert diagnostics.angular_momentum(run.world.bodies, run.state)[2] == pytest.approx(
        spin, abs=1e-6)
    assert np.abs(run.state.angular_velocity[:, 1]).max() > 0.1
