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
The lines of one pair in plain floats: what `pair_lines` has for many.

Each function returns the one that `plain_march.march_one` asks for the lines at a time; `end` [s]
is the end of the search.
"""

from functools import partial
from math import copysign
from operator import add

from rigid_sim_ros.engine.broad_phase.meeting import first_fall, sphere_meeting_time
from rigid_sim_ros.engine.plain_vectors import (
    axes_of, corners, cross, difference, dot, length, to_world)
from rigid_sim_ros.engine.time_of_impact.pair_lines import LIMIT, NEVER


POINT = ((0.0,),) * 4
"""What a centre has in the place of vertices, see `turning`."""


class PlainBody:
    """What stays of one body in flight, as plain floats."""

    __slots__ = ('motion', 'half', 'radius', 'acceleration', 'spin_bound', 'spin_change')

    def __init__(self, bodies, flights, index, start, end):
        """Look up one body, whose bounds are to hold between two times [s]."""
        self.motion = flights.trajectory(index)
        self.spin_bound, self.spin_change = flights.bounds_of_one(index, start, end)
        self.half = bodies.half_extents[:, index].tolist()
        self.radius = bodies.bounding_radius.item(index)
        self.acceleration = flights.acceleration[:, index].tolist()

    def vertex_pull(self, across, left):
        """Return how strongly [m/s^2] turning pulls a vertex along n; see `pair_lines.Side`."""
        bound = self.spin_bound
        reached = min(length(across) + self.spin_change * left, bound)
        return (reached * bound + self.spin_change) * self.radius

    def vertex_acceleration(self):
        """Return a bound [m/s^2] of how turning accelerates a vertex."""
        return (self.spin_bound * self.spin_bound + self.spin_change) * self.radius

    def corners(self, axes, direction, middle=0.0):
        """Return where [m] the 8 vertices are along `direction`: `plain_vectors.corners`."""
        return corners(axes, self.half, direction, middle)


def box_plane(a, normal, offset, end):
    """Return the lines of a box above a plane."""
    push = dot(normal, a.acceleration)

    def lines(time):
        position, quaternion, velocity, spin = a.motion(time)
        axes = axes_of(quaternion)
        center = dot(normal, position)
        height, speed = center - offset, dot(normal, velocity)
        across = cross(normal, spin)
        pull = a.vertex_pull(across, end - time) - push
        return (a.corners(axes, normal, height), a.corners(axes, across, speed), [pull] * 8,
                NEVER, None, 0.0, first_fall(height - a.radius, speed, push),
                abs(center) + abs(offset) + a.radius)
    return lines


def sphere_plane(a, normal, offset, end):
    """Return the line of a sphere above a plane."""
    push = dot(normal, a.acceleration)

    def lines(time):
        position, _, velocity, _ = a.motion(time)
        center = dot(normal, position)
        height, speed = center - offset - a.radius, dot(normal, velocity)
        return ([height], [speed], [-push], NEVER, None, 0.0, first_fall(height, speed, push),
                abs(center) + abs(offset) + a.radius)
    return lines


def sphere_sphere(a, b, end):
    """Return the line of two spheres."""
    reach = a.radius + b.radius

    def lines(time):
        start, _, velocity, _ = a.motion(time)
        there, _, other_velocity, _ = b.motion(time)
        between = difference(start, there)
        velocity = difference(velocity, other_velocity)
        distance = length(between)
        inverse = 1 / distance if distance > 0 else 0.0
        x, y, z = between
        normal = x * inverse, y * inverse, z * inverse
        speed = dot(normal, velocity)
        rate = tuple((v - speed * n) * inverse for v, n in zip(velocity, normal))
        return turning(a, b, normal, rate, start, there, velocity, reach,
                       POINT, POINT, 0.0, 0.0)
    return lines


def sphere_box(a, b, end):
    """Return the lines from a sphere to the vertices of a box; see `pair_lines.sphere_box`."""
    def lines(time):
        position, _, velocity, _ = a.motion(time)
        other_position, quaternion, other_velocity, spin = b.motion(time)
        axes = axes_of(quaternion)
        away = difference(other_position, position)
        outward, distance, beyond = nearest([dot(axis, away) for axis in axes], b.half)
        x, y, z = difference(other_velocity, velocity)
        p, q, r = cross(spin, away)
        past = x - p, y - q, z - r
        around = [dot(axis, past) if on else 0.0 for axis, on in zip(axes, beyond)]
        along = dot(outward, around)
        inverse = 1 / distance if distance > 0 else 0.0
        around = [(u - along * n) * inverse for u, n in zip(around, outward)]
        # from the sphere to the box
        normal = [-u for u in to_world(axes, outward)]
        rate = [u - v for u, v in zip(cross(spin, normal), to_world(axes, around))]
        across = cross(normal, spin)
        return turning(
            a, b, normal, rate, position, other_position, difference(velocity, other_velocity),
            a.radius, POINT, [b.corners(axes, direction) for direction in (
                normal, across, rate, cross(rate, spin))],
            b.vertex_pull(across, end - time), b.vertex_acceleration())
    return lines


def differences(values, other_values, constant):
    """Return constant + q - p for every p of some values and every q of others."""
    return [q - p for p in [p - constant for p in values] for q in other_values]


def nearest(center, half):
    """Return the direction out of a box, how far, and beyond which faces; see `sphere_box`."""
    outside = [abs(x) - h for x, h in zip(center, half)]
    beyond = [x > 0 for x in outside]
    excess = [max(x, 0.0) for x in outside]
    distance = length(excess)
    if distance > 0:
        direction = [x / distance for x in excess]
    else:
        distance = max(outside)
        least = outside.index(distance)
        direction = [float(axis == least) for axis in range(3)]
    return [copysign(x, y) for x, y in zip(direction, center)], distance, beyond


def turning(a, b, normal, rate, position, other_position, velocity, radius,
            of_a, of_b, pull, acceleration):
    """
    Return the lines of points of a and b along a normal that turns: `pair_lines._turning`.

    Of each body, where its points are along n, n x w, the rate n' and n' x w, seen from its
    centre: four sequences.
    """
    between = difference(position, other_position)
    push = difference(a.acceleration, b.acceleration)
    turn = length(rate)
    height = dot(normal, between) - radius
    held_speed, held_pull = dot(normal, velocity), pull - dot(normal, push)
    turned, swing = dot(rate, between), dot(rate, velocity)
    strongest = (held_pull - 2 * swing + LIMIT * (acceleration + length(push))
                 + radius * turn * turn)
    reach = a.radius + b.radius
    apart = 0.0
    if dot(between, between) > reach * reach:
        apart = sphere_meeting_time(reach, between, velocity, push)
    (heights, across, turning_heights, turning_speeds) = of_a
    (other_heights, other_across, other_turning_heights, other_turning_speeds) = of_b
    return (differences(heights, other_heights, height),
            differences(map(add, across, turning_heights),
                        list(map(add, other_across, other_turning_heights)), held_speed + turned),
            differences([-2 * u for u in turning_speeds],
                        [-2 * u for u in other_turning_speeds], strongest),
            LIMIT / turn if turn * NEVER > 1 else NEVER,
            partial(differences, across, other_across, held_speed), held_pull, apart,
            max(map(abs, position)) + max(map(abs, other_position)) + reach)
