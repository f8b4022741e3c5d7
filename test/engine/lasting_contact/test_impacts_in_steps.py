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

"""Impacts in the steps of few bodies: none is missed, and each is at its instant."""

from dataclasses import replace
from math import radians

from island_run import body, GRAVITY, ground, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.lasting_contact.arrival import dipping_time, meeting_time
from rigid_sim_ros.engine.lasting_contact.step import first_half, Limits
from rigid_sim_ros.engine.model import Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere

STEP = 1 / 60
ELASTIC = Material(restitution=1.0, friction=0.0)


@pytest.mark.parametrize('degrees', (60, 80, 95, 110, 130, 150, 175))
def test_what_dips_in_and_out_again_has_hit(degrees):
    """
    A rod that turns over a plane, and would be out of it at the end of the step, hits it.

    A wall within reach keeps it from being alone with the plane. Between its one impact and the
    end of the step it flies: the same by formula is the reference.
    """
    rod = body('rod', Box((0.3, 0.03, 0.03)), position=(0.0, 0.0, 0.1), material=ELASTIC,
               angular_velocity=(0.0, radians(degrees) / STEP, 0.0))
    planes = (ground(material=ELASTIC),
              Plane('wall', normal=(-1.0, 0.0, 0.0), offset=-0.2, material=ELASTIC))
    run = IslandRun([rod], planes, step=STEP, gravity=(0.0, 0.0, 0.0))
    flown = Simulation(Scene((rod,), planes, (0.0, 0.0, 0.0)), max_step=STEP)
    run.step()
    flown.advance(STEP)
    assert flown.work.impacts == run.world.work.impacts == 1
    assert np.abs(run.state.position[:, 0] - flown.position[0]).max() < 1e-9
    assert np.abs(run.state.linear_velocity[:, 0] - flown.linear_velocity[0]).max() < 1e-9


def test_what_touches_softly_hides_no_arrival():
    """A cube that touches from the start does not say when another one lands."""
    fall, gap, step = (0.0, 0.0, -1.0), 1e-3, 0.01
    run = IslandRun([body('low', Cube(0.2), position=(0.0, 0.0, 0.1), velocity=fall),
                     body('high', Cube(0.2), position=(0.5, 0.0, 0.1 + gap), velocity=fall)],
                    step=step, gravity=(0.0, 0.0, -1e-9))
    island = run.island
    free, motion = island.free_motion(run.state), island.gather(run.state)
    limits = Limits.of(island.scales(free), step)
    trial = first_half(free, motion, island.near(motion, limits.margin(step)), step, limits)
    end = trial.end()
    contacts = island.find_contacts(end, 0.0)
    low, high = (np.flatnonzero(contacts.body_a == index).tolist() for index in (0, 1))
    assert len(low) == len(high) == 4
    assert meeting_time(trial, end, contacts, low + high, 1e-12) == pytest.approx(gap, rel=1e-6)
    assert meeting_time(trial, end, contacts, low, 1e-12) is None
    parting = np.ones(contacts.count)
    assert dipping_time(trial, end, contacts, low, parting, 1e-12, np.float64(0.0)) is None


def test_what_slows_down_hits_when_it_arrives():
    """A ball that rises to a ceiling, slowed by gravity all the step, hits at once."""
    speed, gap = 2 * GRAVITY * STEP, 1e-8
    ball = body('ball', Sphere(0.1), position=(0.1, 0.0, -0.1 - gap), velocity=(0.0, 0.0, speed))
    planes = (Plane('ceiling', normal=(0.0, 0.0, -1.0)), Plane('wall', normal=(1.0, 0.0, 0.0)))
    run = IslandRun([replace(ball, material=ELASTIC)],
                    [replace(plane, material=ELASTIC) for plane in planes], step=STEP)
    run.step()
    first, = run.world.events.take()
    assert first['time'] == pytest.approx(gap / speed, rel=1e-6)


@pytest.mark.parametrize('seed', range(12))
def test_throws_fly_as_by_formula(seed):
    """
    Elastic cubes thrown hard on the ground, turning fast after: the same as by impacts in flight.

    In long steps, in which many hit twice.
    """
    random = np.random.default_rng(seed)
    attitude, spin = random.normal(size=4), random.normal(size=3)
    cube = body('cube', Cube(0.2), position=(0.0, 0.0, 0.22), material=ELASTIC,
                orientation=tuple(attitude / np.linalg.norm(attitude)),
                velocity=(0.0, 0.0, -10.0), angular_velocity=tuple(10.0 * spin))
    planes = (ground(material=ELASTIC),
              Plane('wall', normal=(-1.0, 0.0, 0.0), offset=-0.25, material=ELASTIC))
    run = IslandRun([cube], planes, step=STEP)
    flown = Simulation(Scene((cube,), planes[:1], (0.0, 0.0, -GRAVITY)), max_step=STEP)
    for _ in range(3):
        run.step()
        flown.advance(STEP)
    assert flown.work.impacts
    assert np.abs(run.state.position[:, 0] - flown.position[0]).max() < 1e-7


@pytest.mark.parametrize('angle', (1e-2, 1e-4, 1e-6))
@pytest.mark.parametrize('spin', ((0.0, 0.5, 0.0), (0.5, 0.0, 0.0), (0.1, 0.2, 0.3)))
def test_edges_all_but_parallel_move_nothing(angle, spin):
    """
    What edges nearly along each other say of how their normal turns is not followed.

    Two cubes pass each other without contact, corner to corner: they fall freely.
    """
    axis = np.sin(0.5 * angle) * np.array([1.0, 0.0, 1.0]) / 2 ** 0.5
    place = np.array([0.203, 0.0, 0.203])
    still = body('still', Cube(0.2))
    passing = body('passing', Cube(0.2), position=tuple(place), angular_velocity=spin,
                   orientation=(*axis.tolist(), float(np.cos(0.5 * angle))),
                   velocity=(0.1, 0.0, 0.0))
    run = IslandRun([still, passing], (), step=0.01, friction=0.5)
    run.step()
    fall = np.array([0.1, 0.0, -GRAVITY * 0.01])
    assert np.abs(run.state.linear_velocity[:, 1] - fall).max() < 1e-12
    assert np.abs(run.state.angular_velocity[:, 1] - spin).max() < 1e-12
