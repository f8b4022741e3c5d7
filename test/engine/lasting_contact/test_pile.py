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

"""Piles: towers stand, heaps come to rest, and nothing is made of nothing."""

from math import cos, pi, sqrt

from island_run import body, GRAVITY, ground, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine import diagnostics
from rigid_sim_ros.engine.lasting_contact.motion import Motion
from rigid_sim_ros.engine.lasting_contact.pile.budget import Budget, SAVED
from rigid_sim_ros.engine.lasting_contact.pile.energy import kept_part, rebound_part
from rigid_sim_ros.engine.lasting_contact.pile.memory import Impulses, Quiet
from rigid_sim_ros.engine.lasting_contact.pile.patience import newton_pays, Patience, WAITS
from rigid_sim_ros.engine.lasting_contact.pile.pile_rows import PointRows
from rigid_sim_ros.engine.model import Material
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.engine.solvers.blocks import Block, BlockRows


def tower(count, edge=0.2, offset=0.0, friction=0.5, **values):
    """Return a tower of cubes, each shifted at random by at most `offset` [m]."""
    random = np.random.default_rng(1)
    return IslandRun([
        body(f'cube_{level}', Cube(edge), position=(*(offset * random.uniform(-1, 1, 2)),
                                                    edge * (level + 0.5)))
        for level in range(count)], friction=friction, **values)


def heap(seed, **values):
    """Return eight tumbled cubes in two layers just above the ground."""
    random = np.random.default_rng(seed)
    bodies = []
    for x in (0, 1):
        for y in (0, 1):
            for z in (0, 1):
                turn = random.normal(size=4)
                bodies.append(body(f'c{x}{y}{z}', Cube(0.2),
                                   position=(0.36 * x, 0.36 * y, 0.2 + 0.36 * z),
                                   orientation=tuple(turn / np.linalg.norm(turn))))
    return IslandRun(bodies, **values)


def test_aligned_tower_stands_still():
    """Ten cubes: nothing moves by more than the overlap that is allowed, and all rest."""
    run = tower(10)
    start = run.state.position.copy()
    assert run.run_to_rest(1.0) is not None
    assert np.abs(run.state.position - start).max() < 1e-4


def test_offset_tower_stands():
    """Shifted by up to a tenth of an edge: it stands, and hardly creeps."""
    run = tower(8, offset=0.02)
    start = run.state.position.copy()
    assert run.run_to_rest(1.0) is not None
    assert np.abs(run.state.position - start).max() < 2e-4


def test_a_light_cube_between_heavy_ones():
    """Mass ratios of a thousand, hit from above: hardly any overlap, all at rest."""
    run = IslandRun([body('low', Cube(0.2), 100.0, position=(0, 0, 0.1)),
                     body('light', Cube(0.2), 0.1, position=(0, 0, 0.3)),
                     body('high', Cube(0.2), 100.0, position=(0, 0, 0.5)),
                     body('hit', Cube(0.2), 10.0, position=(0.02, 0.03, 0.7))],
                    restitution=0.0, friction=0.5)
    deepest = 0.0
    while run.time < 2.0 and not run.step().resting.all():
        deepest = max(deepest, diagnostics.penetration(run.world.bodies, run.state))
    assert run.time < 2.0
    assert deepest < 1e-6


@pytest.mark.parametrize('restitution', [0.0, 0.5])
def test_heap_comes_to_rest(restitution):
    """Energy only falls; little overlaps at any time."""
    run = heap(1, restitution=restitution, friction=0.5)
    energy, rise, deepest = run.energy(), 0.0, 0.0
    while run.time < 6:
        resting = run.step().resting.all()
        deepest = max(deepest, diagnostics.penetration(run.world.bodies, run.state))
        energy, before = run.energy(), energy
        rise = max(rise, energy - before)
        if resting:
            break
    assert resting
    assert rise < 1e-12 * GRAVITY * 0.2
    assert deepest < 2e-3 * 0.2


