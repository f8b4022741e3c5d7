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

"""
Newton's method for many small contact problems of one shape, all in the same products of arrays.

It is the method of `newton`, one whole step of it: of columns that rest on each other nine in ten
take no more. What does, or goes astray, is left to the caller. Vectors of g problems of k contacts
are flat, (3gk,): normals, first, second tangents, each problem by problem.
"""

import numpy as np

from rigid_sim_ros.engine.solvers.canonical import COMPLIANCE, MAX_PASSES
from rigid_sim_ros.engine.solvers.contact_equations import ManyEquations
from rigid_sim_ros.engine.solvers.newton import rounding_of, SETTLED, STALLED
from rigid_sim_ros.engine.solvers.newton_systems import FactoredSystem

FINER = 1e-3
"""Of the tolerance: what is left of the compliance, as a pass takes off so much of it."""


def newton_together(factor, free, friction, force, tolerance):
    """
    Return (forces (3, g, k), which problems (g,) bool are solved).

    They are the canonical forces, or nearer to them than those to start from, as a rule.

    Parameters
    ----------
    factor : (3, g, k, n)
        The response of a problem, (3k, 3k), is factor @ factor.T.
    free, force : (3, g, k)
        As in `ContactProblem`; forces to start from.
    friction : (g, k)
        As in `ContactProblem`.
    tolerance : (g,)
        Of motion: what is left of the conditions and of the compliance.

    """
    problems = _Problems(factor, free, friction)
    try:
        whole, force, system, settled = problems.stepped(
            force.ravel(), np.maximum(tolerance, SETTLED * np.abs(free).max(axis=(0, 2))))
        reference, force, converged = problems.extrapolated(force, system, tolerance)
        residual, size = problems.residual(force, problems.motion(force, reference))
        solved = settled & converged & (size <= tolerance + problems.rounding(force))
        # the last digits, unseen
        force = (force - system.solve(residual)).reshape(free.shape)
    except np.linalg.LinAlgError:
        return force.reshape(free.shape), np.zeros(len(tolerance), dtype=bool)
    return np.where(solved[:, None], force, whole.reshape(free.shape)), solved


class _Problems:
    """The conditions of the problems with a compliance in every row; see `newton_together`."""

    def __init__(self, factor, free, friction):
        self._factor, self._transposed = factor, factor.swapaxes(-1, -2)
        self._free, self._shape = free.ravel(), free.shape
        diagonal = (factor * factor).sum(axis=3)
        self.compliance = COMPLIANCE * diagonal[0].mean(axis=1)[:, None]
        diagonal += self.compliance
        np.maximum(diagonal[1], diagonal[2], out=diagonal[1])
        diagonal[2] = diagonal[1]
        self._diagonal = diagonal
        self._equations = ManyEquations(
            1.0 / diagonal[:2].reshape(2, -1), friction.ravel(), np.zeros(friction.size),
            np.zeros((2, friction.size)))

    def motion(self, force, reference):
        """Return how all rows move, (3gk,), with a force and the compliance about a reference."""
        on_bodies = (self._transposed @ force.reshape(*self._shape, 1)).sum(axis=0)
        return self._free + (self._factor @ on_bodies).ravel() + self._complied(force - reference)

    def residual(self, force, motion):
        """Return what is left of the conditions, (3gk,), and its size (g,) in units of motion."""
        residual, _ = self._equations.residual(force, motion)
        return residual, np.sqrt(((residual.reshape(self._shape) * self._diagonal) ** 2).sum(
            axis=(0, 2)))

    def stepped(self, force, tolerance):
        """
        Return (force, force to the last digits, system, settled (g,) bool) after a step.

        Settled is what is solved by it: sticking and sliding are found.
        """
        motion = self.motion(force, 0.0)
        system = FactoredSystem(
            self._equations.derivatives(force, motion), self._factor, self.compliance)
        force = force - system.solve(self.residual(force, motion)[0])
        residual, size = self.residual(force, self.motion(force, 0.0))
        return (force, force - system.solve(residual), system,
                size <= tolerance + self.rounding(force))

    def extrapolated(self, force, system, tolerance):
        """
        Return (force before the last pass, force, which (g,) bool have come to an end).

        Passes are those of `newton.Newton._extrapolated`, from no reference, until none of what
        is left of the compliance counts.
        """
        change, size = force, self._largest(force)
        for _ in range(MAX_PASSES):
            change = system.solve(system.of_motion(self._complied(change)))
            reference, force = force, force + change
            before, size = size, self._largest(change)
            left = self.compliance[:, 0] * size
            if ((left <= FINER * tolerance) | (size > STALLED * before)).all():
                break
        return reference, force, left <= tolerance

    def rounding(self, force):
        """Return the residuals (g,) below which none gets."""
        return rounding_of(self._shape[2], self._diagonal.max(axis=(0, 2))) * self._largest(force)

    def _complied(self, force):
        """Return a force (3gk,) times the compliance of its problem."""
        return (self.compliance * force.reshape(self._shape)).ravel()

    def _largest(self, values):
        return np.abs(values.reshape(self._shape)).max(axis=(0, 2))
