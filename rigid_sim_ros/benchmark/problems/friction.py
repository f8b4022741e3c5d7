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

"""Problems of one body that slides, sticks, spins, tips or rolls on a plane, in closed form."""

from math import atan, cos, pi, sin, sqrt

import numpy as np

from rigid_sim_ros.benchmark.problems.bounces import UNTURNED
from rigid_sim_ros.benchmark.problems.problem import cube, frames, largest, Problem, scene
from rigid_sim_ros.benchmark.trajectories import angles_between

EDGE, HALF = 0.2, 0.1
GRAVITY = 9.81

SLIDE_SPEED, SLIDE_FRICTION = 3.0, 0.3
SLIDE_TIME = SLIDE_SPEED / (SLIDE_FRICTION * GRAVITY)
SLIDE_DISTANCE = SLIDE_SPEED * SLIDE_TIME / 2


def slide_scene():
    """Return a cube that slides flat."""
    return scene([cube('cube', (0, 0, HALF), velocity=(SLIDE_SPEED, 0.0, 0.0))],
                 friction=SLIDE_FRICTION)


def slide_errors(trajectory):
    """Compare with v0 t - mu g t^2 / 2 up to the stop at v0 / mu g."""
    times = np.minimum(trajectory.times, SLIDE_TIME)
    expected = SLIDE_SPEED * times - SLIDE_FRICTION * GRAVITY * times ** 2 / 2
    x, z = trajectory.position[:, 0, 0], trajectory.position[:, 0, 2]
    return {'distance_error_relative': abs(x[-1] / SLIDE_DISTANCE - 1),
            'position_error_m': largest(x - expected),
            'lift_m': largest(z - HALF),
            'tilt_rad': largest(angles_between(trajectory.orientation[:, 0], UNTURNED))}


INCLINE_FRICTION, INCLINE_TIME = 0.5, 5.0


def incline_scene(share):
    """Return a cube put flat on a plane as steep as this share of mu's slope."""
    angle = atan(share * INCLINE_FRICTION)
    normal = (sin(angle), 0.0, cos(angle))
    return scene([cube('cube', [HALF * component for component in normal],
                       orientation=(0.0, sin(angle / 2), 0.0, cos(angle / 2)))],
                 planes=({'name': 'incline', 'normal': list(normal)},),
                 friction=INCLINE_FRICTION)


def incline_errors(share):
    """Return the measure: creep where it must stick, acceleration where it must slide."""
    angle = atan(share * INCLINE_FRICTION)
    downhill = np.array([cos(angle), 0.0, -sin(angle)])
    start = HALF * np.array([sin(angle), 0.0, cos(angle)])
    acceleration = GRAVITY * (sin(angle) - INCLINE_FRICTION * cos(angle))

    def measure(trajectory):
        moved = trajectory.position[-1, 0] - start
        if share < 1:
            return {'creep_m': float(np.linalg.norm(moved))}
        expected = acceleration * INCLINE_TIME ** 2 / 2
        return {'acceleration_error_relative': abs(moved @ downhill / expected - 1)}
    return measure


SPIN_RATE, SPIN_FRICTION = 10.0, 0.3
SPIN_SLOWING = SPIN_FRICTION * GRAVITY * (EDGE / sqrt(2)) / (EDGE * EDGE / 6)
"""[rad/s^2]: friction of a quarter of the weight at each corner, over the moment of inertia."""


def spin_scene():
    """Return a cube that spins flat on its face."""
    return scene([cube('cube', (0, 0, HALF), angular_velocity=(0.0, 0.0, SPIN_RATE))],
                 friction=SPIN_FRICTION)


def spin_errors(trajectory):
    """Compare with w0 t - a t^2 / 2 up to the stop; the weight rests on the four corners."""
    times = np.minimum(trajectory.times, SPIN_RATE / SPIN_SLOWING)
    angle = SPIN_RATE * times - SPIN_SLOWING * times ** 2 / 2
    expected = np.zeros((len(times), 4))
    expected[:, 2], expected[:, 3] = np.sin(angle / 2), np.cos(angle / 2)
    return {'angle_error_rad': largest(angles_between(trajectory.orientation[:, 0], expected)),
            'position_error_m': largest(trajectory.position[:, 0] - (0.0, 0.0, HALF))}


TIP_START = 0.05
"""[rad] of the diagonal from the vertical."""


def tip_scene():
    """Return a cube on its edge, just past balance, on a plane it cannot slide on."""
    angle = pi / 4 + TIP_START
    reach = EDGE / sqrt(2)
    # turned about y by `angle`, the lower edge is the one along y at the origin
    return scene([cube('cube', (reach * sin(TIP_START), 0.0, reach * cos(TIP_START)),
                       orientation=(0.0, sin(angle / 2), 0.0, cos(angle / 2)))], friction=1.0)


def tip_errors(trajectory):
    """Compare with the pendulum up to the landing, then with a cube flat where it fell."""
    # here, as mpmath is only needed for this
    from rigid_sim_ros.benchmark.references.tipping import landing_time, tipping_angle
    landing = landing_time(TIP_START, EDGE, GRAVITY)
    angle = np.array([tipping_angle(time, TIP_START, EDGE, GRAVITY) if time < landing else pi / 4
                      for time in trajectory.times]) + pi / 4
    expected = np.zeros((len(angle), 4))
    expected[:, 1], expected[:, 3] = np.sin(angle / 2), np.cos(angle / 2)
    error = angles_between(trajectory.orientation[:, 0], expected)
    tipping = trajectory.times < landing
    return {'angle_error_rad': largest(error[tipping]),
            'angle_at_rest_rad': largest(error[-1]),
            'place_at_rest_error_m': largest(trajectory.position[-1, 0] - (HALF, 0.0, HALF))}