def test_contact_forces_keep_momenta():
    """Eight cubes thrown together in free space: momentum to rounding, spin to first order."""
    random = np.random.default_rng(3)
    run = heap(2, restitution=0.3, friction=0.4, gravity=(0.0, 0.0, 0.0), planes=[])
    state = run.state
    towards = np.array((0.18, 0.18, 0.38))[:, None] - state.position
    state.linear_velocity = 3 * towards
    state.angular_velocity = random.normal(size=towards.shape)
    before = (diagnostics.momentum(run.world.bodies, state),
              diagnostics.angular_momentum(run.world.bodies, state))
    run.run(0.3)
    np.testing.assert_allclose(diagnostics.momentum(run.world.bodies, state), before[0],
                               atol=1e-12)
    np.testing.assert_allclose(diagnostics.angular_momentum(run.world.bodies, state), before[1],
                               atol=5e-3)


def sliding_row(step, slope=0.0, duration=0.3):
    """Return a run of eight touching cubes that slide side by side at 2 m/s, and how far."""
    run = IslandRun([body(f'c{i}', Cube(0.2), position=(0.2 * i, 0, 0.1), velocity=(2, 0, 0))
                     for i in range(8)], friction=0.4, step=step,
                    gravity=(GRAVITY * np.sin(slope), 0.0, -GRAVITY * np.cos(slope)))
    start = run.state.position.copy()
    run.run(duration)
    return run, (run.state.position - start)[:, :8]


@pytest.mark.parametrize('rate', [60, 240])
def test_row_slides_down_a_slope(rate):
    """Eight touching cubes go as one does, g (sin - mu cos): parabolas whatever the step."""
    slope, duration = 0.3, 0.3
    run, way = sliding_row(1 / rate, slope, duration)
    pull = GRAVITY * (np.sin(slope) - 0.4 * np.cos(slope))
    np.testing.assert_allclose(way[0], 2 * duration + pull * duration ** 2 / 2, rtol=1e-8)
    np.testing.assert_allclose(run.state.linear_velocity[0, :8], 2 + pull * duration, rtol=1e-7)
    assert np.abs(way[1:]).max() < 1e-7


def test_sliding_row_stops_where_friction_takes_it():
    """v^2 / (2 mu g): what is wrong is the step in which it stops, of second order."""
    errors = []
    for rate in (60, 240):
        _, way = sliding_row(1 / rate, duration=0.6)
        errors.append(np.abs(way[0] - 4 / (2 * 0.4 * GRAVITY)).max())
    # in the step it stops in, a row goes wrong by mu g h^2 / 8 at most
    assert errors[0] < 0.4 * GRAVITY / 60 ** 2 / 8 + 1e-6
    assert errors[1] < 0.4 * GRAVITY / 240 ** 2 / 8 + 1e-6


@pytest.mark.parametrize('rate', [60, 240])
def test_many_balls_roll_on_a_pushed_plate(rate):
    """A plate on smooth ground is pushed: balls on it roll at 2/7 of its acceleration."""
    rough, radius = Material(0.0, 1.0), 0.1
    balls = [body(f'b{x}{y}', Sphere(radius), 1.0, position=(0.3 * x, 0.3 * y, 0.3),
                  material=rough) for x in range(3) for y in range(3)]
    plate = body('plate', Box((3.0, 3.0, 0.2)), 10.0, position=(0.3, 0.3, 0.1),
                 force=(30.0, 0.0, 0.0), material=rough)
    run = IslandRun([*balls, plate], [ground(material=Material(0.0, 0.0))], step=1 / rate)
    start, duration = run.state.position.copy(), 0.5
    run.run(duration)
    # m a = F on a ball, and F r = 2/5 m r^2 (A - a) / r; M A = 30 - 9 F on the plate
    acceleration = 30 / (10 + 9 * 2 / 7) * np.array([2 / 7] * 9 + [1.0])
    state = run.state
    np.testing.assert_allclose(state.linear_velocity[0, :10], duration * acceleration, rtol=1e-6)
    np.testing.assert_allclose((state.position - start)[0, :10],
                               duration ** 2 / 2 * acceleration, rtol=2e-6)
    # backwards as seen from the plate
    angle = 2 * np.arctan2(state.orientation[1, :9], state.orientation[3, :9])
    np.testing.assert_allclose(
        angle, -duration ** 2 / 2 * (acceleration[9] - acceleration[0]) / radius, rtol=2e-6)


