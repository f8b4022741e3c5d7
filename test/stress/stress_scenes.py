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
"""Scenes far outside comfort, as `model.Scene`; sizes in m, masses in kg."""

from dataclasses import replace
from math import cos, sin

import numpy as np

from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere

GRAVITY = 9.81


def body(name, shape, position, mass=1.0, **values):
    """Return a solid body."""
    return Body(name, shape, mass, shape.inertia(mass), position=tuple(map(float, position)),
                **values)


def scene(bodies, restitution=0.0, friction=0.5, gravity=GRAVITY, planes=True, law='poisson',
          **material):
    """Return these bodies above the plane z = 0, all of one material."""
    material = Material(restitution, friction, **material)
    return Scene(tuple(replace(each, material=material) for each in bodies),
                 (Plane('ground', material=material),) if planes else (),
                 (0.0, 0.0, -float(gravity)), law)


def attitude(random):
    """Return a random unit quaternion."""
    turn = random.normal(size=4)
    return tuple((turn / np.linalg.norm(turn)).tolist())


def vector(random, size):
    """Return a random vector with this standard deviation along each axis."""
    return tuple((size * random.normal(size=3)).tolist())


# -- what stands ------------------------------------------------------------

def tower(count, edge=0.2, **values):
    """Return cubes on top of each other."""
    return scene([body(f'cube_{level}', Cube(edge), (0, 0, edge * (level + 0.5)))
                  for level in range(count)], **values)


def crooked_tower(count, edge=0.2, seed=1):
    """Return a tower of cubes that are shifted by up to a twentieth of an edge and turned."""
    random = np.random.default_rng(seed)
    bodies = []
    for level in range(count):
        turn = random.uniform(-0.2, 0.2)
        x, y = random.uniform(-0.05, 0.05, 2) * edge
        bodies.append(body(f'cube_{level}', Cube(edge), (x, y, edge * (level + 0.5)),
                           orientation=(0.0, 0.0, sin(turn / 2), cos(turn / 2))))
    return scene(bodies)


def wall(courses=6, length=6):
    """Return bricks of 2:1:1 in a running bond, half bricks at the ends of every other course."""
    bodies = []
    for course in range(courses):
        z = 0.1 * (course + 0.5)
        ends = [(-0.05, 0.1), (length * 0.2 - 0.15, 0.1)] if course % 2 else []
        shift, count = (0.1, length - 1) if course % 2 else (0.0, length)
        whole = [(0.2 * number + shift, 0.2) for number in range(count)]
        for number, (x, size) in enumerate(sorted(whole + ends)):
            bodies.append(body(f'brick_{course}_{number}', Box((size, 0.1, 0.1)), (x, 0, z),
                               10 * size))
    return scene(bodies)


def pyramid(rows, edge=0.2):
    """Return cubes in rows, each one shorter than the row below; they do not touch sideways."""
    return scene([
        body(f'cube_{row}_{number}', Cube(edge),
             (1.1 * edge * (number + 0.5 * row), 0, edge * (row + 0.5)))
        for row in range(rows) for number in range(rows - row)])


def card_house(storeys=2, lean=0.3):
    """
    Return a house of cards: plates of 100:70:1 mm that lean against each other, and floors.

    A storey less has one pair of cards less; floors lie on the tops of the pairs.
    """
    length, width, thickness = 0.1, 0.07, 0.001
    tall = length * cos(lean) + thickness * sin(lean)
    wide = length * sin(lean) + thickness * cos(lean)
    card, floor = Box((thickness, width, length)), Box((length, width, thickness))
    spacing = 2.2 * wide
    bodies, z = [], 0.0
    for storey in range(storeys):
        pairs = storeys - storey
        middle = 0.5 * spacing * storey
        for number in range(pairs):
            x = middle + spacing * number
            for name, side in (('left', -1.0), ('right', 1.0)):
                bodies.append(body(
                    f'card_{storey}_{number}_{name}', card,
                    (x + side * wide / 2, 0, z + tall / 2), 0.002,
                    orientation=(0.0, -side * sin(lean / 2), 0.0, cos(lean / 2))))
        z += tall
        if pairs > 1:
            plate = Box((spacing * (pairs - 1) + length / 2, width, thickness))
            bodies.append(body(f'floor_{storey}', plate,
                               (middle + 0.5 * spacing * (pairs - 1), 0, z + thickness / 2),
                               0.003))
        else:
            bodies.append(body('roof', floor, (middle, 0, z + thickness / 2), 0.002))
        z += thickness
    return scene(bodies, friction=0.8)


