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

"""The lines of two boxes in plain floats: `separating_axes` and `pair_lines.box_box` for one."""

from math import inf, sqrt

from rigid_sim_ros.engine.narrow_phase.separating_axes import PARALLEL
from rigid_sim_ros.engine.plain_vectors import axes_of, cross, difference, dot
from rigid_sim_ros.engine.time_of_impact.plain_lines import turning


def box_box(a, b, end):
    """Return the lines of two boxes, `PlainBody`s."""
    def lines(time):
        position, quaternion, velocity, spin = a.motion(time)
        other_position, other_quaternion, other_velocity, other_spin = b.motion(time)
        axes, other_axes = axes_of(quaternion), axes_of(other_quaternion)
        between = difference(position, other_position)
        normal, edge, other_edge = best_axis(axes, other_axes, a.half, b.half, between)
        if dot(normal, between) < 0:
            x, y, z = normal
            normal = -x, -y, -z
        rate = _rate(normal, edge, other_edge, spin, other_spin)
        across, other_across = cross(normal, spin), cross(normal, other_spin)
        of_a = [a.corners(axes, direction) for direction in (
            normal, across, rate, cross(rate, spin))]
        of_b = [b.corners(other_axes, direction) for direction in (
            normal, other_across, rate, cross(rate, other_spin))]
        left = end - time
        return turning(
            a, b, normal, rate, position, other_position, difference(velocity, other_velocity),
            0.0, of_a, of_b, a.vertex_pull(across, left) + b.vertex_pull(other_across, left),
            a.vertex_acceleration() + b.vertex_acceleration())
    return lines


def best_axis(axes, other_axes, half, other_half, between):
    """
    Return the axis, of all 15, along which two boxes are apart the most.

    A unit vector of either sign, and the edges of a and of b whose product it is; where it is the
    normal of a face that edge is None, and of the other body it is the normal again.
    """
    best, found = -inf, None
    relative = [[dot(p, q) for q in other_axes] for p in axes]
    offset = [dot(p, between) for p in axes]
    for i, row in enumerate(relative):
        apart = abs(offset[i]) - half[i] - (abs(row[0]) * other_half[0] + abs(row[1])
                                            * other_half[1] + abs(row[2]) * other_half[2])
        if apart > best:
            best, found = apart, (axes[i], axes[i], None)
    for j, axis in enumerate(other_axes):
        apart = abs(dot(axis, between)) - other_half[j] - (
            abs(relative[0][j]) * half[0] + abs(relative[1][j]) * half[1]
            + abs(relative[2][j]) * half[2])
        if apart > best:
            best, found = apart, (axis, None, axis)
    edges = None
    for i, i1, i2 in _CYCLES:
        row1, row2 = relative[i1], relative[i2]
        offset1, offset2, half1, half2 = offset[i1], offset[i2], half[i1], half[i2]
        for j, j1, j2 in _CYCLES:
            p, q = row2[j], row1[j]
            apart = (abs(offset2 * q - offset1 * p) - half1 * abs(p) - half2 * abs(q)
                     - other_half[j1] * abs(q * row2[j1] - p * row1[j1])
                     - other_half[j2] * abs(q * row2[j2] - p * row1[j2]))
            sine = sqrt(p * p + q * q)
            if sine > PARALLEL and apart > best * sine:
                best, edges = apart / sine, (i, j)
    if edges is None:
        return found
    edge, other_edge = axes[edges[0]], other_axes[edges[1]]
    x, y, z = cross(edge, other_edge)
    inverse = 1 / sqrt(x * x + y * y + z * z)
    return (x * inverse, y * inverse, z * inverse), edge, other_edge


_CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def _rate(normal, edge, other_edge, spin, other_spin):
    """Return how the normal turns: `Direction.rate`."""
    if other_edge is None:
        return cross(spin, normal)
    if edge is None:
        return cross(other_spin, normal)
    x, y, z = cross(edge, other_edge)
    inverse = 1 / (x * normal[0] + y * normal[1] + z * normal[2])
    p, q = cross(cross(spin, edge), other_edge), cross(edge, cross(other_spin, other_edge))
    rate = [(u + v) * inverse for u, v in zip(p, q)]
    along = dot(normal, rate)
    return [u - along * n for u, n in zip(rate, normal)]