def test_a_push_on_top_of_a_tower_moves_nothing_below():
    friction, force, duration = 0.3, 0.4 * GRAVITY, 0.1
    run = tower(10, friction=friction)
    run.run(0.5)
    run.state.force[0, 9] = force
    run.island.disturb(np.array([9]))
    run.run(duration)
    velocity = run.state.linear_velocity[0, :10]
    # friction on the one below does not overturn the rest: 1.8 m of lever against 0.1 m
    assert 1.8 * friction < 9 * 0.1
    assert velocity[9] == pytest.approx((force - friction * GRAVITY) * duration, rel=1e-5)
    assert abs(velocity[:9]).max() < 2e-5


@pytest.mark.parametrize('step', [0.01, 1 / 240])
def test_a_torque_tips_the_top_of_a_tower_about_its_edge(step):
    edge, duration = 0.2, 0.1
    torque = 1.5 * GRAVITY * edge / 2
    run = tower(9, edge, friction=0.9, step=step)
    run.state.torque[1, 8] = torque
    run.run(duration)
    # 2/3 m a^2 turning about an edge, which gravity has a lever to of a/2 and less; by Euler's
    # method in steps so small that it is off by 1e-5
    angle = rate = 0.0
    for _ in range(100_000):
        lever = edge / sqrt(2) * cos(pi / 4 + angle)
        rate += duration / 100_000 * (torque - GRAVITY * lever) / (2 / 3 * edge * edge)
        angle += duration / 100_000 * rate
    assert run.state.angular_velocity[1, 8] == pytest.approx(rate, rel=0.01)
    assert 2 * np.arctan2(*run.state.orientation[[1, 3], 8]) == pytest.approx(angle, rel=0.01)


@pytest.mark.parametrize('restitution', [0.0, 0.5, 1.0])
def test_a_ball_hits_a_row_as_one_body(restitution):
    """On smooth ground: all that touch are compressed together, and only the hit rebounds."""
    count, speed, step = 8, 3.0, 1 / 240
    row = [body(f'c{place}', Cube(0.2), position=(0.2 * place, 0.0, 0.1))
           for place in range(count)]
    ball = body('ball', Sphere(0.1), position=(-0.2 - 4.5 * speed * step, 0.0, 0.1),
                velocity=(speed, 0.0, 0.0))
    run = IslandRun([*row, ball], restitution=restitution, friction=0.0)
    run.run(20 * step)
    together = speed * (1 + restitution) / (count + 1)
    expected = [together] * count + [speed - count * together]
    np.testing.assert_allclose(run.state.linear_velocity[0, :count + 1], expected,
                               atol=1e-3 * speed)


@pytest.mark.parametrize('restitution', [0.0, 0.5])
def test_a_long_row_takes_a_hit_to_its_far_end(restitution):
    """30 cubes on smooth ground: all go on at what momentum and restitution say."""
    count, speed, step = 30, 2.0, 1 / 240
    row = [body(f'c{place}', Cube(0.2), position=(0.2 * place, 0.0, 0.1))
           for place in range(count)]
    hitter = body('hitter', Cube(0.2), position=(-0.2 - 9.5 * speed * step, 0.0, 0.1),
                  velocity=(speed, 0.0, 0.0))
    run = IslandRun([*row, hitter], restitution=restitution, friction=0.0)
    run.run(16 * step)
    together = speed * (1 + restitution) / (count + 1)
    expected = [together] * count + [speed - count * together]
    np.testing.assert_allclose(run.state.linear_velocity[0, :count + 1], expected, rtol=1e-4)