def heavy_on_light(ratio=1000.0):
    """Return a heavy cube on four light ones."""
    bodies = [body(f'light_{number}', Cube(0.2), (x, y, 0.1))
              for number, (x, y) in enumerate(
                  ((-0.15, -0.15), (-0.15, 0.15), (0.15, -0.15), (0.15, 0.15)))]
    return scene([*bodies, body('heavy', Cube(0.5), (0, 0, 0.45), ratio)])


def light_between_heavy(ratio=1000.0):
    """Return a light cube between two heavy ones, and one more that falls on top."""
    return scene([body('low', Cube(0.2), (0, 0, 0.1), ratio),
                  body('light', Cube(0.2), (0.02, 0, 0.3)),
                  body('high', Cube(0.2), (0, 0, 0.5), ratio),
                  body('falling', Cube(0.2), (0.03, 0.02, 0.8), 0.1 * ratio)], restitution=0.2)


# -- what falls ------------------------------------------------------------

def pile(counts, edge=0.2, spacing=1.3, jitter=0.1, seed=1, **values):
    """Return a block of cubes (x, y, z of them), with gaps and jitter in parts of an edge."""
    random = np.random.default_rng(seed)
    bodies = []
    for place in np.ndindex(counts):
        where = edge * (np.array(place) * spacing + random.uniform(-jitter, jitter, 3))
        bodies.append(body('cube_' + '_'.join(map(str, place)), Cube(edge),
                           where + (0, 0, 2 * edge)))
    return scene(bodies, **values)


def heap(counts, edge=0.2, seed=1, **values):
    """Return a block of cubes in random attitudes, above the ground."""
    random = np.random.default_rng(seed)
    return scene([
        body('cube_' + '_'.join(map(str, place)), Cube(edge),
             edge * (1.8 * np.array(place) + random.uniform(-0.02, 0.02, 3) + (0, 0, 2.5)),
             orientation=attitude(random))
        for place in np.ndindex(counts)], **values)


def marble_run(balls=6):
    """Return balls on two rails of fixed rods, 1:100, that roll down onto loose rods."""
    slope, length, thickness = 0.15, 1.0, 0.01
    rail = Box((length, thickness, thickness))
    down = (0.0, sin(slope / 2), 0.0, cos(slope / 2))
    bodies = [body(f'rail_{side}', rail, (0, 0.015 * side, 0.3), fixed=True, orientation=down)
              for side in (-1, 1)]
    # a ball on two edges, 20 mm apart: well above where it would touch, it drops 5 mm
    bodies += [body(f'ball_{number}', Sphere(0.02),
                    (-0.45 + 0.06 * number, 0.0, 0.335 - (-0.45 + 0.06 * number) * sin(slope)),
                    0.26) for number in range(balls)]
    bodies += [body(f'rod_{number}', rail, (0.9 + 0.05 * number, 0.02 * number, 0.005), 0.1,
                    orientation=(0.0, 0.0, sin(0.6), cos(0.6))) for number in range(3)]
    return scene(bodies, restitution=0.3, friction=0.4)


def spinning(rate=1e4, shape=None):
    """Return bodies that spin fast and fall on the ground and each other."""
    shapes = (Cube(0.2), Box((0.1, 0.2, 0.3)), Sphere(0.1)) if shape is None else (shape,) * 3
    spins = ((0.0, 0.0, rate), (rate, 0.1 * rate, 0.0), (0.0, rate, 0.0))
    return scene([body(f'body_{number}', each, (0.5 * number, 0, 0.4), angular_velocity=spin)
                  for number, (each, spin) in enumerate(zip(shapes, spins))], restitution=0.5)


