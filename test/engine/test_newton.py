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

"""What Newton's method is made of: equations in two ways, linear systems in two ways."""

import numpy as np

import pytest

from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.narrow_phase import find_contacts
from rigid_sim_ros.engine.shapes import Cube
from rigid_sim_ros.engine.solvers import contact_rows, ContactProblem, solve
from rigid_sim_ros.engine.solvers.contact_equations import FewEquations, ManyEquations
from rigid_sim_ros.engine.solvers.newton_systems import DenseSystem, FactoredSystem
from rigid_sim_ros.engine.solvers.single import slide_one
from rigid_sim_ros.engine.state import state_of

COUNT = 20


def arguments(random):
    """Return steps, friction, floor and slip of contacts, some with a floor, some sliding."""
    slip = random.normal(size=(2, COUNT))
    slip = slip / np.linalg.norm(slip, axis=0) * (random.random(COUNT) < 0.3)
    floor = random.uniform(0, 0.5, COUNT) * (random.random(COUNT) < 0.3)
    return random.uniform(0.5, 2, (2, COUNT)), random.uniform(0, 1, COUNT), floor, slip


@pytest.mark.parametrize('seed', range(5))
def test_equations_in_arrays_are_those_in_floats(seed):
    """Residuals, derivatives and size of contacts that are open, stick, slide or are known to."""
    random = np.random.default_rng(seed)
    given = arguments(random)
    few, many = FewEquations(*given), ManyEquations(*given)
    force, motion = random.normal(size=(2, 3 * COUNT))
    for found, expected in zip(
            (*many.residual(force, motion), *many.derivatives(force, motion)),
            (*few.residual(force, motion), *few.derivatives(force, motion))):
        np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize('seed', range(5))
def test_derivatives_are_those_of_the_residual(seed):
    """Against central differences of the residual, along a random direction of force."""
    random = np.random.default_rng(seed)
    equations = FewEquations(*arguments(random))
    factor = random.normal(size=(3 * COUNT, 12))
    matrix = factor @ factor.T + 0.1 * np.eye(3 * COUNT)
    free, force, direction = random.normal(size=(3, 3 * COUNT))

    def residual(force):
        return equations.residual(force, free + matrix @ force)[0]

    system = DenseSystem(equations.derivatives(force, free + matrix @ force), matrix)
    change = (residual(force + 1e-7 * direction) - residual(force - 1e-7 * direction)) / 2e-7
    # a large system is solved the first time and inverted the second
    for _ in range(3):
        np.testing.assert_allclose(system.solve(change), direction, rtol=1e-5, atol=1e-5)


def test_systems_of_contacts_that_all_stick():
    """No row depends on any other by itself: the system is the response, each row scaled."""
    random = np.random.default_rng(0)
    steps, _, floor, _ = arguments(random)
    equations = FewEquations(steps, np.full(COUNT, 1e3), 0 * floor, np.zeros((2, COUNT)))
    factor = random.normal(size=(3 * COUNT, 12))
    matrix, residual = factor @ factor.T + 1e-2 * np.eye(3 * COUNT), random.normal(size=3 * COUNT)
    force = np.concatenate((np.full(COUNT, 50.0), np.zeros(2 * COUNT)))
    derivatives = equations.derivatives(force, random.normal(size=3 * COUNT))
    expected = np.linalg.solve(matrix, residual / steps[[0, 1, 1]].ravel())
    for system in (DenseSystem(derivatives, matrix),
                   FactoredSystem(derivatives, factor.reshape(3, COUNT, 12), 1e-2)):
        np.testing.assert_allclose(system.solve(residual), expected, rtol=1e-8)


@pytest.mark.parametrize('seed', range(5))
def test_factored_systems_are_dense_ones(seed):
    """The formula of Woodbury against the inverse of the whole matrix."""
    random = np.random.default_rng(seed)
    derivatives = FewEquations(*arguments(random)).derivatives(
        *random.normal(size=(2, 3 * COUNT)))
    factor, compliance = random.normal(size=(3 * COUNT, 12)), 1e-2
    dense = DenseSystem(derivatives, factor @ factor.T + compliance * np.eye(3 * COUNT))
    factored = FactoredSystem(derivatives, factor.reshape(3, COUNT, 12), compliance)
    residual = random.normal(size=3 * COUNT)
    # solved the first time, by the inverse the second
    for _ in range(2):
        np.testing.assert_allclose(factored.solve(residual), dense.solve(residual), rtol=1e-9)
    np.testing.assert_allclose(factored.of_motion(residual), dense.of_motion(residual),
                               rtol=1e-14, atol=1e-15)


