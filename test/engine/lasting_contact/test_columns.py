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

"""Columns that land side by side in one pile: each is solved to the end, and stands at once."""

from collections import Counter

from island_run import body, IslandRun

import numpy as np

import pytest

from rigid_sim_ros.engine.lasting_contact import Island
from rigid_sim_ros.engine.lasting_contact.pile import group_newton, pile_contacts
from rigid_sim_ros.engine.lasting_contact.pile.group_newton import GroupNewton, MOST_BODIES
from rigid_sim_ros.engine.shapes import Cube

EDGE, SPEED, GAP = 0.2, 1.0, 1e-4


def columns(count, height):
    """Return columns of cubes, one on the other at random, that fall onto the ground at 1 m/s."""
    random = np.random.default_rng(0)
    return IslandRun([
        body(f'cube_{column}_{level}', Cube(EDGE), velocity=(0.0, 0.0, -SPEED), position=(
            *(np.array((0.26 * column, 0.0)) + random.uniform(-0.02, 0.02, 2)),
            GAP + EDGE * (level + 0.5)))
        for column in range(count) for level in range(height)], friction=0.5)


def test_columns_stand_when_they_have_landed():
    """Nothing moves after the second step but by what the solver leaves, and that takes little."""
    run = columns(14, 10)
    run.run(2 / 240)
    for _ in range(4):
        run.step()
        assert np.abs(run.state.linear_velocity).max() < 1e-6
        assert np.abs(run.state.angular_velocity).max() < 1e-6
    # sixty in each of four steps would be those of the gradient alone, at 3e-2 m/s
    assert run.world.work.solver_iterations < 200


def test_a_column_is_not_solved_by_others():
    """One by itself lands as it does among others, to rounding."""
    among, alone = columns(14, 10), columns(1, 10)
    for run in (among, alone):
        run.run(3 / 240)
    np.testing.assert_allclose(among.state.position[:, :10], alone.state.position[:, :10],
                               atol=1e-9)


class Tries:
    """
    Groups of contacts Newton's method is tried for one by one: it fails for those not allowed.

    Whole steps of many groups together fail for these too, and do not count.
    """

    def __init__(self, monkeypatch, allowed=()):
        self.groups = []
        self._now, self._allowed = None, allowed
        factor, steps, alone = (
            GroupNewton._factor, group_newton.newton_steps, group_newton.newton_alone)

        def noted(newton, groups, places):
            self._now = groups
            return factor(newton, groups, places)

        def tried_together(*arguments):
            force, used = steps(*arguments)
            return force, np.where(np.isin(self._now, self._allowed), used, 0)

        def tried_alone(*arguments):
            self.groups.extend(self._now)
            return alone(*arguments) if self._now[0] in self._allowed else (None, 20)

        monkeypatch.setattr(GroupNewton, '_factor', noted)
        monkeypatch.setattr(group_newton, 'newton_steps', tried_together)
        monkeypatch.setattr(group_newton, 'newton_alone', tried_alone)


def test_newtons_method_is_given_up_where_it_does_not_pay(monkeypatch):
    """If it solves none it is tried for eight of fourteen columns, and for each less and less."""
    tries, solutions = Tries(monkeypatch), []
    solved = pile_contacts.PileContacts.solved

    def counted(contacts, *arguments):
        solutions.append(len(tries.groups))
        return solved(contacts, *arguments)

    monkeypatch.setattr(pile_contacts.PileContacts, 'solved', counted)
    run = columns(14, 10)
    run.run(3 / 240)
    assert solutions[1] == 8
    while len(solutions) < 20:
        run.step()
    assert set(Counter(tries.groups).values()) <= {3, 4}


def test_a_pile_that_is_made_anew_knows_whom_newtons_method_fails(monkeypatch):
    """Three columns are not tried again at once when their island has been found anew."""
    tries = Tries(monkeypatch)
    run = columns(3, 10)
    run.step()
    assert len(tries.groups) == 3
    before = run.island
    run.island = Island(run.world, before.members, before.pairs.pairs_a, before.pairs.pairs_b,
                        [before])
    run.step()
    assert len(tries.groups) == 3


@pytest.mark.parametrize('more', [0, 1])
def test_newtons_method_leaves_large_groups_alone(monkeypatch, more):
    """They are for the gradient."""
    tries = Tries(monkeypatch)
    columns(1, MOST_BODIES + more).run(2 / 240)
    assert bool(tries.groups) == (more == 0)


def test_newtons_method_goes_on_for_whom_it_pays(monkeypatch):
    """Four columns that it fails on do not keep it from ten others, which stand: 3e-2 if so."""
    tries = Tries(monkeypatch, allowed=range(10))
    run = columns(14, 10)
    run.run(8 / 240)
    assert 13 in tries.groups
    moving = np.abs(run.state.linear_velocity).max(axis=0)
    assert moving[100:140].max() > 1e-2
    assert moving[:100].max() < 1e-3


def test_columns_are_solved_together(monkeypatch):
    """Not one by one: nearly all of them by whole steps."""
    tries = Tries(monkeypatch, allowed=range(14))
    run = columns(14, 10)
    run.run(4 / 240)
    assert np.abs(run.state.linear_velocity).max() < 1e-6
    assert len(tries.groups) <= 2


def test_the_gradient_takes_no_notice_of_other_columns(monkeypatch):
    """Without Newton's method: the others move alike if one column slides."""
    Tries(monkeypatch)
    alike, other = columns(14, 10), columns(14, 10)
    other.state.linear_velocity[0, :10] = 0.5
    for run in (alike, other):
        run.step()
    assert np.abs((alike.state.linear_velocity - other.state.linear_velocity)[:, :10]).max() > 1e-4
    np.testing.assert_allclose(alike.state.linear_velocity[:, 10:],
                               other.state.linear_velocity[:, 10:], atol=1e-12)
