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

"""What the march relies on: every line stays above its minorant, in arrays and in floats."""

from flying import Flying

import numpy as np

import pytest

from rigid_sim_ros.engine.narrow_phase import PairGroups
from rigid_sim_ros.engine.narrow_phase.box_plane import VERTEX_SIGNS
from rigid_sim_ros.engine.narrow_phase.separating_axes import separating_axes
from rigid_sim_ros.engine.rotation import matrix
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.engine.time_of_impact.first_touch import PLAIN_LINES
from rigid_sim_ros.engine.time_of_impact.march import march
from rigid_sim_ros.engine.time_of_impact.pair_lines import NEVER, PairLines
from rigid_sim_ros.engine.time_of_impact.plain_lines import PlainBody
from rigid_sim_ros.engine.time_of_impact.plain_march import march_one

COUNT = 60
END = 3.0
GROUND = ((0.0, 0.6, 0.8), -1.0)


def shape_of(rng, kind):
    if kind == 'sphere':
        return Sphere(rng.uniform(0.2, 0.6))
    return Cube(rng.uniform(0.3, 1)) if rng.random() < 0.5 else Box(tuple(rng.uniform(0.1, 1, 3)))


def pairs_in_flight(kinds, seed=1):
    """Return `Flying`, its group of COUNT pairs of these kinds, apart at first, and the lines."""
    rng = np.random.default_rng(seed)
    planes = [GROUND] if kinds[1] == 'plane' else []
    count = COUNT * (2 - len(planes))
    shapes = [shape_of(rng, kind) for kind in kinds if kind != 'plane' for _ in range(COUNT)]
    position, velocity = rng.normal(size=(2, count, 3))
    if not planes:
        away = rng.normal(size=(COUNT, 3))
        away *= 2 / np.sqrt((away * away).sum(axis=1, keepdims=True))
        position[COUNT:] = position[:COUNT] + away
        velocity[:COUNT] += away
    torque = 0.1 * rng.normal(size=(count, 3)) * (rng.random((count, 1)) < 0.3)
    q = rng.normal(size=(count, 4))
    flying = Flying(
        shapes, planes, position=position, velocity=velocity, torque=torque,
        spin=2 * rng.normal(size=(count, 3)), acceleration=3 * rng.normal(size=(count, 3)),
        orientation=q / np.sqrt((q * q).sum(axis=1, keepdims=True)))
    a = np.arange(COUNT)
    b = np.full(COUNT, COUNT) if planes else a + COUNT
    group, = PairGroups(flying.bodies, a, b).groups
    return flying, group, PairLines(kinds, flying.flights, group.a, group.b, 0.0, END)


def heights_along(flying, group, normal, rate, now, later):
    """Return the heights (64, p) of all pairs of vertices at `now + later`, by definition."""
    index = np.concatenate((group.a.index, group.b.index))
    position, q, _, _ = flying.flights.motions(index, np.concatenate((now + later,) * 2))
    direction = normal + later * rate
    sides = []
    for part, side in ((slice(COUNT), group.a), (slice(COUNT, None), group.b)):
        local = VERTEX_SIGNS[:, :, np.newaxis] * side.half_extents[:, np.newaxis]
        world = (matrix(q[:, part])[:, :, np.newaxis] * local).sum(axis=1)
        vertices = world + position[:, part][:, np.newaxis]
        sides.append((direction[:, np.newaxis] * vertices).sum(axis=0))
    return (sides[1] - sides[0][:, np.newaxis]).reshape(64, COUNT)


@pytest.mark.parametrize('seed', range(3))
def test_heights_of_two_boxes_stay_above_their_minorants(seed):
    flying, group, lines = pairs_in_flight(('box', 'box'), seed)
    now = np.random.default_rng(seed).uniform(0, END / 2, COUNT)
    at = lines(np.arange(COUNT), now)
    index = np.concatenate((group.a.index, group.b.index))
    position, q, _, spin = flying.flights.motions(index, np.concatenate((now, now)))
    sides = [side.at(position[:, part], q[:, part]) for side, part in (
        (group.a, slice(COUNT)), (group.b, slice(COUNT, None)))]
    best = separating_axes(*sides).best()
    rate = best.rate(spin[:, :COUNT], spin[:, COUNT:])
    assert at.height == pytest.approx(
        heights_along(flying, group, best.normal, rate, now, np.zeros(COUNT)), abs=1e-14)
    for part in (1e-3, 0.1, 0.5, 1.0):
        later = part * np.minimum(at.limit, END - now)
        turning = heights_along(flying, group, best.normal, rate, now, later)
        minorant = at.height + at.speed * later - 0.5 * at.pull * later * later
        assert (turning > minorant - 1e-13).all()
        later = part * (END - now)
        held = heights_along(flying, group, best.normal, 0 * rate, now, later)
        minorant = at.height + at.held_speed * later - 0.5 * at.held_pull * later * later
        assert (held > minorant - 1e-13).all()
    # the speeds are those of differences, so that a minorant touches its line
    step = np.full(COUNT, 1e-6)
    change = (heights_along(flying, group, best.normal, rate, now, step)
              - heights_along(flying, group, best.normal, rate, now, -step)) / 2e-6
    assert at.speed == pytest.approx(change, abs=1e-8)


