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

"""What changes while a scene is simulated, as arrays with one column a body."""

from dataclasses import dataclass, fields

import numpy as np

from rigid_sim_ros.engine.bodies import names_of, ordered


@dataclass
class State:
    """
    Poses, velocities and held wrenches; n columns in the order of `bodies.Bodies`.

    Whoever changes a state puts new arrays in place of the old and never writes into them, so
    that what a caller was given stays as it was.
    """

    position: np.ndarray
    """(3, n) centres of mass [m], world axes."""

    orientation: np.ndarray
    """(4, n) unit quaternions x, y, z, w, body to world."""

    linear_velocity: np.ndarray
    """(3, n) [m/s], world axes."""

    angular_velocity: np.ndarray
    """(3, n) [rad/s], world axes."""

    force: np.ndarray
    """(3, n) held on the centre of mass besides gravity [N], world axes."""

    torque: np.ndarray
    """(3, n) held [N m], world axes."""

    def change(self, quantity, indices, values):
        """Give the columns `indices` (k,) of a quantity (a field's name) new values (., k)."""
        changed = getattr(self, quantity).copy()
        changed[:, indices] = values
        setattr(self, quantity, changed)


def state_of(scene):
    """Return the state a `model.Scene` starts with; planes are at the origin, at rest."""
    bodies = ordered(scene)
    plane_count = len(scene.planes)

    def columns(rows, plane):
        return np.array(rows + [plane] * plane_count, dtype=float).reshape(-1, len(plane)).T.copy()

    zero = (0.0, 0.0, 0.0)
    return State(
        position=columns([body.position for body in bodies], zero),
        orientation=columns([body.orientation for body in bodies], (0.0, 0.0, 0.0, 1.0)),
        linear_velocity=columns([_moving(body, body.velocity) for body in bodies], zero),
        angular_velocity=columns([_moving(body, body.angular_velocity) for body in bodies], zero),
        force=columns([_moving(body, body.force) for body in bodies], zero),
        torque=columns([_moving(body, body.torque) for body in bodies], zero))


def state_after(before, index, scene):
    """
    Return the state of a `model.Scene` that has come of another.

    Bodies that were there go on from the `State` before, in which `index` gives the column of
    each name; the others start as they are in the scene.
    """
    state = state_of(scene)
    names = names_of(scene)
    kept = [column for column, name in enumerate(names) if name in index]
    for field in fields(State):
        getattr(state, field.name)[:, kept] = (
            getattr(before, field.name)[:, [index[names[column]] for column in kept]])
    return state


def _moving(body, vector):
    """Return the vector, or zero for a fixed body: what is fixed has no motion."""
    return (0.0, 0.0, 0.0) if body.fixed else vector