def test_friction_holds_a_long_row_that_is_pushed():
    """By nine tenths of what all 30 together withstand: nothing moves by a nanometre."""
    count, friction = 30, 0.5
    run = IslandRun([body(f'c{place}', Cube(0.2), position=(0.2 * place, 0.0, 0.1))
                     for place in range(count)], friction=friction)
    run.state.force[0, 0] = 0.9 * friction * count * GRAVITY
    start = run.state.position.copy()
    assert run.run_to_rest(2.0) is not None
    assert np.abs(run.state.position - start).max() < 1e-9


def test_what_quiet_steps_leave_is_there_for_others():
    """Iterations: saved up to a limit, spent down to none, handed on to the next pile."""
    budget = Budget([])
    assert budget.saved == SAVED
    budget.spend(np.array((10, SAVED + 100)), np.array((60, 60)))
    assert budget.saved == 0
    budget.spend(np.array((10,)), np.array((60,)))
    assert budget.saved == 50
    assert Budget([budget, Budget([budget])]).saved == 50
    budget.spend(np.array((0,)), np.array((2 * SAVED,)))
    assert budget.saved == SAVED


def test_newtons_method_waits_for_whom_it_fails():
    """Ever longer if it does so again and again, whatever group they are in; not for others."""
    groups, first_failed = np.array((0, 1, 1, 2)), np.array((False, True))
    tried = np.array((True, True))
    patience = Patience(np.array((3, 5, 7, 9)))
    for waits in (*WAITS[1:], WAITS[-1]):
        patience.note(groups, tried, ~first_failed)
        for _ in range(waits):
            assert patience.allows(groups, 2).tolist() == [True, False]
            later = Patience(np.array((5, 8)))
            later.take_over(patience)
            assert later.allows(np.array((0, 1)), 2).tolist() == [False, True]
            patience.note(groups, ~tried, ~tried)
        assert patience.allows(groups, 2).all()
    patience.note(groups, tried, tried)
    patience.note(groups, tried, ~first_failed)
    patience.note(groups, ~tried, ~tried)
    assert patience.allows(groups, 2).all()
    assert newton_pays(7, 0) and newton_pays(8, 6) and not newton_pays(8, 5)


@pytest.mark.parametrize('share', [(1.0, 1.0, 1.0), (0.5, 0.5, 1.0), (0.5, 0.5, 0.5)])
def test_impulses_that_have_not_converged_add_no_energy(share):
    """The energy of a step from v, by kick and change: made as far as it does not rise."""
    before, kick, share = np.array((1.0, 0.0, -2.0)), np.array((0.0, 0.1, -0.1)), np.array(share)

    def rise(change):
        """Return the kinetic energy gained less what the kick's potential loses on the way."""
        after = before + kick + change
        passing = before + share * (kick + change)
        return 0.5 * (after @ after - before @ before) - kick @ passing

    for change in (-0.5 * before, -4.0 * before, 0.1 * before):
        part, lost = kept_part(before, kick, change, share)
        assert rise(part * change) == pytest.approx(-lost, abs=1e-14)
        assert part == 1.0 or lost < 1e-14 < rise(change)
    assert kept_part(before, kick, -0.5 * before, share)[0] == 1.0
    part = rebound_part(before, before, 1.0)
    assert 0.5 * ((1 + part) ** 2 - 1) * (before @ before) == pytest.approx(1.0, rel=1e-14)
    assert rebound_part(before, -before, 0.0) == 1.0


def test_blocks_multiply_as_a_matrix_does():
    """Products by blocks against the dense Jacobian, for pairs of different sizes."""
    random = np.random.default_rng(0)
    slots = 4
    blocks, dense = [], []
    start = 0
    for room, pairs in ((1, 2), (4, 3)):
        bodies = np.array([random.permutation(slots)[:2] for _ in range(pairs)])
        rows = random.normal(size=(pairs, 3 * room, 12))
        blocks.append(Block(bodies, rows, start))
        full = np.zeros((3, pairs * room, 6 * slots))
        for pair, (a, b) in enumerate(bodies):
            part = rows[pair].reshape(3, room, 12)
            full[:, pair * room:(pair + 1) * room, 6 * a:6 * a + 6] = part[..., :6]
            full[:, pair * room:(pair + 1) * room, 6 * b:6 * b + 6] = part[..., 6:]
        dense.append(full)
        start += pairs * room
    matrix = np.concatenate(dense, axis=1).reshape(-1, 6 * slots)
    product = BlockRows(blocks, slots)
    velocity, force = random.normal(size=6 * slots), random.normal(size=len(matrix))
    np.testing.assert_allclose(product.motion(velocity), matrix @ velocity, atol=1e-12)
    np.testing.assert_allclose(product.momentum(force), matrix.T @ force, atol=1e-12)
    np.testing.assert_allclose(product.response(force), matrix @ (matrix.T @ force), atol=1e-11)


