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

"""How far a simulated toss is from the measured one."""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.benchmark.trajectories import angles_between


@dataclass(frozen=True)
class Score:
    """Errors of one toss, means over its samples."""

    position_percent: float
    """Distance of the centres, % of the cube's width."""

    rotation_degrees: float
    """Angle between the attitudes."""

    right_face: bool
    """Whether the face that is up at the end is the measured one."""


def score(toss, position, orientation):
    """Return the `Score` of poses, (k, 3) and (k, 4), at the k sample times of a toss."""
    distance = np.linalg.norm(position - toss.position, axis=1)
    angle = angles_between(orientation, toss.orientation)
    return Score(position_percent=float(distance.mean() / toss.edge * 100),
                 rotation_degrees=float(np.degrees(angle.mean())),
                 right_face=upper_face(orientation[-1]) == upper_face(toss.orientation[-1]))


def upper_face(orientation):
    """Return the body axis that points up most, 0 to 2, and whether its positive end does."""
    x, y, z, w = orientation
    up = np.array([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)])
    axis = int(np.abs(up).argmax())
    return axis, bool(up[axis] > 0)


def summary(scores):
    """Return the means over tosses: position [%], rotation [degrees], right faces [%]."""
    rows = np.array([(row.position_percent, row.rotation_degrees, 100.0 * row.right_face)
                     for row in scores])
    return tuple(rows.mean(axis=0))