BALL_SPEED, BALL_FRICTION = 3.0, 0.3


def ball_scene():
    """Return a ball thrown along the ground without spin."""
    return scene([{'name': 'ball', 'sphere': {'radius': HALF}, 'mass': 1.0,
                   'position': [0.0, 0.0, HALF], 'velocity': [BALL_SPEED, 0.0, 0.0]}],
                 friction=BALL_FRICTION)


def ball_errors(trajectory):
    """Compare with sliding until t = 2 v0 / (7 mu g), then rolling at 5/7 of the speed."""
    times = trajectory.times
    rolling = 2 * BALL_SPEED / (7 * BALL_FRICTION * GRAVITY)
    sliding = np.minimum(times, rolling)
    x = (BALL_SPEED * sliding - BALL_FRICTION * GRAVITY * sliding ** 2 / 2
         + 5 / 7 * BALL_SPEED * (times - sliding))
    spin = np.array([0.0, 5 / 7 * BALL_SPEED / HALF, 0.0])
    return {'position_error_m': largest(trajectory.position[:, 0, 0] - x),
            'spin_error_relative': largest(
                np.linalg.norm(trajectory.angular_velocity[-1, 0] - spin) / spin[1])}


BALLS, BALL_RADIUS, BALL_SPACING = 5, 0.1, 0.4
BASE_SIZE, BASE_MASS, PUSH = (2.4, 2.4, 0.2), 10.0, 150.0
GROUND_MIX, BALL_MIX = 0.4, 0.8
"""Frictions of the box with the ground and with the balls: geometric means of the materials'."""


def carried_scene():
    """Return a box pushed along the ground with 25 balls on it, as in SimBenchmark's rolling."""
    base_friction = 0.8
    materials = {name: {'restitution': 0.0, 'friction': mixed ** 2 / base_friction}
                 for name, mixed in (('ground', GROUND_MIX), ('ball', BALL_MIX))}
    base = {'name': 'base', 'box': {'size': list(BASE_SIZE)}, 'mass': BASE_MASS,
            'position': [0.0, 0.0, BASE_SIZE[2] / 2], 'force': [PUSH, 0.0, 0.0]}
    top = BASE_SIZE[2] + BALL_RADIUS
    places = [(place - BALLS // 2) * BALL_SPACING for place in range(BALLS)]
    balls = [{'name': f'ball_{row}_{column}', 'sphere': {'radius': BALL_RADIUS}, 'mass': 1.0,
              'position': [x, y, top], 'material': materials['ball']}
             for row, x in enumerate(places) for column, y in enumerate(places)]
    return scene([base, *balls], friction=base_friction,
                 planes=({'name': 'ground', 'material': materials['ground']},))


def carried_errors(trajectory):
    """
    Compare with balls that roll: each has 2/7 of the box's acceleration.

    So the box carries 2/7 of their mass: a = (F - mu g (M + m)) / (M + 2/7 m), m of all balls.
    """
    mass = BALLS * BALLS * 1.0
    acceleration = ((PUSH - GROUND_MIX * GRAVITY * (BASE_MASS + mass))
                    / (BASE_MASS + 2 / 7 * mass))
    share = np.array([1.0] + [2 / 7] * (BALLS * BALLS))
    final = acceleration * trajectory.times[-1]
    error = trajectory.linear_velocity[-1] - np.outer(share * final, (1.0, 0.0, 0.0))
    moved = share * acceleration * trajectory.times[-1] ** 2 / 2
    start = np.array([0.0] + [(place - BALLS // 2) * BALL_SPACING
                              for place in range(BALLS) for _ in range(BALLS)])
    return {'velocity_error_relative': largest(error) / final,
            'position_error_m': largest(trajectory.position[-1, :, 0] - start - moved)}


PROBLEMS = (
    Problem('slide', 'cube sliding to rest, mu 0.3 from 3 m/s',
            slide_scene, frames(1.5, 6), slide_errors, 'distance_error_relative'),
    Problem('incline_stick', 'cube on an incline at 0.95 of the friction angle, 5 s',
            lambda: incline_scene(0.95), (INCLINE_TIME,), incline_errors(0.95),
            'creep_m'),
    Problem('incline_slide', 'cube on an incline at 1.05 of the friction angle, 5 s',
            lambda: incline_scene(1.05), (INCLINE_TIME,), incline_errors(1.05),
            'acceleration_error_relative'),
    Problem('flat_spin', 'cube spinning to rest on its face, mu 0.3 from 10 rad/s',
            spin_scene, frames(0.3), spin_errors, 'angle_error_rad'),
    Problem('tipping', 'cube tipping over its edge from 0.05 rad, to rest',
            tip_scene, frames(1.0), tip_errors, 'angle_error_rad'),
    Problem('rolling', 'ball thrown along the ground, mu 0.3 from 3 m/s, 1 s',
            ball_scene, frames(1.0, 6), ball_errors, 'position_error_m'),
    Problem('rolling_25', 'box pushed along the ground under 25 balls, 1 s',
            carried_scene, (1.0,), carried_errors, 'velocity_error_relative',
            bodies=1 + BALLS * BALLS),
)
