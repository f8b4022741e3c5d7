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

"""Problems of many bodies in contact: time, and what the speed costs in penetration."""

from functools import lru_cache

import numpy as np

from rigid_sim_ros.benchmark.penetration import deepest_penetration
from rigid_sim_ros.benchmark.problems.problem import cube, frames, largest, Problem, scene
from rigid_sim_ros.scene import load_scene

EDGE, HALF = 0.2, 0.1

BLOCKS = {10: (2, 1, 5), 100: (5, 5, 4), 1000: (10, 10, 10)}
"""How many cubes along x, y and z."""


def toss_scene():
    """Return ten cubes thrown at each other and onto the ground, tumbling."""
    random = np.random.default_rng(3)
    bodies = []
    for number in range(10):
        direction = 2 * np.pi * number / 10
        # two rings, far enough apart that no cubes of either touch at the start
        ring = 0.6 + 0.4 * (number % 2)
        orientation = random.normal(size=4)
        bodies.append(cube(
            f'cube_{number}',
            (ring * np.cos(direction), ring * np.sin(direction), 0.7 + 0.5 * (number % 2)),
            orientation=(orientation / np.linalg.norm(orientation)).tolist(),
            velocity=(-np.cos(direction), -np.sin(direction), random.uniform(0.8, 1.8)),
            angular_velocity=random.uniform(-6, 6, 3).tolist()))
        bodies[-1].update({key: [float(value) for value in bodies[-1][key]]
                           for key in ('position', 'velocity')})
    return scene(bodies, restitution=0.3)


def tower_scene():
    """Return ten cubes on top of each other, just touching."""
    return scene([cube(f'cube_{number}', (0.0, 0.0, HALF + EDGE * number))
                  for number in range(10)])


def pile_scene(count):
    """Return a block of cubes with gaps and jitter, above the ground: it falls into a pile."""
    block = {'count': list(BLOCKS[count]), 'spacing': [0.26] * 3, 'jitter': 0.02, 'seed': 1}
    return scene([cube('cube', (0.0, 0.0, 0.4), edge=EDGE, repeat=block)])


def heap_scene(count):
    """Return cubes in random attitudes, too far apart to touch, above the ground."""
    random = np.random.default_rng(1)
    bodies = []
    for number, cell in enumerate(np.ndindex(BLOCKS[count])):
        orientation = random.normal(size=4)
        place = np.array(cell) * 0.36 + random.uniform(-0.005, 0.005, 3) + (0.0, 0.0, 0.5)
        bodies.append(cube(f'cube_{number}', place.tolist(),
                           orientation=(orientation / np.linalg.norm(orientation)).tolist()))
    return scene(bodies)


def rest_scene(count):
    """Return cubes at rest on the ground, apart."""
    side = int(np.ceil(np.sqrt(count)))
    return scene([cube(f'cube_{number}', (0.4 * (number % side), 0.4 * (number // side), HALF))
                  for number in range(count)])


def crowd_errors(make_scene, still=False):
    """Return the measure: penetration, movement where nothing may move, how many are asleep."""
    @lru_cache(maxsize=1)
    def start():
        return load_scene(make_scene())

    def measure(trajectory):
        depths = [deepest_penetration(start(), *poses)
                  for poses in zip(trajectory.position, trajectory.orientation)]
        moved = trajectory.position[-1] - [body.position for body in start().bodies]
        return {**({'drift_m': largest(np.linalg.norm(moved, axis=-1))} if still else {}),
                'penetration_largest_m': max(depths), 'penetration_at_end_m': depths[-1],
                'speed_at_end_m_s': largest(np.linalg.norm(trajectory.linear_velocity[-1],
                                                           axis=-1)),
                'asleep_share': float(trajectory.asleep.mean())}
    return measure


def _crowd(name, title, make_scene, duration, bodies, still=False, may_sleep=False):
    return Problem(name, title, make_scene, frames(duration, 6), crowd_errors(make_scene, still),
                   'penetration_largest_m', rates=(240,), reads_every_step=True, reach=30.0,
                   may_sleep=may_sleep, bodies=bodies)


PROBLEMS = (
    _crowd('toss_10', 'ten cubes tossed onto a plane, e = 0.3, 4 s', toss_scene, 4, 10),
    _crowd('tower_10', 'a tower of ten cubes, 10 s', tower_scene, 10, 10, still=True),
    *(_crowd(f'pile_{count}', f'{count} cubes dropped from a jittered grid, 4 s',
             lambda count=count: pile_scene(count), 4, count) for count in BLOCKS),
    *(_crowd(f'heap_{count}', f'{count} tumbled cubes dropped, 4 s',
             lambda count=count: heap_scene(count), 4, count) for count in BLOCKS),
    _crowd('rest_1000', '1000 cubes at rest, apart, 4 s, free to sleep',
           lambda: rest_scene(1000), 4, 1000, still=True, may_sleep=True),
)
