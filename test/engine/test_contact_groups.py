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

"""Groups of contacts that are solved side by side: each as if it were alone."""

import numpy as np

import pytest

from rigid_sim_ros.engine.lasting_contact.pile.group_newton import (
    GroupNewton, MOST_BODIES, newton_steps)
from rigid_sim_ros.engine.lasting_contact.pile.pile_rows import PointRows
from rigid_sim_ros.engine.solvers.accelerated import accelerated, Cones, largest_eigenvalue
from rigid_sim_ros.engine.solvers.accelerated_groups import (
    accelerated_groups, largest_eigenvalues)
from rigid_sim_ros.engine.solvers.blocks import Block, BlockRows
from rigid_sim_ros.engine.solvers.problem import ContactProblem

COUNTS = 4, 7, 2
"""Contacts of each group, all of one body with the ground."""

GROUPS = np.repeat(np.arange(3), COUNTS)


def random_rows(random, counts=COUNTS):
    """Return rows (3, 12, k) and slots (2, k): contacts of bodies with the ground, one a group."""
    count = sum(counts)
    rows = np.zeros((3, 12, count))
    rows[:, :6] = random.normal(size=(3, 6, count))
    rows[0, 2] = 3.0
    slots = np.stack((np.repeat(np.arange(len(counts)), counts), np.full(count, len(counts))))
    return rows, slots


class Problem:
    """Three groups of contacts at random that all press, with the solution of each by itself."""

    def __init__(self, seed):
        """See the class."""
        random = np.random.default_rng(seed)
        self.raw, self.slots = random_rows(random)
        self.rows = PointRows(self.raw, self.slots, 4)
        self.friction = random.uniform(0.2, 0.8, len(GROUPS))
        self.free = random.normal(size=(3, len(GROUPS)))
        self.free[0] -= 2.0
        self.step = np.array([0.9 / np.linalg.eigvalsh(self.response(group))[-1]
                              for group in range(3)])

    def factor(self, group):
        """Return the rows (3k, 6) of a group."""
        return self.raw[:, :6, group == GROUPS].transpose(0, 2, 1).reshape(-1, 6)

    def response(self, group):
        """Return what forces of a group move in it, (3k, 3k)."""
        return self.factor(group) @ self.factor(group).T

    def alone(self, group, tolerance, iterations, step=None):
        """Return (force (3, k), iterations, residual) of a group that is solved by itself."""
        which = group == GROUPS
        force, used, residual = accelerated(
            self.response(group).__matmul__, self.step[group] if step is None else step,
            Cones(self.friction[which]), self.free[:, which].ravel(), np.zeros(3 * which.sum()),
            tolerance, iterations)
        return force.reshape(3, -1), used, residual.max()

    def together(self, tolerance, iterations, step=None):
        """Return (force (3, k), iterations (g,), solved (g,)) of all groups at once."""
        force, used, solved = accelerated_groups(
            self.rows, Cones(self.friction), GROUPS, self.step if step is None else step,
            self.free.ravel(), np.zeros(3 * len(GROUPS)), np.asarray(tolerance),
            np.asarray(iterations))
        return force.reshape(3, -1), used, solved


def test_each_group_is_solved_as_if_alone():
    """The same iterations lead to the same forces, to rounding, whoever else there is."""
    for seed in range(20):
        problem = Problem(seed)
        tolerance = 1e-9, 1e-6, 1e-3
        force, used, solved = problem.together(tolerance, (2000, 2000, 2000))
        assert solved.all() and len(set(used)) > 1
        for group in range(3):
            alone, iterations, residual = problem.alone(group, tolerance[group], 2000)
            assert residual <= tolerance[group] and used[group] == iterations
            np.testing.assert_allclose(force[:, group == GROUPS], alone, atol=1e-8)


def test_a_group_stops_at_its_own_limit():
    """At the next test of convergence; what has no iterations keeps its force."""
    problem = Problem(1)
    force, used, solved = problem.together((0.0,) * 3, (30, 0, 8))
    assert used.tolist() == [32, 0, 8] and not solved.any()
    np.testing.assert_array_equal(force[:, GROUPS == 1], 0.0)
    np.testing.assert_allclose(force[:, GROUPS == 0], problem.alone(0, 0.0, 32)[0], atol=1e-10)
    np.testing.assert_allclose(force[:, GROUPS == 2], problem.alone(2, 0.0, 8)[0], atol=1e-10)


def test_a_step_that_is_too_long_is_shortened_for_its_group_alone():
    """The others go on as if nothing were."""
    problem = Problem(2)
    step = problem.step * (1.0, 40.0, 1.0)
    force, used, solved = problem.together((1e-9,) * 3, (3000,) * 3, step)
    assert solved.all()
    for group in range(3):
        alone, iterations, _ = problem.alone(group, 1e-9, 3000, step[group])
        assert used[group] == iterations
        np.testing.assert_allclose(force[:, group == GROUPS], alone, atol=1e-7)


def test_rows_of_some_contacts():
    """Both forms give the motion of those contacts that is left, as the dense matrix does."""
    random = np.random.default_rng(3)
    rows, slots = random_rows(random, (4, 4, 2))
    kept = np.repeat((True, False, True), (4, 4, 2))
    force = random.normal(size=(3, 6))
    full = np.zeros((3, 10))
    full[:, kept] = force
    points = PointRows(rows, slots, 4)
    expected = points.response(full.ravel()).reshape(3, -1)[:, kept].ravel()
    np.testing.assert_allclose(points.select(kept).response(force.ravel()), expected, atol=1e-12)
    blocks = []
    for first, pairs, room in ((0, 2, 4), (8, 1, 2)):
        part = slice(first, first + pairs * room)
        blocks.append(Block(
            slots[:, part][:, ::room].T,
            rows[:, :, part].reshape(3, 12, pairs, room).transpose(2, 0, 3, 1).reshape(
                pairs, 3 * room, 12), first))
    chosen = BlockRows(blocks, 4).select(kept)
    assert chosen.count == 6
    np.testing.assert_allclose(chosen.response(force.ravel()), expected, atol=1e-12)


