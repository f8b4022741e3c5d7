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

"""Problems of cubes that fall on the ground and bounce."""

from functools import lru_cache
from math import sqrt

import numpy as np

from rigid_sim_ros.benchmark.problems.problem import (
    cube, frames, frames_near, largest, Problem, scene)
from rigid_sim_ros.benchmark.trajectories import angles_between

EDGE, HALF = 0.2, 0.1
GRAVITY = 9.81
DROP = 1.0
"""[m] below the cube at the start."""

FALL = sqrt(2 * DROP / GRAVITY)
"""[s]"""

UNTURNED = np.array([0.0, 0.0, 0.0, 1.0])


def drop_scene(restitution):
    """Return a cube that falls flat."""
    return scene([cube('cube', (0, 0, HALF + DROP))], restitution=restitution)


def apexes(restitution, count):
    """Return the times [s] and the heights above rest [m] of the apexes after each bounce."""
    times, heights = [], []
    time, factor = FALL, 1.0
    for _ in range(count):
        factor *= restitution
        times.append(time + FALL * factor)
        heights.append(DROP * factor * factor)
        time += 2 * FALL * factor
    return np.array(times), np.array(heights)


def rest_time(restitution):
    """Return when [s] a cube dropped flat has come to rest: t (1 + e) / (1 - e)."""
    return FALL * (1 + restitution) / (1 - restitution)


def drop_errors(restitution, count, rest_frames=0):
    """Return the measure of the apexes, by parabolas through three readings of each."""
    expected_times, expected_heights = apexes(restitution, count)

    def measure(trajectory):
        flight = slice(0, 3 * count)
        times = trajectory.times[flight].reshape(count, 3)
        heights = trajectory.position[flight, 0, 2].reshape(count, 3) - HALF
        instants, tops = parabola_tops(times, heights)
        result = {
            'apex_height_error_relative': largest(tops / expected_heights - 1),
            'apex_time_error_s': largest(instants - expected_times),
            'tilt_rad': largest(angles_between(trajectory.orientation, UNTURNED))}
        if rest_frames:
            result['motion_after_rest_m'] = largest(
                trajectory.position[-rest_frames:, 0, 2] - HALF)
        return result
    return measure


def parabola_tops(times, heights):
    """Return times and heights of the tops of parabolas through three points each, (n, 3)."""
    first, second, third = heights.T
    before, after = times[:, 0] - times[:, 1], times[:, 2] - times[:, 1]
    slope_before, slope_after = (first - second) / before, (third - second) / after
    curvature = (slope_after - slope_before) / (after - before)
    slope = slope_before - curvature * before
    with np.errstate(divide='ignore', invalid='ignore'):
        # through three points on a line there is no top, and no number either
        offset = -slope / (2 * curvature)
        return times[:, 1] + offset, second + slope * offset / 2


TUMBLE = {'height': 0.6, 'spin': (3.0, 5.0, 2.0), 'velocity': (0.25, 0.125, 0.0)}


def tumble_scene():
    """Return a tumbling cube above a plane without friction, e = 1."""
    return scene([cube('cube', (0, 0, TUMBLE['height']), edge=EDGE, velocity=TUMBLE['velocity'],
                       angular_velocity=TUMBLE['spin'])], restitution=1.0, friction=0.0)


@lru_cache(maxsize=1)
def tumble_reference(times):
    """Return positions (k, 3) and rotation matrices (k, 3, 3) of the bouncing cube."""
    # here, as mpmath is only needed for this
    from rigid_sim_ros.benchmark.references.bouncing import BouncingCube
    flight = BouncingCube(edge=EDGE, mass=1.0, gravity=GRAVITY, restitution=1.0, **TUMBLE)
    poses = []
    impact, _ = flight.next_impact()
    for time in times:
        while impact < time:
            flight.bounce()
            impact, _ = flight.next_impact()
        poses.append(flight.pose_at(time))
    return tuple(np.array(part) for part in zip(*poses))


def tumble_errors(trajectory):
    """Compare with the reference of the first bounces."""
    position, rotation = tumble_reference(tuple(trajectory.times.tolist()))
    return {'position_error_m': largest(trajectory.position[:, 0] - position),
            'angle_error_rad': largest(
                angles_between(trajectory.orientation[:, 0], quaternions(rotation)))}


def quaternions(matrices):
    """Return quaternions x, y, z, w, (k, 4), of rotation matrices (k, 3, 3), by eigenvectors."""
    # Bar-Itzhack 2000: the eigenvector to the largest eigenvalue, accurate for all angles
    xx, xy, xz, yx, yy, yz, zx, zy, zz = np.moveaxis(matrices.reshape(-1, 9), -1, 0)
    symmetric = np.array([
        [xx - yy - zz, yx + xy, zx + xz, zy - yz],
        [yx + xy, yy - xx - zz, zy + yz, xz - zx],
        [zx + xz, zy + yz, zz - xx - yy, yx - xy],
        [zy - yz, xz - zx, yx - xy, xx + yy + zz]])
    return np.linalg.eigh(np.moveaxis(symmetric, -1, 0))[1][:, :, -1]


def energy_errors(trajectory):
    """Return the change of energy of a cube of 1 kg that bounces for ever."""
    moment = EDGE * EDGE / 6
    speed, spin = np.array(TUMBLE['velocity']), np.array(TUMBLE['spin'])
    start = speed @ speed / 2 + moment * spin @ spin / 2 + GRAVITY * TUMBLE['height']
    energy = ((trajectory.linear_velocity ** 2).sum(axis=-1) / 2
              + moment * (trajectory.angular_velocity ** 2).sum(axis=-1) / 2
              + GRAVITY * trajectory.position[..., 2])
    return {'energy_error_relative': largest(energy / start - 1)}


REST_FRAMES = 10

PROBLEMS = (
    Problem('drop_elastic', 'cube dropped flat, e = 1, four bounces',
            lambda: drop_scene(1.0), frames_near(apexes(1.0, 4)[0], 0.1), drop_errors(1.0, 4),
            'apex_height_error_relative'),
    Problem('drop_half', 'cube dropped flat, e = 0.5, to rest',
            lambda: drop_scene(0.5),
            frames_near(apexes(0.5, 3)[0], 1 / 60) + tuple(
                (np.ceil(rest_time(0.5) * 60) + frame) / 60 for frame in range(REST_FRAMES)),
            drop_errors(0.5, 3, REST_FRAMES), 'apex_height_error_relative'),
    Problem('tumble_bounces', 'tumbling cube, e = 1, no friction: the first five bounces',
            tumble_scene, frames(1.45, 3), tumble_errors, 'position_error_m'),
    Problem('tumble_energy', 'tumbling cube, e = 1, no friction: energy over 100 bounces, 45 s',
            tumble_scene, frames(45, 60), energy_errors, 'energy_error_relative'),
)
