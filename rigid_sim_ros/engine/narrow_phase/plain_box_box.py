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
Two boxes in plain floats: `box_box.contacts` for one pair, five times quicker than with arrays.

Every step is that of `separating_axes`, `face_clipping` or `edge_pair`, in the same order and with
the same tolerances, but that it ends at the first axis along which the boxes are far apart.
"""

from math import copysign, inf, sqrt

from rigid_sim_ros.engine.contacts import EDGES, FACE_A, FACE_B
from rigid_sim_ros.engine.narrow_phase.box_box import EDGE_PREFERENCE, TIE
from rigid_sim_ros.engine.narrow_phase.face_clipping import CLIP, SAME_POINT
from rigid_sim_ros.engine.narrow_phase.separating_axes import PARALLEL
from rigid_sim_ros.engine.plain_vectors import axes_of, cross, difference, dot

_CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
_TINY = 1e-300
_NOTHING = (0.0, 0.0, 0.0)


class PlainBox:
    """One box at a pose: centre [m], body axes in world axes, half extents [m]."""

    __slots__ = ('center', 'axes', 'half', 'radius')

    def __init__(self, center, orientation, half, radius):
        """Take sequences of floats, and the bounding radius [m]."""
        self.center = center
        self.axes = axes_of(orientation)
        self.half = half
        self.radius = radius


def box_with_box(a, b, margin):
    """
    Return the contacts of two `PlainBox` with gaps below `margin` [m], a list of tuples.

    Each holds point, normal, separation, feature, edge of a, edge of b, as in `Contacts`.
    """
    axes = _Axes(a, b)
    best_a, axis_a = axes.faces_a()
    if best_a >= margin:
        return ()
    best_b, axis_b = axes.faces_b()
    best_edge, edges = axes.edges()
    if best_b >= margin or best_edge >= margin:
        return ()
    size = min(a.radius, b.radius)
    of_b = best_b > best_a + TIE * size
    best_face = best_b if of_b else best_a
    lead = max(min(margin, EDGE_PREFERENCE * size), TIE * size)
    if best_edge > best_face + lead:
        return (_edge_contact(a, b, axes.between, *edges, best_edge),)
    if of_b:
        return _face_contacts(b, a, list(zip(*axes.relative)), [-x for x in axes.offset_b],
                              axis_b, True, margin, size)
    return _face_contacts(a, b, axes.relative, axes.offset_a, axis_a, False, margin, size)


def separation_of_boxes(a, b):
    """Return the signed distance [m] along the best of all 15 axes: `box_box.separation`."""
    axes = _Axes(a, b)
    return max(axes.faces_a()[0], axes.faces_b()[0], axes.edges()[0])


class _Axes:
    """Distances along the axes of two boxes: `separating_axes.Axes` for one pair."""

    __slots__ = ('between', 'relative', 'offset_a', 'offset_b', '_half', '_other_half')

    def __init__(self, a, b):
        between = self.between = difference(a.center, b.center)
        self.relative = [[dot(p, q) for q in b.axes] for p in a.axes]
        self.offset_a = [dot(p, between) for p in a.axes]
        self.offset_b = [dot(q, between) for q in b.axes]
        self._half, self._other_half = a.half, b.half

    def faces_a(self):
        """Return (distance [m], axis) of the best face of a."""
        one, two, three = self._other_half
        return _largest([
            abs(x) - half - (abs(p) * one + abs(q) * two + abs(r) * three)
            for x, half, (p, q, r) in zip(self.offset_a, self._half, self.relative)])

    def faces_b(self):
        """Return (distance [m], axis) of the best face of b."""
        one, two, three = self._half
        return _largest([
            abs(x) - half - (abs(p) * one + abs(q) * two + abs(r) * three)
            for x, half, p, q, r in zip(self.offset_b, self._other_half, *self.relative)])

    def edges(self):
        """Return (distance [m], edges) of the best product of edges; -infinity if none."""
        return _best_edges(self.relative, self.offset_a, self._half, self._other_half)


def _largest(values):
    """Return the largest of some values, and the place of the first such."""
    largest = max(values)
    return largest, values.index(largest)


def _best_edges(relative, offset, half, other_half):
    """Return the largest distance [m] along products of edges, and which edges; -inf if none."""
    best, edges = -inf, None
    for i, i1, i2 in _CYCLES:
        row1, row2 = relative[i1], relative[i2]
        offset1, offset2, half1, half2 = offset[i1], offset[i2], half[i1], half[i2]
        for j, j1, j2 in _CYCLES:
            p, q = row2[j], row1[j]
            sine = sqrt(p * p + q * q)
            if sine < PARALLEL:
                continue
            apart = (abs(offset2 * q - offset1 * p) - half1 * abs(p) - half2 * abs(q)
                     - other_half[j1] * abs(q * row2[j1] - p * row1[j1])
                     - other_half[j2] * abs(q * row2[j2] - p * row1[j2])) / sine
            if apart > best:
                best, edges = apart, (i, j)
    return best, edges


def _edge_contact(a, b, between, axis_a, axis_b, gap):
    """Return the contact where an edge of each crosses: `edge_pair.edge_contacts`."""
    edge_a, edge_b = a.axes[axis_a], b.axes[axis_b]
    normal = cross(edge_a, edge_b)
    inverse = copysign(1 / sqrt(dot(normal, normal)), dot(normal, between))
    normal = tuple(inverse * x for x in normal)
    middle_a = _middle(a, axis_a, normal, 1.0)
    middle_b = _middle(b, axis_b, normal, -1.0)
    apart = difference(middle_a, middle_b)
    cosine, sine = dot(edge_a, edge_b), cross(edge_a, edge_b)
    square, ahead_a, ahead_b = dot(sine, sine), dot(edge_a, apart), dot(edge_b, apart)
    half_a, half_b = a.half[axis_a], b.half[axis_b]
    along_a = min(max((ahead_a - cosine * ahead_b) / square, -half_a), half_a)
    along_b = min(max((cosine * ahead_a - ahead_b) / square, -half_b), half_b)
    point = tuple(0.5 * (p + along_a * u + q + along_b * v) for p, u, q, v in zip(
        middle_a, edge_a, middle_b, edge_b))
    return point, normal, gap, EDGES, edge_a, edge_b


def _middle(box, axis, direction, sign):
    """Return the middle of the edge along `axis` that is furthest along sign * `direction`."""
    x, y, z = box.center
    for i, (along, half) in enumerate(zip(box.axes, box.half)):
        if i != axis:
            u, v, w = along
            half = copysign(half, sign * dot(along, direction))
            x, y, z = x + half * u, y + half * v, z + half * w
    return x, y, z


def _face_contacts(box, other, relative, offset, axis, of_b, margin, size):
    """
    Return the contacts of a face of `box` with `other`: `face_clipping.face_contacts`.

    `relative` holds the axes of the other box in those of this one, `offset` its centre.
    """
    rows = _CYCLES[axis][1:] + (axis,)
    row = relative[axis]
    facing = max(range(3), key=lambda j: abs(row[j]))
    columns = _CYCLES[facing][1:] + (facing,)
    outward = copysign(1.0, offset[axis])
    half_x, half_y, half_z = (box.half[i] for i in rows)
    extent_x, extent_y, extent_z = (other.half[j] for j in columns)
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = (
        [relative[i][j] for j in columns] for i in rows)
    zx, zy, zz = outward * zx, outward * zy, outward * zz
    depth = copysign(extent_z, zz)
    # the incident face: its middle and half its sides, in axes of the reference face
    middle = (offset[rows[0]] - depth * xz, offset[rows[1]] - depth * yz,
              outward * offset[rows[2]] - depth * zz - half_z)
    side_x = extent_x * xx, extent_x * yx, extent_x * zx
    side_y = extent_y * xy, extent_y * yy, extent_y * zy
    found = _clipped(middle, side_x, side_y, half_x, half_y, CLIP * size)
    found = [point for point in found if point[2] < margin]
    same = SAME_POINT * size
    found = [point for place, point in enumerate(found) if not any(
        abs(point[0] - earlier[0]) < same and abs(point[1] - earlier[1]) < same
        for earlier in found[:place])]
    if not found:
        found = _support(middle, side_x, side_y, half_x, half_y, margin)
    one, two, up = (box.axes[i] for i in rows)
    up = tuple(outward * x for x in up)
    normal = tuple(-x for x in up) if of_b else up
    feature = FACE_B if of_b else FACE_A
    result = []
    for x, y, gap in found:
        z = half_z + 0.5 * gap
        point = tuple(c + x * p + y * q + z * r for c, p, q, r in zip(box.center, one, two, up))
        result.append((point, normal, gap, feature, _NOTHING, _NOTHING))
    return result


def _clipped(middle, side_x, side_y, half_x, half_y, tolerance):
    """Return the corners (x, y, height) of what of a parallelogram is within a rectangle."""
    mx, my, mz = middle
    ax, ay, az = side_x
    bx, by, bz = side_y
    border_x, border_y = half_x + tolerance, half_y + tolerance
    entering, leaving = [], []
    for x, y, z, u, v, w in (
            (mx + ax + bx, my + ay + by, mz + az + bz, -2 * ax, -2 * ay, -2 * az),
            (mx - ax + bx, my - ay + by, mz - az + bz, -2 * bx, -2 * by, -2 * bz),
            (mx - ax - bx, my - ay - by, mz - az - bz, 2 * ax, 2 * ay, 2 * az),
            (mx + ax - bx, my + ay - by, mz + az - bz, 2 * bx, 2 * by, 2 * bz)):
        flat_u, flat_v = u + _TINY, v + _TINY
        one_x, two_x = (-border_x - x) / flat_u, (border_x - x) / flat_u
        one_y, two_y = (-border_y - y) / flat_v, (border_y - y) / flat_v
        enter = max(min(one_x, two_x), min(one_y, two_y), 0.0)
        leave = min(max(one_x, two_x), max(one_y, two_y), 1.0)
        if enter <= leave:
            entering.append((x + enter * u, y + enter * v, z + enter * w))
            if leave < 1.0:
                leaving.append((x + leave * u, y + leave * v, z + leave * w))
    area = ax * by - bx * ay
    inside = []
    for x, y in ((half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y)):
        from_x, from_y = x - mx, y - my
        along_x = (from_x * by - from_y * bx) / area
        along_y = (from_y * ax - from_x * ay) / area
        if abs(along_x) <= 1.0 and abs(along_y) <= 1.0:
            inside.append((x, y, mz + along_x * az + along_y * bz))
    return entering + leaving + inside


def _support(middle, side_x, side_y, half_x, half_y, margin):
    """Return the lowest point, moved into the rectangle: `face_clipping._keep_support`."""
    sign_x, sign_y = copysign(1.0, side_x[2]), copysign(1.0, side_y[2])
    x, y, z = (m - sign_x * p - sign_y * q for m, p, q in zip(middle, side_x, side_y))
    inside_x = min(max(x, -half_x), half_x)
    inside_y = min(max(y, -half_y), half_y)
    aside = max(abs(inside_x - x), abs(inside_y - y))
    if z <= 0 or (z < margin and aside < margin):
        return [(inside_x, inside_y, z)]
    return []