def test_contacts_by_themselves_multiply_as_a_matrix_does():
    """Products by contact against the dense Jacobian; one body has several, one does not move."""
    random = np.random.default_rng(0)
    slots = np.array([(0, 1, 1, 2, 3), (1, 2, 2, 3, 0)])
    rows = random.normal(size=(3, 12, 5))
    matrix = np.zeros((3, 5, 4, 6))
    for contact, (a, b) in enumerate(slots.T):
        matrix[:, contact, a] = rows[:, :6, contact]
        matrix[:, contact, b] = rows[:, 6:, contact]
    matrix = matrix.reshape(15, 24)
    product = PointRows(rows, slots, 4)
    velocity, force = random.normal(size=24), random.normal(size=15)
    np.testing.assert_allclose(product.motion(velocity), matrix @ velocity, atol=1e-12)
    np.testing.assert_allclose(product.momentum(force), matrix.T @ force, atol=1e-12)
    np.testing.assert_allclose(product.response(force), matrix @ (matrix.T @ force), atol=1e-11)


def test_impulses_are_found_again():
    """By pair and place: what moved a little is known, what is far or of another pair is not."""
    points = np.array([(0, 0, 0), (1, 0, 0), (5, 5, 5.0)]).T
    old = Impulses(np.array((7, 7, 3)), points, np.diag((1.0, 2.0, 3.0)))
    found = old.at(np.array((7, 3, 3, 9)),
                   np.array([(0.95, 0, 0), (5, 5, 5.05), (0, 0, 0), (0, 0, 0)]).T, 0.1)
    np.testing.assert_array_equal(found, np.array([(0, 2, 0), (0, 0, 3), (0,) * 3, (0,) * 3]).T)


def test_quiet_bodies_are_timed():
    """A tremor does not count, a move does; what is known outlives the island."""
    def at(x):
        return Motion(np.array([(0.0, x)] * 3), np.array([(0.0, 0)] * 3 + [(1.0, 1)]),
                      np.zeros((3, 2)), np.zeros((3, 2)))

    radius = np.ones(2)
    quiet = Quiet(np.array((4, 6)))
    assert quiet.durations(1.0, at(0.0), radius, 0.01).tolist() == [0.0, 0.0]
    assert quiet.durations(2.0, at(0.001), radius, 0.01).tolist() == [1.0, 1.0]
    younger = Quiet(np.array((6, 4)))
    younger.take_over(quiet)
    assert younger.durations(3.0, at(0.0), radius, 0.01).tolist() == [2.0, 2.0]
    assert younger.durations(4.0, at(0.5), radius, 0.01).tolist() == [3.0, 0.0]


def test_a_slab_on_very_many_posts_stands():
    """Eight cubes on a slab on 169 fixed ones: few bodies, and more contacts than fit at once."""
    posts = [body(f'post_{x}_{y}', Cube(0.2), position=(0.3 * x, 0.3 * y, 0.1), fixed=True)
             for x in range(13) for y in range(13)]
    slab = body('slab', Box((3.9, 3.9, 0.2)), 50.0, position=(1.8, 1.8, 0.3))
    cubes = [body(f'cube_{place}', Cube(0.2), position=(0.8 + 0.25 * place, 1.8, 0.5),
                  velocity=(0.0, 0.5, 0.0)) for place in range(8)]
    run = IslandRun([slab, *cubes, *posts], friction=0.5)
    run.run(3 / 240)
    assert run.state.position[2, 0] == pytest.approx(0.3, abs=1e-9)