def shot(speed=1e4):
    """Return a small cube shot at a wall of nine cubes, one behind each other, on the ground."""
    targets = [body(f'target_{x}_{z}', Cube(0.2), (0.3 * x, 0, 0.1 + 0.2 * z))
               for x in range(3) for z in range(3)]
    bullet = body('bullet', Cube(0.05), (-2, 0.01, 0.33), 0.1, velocity=(speed, 0.0, 0.0),
                  orientation=attitude(np.random.default_rng(3)))
    return scene([bullet, *targets], restitution=0.3)


def overlapping(depth, count=3):
    """Return cubes on the ground and each other, `depth` of an edge into what is below."""
    return scene([body(f'cube_{level}', Cube(0.2), (0.01 * level, 0, 0.2 * (
        level + 0.5 - depth * (level + 1)))) for level in range(count)])


def swarm(count, speed=2.0, spin=3.0, seed=1, **values):
    """Return bodies of three shapes in free space that fly towards each other, tumbling."""
    random = np.random.default_rng(seed)
    shapes = (Cube(0.2), Box((0.1, 0.2, 0.3)), Sphere(0.12))
    side = int(np.ceil(count ** (1 / 3)))
    bodies = []
    for number, place in enumerate(list(np.ndindex(side, side, side))[:count]):
        where = 0.5 * (np.array(place) - 0.5 * (side - 1))
        velocity = -speed * where + random.normal(size=3) * 0.1 * speed
        bodies.append(body(f'body_{number}', shapes[number % 3], where, 1.0 + number % 4,
                           velocity=tuple(velocity.tolist()), orientation=attitude(random),
                           angular_velocity=vector(random, spin)))
    return scene(bodies, gravity=0.0, planes=False, restitution=0.3, friction=0.4, **values)


def throw(seed, restitution, friction, shape, edge=1.0, **values):
    """Return one body thrown over the ground, tumbling."""
    random = np.random.default_rng(seed)
    unit = (GRAVITY * edge) ** 0.5
    return scene([body(
        'thrown', shape, (0, 0, edge * random.uniform(2, 3)), orientation=attitude(random),
        velocity=vector(random, 0.5 * unit), angular_velocity=vector(random, 1.3 * unit / edge))],
        restitution, friction, **values)


def two_thrown(seed, restitution, friction, edge=1.0, order=(0, 1), **values):
    """Return two cubes flung at each other above the ground, the second first on demand."""
    random = np.random.default_rng(seed)
    unit = (GRAVITY * edge) ** 0.5
    direction = random.normal(size=3) * (1, 1, 0.3)
    direction /= np.linalg.norm(direction)
    speed = unit * random.uniform(0.16, 0.4)
    bodies = [body(name, Cube(edge), edge * (np.array((0, 0, 2)) + side * direction),
                   orientation=attitude(random),
                   velocity=tuple((-side * speed * direction).tolist()),
                   angular_velocity=vector(random, unit / edge))
              for name, side in (('a', -1.0), ('b', 1.0))]
    return scene([bodies[which] for which in order], restitution, friction, **values)


def several_thrown(count, seed, restitution, friction, **values):
    """Return three or more cubes on a ring above the ground, flung at its middle."""
    random = np.random.default_rng((count, seed))
    unit = GRAVITY ** 0.5
    bodies = []
    for number in range(count):
        angle = 2 * np.pi * number / count
        direction = np.array((np.cos(angle), np.sin(angle), 0.0))
        bodies.append(body(
            f'b{number}', Cube(1.0),
            direction / np.sin(np.pi / count) + (0, 0, 2 + random.uniform(-0.3, 0.3)),
            orientation=attitude(random),
            velocity=tuple((-unit * random.uniform(0.3, 0.8) * direction).tolist()),
            angular_velocity=vector(random, unit)))
    return scene(bodies, restitution, friction, **values)
