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

"""Problems of free flight: nothing touches."""

from functools import lru_cache

import numpy as np

from rigid_sim_ros.benchmark.problems.problem import cube, frames, largest, Problem, scene
from rigid_sim_ros.benchmark.references.rotation import attitudes
from rigid_sim_ros.benchmark.trajectories import angles_between

NO_GRAVITY = (0.0, 0.0, 0.0)

CUBE_MOMENT = 0.0078125
"""[kg m^2]: near that of a cube of 0.2 m and 1 kg, and a power of two, so no digit is lost."""

FORCE, TORQUE = (0.1, 0.2, 0.3), (0.001, 0.002, 0.003)
VELOCITY, SPIN = (1.0, 0.0, -0.5), (1.0, 2.0, 0.0)

BOX = {'name': 'box', 'box': {'size': [1.0, 2.0, 3.0]}, 'mass': 12.0}
BOX_MOMENTS = (13.0, 10.0, 5.0)
"""[kg m^2] of the box 1:2:3 with 12 kg: m/12 (y^2 + z^2) ..., whole numbers."""


def constant_wrench_scene():
    """Return one cube under a constant force and torque."""
    return scene([cube('cube', (0, 0, 0), inertia=[CUBE_MOMENT] * 3, velocity=VELOCITY,
                       angular_velocity=SPIN, force=FORCE, torque=TORQUE)],
                 planes=(), gravity=NO_GRAVITY)


def constant_wrench_errors(trajectory):
    """Compare with x0 + v t + F t^2 / 2 m, and with the attitude in exact arithmetic."""
    times = trajectory.times[:, None, None]
    position = times * np.array(VELOCITY) + times ** 2 / 2 * np.array(FORCE)
    return {'angle_error_rad': _angle_error(trajectory, 0, (CUBE_MOMENT,) * 3, SPIN, TORQUE),
            'position_error_m': largest(trajectory.position - position)}


def tumbling_scene(offsets):
    """Return boxes 1:2:3 that turn at 5 rad/s, each so far [rad] off the middle axis."""
    return scene([{**BOX, 'name': f'box_{number}', 'position': [10.0 * number, 0.0, 0.0],
                   'inertia': list(BOX_MOMENTS), 'angular_velocity': list(tumbling_spin(offset))}
                  for number, offset in enumerate(offsets)], planes=(), gravity=NO_GRAVITY)


def tumbling_spin(offset):
    """Return the spin [rad/s] near the middle axis, so far [rad] off."""
    return (5.0 * offset, 5.0, 5.0 * offset)


def tumbling_errors(offsets):
    """Return the measure: attitude in exact arithmetic, energy and angular momentum kept."""
    def measure(trajectory):
        moments = np.array(BOX_MOMENTS)
        spins = np.array([tumbling_spin(offset) for offset in offsets])
        energy = (moments * spins ** 2).sum(axis=-1) / 2
        momentum = moments * spins
        rates, turned = _body_rates(trajectory)
        energies = (moments * rates ** 2).sum(axis=-1) / 2
        change = turned(moments * rates) - momentum
        return {
            'angle_error_rad': max(_angle_error(trajectory, number, BOX_MOMENTS, tuple(spin))
                                   for number, spin in enumerate(spins.tolist())),
            'energy_error_relative': largest(energies / energy - 1),
            'angular_momentum_error_relative': largest(
                np.linalg.norm(change, axis=-1) / np.linalg.norm(momentum, axis=-1))}
    return measure


def driven_box_scene():
    """Return a box 1:2:3 under a constant torque."""
    return scene([{**BOX, 'position': [0.0, 0.0, 0.0], 'inertia': list(BOX_MOMENTS),
                   'angular_velocity': [1.0, 1.5, 0.5], 'torque': [0.5, -0.25, 0.75]}],
                 planes=(), gravity=NO_GRAVITY)


