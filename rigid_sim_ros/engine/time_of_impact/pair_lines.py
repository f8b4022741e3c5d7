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
The lines of pairs in flight: one function for each pair of shapes, one row each in `LINES`.

A function takes two `Side`s, in the order of the row, and returns `march.Lines`. With d between a
vertex of each and |d''| <= A, along n + s n' the height z = (n + s n') . d has

    z' = n . d' + n' . d   and   z'' >= 2 n' . d' + n . d'' - 3 |n'| A s   (d' as it is now),

of which n . d'' is the difference of the known accelerations of the centres and of what turning
pulls, `Side.vertex_pull`. Integrated twice over s <= LIMIT / |n'|, the last term is no more than
LIMIT A s^2 / 2 below. What is round, of radius r, has the height z - r |n + s n'|.
"""

from dataclasses import dataclass

import numpy as np

from rigid_sim_ros.engine.bodies import PLANE
from rigid_sim_ros.engine.broad_phase.meeting import first_falls, sphere_meeting_times
from rigid_sim_ros.engine.narrow_phase.box_plane import VERTEX_SIGNS
from rigid_sim_ros.engine.narrow_phase.separating_axes import separating_axes
from rigid_sim_ros.engine.narrow_phase.sphere_box import nearest
from rigid_sim_ros.engine.rotation import cross, dot, matrix, transform, transform_transposed
from rigid_sim_ros.engine.time_of_impact.march import Lines


LIMIT = 0.3
"""Turning directions are used for steps up to this angle [rad]."""

NEVER = 1e300
"""A limit [s] that is none."""


@dataclass
class Side:
    """One body of q pairs, at times of their own."""

    solids: object
    """`Solids`, placed."""

    velocity: np.ndarray
    """(3, q) [m/s]."""

    spin: np.ndarray
    """(3, q) [rad/s], world axes."""

    acceleration: np.ndarray
    """(3, q) [m/s^2], of the centre of mass."""

    spin_bound: np.ndarray
    """(q,) [rad/s]: |w| until the end."""

    spin_change: np.ndarray
    """(q,) [rad/s^2]: |dw/dt| until the end."""

    left: np.ndarray
    """(q,) [s] until the end."""

    def vertex_pull(self, across):
        """
        Return how strongly, (q,) [m/s^2], turning pulls any vertex along n; `across` is n x w.

        n . (w x (w x r)) is (n x w) . (w x r): the part of w along n pulls nothing.
        """
        bound = length(across) + self.spin_change * self.left
        bound = np.minimum(bound, self.spin_bound)
        return (bound * self.spin_bound + self.spin_change) * self.solids.bounding_radius

    def vertex_acceleration(self):
        """Return a bound, (q,) [m/s^2], of how turning accelerates any vertex."""
        return ((self.spin_bound * self.spin_bound + self.spin_change)
                * self.solids.bounding_radius)

    def vertices(self, rotation, *directions):
        """
        Return how far [m], (8, q) each, the vertices are from the centre along `directions`.

        Along n x w this is how fast they move along n.
        """
        half = self.solids.half_extents[:, np.newaxis]
        offset = transform_transposed(rotation[:, :, np.newaxis], np.stack(directions, axis=1))
        offset *= half
        count = half.shape[-1]
        return (VERTEX_SIGNS.T @ offset.reshape(3, -1)).reshape(
            8, len(directions), count).transpose(1, 0, 2)


def length(vectors):
    """Return the lengths, (q,), of vectors (3, q)."""
    return np.sqrt(dot(vectors, vectors))


def box_plane(a, b):
    """Return the lines of the 8 vertices of a box above a plane, which does not turn."""
    normal = b.solids.plane_normal
    across = cross(normal, a.spin)
    height, speed = a.vertices(matrix(a.solids.orientation), normal, across)
    return _above_plane(a, b, height, speed, a.vertex_pull(across))


def sphere_plane(a, b):
    """Return the line of a sphere's lowest point; its pull is exact."""
    zero = np.zeros((1, len(a.left)))
    return _above_plane(a, b, zero - a.solids.radius, zero, 0.0)


def _above_plane(a, b, height, speed, pull):
    """Return the lines of points (m, q) that are so high above the centre of a."""
    normal, offset = b.solids.plane_normal, b.solids.plane_offset
    center = dot(normal, a.solids.center)
    center_speed, center_pull = dot(normal, a.velocity), -dot(normal, a.acceleration)
    return Lines(
        center - offset + height, center_speed + speed, pull + center_pull,
        np.full(len(a.left), NEVER), None, None,
        first_falls(center - offset - a.solids.bounding_radius, center_speed, -center_pull),
        np.abs(center) + np.abs(offset) + a.solids.bounding_radius)


def sphere_sphere(a, b):
    """Return the line between two centres."""
    between = b.solids.center - a.solids.center
    distance = length(between)
    normal = between / np.where(distance > 0, distance, 1.0)
    velocity = b.velocity - a.velocity
    around = velocity - normal * dot(normal, velocity)
    rate = around / np.where(distance > 0, distance, np.inf)
    zero = np.zeros((1, len(distance)))
    return _turning(a, b, normal, rate, a.solids.radius + b.solids.radius,
                    (zero, zero, zero, zero), 0.0, 0.0)


def sphere_box(a, b):
    """Return the lines from a sphere to the 8 vertices of a box, along the shortest way."""
    rotation = matrix(b.solids.orientation)
    outward, gap, beyond = nearest(rotation, a.solids, b.solids)
    velocity = a.velocity - b.velocity - cross(b.spin, a.solids.center - b.solids.center)
    # around an edge or a vertex; a face has its one direction
    around = np.where(beyond, transform_transposed(rotation, velocity), 0.0)
    around -= outward * dot(outward, around)
    distance = gap + a.solids.radius
    around = around / np.where(distance > 0, distance, np.inf)
    normal = -transform(rotation, outward)
    rate = cross(b.spin, normal) - transform(rotation, around)
    across = cross(normal, b.spin)
    return _turning(a, b, normal, rate, a.solids.radius,
                    b.vertices(rotation, normal, across, rate, cross(rate, b.spin)),
                    b.vertex_pull(across), b.vertex_acceleration())


def box_box(a, b):
    """Return the lines from 8 to 8 vertices along the best of the 15 axes."""
    axes = separating_axes(a.solids, b.solids)
    best = axes.best()
    normal, rate = best.normal, best.rate(a.spin, b.spin)
    across = [cross(normal, side.spin) for side in (a, b)]
    of_a, of_b = (
        side.vertices(rotation, normal, turn, rate, cross(rate, side.spin))
        for side, rotation, turn in zip((a, b), (axes.rotation_a, axes.rotation_b), across))
    along = (of_b[:, np.newaxis] - of_a[:, :, np.newaxis]).reshape(4, 64, -1)
    return _turning(a, b, normal, rate, 0.0, along,
                    a.vertex_pull(across[0]) + b.vertex_pull(across[1]),
                    a.vertex_acceleration() + b.vertex_acceleration())


def _turning(a, b, normal, rate, radius, along, pull, acceleration):
    """
    Return the lines of points of a and b along normals (3, q) that turn at `rate` (3, q).

    `along` holds what the points (m, q) of b are beyond those of a, seen from the centres, along
    the normal, along n x w, along the rate n' and along n' x w; `pull` and `acceleration` are
    bounds, (q,), of what turning does to them.
    """
    between = b.solids.center - a.solids.center
    velocity = b.velocity - a.velocity
    push = b.acceleration - a.acceleration
    turn = length(rate)
    held_speed = dot(normal, velocity) + along[1]
    held_pull = pull - dot(normal, push)
    strongest = (held_pull - 2 * dot(rate, velocity) + LIMIT * (acceleration + length(push))
                 + radius * turn * turn)
    reach = a.solids.bounding_radius + b.solids.bounding_radius
    return Lines(
        dot(normal, between) - radius + along[0],
        held_speed + dot(rate, between) + along[2], strongest - 2 * along[3],
        LIMIT / np.maximum(turn, LIMIT / NEVER), held_speed, held_pull,
        _apart(reach, between, velocity, push),
        np.abs(a.solids.center).max(axis=0) + np.abs(b.solids.center).max(axis=0) + reach)


def _apart(reach, between, velocity, push):
    """Return how long [s], (q,), the bounding spheres stay apart."""
    result = np.zeros(len(reach))
    rows = np.flatnonzero(dot(between, between) > reach * reach)
    if len(rows):
        result[rows] = sphere_meeting_times(
            reach[rows], *(values[:, rows] for values in (between, velocity, push)))
    return result


LINES = {('box', 'box'): box_box, ('box', PLANE): box_plane, ('sphere', 'box'): sphere_box,
         ('sphere', PLANE): sphere_plane, ('sphere', 'sphere'): sphere_sphere}
"""What of each pair of kinds may touch; the keys are those of the narrow phase."""


class PairLines:
    """The lines of pairs of the same kinds, at any times of their flights until the end."""

    def __init__(self, kinds, flights, a, b, start, end):
        """Watch `Solids` a and b, of kinds in the order of `LINES`, from the time `start`."""
        self._lines = LINES[kinds]
        self._flights = flights
        self._sides = a, b
        self._end = end
        index = np.concatenate((a.index, b.index))
        self._constants = (flights.acceleration.take(index, axis=1),
                           flights.rate_bound(index, start, end),
                           flights.rate_derivative_bound(index, start, end))

    def __call__(self, pairs, time):
        """Return the `Lines` of pairs, (q,) int, at times (q,) [s]."""
        return self._lines(*self.sides(pairs, time))

    def sides(self, pairs, time):
        """Return the `Side`s a and b of pairs, (q,) int, at times (q,) [s]."""
        count = len(self._sides[0].index)
        both = np.concatenate((pairs, pairs + count))
        a, b = (side.select(pairs) for side in self._sides)
        twice = np.concatenate((time, time))
        motion = self._flights.motions(np.concatenate((a.index, b.index)), twice)
        columns = (*motion, *(values.take(both, axis=-1) for values in self._constants),
                   self._end - twice)
        return tuple(
            Side(solids.at(*(values[..., part] for values in columns[:2])),
                 *(values[..., part] for values in columns[2:]))
            for solids, part in ((a, slice(len(pairs))), (b, slice(len(pairs), None))))