def test_factored_systems_together_are_those_alone():
    """Two problems of four contacts each, with compliances of their own."""
    random = np.random.default_rng(0)
    shape = 3, 2, 4
    steps, friction = random.uniform(0.5, 2, (2, 8)), random.uniform(0, 1, 8)
    force, motion, residual = random.normal(size=(3, *shape))
    factor, compliance = random.normal(size=(*shape, 6)), np.array([[1e-2], [3e-2]])

    def derivatives(part):
        places = np.arange(8).reshape(2, 4)[part].ravel()
        equations = ManyEquations(steps[:, places], friction[places], np.zeros(len(places)),
                                  np.zeros((2, len(places))))
        return equations.derivatives(force[:, part].ravel(), motion[:, part].ravel())

    together = FactoredSystem(derivatives(slice(None)), factor, compliance)
    for one in range(2):
        alone = FactoredSystem(derivatives(one), factor[:, one], compliance[one].item())
        for method in ('solve', 'of_motion', 'solve'):
            np.testing.assert_allclose(
                getattr(together, method)(residual.ravel()).reshape(shape)[:, one].ravel(),
                getattr(alone, method)(residual[:, one].ravel()), rtol=1e-10)


def test_forces_in_a_tower():
    """Ten cubes: at every level each of four corners holds a quarter of what is above it."""
    levels, gravity = 10, 9.81
    shape = Cube(0.2)
    scene = Scene(tuple(Body(f'c{level}', shape, 1.0, shape.inertia(1.0),
                             position=(0, 0, 0.1 + 0.2 * level)) for level in range(levels)),
                  (Plane('ground'),))
    bodies, state = bodies_of(scene), state_of(scene)
    below = [levels, *range(levels - 1)]
    contacts = find_contacts(bodies, np.array(below), np.arange(levels), state.position,
                             state.orientation, 1e-6)
    assert contacts.count == 4 * levels
    rows = contact_rows(bodies, contacts, state.position, state.orientation)
    pull = np.zeros((3, bodies.count))
    pull[2, :levels] = -gravity
    count = contacts.count
    problem = ContactProblem(rows.response(), rows.motion(pull, np.zeros_like(pull)),
                             np.full(count, 0.5), np.zeros(count), np.zeros((2, count)),
                             rows.scaled)
    normal, first, second = solve(problem).force.reshape(3, -1)
    above = levels - np.minimum(contacts.body_a % levels, contacts.body_b % levels) - 1
    above = np.where(np.maximum(contacts.body_a, contacts.body_b) == levels, levels, above)
    np.testing.assert_allclose(normal, gravity * above / 4, rtol=1e-9)
    np.testing.assert_allclose((first, second), 0, atol=1e-9)


def test_one_contact_that_slides_along_a_known_direction():
    """The normal force ends the approach with all of its friction, or none does."""
    response = 2.0, 0.5, -0.25, 1.5, 0.1, 1.2
    normal, first, second = slide_one(response, -1.0, 0.4, (0.6, 0.8))
    assert (first, second) == pytest.approx((-0.24 * normal, -0.32 * normal))
    assert 2.0 * normal + 0.5 * first - 0.25 * second == pytest.approx(1.0)
    assert slide_one(response, 0.1, 0.4, (0.6, 0.8)) == (0.0, 0.0, 0.0)
    # friction 10 along +n1 presses the contact together by more than the normal force parts it
    assert slide_one(response, -1.0, 10.0, (1.0, 0.0)) is None


def test_what_sticks_without_friction_needs_no_division():
    """A contact pressed hard that has no reason to slide: no overflow, which users would see."""
    equations = ManyEquations(np.ones((2, 1)), np.array([0.5]), np.zeros(1), np.zeros((2, 1)))
    with np.errstate(all='raise'):
        derivatives = equations.derivatives(np.array([10.0, 0.0, 0.0]), np.zeros(3))
    assert all(np.isfinite(each).all() for each in derivatives)
