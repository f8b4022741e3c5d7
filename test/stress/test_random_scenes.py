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
"""Random scenes of few bodies: what fails is shrunk to the smallest scene that does."""

from hypothesis import given, Phase, settings, strategies as st
import numpy as np

import pytest

from rigid_sim_ros.engine.shapes import Box, Cube, Sphere

from stress_scenes import attitude, body, scene

from watching import cpu_limit, Watch

ENERGY = 1e-8
"""What energy may rise by in parts of its scale."""

ENERGY_OF_STACKS = 1e-4
"""The same of stacks, whose piles may leave overlaps that count as somebody else's."""

MOMENTUM = 1e-12
"""What momentum may change by where nothing external acts, in parts of what flies about."""

PENETRATION = 0.05
"""In parts of the thinnest body."""

SHAPES = (Cube(0.2), Box((0.1, 0.2, 0.3)), Sphere(0.1), Box((0.02, 0.2, 0.2)),
          Box((0.03, 0.03, 0.3)))

PHASES = Phase.generate, Phase.shrink
"""Without explaining, for which all lines of the engine would be traced."""

SPACING = 0.4
"""[m] between the places of bodies: none touch at the start."""

places = st.tuples(st.integers(0, 2), st.integers(0, 1), st.integers(0, 2))
seeds = st.integers(0, 1000)


@st.composite
def bodies(draw, count=8):
    """Return bodies on a grid above the ground: shape, mass, attitude and motion of each."""
    result = []
    for number, place in enumerate(draw(st.lists(places, min_size=1, max_size=count,
                                                 unique=True))):
        random = np.random.default_rng(draw(seeds))
        speed, spin = draw(st.sampled_from((0.0, 1.0, 10.0))), draw(st.sampled_from((0.0, 10.0)))
        result.append(body(
            f'body_{number}', draw(st.sampled_from(SHAPES)),
            SPACING * np.array(place) + (0, 0, 0.25), draw(st.sampled_from((1.0, 0.01, 100.0))),
            orientation=attitude(random) if draw(st.booleans()) else (0.0, 0.0, 0.0, 1.0),
            velocity=tuple((speed * random.normal(size=3)).tolist()),
            angular_velocity=tuple((spin * random.normal(size=3)).tolist())))
    return result


@st.composite
def scenes(draw):
    """Return (scene, step [s])."""
    free = draw(st.booleans())
    made = scene(draw(bodies()), restitution=draw(st.sampled_from((0.0, 0.5, 0.9))),
                 friction=draw(st.sampled_from((0.5, 0.0, 1.0))),
                 gravity=0.0 if free else draw(st.sampled_from((9.81, 1.0, 100.0))),
                 planes=not free, law=draw(st.sampled_from(('poisson', 'newton', 'stronge'))))
    return made, draw(st.sampled_from((1 / 240, 1 / 60, 1 / 1000)))


@st.composite
def stacks(draw):
    """Return (scene, step [s]) of stacks side by side that fall onto each other, askew."""
    random = np.random.default_rng(draw(seeds))
    shapes = draw(st.sampled_from(((Cube(0.2),), (Cube(0.2), Box((0.2, 0.14, 0.18)),
                                                  Sphere(0.1)))))
    ratio = draw(st.sampled_from((1.0, 10.0, 100.0)))
    result = []
    for place, height in enumerate(draw(st.lists(st.integers(1, 5), min_size=3, max_size=8))):
        for level in range(height):
            x, y, z = random.uniform((-0.03, -0.03, 0.0), (0.03, 0.03, 0.02))
            result.append(body(
                f'body_{place}_{level}', shapes[random.integers(len(shapes))],
                (0.32 * (place % 5) + x, 0.32 * (place // 5) + y, 0.11 + 0.235 * level + z),
                float(ratio ** random.uniform(-0.5, 0.5))))
    made = scene(result, restitution=draw(st.sampled_from((0.0, 0.5, 0.9, 1.0))),
                 friction=draw(st.sampled_from((0.5, 0.0, 0.2, 1.0))),
                 law=draw(st.sampled_from(('poisson', 'newton', 'stronge'))),
                 **draw(st.sampled_from((
                     {}, {'rolling_friction': 0.002, 'pivoting_friction': 0.002},
                     {'restitution_speed': 1.0}))))
    return made, draw(st.sampled_from((1 / 240, 1 / 100, 1 / 60)))


def check(case):
    """Simulate for half a second and look all the time."""
    made, step = case
    watch = Watch(made, step, max(step, 1 / 120))
    with cpu_limit(20):
        watch.run(0.5)
    assert watch.penetration < PENETRATION
    assert watch.energy_rise < ENERGY
    if watch.isolated:
        assert watch.momentum_change < MOMENTUM


@settings(max_examples=8, deadline=None, derandomize=True, database=None, phases=PHASES)
@given(scenes())
def test_a_few_random_scenes(case):
    """Finite, hardly any overlap, energy falls, momentum is kept where nothing acts."""
    check(case)


@pytest.mark.stress
@settings(max_examples=300, deadline=None, database=None, phases=PHASES)
@given(scenes())
def test_many_random_scenes(case):
    """The same of others each time; the failing scene is printed."""
    check(case)


@pytest.mark.stress
@settings(max_examples=20, deadline=None, database=None, phases=PHASES)
@given(stacks())
def test_many_stacks_at_random(case):
    """Finite, hardly any overlap; what has sunk in a pile may be lifted out when that is over."""
    made, step = case
    watch = Watch(made, step)
    with cpu_limit(180):
        watch.run(1.5)
    assert watch.penetration < PENETRATION
    assert watch.energy_rise < ENERGY_OF_STACKS
