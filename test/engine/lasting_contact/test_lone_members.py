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
"""Those of many bodies that touch only what is fixed are told at once whether they stand."""

from math import cos, radians, sin, sqrt, tan

import numpy as np

import pytest

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.engine.lasting_contact.pile import groups
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.scene import load_scene

SLOPE = radians(25.0)
HALF = (0.1, 0.15, 0.2)

CROWD = 10
"""Makes enough of them that they are looked at together."""


def lying(number, shape, friction, height, slope=SLOPE, orientation=(0.0, 0.0, 0.0, 1.0), **held):
    """Return a body on a plane that falls along x, in a row across the slope."""
    turned = np.array((0.0, sin(slope / 2), 0.0, cos(slope / 2)))
    x, y, z, w = orientation
    about_y = turned[1], turned[3]
    place = (height * sin(slope), 1.0 * number, height * cos(slope))
    return Body(f'body_{number}', shape, 2.0, shape.inertia(2.0), position=place,
                orientation=(about_y[1] * x + about_y[0] * z, about_y[1] * y + about_y[0] * w,
                             about_y[1] * z - about_y[0] * x, about_y[1] * w - about_y[0] * y),
                material=Material(restitution=0.0, friction=friction), **held)


def on_slope(bodies, slope=SLOPE, friction=1.0):
    """Return the simulation of bodies on it after the first step."""
    plane = Plane('slope', (sin(slope), 0.0, cos(slope)), 0.0,
                  material=Material(restitution=0.0, friction=friction))
    simulation = Simulation(Scene(bodies=tuple(bodies), planes=(plane,)))
    simulation.advance(1 / 240)
    return simulation


def test_boxes_stand_on_a_slope_that_their_friction_holds():
    """A pair's friction is the geometric mean: it holds from the tangent of the slope on."""
    needed = tan(SLOPE) ** 2
    shares = np.array((0.5, 0.9, 0.999, 1.001, 1.1, 2.0) * CROWD)
    simulation = on_slope(lying(number, Box(tuple(2 * half for half in HALF)), needed * share,
                                HALF[2]) for number, share in enumerate(shares))
    np.testing.assert_array_equal(simulation.asleep, shares > 1)


def test_a_held_force_counts():
    """Level ground holds a push of up to the friction times the weight, in any direction."""
    shares = np.array((0.0, 0.5, 0.999, 1.001, 1.5) * CROWD)
    turns = 0.7 * np.arange(len(shares))
    limit = 0.4 * 2.0 * 9.81
    simulation = on_slope((lying(
        number, Box((0.4, 0.6, 0.2)), 0.16, 0.1, slope=0.0,
        force=(limit * share * cos(turn), limit * share * sin(turn), 0.0))
        for number, (share, turn) in enumerate(zip(shares, turns))), slope=0.0)
    np.testing.assert_array_equal(simulation.asleep, shares < 1)


@pytest.mark.parametrize('tilt, stands', [(0.0, True), (0.3, False), (-0.3, False)])
def test_who_leans_over_an_edge_falls(tilt, stands):
    """Slow or not: only straight above its lower edge is a cube balanced."""
    half = radians(45.0) / 2 + tilt / 2
    height = 0.1 * sqrt(2.0) * cos(tilt)
    simulation = on_slope((lying(number, Cube(0.2), 0.5, height, slope=0.0,
                                 orientation=(sin(half), 0.0, 0.0, cos(half)))
                           for number in range(5 * CROWD)), slope=0.0)
    assert (simulation.asleep == stands).all()


def test_balls_and_boxes_together():
    """Balls have a point each and roll down; boxes on the same slope stand."""
    simulation = on_slope(
        lying(number, *((Sphere(0.1), 1.0, 0.1) if number % 2 else (Cube(0.2), 1.0, 0.1)))
        for number in range(5 * CROWD))
    np.testing.assert_array_equal(simulation.asleep, np.arange(5 * CROWD) % 2 == 0)


def test_nobody_who_lies_flat_is_looked_at_alone(monkeypatch):
    """However many there are: what a group by itself takes is not asked for."""
    def refused(*_):
        pytest.fail('a group was looked at by itself')
    monkeypatch.setattr(groups, 'stands', refused)
    block = {'count': [6, 6, 1], 'spacing': [0.5, 0.5, 0.0]}
    simulation = Simulation(load_scene({
        'planes': [{'name': 'ground', 'normal': [0, 0, 1], 'offset': 0.0}],
        'bodies': [{'name': 'cube', 'cube': {'edge': 0.2}, 'mass': 1.0,
                    'position': [0.0, 0.0, 0.1], 'repeat': block}]}))
    simulation.advance(1 / 240)
    assert simulation.asleep.all()
