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

"""Overlaps at the start are found, all of them, and touching bodies are let through."""

from math import sqrt

import numpy as np
import pytest
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.shapes import Sphere
from rigid_sim_ros.scene import load_scene, overlap, SceneError
from rigid_sim_ros.scene.overlap import deepest_overlap

CUBE = {'cube': {'edge': 0.2}, 'mass': 1}
ON_EDGE = {'rpy': [0, 0, np.pi / 4]}


def pair(gap, first=CUBE, second=CUBE, **changes):
    """Load two bodies, `gap` apart along x from centre to centre."""
    return load_scene({'bodies': [{'name': 'a', **first},
                                  {'name': 'b', **second, 'position': [gap, 0, 0], **changes}]})


@pytest.mark.parametrize('touching, changes', [
    (0.2, {}),
    # a vertical edge ahead: half a diagonal
    (0.1 + 0.1 * sqrt(2), ON_EDGE),
    (0.1 + 0.5, {'second': {'sphere': {'radius': 0.5}, 'mass': 1}}),
    (0.3 + 0.5, {'first': {'sphere': {'radius': 0.3}, 'mass': 1},
                 'second': {'sphere': {'radius': 0.5}, 'mass': 1}}),
    (0.1 + 2, {'second': {'box': {'size': [4, 1, 1]}, 'fixed': True}}),
])
def test_bodies_touch_or_overlap(touching, changes):
    pair(touching, **changes)
    pair(touching - 0.9e-4, **changes)      # the tolerance: 1e-3 of the smaller half side, 0.1 m
    smallest = 0.3e-3 if 'first' in changes else 1e-4
    with pytest.raises(SceneError, match=f"'a'.*overlaps 'b' by 0.05 m.* {smallest:g} m is"):
        pair(touching - 0.05, **changes)


def test_crossed_edges_are_apart_where_faces_and_boxes_around_are_not():
    # two cubes on an edge each, the edges crossed and above each other: only the product of the
    # edges separates them, by the height less two half diagonals
    height = 0.2 * sqrt(2)
    low = {'name': 'low', **CUBE, 'rpy': [np.pi / 4, 0, 0]}
    high = {'name': 'high', **CUBE, 'rpy': [0, np.pi / 4, 0]}
    load_scene({'bodies': [low, {**high, 'position': [0, 0, height + 1e-9]}]})
    with pytest.raises(SceneError, match='by 0.01 m'):
        load_scene({'bodies': [low, {**high, 'position': [0, 0, height - 0.01]}]})


def test_planes():
    plane = {'name': 'slope', 'normal': [0.6, 0, 0.8], 'offset': 1.0}

    def place(distance, **changes):
        position = (np.array(plane['normal']) * (1.0 + distance)).tolist()
        return load_scene({'planes': [plane],
                           'bodies': [{'name': 'a', **CUBE, 'position': position, **changes}]})

    # the reach of a cube along a direction is the sum of its components times the half side
    reach = 0.1 * (0.6 + 0.8)
    place(reach)
    with pytest.raises(SceneError, match="'a'.*overlaps 'slope' by 0.03 m"):
        place(reach - 0.03)
    place(-5, fixed=True)


def test_fixed_bodies_may_overlap_each_other_but_not_moving_ones():
    wall = {'cube': {'edge': 2}, 'fixed': True}
    pair(0.5, first=wall, second=wall)
    with pytest.raises(SceneError, match="'b'.*overlaps 'a'|'a'.*overlaps 'b'"):
        pair(0.5, second=wall)


@pytest.mark.parametrize('chunk', [1, 7, 200_000])
@pytest.mark.parametrize('seed', range(10))
def test_the_sweep_misses_no_pair(monkeypatch, chunk, seed):
    """Balls of very different sizes: the distance of their centres tells everything."""
    monkeypatch.setattr(overlap, 'CHUNK', chunk)
    random = np.random.default_rng(seed)
    count = 60
    radius = 10 ** random.uniform(-3, -0.5, count)
    position = random.uniform(-1, 1, (count, 3)) * random.permutation([1, 1, 0.3])
    fixed = random.random(count) < 0.3
    distance = np.linalg.norm(position[:, None] - position, axis=2)
    depth = radius[:, None] + radius - distance
    overlapping = np.triu(depth > 1e-3 * np.minimum(radius[:, None], radius), 1)
    overlapping &= ~(fixed[:, None] & fixed)

    bodies = [Body(f'{index}', Sphere(radius[index]), 1.0, (1.0,) * 3,
                   tuple(position[index].tolist()), fixed=bool(fixed[index]))
              for index in range(count)]
    # take bodies out, one of each pair found, until none is found: none may then be left
    left = dict(enumerate(bodies))
    while True:
        found = deepest_overlap(Scene(bodies=tuple(left.values())))
        if found is None:
            break
        a, b = sorted(int(name) for name in found[:2])
        assert overlapping[a, b]
        assert found[2] == pytest.approx(depth[a, b], rel=1e-12)
        del left[a]
    keep = list(left)
    assert not overlapping[np.ix_(keep, keep)].any()
    assert overlapping.any()


def test_nothing_to_overlap():
    assert deepest_overlap(Scene(planes=(Plane('p'),))) is None
    ball = Body('a', Sphere(1.0), 1.0, (0.4,) * 3)
    assert deepest_overlap(Scene(bodies=(ball,))) is None