def test_bounds_are_not_wasteful():
    # the pull is at most what a vertex at the bounding radius can feel, and vertices come near
    _, group, lines = pairs_in_flight(('box', 'plane'))
    a, b = lines.sides(np.arange(COUNT), np.zeros(COUNT))
    normal, spin = b.solids.plane_normal, a.spin
    local = VERTEX_SIGNS[:, :, np.newaxis] * a.solids.half_extents[:, np.newaxis]
    arms = (matrix(a.solids.orientation)[:, :, np.newaxis] * local).sum(axis=1)
    turned = np.cross(spin[:, np.newaxis], arms, axis=0)
    pull = -(normal[:, np.newaxis] * np.cross(spin[:, np.newaxis], turned, axis=0)).sum(axis=0)
    bound = a.vertex_pull(np.cross(normal, spin, axis=0))
    share = (pull / bound).max(axis=0)
    assert (share <= 1).all()
    free = a.spin_change == 0
    assert share[free].max() > 0.8


@pytest.mark.parametrize('kinds', PLAIN_LINES)
def test_plain_floats_say_what_arrays_say(kinds):
    flying, group, lines = pairs_in_flight(kinds)
    time = np.random.default_rng(2).uniform(0, END / 2, COUNT)
    many = lines(np.arange(COUNT), time)
    for pair in range(COUNT):
        one, other = (PlainBody(flying.bodies, flying.flights, side.index.item(pair), 0.0, END)
                      for side in (group.a, group.b))
        others = (other,) if kinds[1] != 'plane' else GROUND
        heights, speeds, pulls, limit, held_speeds, held_pull, apart, scale = (
            PLAIN_LINES[kinds](one, *others, END)(time.item(pair)))
        assert heights == pytest.approx(many.height[:, pair], abs=1e-13)
        assert speeds == pytest.approx(many.speed[:, pair], abs=1e-12)
        shape = many.height.shape
        assert pulls == pytest.approx(np.broadcast_to(many.pull, shape)[:, pair], rel=1e-9)
        assert min(limit, NEVER) == pytest.approx(many.limit[pair], rel=1e-9)
        assert apart == pytest.approx(many.apart[pair], rel=1e-9)
        assert scale >= 0.3 * many.scale[pair]
        if held_speeds is not None:
            assert held_speeds() == pytest.approx(many.held_speed[:, pair], abs=1e-12)
            assert held_pull == pytest.approx(many.held_pull[pair], rel=1e-9)


@pytest.mark.parametrize('kinds', PLAIN_LINES)
@pytest.mark.parametrize('guarded', [False, True])
def test_one_by_one_the_march_ends_where_all_together_do(kinds, guarded):
    _, group, lines = pairs_in_flight(kinds)
    size = np.minimum(group.a.bounding_radius, group.b.bounding_radius)
    found, rest, _, _ = march(lines, size, np.zeros(COUNT), END, np.full(COUNT, guarded), 0)
    assert len(rest) == 0
    assert np.isfinite(found).sum() > 10

    def lines_of(pair):
        def one(time):
            at = lines(np.array([pair]), np.array([time]))
            held = at.held_speed is not None
            return (at.height[:, 0].tolist(), at.speed[:, 0].tolist(),
                    np.broadcast_to(at.pull, at.height.shape)[:, 0].tolist(), at.limit.item(),
                    at.held_speed[:, 0].tolist if held else None,
                    at.held_pull.item() if held else 0.0, at.apart.item(), at.scale.item())
        return one
    for pair in range(0, COUNT, 3):
        alone = march_one(lines_of(pair), size.item(pair), 0.0, END, [not guarded])
        assert alone == pytest.approx(found[pair], abs=1e-13)
