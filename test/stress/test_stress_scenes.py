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
"""Scenes far outside comfort: one row each, with what must hold."""

from dataclasses import replace
from typing import Callable, NamedTuple

import numpy as np

import pytest

from rigid_sim_ros.engine.shapes import Box, Cube, Sphere

import stress_scenes as scenes

from watching import cpu_limit, Watch

ENERGY = 1e-8
"""What energy may rise by, in parts of its scale."""

SPIN = 1e-5
"""What angular momentum may change by where nothing external acts: contacts in use for a while."""

MOMENTUM = 1e-13
"""What momentum may change by where nothing external acts, in parts of what flies about."""

ALL_STEPS = (1 / 30, 1 / 60, 1 / 240, 1 / 1000)


class Row(NamedTuple):
    """A scene and what must hold of it at any time, besides being finite."""

    name: str
    scene: Callable
    duration: float
    """[s]"""

    penetration: float
    """In parts of the thinnest moving body."""

    rests: bool = True
    """Whether all must sleep in the end."""

    steps: tuple = ALL_STEPS
    """[s]"""

    quick: tuple = ()
    """Those of them that are no stress."""

    limit: float = 60.0
    """CPU time [s]."""


ROWS = (
    Row('tower of 10', lambda: scenes.tower(10), 1, 1e-5, quick=(1 / 240,)),
    Row('tower of 20', lambda: scenes.tower(20), 1, 1e-5),
    Row('tower of 40', lambda: scenes.tower(40), 1, 1e-5, quick=(1 / 30,)),
    Row('crooked tower of 20', lambda: scenes.crooked_tower(20), 1, 1e-5, quick=(1 / 1000,)),
    Row('wall', scenes.wall, 2, 1e-3, quick=(1 / 240,)),
    Row('pyramid of 55', lambda: scenes.pyramid(10), 2, 1e-3, quick=(1 / 240,)),
    Row('house of cards', scenes.card_house, 2, 1e-3, quick=(1 / 240,)),
    Row('house of cards, three storeys', lambda: scenes.card_house(3), 2, 1e-3),
    Row('heavy on light', scenes.heavy_on_light, 1, 1e-5, quick=(1 / 60,)),
    Row('light between heavy', scenes.light_between_heavy, 3, 1e-5, quick=(1 / 240,)),
    Row('marble run', scenes.marble_run, 2, 1e-2, rests=False, steps=(1 / 30, 1 / 240)),
    Row('spinning cubes', lambda: scenes.spinning(shape=Cube(0.2)), 0.5, 1e-6, rests=False,
        steps=(1 / 30, 1 / 240)),
    Row('spinning balls', lambda: scenes.spinning(shape=Sphere(0.1)), 0.5, 1e-6, rests=False,
        quick=(1 / 240,)),
    Row('spinning boxes', lambda: scenes.spinning(shape=Box((0.1, 0.2, 0.3))), 0.5, 1e-6,
        rests=False, steps=(1 / 240,)),
    Row('spinning rods', lambda: scenes.spinning(shape=Box((0.002, 0.002, 0.2))), 0.7, 1e-6,
        rests=False, steps=(1 / 240,), limit=240),
    Row('shot at 100 m/s', lambda: scenes.shot(1e2), 0.5, 5e-3, rests=False, quick=(1 / 240,)),
    Row('shot at 10 km/s', lambda: scenes.shot(1e4), 0.1, 5e-3, rests=False),
    Row('colliding swarm of 8', lambda: scenes.swarm(8), 1, 5e-3, rests=False,
        quick=(1 / 240,)),
    Row('colliding swarm of 27', lambda: scenes.swarm(27), 1, 5e-3, rests=False),
    Row('a millimetre', lambda: scenes.two_thrown(1, 0.3, 0.5, edge=1e-3), 1, 1e-6,
        quick=(1 / 240,)),
    Row('a kilometre', lambda: scenes.two_thrown(1, 0.3, 0.5, edge=1e3), 200, 1e-6,
        steps=(1 / 30, 1 / 240)),
    Row('heap of millimetres', lambda: scenes.heap((2, 2, 2), edge=1e-3), 2, 5e-3),
    Row('heap of kilometres', lambda: scenes.heap((2, 2, 2), edge=1e3), 300, 5e-3,
        steps=(1 / 30,)),
    Row('no gravity', lambda: scenes.heap((2, 2, 2), gravity=0.0), 1, 1e-9, rests=False),
    Row('a thousandth of gravity', lambda: scenes.heap((2, 2, 2), gravity=0.01), 100, 5e-3,
        steps=(1 / 30,)),
    Row('ten times gravity', lambda: scenes.heap((2, 2, 2), gravity=100), 2, 5e-3,
        steps=(1 / 60, 1 / 240, 1 / 1000), quick=(1 / 240,)),
    Row('bouncing heap', lambda: scenes.heap((2, 2, 2), restitution=0.6), 4, 5e-3,
        steps=(1 / 240, 1 / 1000)),
    Row('heap in long steps', lambda: scenes.heap((2, 2, 2), seed=3), 4, 2e-2,
        steps=(1 / 30, 1 / 60), quick=(1 / 60,)),
    Row('slippery heap', lambda: scenes.heap((2, 2, 2), friction=0.0), 1, 5e-3, rests=False),
    Row('heap of 10', lambda: scenes.heap((2, 1, 5)), 8, 1.5e-3, steps=(1 / 240,)),
    Row('heap of 100', lambda: scenes.heap((5, 5, 4)), 8, 5e-3, steps=(1 / 240,), limit=180),
    Row('pile of 10', lambda: scenes.pile((2, 1, 5)), 8, 1.5e-3, steps=(1 / 240, 1 / 1000),
        quick=(1 / 240,)),
    Row('pile of 100', lambda: scenes.pile((5, 5, 4)), 8, 5e-3, steps=(1 / 60, 1 / 240, 1 / 1000),
        limit=120),
    Row('pile of 1000', lambda: scenes.pile((10, 10, 10)), 8, 5e-2, steps=(1 / 240,), limit=600),
)


