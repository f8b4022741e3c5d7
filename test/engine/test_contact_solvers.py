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

"""The contact solvers: the conditions, the oracle, and the canonical choice of forces."""

from contact_oracle import oracle, violation

from hypothesis import given, settings, strategies as st

import numpy as np

import pytest

from rigid_sim_ros.engine.solvers import ContactProblem, solve
from rigid_sim_ros.engine.solvers.accelerated import accelerated, Cones
from rigid_sim_ros.engine.solvers.single import friction_under, solve_one

CORNERS = np.array([(x, y, -0.5) for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
"""The lower face of a unit cube, (4, 3) [m]."""


def cube_response(points):
    """Return J M^-1 (3k, 6) and response (3k, 3k) of a unit cube (1 kg, 1 m) at points (k, 3)."""
    count = len(points)
    jacobian = np.zeros((3, count, 6))
    for row, axis in enumerate(((0, 0, 1), (1, 0, 0), (0, 1, 0))):
        jacobian[row, :, :3] = axis
        jacobian[row, :, 3:] = np.cross(points, axis)
    jacobian = jacobian.reshape(3 * count, 6)
    return jacobian, jacobian @ np.diag((1, 1, 1, 6, 6, 6)) @ jacobian.T


def problem_of(points, linear, angular, friction, floor=None, slip=None):
    """Return the problem of a unit cube that meets fixed ground at points (k, 3)."""
    jacobian, response = cube_response(points)
    count = len(points)
    free = jacobian @ np.concatenate((linear, angular))
    friction = np.broadcast_to(np.asarray(friction, float), count).copy()
    floor = np.zeros(count) if floor is None else floor
    return ContactProblem(response, free, friction, floor,
                          np.zeros((2, count)) if slip is None else slip)


def solved(problem):
    """Return the force of a problem, having checked the conditions."""
    force = solve(problem).force
    assert violation(problem.response, problem.free, problem.friction, force,
                     problem.floor) < 1e-11
    return force


speeds = st.tuples(*[st.floats(-2, 2)] * 3)
frictions = st.sampled_from((0.0, 0.1, 0.3, 0.5, 0.9))


@settings(max_examples=150, deadline=None, derandomize=True)
@given(speeds, speeds, frictions)
def test_conditions_hold_for_a_face(linear, angular, friction):
    """Any motion of a cube whose face meets the ground: non-negative, in the cone, opposed."""
    linear = np.array(linear) - (0, 0, 2.5)
    solved(problem_of(CORNERS, linear, angular, friction))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(speeds, speeds, st.integers(2, 3), st.integers(0, 2 ** 32 - 1))
def test_conditions_hold_with_different_frictions_and_floors(linear, angular, count, seed):
    """Two or three points anywhere, each with its friction and least normal force."""
    random = np.random.default_rng(seed)
    points = random.uniform(-0.5, 0.5, (count, 3)) - (0, 0, 0.5)
    solved(problem_of(points, linear, angular, random.uniform(0, 0.6, count),
                      random.uniform(0, 0.3, count)))


@pytest.mark.parametrize('seed', range(6))
def test_agrees_with_the_oracle(seed):
    """
    The motion and the normal forces are those of a slow solver that shares no code.

    The corners are pressed hard enough to stay closed: the choice of forces does not depend on the
    compliance, much larger in the slow solver, if none changes its state while it is refined away.
    """
    random = np.random.default_rng(seed)
    problem = problem_of(CORNERS, random.normal(size=3) - (0, 0, 3), 0.2 * random.normal(size=3),
                         random.uniform(0, 0.8))
    force = solved(problem)
    expected = oracle(problem.response, problem.free, problem.friction)
    assert violation(problem.response, problem.free, problem.friction, expected) < 1e-11
    np.testing.assert_allclose(force[:4], expected[:4], atol=1e-9)
    np.testing.assert_allclose(problem.response @ force, problem.response @ expected, atol=1e-11)


def test_forces_do_not_depend_on_the_order_of_contacts():
    """Four corners landing, sliding and turning: each corner's force is its own in any order."""
    order = np.array((2, 0, 3, 1))
    first = solved(problem_of(CORNERS, (1.0, 0.3, -0.4), (0.1, -0.2, 3.0), 0.3))
    second = solved(problem_of(CORNERS[order], (1.0, 0.3, -0.4), (0.1, -0.2, 3.0), 0.3))
    np.testing.assert_allclose(second.reshape(3, 4), first.reshape(3, 4)[:, order], atol=1e-10)


def test_pressure_of_a_sliding_face_is_affine():
    """Four forces, three equations: the choice is c0 + c1 x + c2 y, a foundation's."""
    force = solved(problem_of(CORNERS, (1.0, 0.3, -0.4), (0.0, 0.0, 3.0), 0.2))
    assert (force[:4] > 0).all() and np.ptp(force[:4]) > 1e-3
    matrix = np.column_stack((np.ones(4), CORNERS[:, :2]))
    rest = np.linalg.lstsq(matrix, force[:4], rcond=None)[1]
    assert rest.item() < 1e-20


def test_known_sliding_is_obeyed():
    """Friction acts against the given direction with the whole of mu times the normal force."""
    slip = np.tile([[0.6], [0.8]], 4)
    problem = problem_of(CORNERS, (0, 0, -1.0), (0, 0, 0), 0.25, slip=slip)
    normal, first, second = solve(problem).force.reshape(3, 4)
    np.testing.assert_allclose(first, -0.25 * 0.6 * normal, rtol=1e-12)
    np.testing.assert_allclose(second, -0.25 * 0.8 * normal, rtol=1e-12)
    np.testing.assert_allclose(normal.sum(), 1.0, rtol=1e-12)


def test_a_guess_changes_nothing():
    """What a solver remembers saves time; the forces are those without it."""
    problem = problem_of(CORNERS, (1.0, 0.3, -0.4), (0.1, -0.2, 3.0), 0.3)
    force = solve(problem).force
    for guess in (force, 3 * force + 0.1, np.zeros(12)):
        np.testing.assert_allclose(solve(problem, guess).force, force, atol=1e-10)


def test_what_a_solution_gives_to_start_from_leaves_little_to_do():
    """The same problem again takes one linear system, and the force is the same."""
    problem = problem_of(CORNERS, (1.0, 0.3, -0.4), (0.1, -0.2, 3.0), 0.3)
    first = solve(problem)
    again = solve(problem, first.start)
    assert again.iterations == 1 < first.iterations
    np.testing.assert_allclose(again.force, first.force, atol=1e-10)


def test_projected_gradient_finds_the_motion():
    """The solver of piles meets the same motion, here with redundant contacts."""
    problem = problem_of(CORNERS, (1.0, 0.3, -0.4), (0.1, -0.2, 3.0), 0.3)
    step = 0.99 / np.linalg.eigvalsh(problem.response)[-1]
    force, _, residual = accelerated(
        problem.response.__matmul__, step, Cones(problem.friction), problem.free, np.zeros(12),
        1e-12, 2000)
    assert residual.max() < 1e-12
    assert violation(problem.response, problem.free, problem.friction, force) < 1e-9
    np.testing.assert_allclose(problem.response @ force,
                               problem.response @ solve(problem).force, atol=1e-7)


def test_projected_gradient_shortens_a_step_that_is_too_long():
    """A step far beyond the reciprocal of the largest eigenvalue is found out, not diverged on."""
    problem = problem_of(CORNERS, (1.0, 0.3, -0.4), (0.1, -0.2, 3.0), 0.3)
    step = 50 / np.linalg.eigvalsh(problem.response)[-1]
    force, _, residual = accelerated(
        problem.response.__matmul__, step, Cones(problem.friction), problem.free, np.zeros(12),
        1e-10, 2000)
    assert residual.max() < 1e-10
    assert violation(problem.response, problem.free, problem.friction, force) < 1e-8


def test_contacts_that_hardly_slide():
    """Two blocks of contacts at the edge of their cones: Newton's circles are broken."""
    random = np.random.default_rng(0)
    for _ in range(30):
        points = np.concatenate((CORNERS, CORNERS + 0.01 * random.normal(size=(4, 3))))
        linear = np.array((0.2999, 0.0, -1.0)) + 1e-6 * random.normal(size=3)
        problem = problem_of(points, linear, 1e-6 * random.normal(size=3), 0.3)
        force = solve(problem).force
        assert violation(problem.response, problem.free, problem.friction, force) < 1e-3


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.integers(0, 2 ** 32 - 1), st.floats(0, 3),
       st.one_of(st.just(0.0), st.floats(1e-9, 2)))
def test_one_contact(seed, friction, floor):
    """Any positive definite response, also with frictions at which a contact could jam."""
    random = np.random.default_rng(seed)
    factor = random.normal(size=(3, 6))
    response, free = factor @ factor.T, random.normal(size=3)
    force = np.array(solve_one(response[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]].tolist(),
                               free.tolist(), friction, floor))
    assert violation(response, free, np.array([friction]), force, floor) < 1e-10


def test_friction_under_a_load():
    """An isotropic response is stopped if it can be, and slowed by response * limit if not."""
    assert friction_under((2.0, 0.0, 2.0), 0.6, -0.8, 1.0) == pytest.approx((-0.3, 0.4))
    assert friction_under((2.0, 0.0, 2.0), 0.6, -0.8, 0.1) == pytest.approx((-0.06, 0.08))
