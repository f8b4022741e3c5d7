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

"""Problems of cubes that collide in free space, without friction."""

from functools import lru_cache

import numpy as np

from rigid_sim_ros.benchmark.problems.problem import cube, frames, largest, Problem, scene
from rigid_sim_ros.benchmark.references.impulses import after_impulse

NO_GRAVITY = (0.0, 0.0, 0.0)
HALF, MOMENT = 0.1, 0.2 * 0.2 / 6

SPACING = 2.0
"""[m] between pairs."""

GAP = 0.047
"""[m] between the bodies of a pair at the start: they meet between the steps of every rate."""

DURATION = 0.1
"""[s]. The pairs meet after a third of it."""


def rotation(orientation):
    """Return the matrix (3, 3) of a unit quaternion x, y, z, w."""
    x, y, z, w = orientation
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def turned(x, y, z, angle):
    """Return the quaternion x, y, z, w of a turn by an angle [rad] about an axis."""
    axis = np.array([x, y, z]) / np.linalg.norm([x, y, z])
    return (*(axis * np.sin(angle / 2)), np.cos(angle / 2))


@lru_cache(maxsize=2)
def vertex_face_pair():
    """
    Return the two bodies, the contact point when they meet, and the normal from a to b.

    A corner of b flies at the face x = 0.1 of a, off the middle.
    """
    orientation = turned(1.0, 2.0, 3.0, 1.1)
    corners = rotation(orientation) @ (np.array(
        [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]).T * HALF)
    corner = corners[:, corners[0].argmin()]
    a = {'orientation': (0.0, 0.0, 0.0, 1.0), 'position': np.zeros(3),
         'velocity': np.array([0.5, 0.0, 0.0])}
    b = {'orientation': orientation, 'velocity': np.array([-1.0, 0.125, 0.25]),
         'position': np.array([HALF + GAP, 0.03, -0.02]) - corner}
    normal = np.array([1.0, 0.0, 0.0])
    span = GAP / 1.5
    return a, b, b['position'] + b['velocity'] * span + corner, normal


@lru_cache(maxsize=2)
def edge_edge_pair():
    """
    Return the same for two edges that cross at right angles.

    An edge of a along z flies at an edge of b along y, each off its middle.
    """
    reach = HALF * np.sqrt(2)
    angle_a, angle_b = np.pi / 4 - 0.1, np.pi / 4 + 0.15
    # from the centre to the edge: a corner of the square, turned
    edge_a = reach * np.array([np.cos(angle_a - np.pi / 4), np.sin(angle_a - np.pi / 4), 0.0])
    edge_b = reach * np.array([-np.cos(angle_b - np.pi / 4), 0.0, np.sin(angle_b - np.pi / 4)])
    a = {'orientation': turned(0, 0, 1, angle_a), 'position': np.zeros(3),
         'velocity': np.array([0.5, 0.0, 0.0])}
    offset = np.array([GAP, 0.0, 0.0]) + edge_a - edge_b
    b = {'orientation': turned(0, 1, 0, angle_b), 'velocity': np.array([-1.0, 0.125, 0.25]),
         'position': offset + np.array([0.0, 0.03, -0.04])}
    span = GAP / 1.5
    point = np.array([edge_a[0] + 0.5 * span, edge_a[1],
                      (b['position'] + edge_b)[2] + 0.25 * span])
    return a, b, point, np.array([1.0, 0.0, 0.0])


def pair_scene(pair, restitution, count=1):
    """Return so many equal pairs, in a row along y."""
    bodies = []
    for number in range(count):
        shift = np.array([0.0, number * SPACING, 0.0])
        for name, body in zip('ab', pair()[:2]):
            bodies.append(cube(f'{name}_{number}', body['position'] + shift,
                               orientation=body['orientation'], velocity=body['velocity']))
    for body in bodies:
        body.update({key: [float(value) for value in body[key]]
                     for key in ('position', 'orientation', 'velocity')})
    return scene(bodies, planes=(), restitution=restitution, friction=0.0, gravity=NO_GRAVITY)


def pair_errors(pair, restitution):
    """Return the measure: velocities and spins after the impulse, relative to their changes."""
    a, b, point, normal = pair()
    span = GAP / 1.5
    meeting = [{'mass': 1.0, 'moment': MOMENT, 'spin': np.zeros(3), 'velocity': body['velocity'],
                'position': body['position'] + body['velocity'] * span} for body in (a, b)]
    expected = after_impulse(meeting, point, normal, restitution)
    velocity = np.array([linear for linear, _ in expected])
    spin = np.array([angular for _, angular in expected])
    change = np.linalg.norm(velocity[0] - a['velocity'])
    momentum = a['velocity'] + b['velocity']

    def measure(trajectory):
        count = trajectory.position.shape[1] // 2
        linear = trajectory.linear_velocity[-1].reshape(count, 2, 3)
        angular = trajectory.angular_velocity[-1].reshape(count, 2, 3)
        scale = np.linalg.norm(spin, axis=-1)
        return {
            'spin_error_relative': largest(np.linalg.norm(angular - spin, axis=-1) / scale),
            'velocity_error_relative': largest(
                np.linalg.norm(linear - velocity, axis=-1) / change),
            'momentum_error_relative': largest(
                (linear.sum(axis=1) - momentum) / np.linalg.norm(momentum))}
    return measure


CRADLE_GAP, CRADLE_SPEED = 1 / 64, 1.0
"""[m] between neighbours, [m/s] of the first."""


def cradle_scene():
    """Return five cubes in a row, the first flying at the others."""
    return scene([cube(f'cube_{number}', (number * (2 * HALF + CRADLE_GAP), 0.0, 0.0),
                       velocity=(CRADLE_SPEED if number == 0 else 0.0, 0.0, 0.0))
                  for number in range(5)],
                 planes=(), restitution=1.0, friction=0.0, gravity=NO_GRAVITY)


def cradle_errors(trajectory):
    """Compare with equal balls: each hands all its speed to the next, where it meets it."""
    numbers = np.arange(5)
    hand_over = CRADLE_GAP / CRADLE_SPEED
    moving = np.clip(trajectory.times[:, None] - numbers * hand_over, 0,
                     np.where(numbers < 4, hand_over, np.inf))
    x = numbers * (2 * HALF + CRADLE_GAP) + CRADLE_SPEED * moving
    expected = np.zeros_like(trajectory.position)
    expected[..., 0] = x
    final = np.zeros((5, 3))
    final[4, 0] = CRADLE_SPEED
    return {'position_error_m': largest(trajectory.position - expected),
            'velocity_error_m_s': largest(trajectory.linear_velocity[-1] - final)}


PROBLEMS = (
    *(Problem(f'{name}_{word}', f'two cubes, {title}, e = {restitution:g}, no friction',
              lambda pair=pair, restitution=restitution: pair_scene(pair, restitution),
              (DURATION,), pair_errors(pair, restitution), 'spin_error_relative', bodies=2)
      for name, title, pair in (('vertex_face', 'vertex on face', vertex_face_pair),
                                ('edge_edge', 'edge on edge', edge_edge_pair))
      for word, restitution in (('elastic', 1.0), ('half', 0.5))),
    Problem('vertex_face_100', '100 pairs of cubes, vertex on face, e = 1, no friction',
            lambda: pair_scene(vertex_face_pair, 1.0, 100), (DURATION,),
            pair_errors(vertex_face_pair, 1.0), 'spin_error_relative', bodies=200),
    Problem('cradle', 'five cubes in line with small gaps, e = 1',
            cradle_scene, frames(0.25, 3), cradle_errors, 'position_error_m', bodies=5),
)