def cases():
    """Return the rows with their steps, those that take long marked."""
    return [pytest.param(row, step, id=f'{row.name}-{round(1 / step)}',
                         marks=() if step in row.quick else pytest.mark.stress)
            for row in ROWS for step in row.steps]


@pytest.mark.parametrize('row, step', cases())
def test_scene(row, step):
    """Finite, hardly any overlap, no energy or momentum out of nothing, rest in the end."""
    watch = Watch(row.scene(), step)
    with cpu_limit(row.limit):
        rests = watch.run(row.duration, until_rest=True)
    assert watch.penetration < row.penetration
    assert watch.energy_rise < ENERGY
    assert rests or not row.rests
    if watch.isolated:
        assert watch.momentum_change < MOMENTUM
        assert watch.spin_change < SPIN


@pytest.mark.parametrize('depth', [0.001, 0.1, 0.5])
def test_overlap_at_the_start(depth):
    """Pushed apart at once: what that lifts is all the energy there is, and all come to rest."""
    count = 3
    watch = Watch(scenes.overlapping(depth, count))
    with cpu_limit(10):
        assert watch.run(3.0, until_rest=True)
    lifted = sum(0.2 * depth * (level + 1) for level in range(count))
    # of as many kilogrammes, in metres
    assert watch.energy_rise * watch.energy_scale < 1.001 * scenes.GRAVITY * lifted
    assert watch.simulation.penetration() < 1e-4 * 0.2


@pytest.mark.parametrize('steps', [100, pytest.param(10_000, marks=pytest.mark.stress)])
def test_tower_kept_awake(steps):
    """Five cubes under a ball that spins on top for ever, as nothing rubs: nothing creeps."""
    tower = scenes.tower(5)
    ball = scenes.body('ball', Sphere(0.1), (0, 0, 1.1), angular_velocity=(0.0, 0.0, 5.0),
                       material=tower.bodies[0].material)
    watch = Watch(replace(tower, bodies=(*tower.bodies, ball)))
    start = watch.simulation.position.copy()
    with cpu_limit(5.0 + steps * 2e-2):
        assert not watch.run(steps / 240)
    assert watch.simulation.work.contact_steps >= steps
    assert not watch.simulation.asleep.any()
    assert np.abs(watch.simulation.position - start).max() < 1e-9
    assert watch.penetration < 1e-9
    assert watch.energy_rise < ENERGY