def driven_box_errors(trajectory):
    """Compare with the attitude in exact arithmetic."""
    return {'angle_error_rad': _angle_error(trajectory, 0, BOX_MOMENTS, (1.0, 1.5, 0.5),
                                            (0.5, -0.25, 0.75))}


@lru_cache(maxsize=4)
def drift_state(count):
    """Return start, velocity and spin, each (count, 3), of cubes that drift and never touch."""
    side = int(np.ceil(count ** (1 / 3)))
    cells = np.stack(np.unravel_index(np.arange(count), (side, side, side)), axis=-1)
    random = np.random.default_rng(1)
    return (cells * 1.0, random.uniform(-0.05, 0.05, (count, 3)),
            random.uniform(-2.0, 2.0, (count, 3)))


def drift_scene(count):
    """Return so many drifting, spinning cubes a metre apart, too slow ever to meet."""
    start, velocity, spin = drift_state(count)
    return scene([cube(f'cube_{number}', start[number].tolist(),
                       velocity=velocity[number].tolist(), angular_velocity=spin[number].tolist())
                  for number in range(count)], planes=(), gravity=NO_GRAVITY)


def drift_errors(count):
    """Return the measure: constant velocity and constant rate about a fixed axis."""
    def measure(trajectory):
        start, velocity, spin = drift_state(count)
        times = trajectory.times[:, None, None]
        rate = np.linalg.norm(spin, axis=-1)[:, None]
        half = times * rate / 2
        expected = np.concatenate((spin / rate * np.sin(half), np.cos(half)), axis=-1)
        return {'angle_error_rad': largest(angles_between(trajectory.orientation, expected)),
                'position_error_m': largest(trajectory.position - start - velocity * times)}
    return measure


def _angle_error(trajectory, number, inertia, spin, torque=(0.0, 0.0, 0.0)):
    """Return the largest angle [rad] between a body's readings and the reference."""
    expected = attitudes(inertia, spin, tuple(trajectory.times.tolist()), torque)
    return largest(angles_between(trajectory.orientation[:, number], np.array(expected)))


def _body_rates(trajectory):
    """Return the rates in body axes, (k, n, 3), and the function that turns body into world."""
    x, y, z, w = np.moveaxis(trajectory.orientation, -1, 0)

    def turn(vectors, sign):
        axis = sign * np.stack((x, y, z), axis=-1)
        twice = 2 * np.cross(axis, vectors)
        return vectors + w[..., None] * twice + np.cross(axis, twice)
    return turn(trajectory.angular_velocity, -1), lambda vectors: turn(vectors, 1)


OFFSETS = tuple(10.0 ** -power for power in range(1, 13))

PROBLEMS = (
    Problem('constant_wrench', 'cube, constant force and torque, 10 s',
            constant_wrench_scene, (10.0,), constant_wrench_errors, 'angle_error_rad'),
    Problem('tumbling_box', 'box 1:2:3 tumbling near its middle axis, 30 s',
            lambda: tumbling_scene((0.01,)), frames(30, 60), tumbling_errors((0.01,)),
            'angle_error_rad'),
    Problem('tumbling_boxes', 'twelve boxes 1:2:3, 1e-1 to 1e-12 rad off the middle axis, 10 s',
            lambda: tumbling_scene(OFFSETS), frames(10, 60), tumbling_errors(OFFSETS),
            'angle_error_rad', bodies=len(OFFSETS)),
    Problem('driven_box', 'box 1:2:3, constant torque, 10 s',
            driven_box_scene, frames(10, 60), driven_box_errors, 'angle_error_rad'),
    *(Problem(f'drift_{count}', f'{count} cubes drifting and spinning apart, poses read each step',
              lambda count=count: drift_scene(count), (0.25, 0.5), drift_errors(count),
              'angle_error_rad', rates=(240,), reads_every_step=True, bodies=count)
      for count in (10, 100, 1000, 10000, 100000)),
)
