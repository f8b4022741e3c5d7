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

"""What an engine did: poses and velocities at chosen times."""

from dataclasses import dataclass

import numpy as np
from rigid_sim_ros.engine import rotation


@dataclass(frozen=True)
class Trajectory:
    """Readings of the n moving bodies at k times, the start not among them."""

    times: np.ndarray
    """(k,) [s]."""

    position: np.ndarray
    """(k, n, 3) [m]."""

    orientation: np.ndarray
    """(k, n, 4) x, y, z, w."""

    linear_velocity: np.ndarray
    """(k, n, 3) [m/s]."""

    angular_velocity: np.ndarray
    """(k, n, 3) [rad/s], world axes."""

    asleep: np.ndarray
    """(n,) bool, at the end."""


def record(engine, times):
    """Advance a built engine through increasing times [s]; return its `Trajectory`."""
    rows = []
    now = 0.0
    for time in times:
        engine.advance(time - now)
        now = time
        rows.append(tuple(np.array(part, dtype=float)
                          for part in (*engine.read_poses(), *engine.read_velocities())))
    return Trajectory(np.array(times), *(np.array(part) for part in zip(*rows)),
                      asleep=np.array(engine.asleep(), dtype=bool))


def fault(trajectory, scene, reach):
    """
    Return why a trajectory is no result, or None: not finite, flown away, or through a plane.

    A body has flown away when it is further than `reach` [m] from where the scene put any body,
    and through a plane when its centre of mass is.
    """
    numbers = (trajectory.position, trajectory.orientation, trajectory.linear_velocity,
               trajectory.angular_velocity)
    if not all(np.isfinite(part).all() for part in numbers):
        return 'not finite'
    start = np.array([body.position for body in scene.bodies])
    outside = np.maximum(trajectory.position - start.max(axis=0),
                         start.min(axis=0) - trajectory.position)
    if outside.max() > reach:
        return f'blew up: a body is {outside.max():.3g} m away'
    for plane in scene.planes:
        height = trajectory.position @ np.array(plane.normal) - plane.offset
        if height.min() < 0:
            return f'a body went through {plane.name}'
    return None


def angles_between(p, q):
    """Return the angles [rad] between unit quaternions (..., 4), accurate also when tiny."""
    p, q = np.broadcast_arrays(p, q)
    return rotation.angle_between(np.moveaxis(p, -1, 0), np.moveaxis(q, -1, 0))