def test_largest_eigenvalues_are_those_of_each_group():
    """As the power method has them for a group alone; a group without entries has none."""
    problem = Problem(4)
    start = np.random.default_rng(0).normal(size=24)
    sizes, vector = largest_eigenvalues(
        lambda velocity: problem.rows.momentum(problem.rows.motion(velocity)), start,
        np.repeat(np.arange(4), 6), 5, 60)
    for group in range(3):
        factor = problem.factor(group)
        part = slice(6 * group, 6 * group + 6)
        alone, direction = largest_eigenvalue((factor.T @ factor).__matmul__, start[part], 60)
        assert abs(sizes[group] - alone) < 1e-12 * alone
        np.testing.assert_allclose(vector[part], direction, atol=1e-12 * alone)
    assert (sizes[3:] == 0.0).all()


def column(height):
    """Return rows (3, k, 2, 6), slots, free motion (3, k) of unit cubes that fall in a column."""
    corners = np.array([(x, y, 0.0) for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    rows, slots = [], []
    for level in range(height):
        for corner in corners:
            # body a is below (for the lowest the ground, in the last slot), b above
            for axis in ((0, 0, 1.0), (1.0, 0, 0), (0, 1.0, 0)):
                rows.append([(*(-np.array(axis)),
                              *(-np.sqrt(6) * np.cross(corner + (0, 0, 0.5), axis))),
                             (*axis, *(np.sqrt(6) * np.cross(corner - (0, 0, 0.5), axis)))])
            slots.append((level - 1 if level else height, level))
    rows = np.array(rows).reshape(-1, 3, 2, 6).transpose(1, 0, 2, 3)
    rows[:, :4, 0] = 0.0
    free = np.zeros((3, 4 * height))
    free[0, :4] = -1.0
    return rows, np.array(slots).T, free


def groups_of(heights, random):
    """Return (`GroupNewton`, free motion, forces close by) of columns, points in random order."""
    columns = [column(height) for height in heights]
    members, slots, body_groups = sum(heights), [], []
    for group, (height, (_, of_column, _)) in enumerate(zip(heights, columns)):
        first = sum(heights[:group])
        slots.append(np.where(of_column == height, members, of_column + first))
        body_groups += height * [group]
    rows, free = (np.concatenate(parts, axis=1) for parts in list(zip(*columns))[::2])
    groups = np.repeat(np.arange(len(heights)), [4 * height for height in heights])
    order = random.permutation(len(groups))
    newton = GroupNewton(rows[:, order], np.concatenate(slots, axis=1)[:, order], groups[order],
                         np.array([*body_groups, len(heights)]), np.full(len(groups), 0.5))
    near = np.zeros_like(free)
    near[0] = 1.0
    return newton, free[:, order], near, groups[order]


@pytest.mark.parametrize('heights', [(MOST_BODIES,), (3, 3), (2, 5, 2, 5, 2, 1)])
def test_columns_are_solved_by_newtons_method(heights):
    """The lowest contacts hold the whole column, those above what is above them: momentum."""
    newton, free, forces, groups = groups_of(heights, np.random.default_rng(0))
    used, solved = newton.solve(free, forces, np.full(len(heights), 1e-10))
    assert solved.all() and (used > 0).all()
    for group, height in enumerate(heights):
        held = np.sort(forces[0, groups == group])
        np.testing.assert_allclose(held, np.repeat(np.arange(1, height + 1), 4) / 4, rtol=1e-8)
    np.testing.assert_allclose(forces[1:], 0.0, atol=1e-8)


@pytest.mark.parametrize('seed', range(5))
def test_whole_steps_solve_what_they_say(seed):
    """Of problems at random they find a quarter, to the tolerance in each of the conditions."""
    random = np.random.default_rng(seed)
    count, points = 40, 4
    factor = random.normal(size=(3, count, points, 9))
    free, friction = random.normal(size=(3, count, points)), random.uniform(0, 1, (count, points))
    free[0] -= 1.0
    force, used = newton_steps(factor, free, friction, np.zeros_like(free), np.full(count, 1e-9))
    assert 4 * np.count_nonzero(used) >= count
    for one in np.flatnonzero(used):
        rows = factor[:, one].reshape(3 * points, -1)
        problem = ContactProblem(rows @ rows.T, free[:, one].ravel(), friction[one],
                                 np.zeros(points), np.zeros((2, points)))
        found = force[:, one].ravel()
        left = problem.residual(found, problem.free + problem.response @ found)
        assert np.abs(left).max() < 1e-9


def test_what_whole_steps_leave_is_found_alone():
    """Of problems at random most."""
    random = np.random.default_rng(0)
    tried = found = 0
    for _ in range(10):
        rows, slots = random.normal(size=(3, 8, 2, 6)), np.repeat(((0, 1), (2, 2)), 4, axis=1)
        rows[:, :, 1] = 0.0
        newton = GroupNewton(rows, slots, np.repeat((0, 1), 4), np.array((0, 1, 2)),
                             random.uniform(0, 1, 8))
        free = random.normal(size=(3, 8)) - np.array(((1,), (0,), (0,)))
        used, solved = newton.solve(free, np.zeros((3, 8)), np.full(2, 1e-8))
        assert (used > 0).all()
        tried, found = tried + 2, found + solved.sum()
    assert found > 0.6 * tried
