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
Two boxes that meet with a face of at least one: the other's nearest face, clipped to it.

Everything happens in axes of the reference face: x and y along its sides, height above it. The
nearest face of the other box (the incident face) is a parallelogram there, and every corner of
what is left of it within the rectangle is a contact point: the clipped ends of its four sides
(Liang and Barsky 1984) and the corners of the rectangle inside it, in 12 slots. No corner is left
out, so that the points do not depend on how vertices are numbered.
"""

import numpy as np

from rigid_sim_ros.engine.contacts import Contacts, FACE_A, FACE_B

CLIP = 1e-8
"""The rectangle is wider by this much of the size, so that flush sides are not cut twice."""

SAME_POINT = 4 * CLIP
"""Corners nearer to each other than this much of the size are one."""

_TINY = 1e-300
"""Added to a side's run: leaves all but zero as it is and makes division safe."""

_NEXT, _AFTER = np.array((1, 2, 0)), np.array((2, 0, 1))
_CORNER_X = np.array((1.0, -1.0, -1.0, 1.0))[:, np.newaxis]
_CORNER_Y = np.array((1.0, 1.0, -1.0, -1.0))[:, np.newaxis]


def face_contacts(a, b, axes, pairs, of_b, margin, size):
    """
    Return the contact points of `pairs`, (q,), with a separation below `margin` [m], (p,).

    `of_b`, (q,) bool, says whose face the reference is; `size` [m], (p,), scales tolerances.
    """
    frame = _Frame(a, b, axes, pairs, of_b)
    margin, size = margin[pairs], size[pairs]
    points, valid = _clip(frame, CLIP * size)
    valid &= points[2] < margin
    _keep_support(frame, points, valid, margin)
    pair, slot = np.nonzero(valid.T)
    local = points[:, slot, pair]
    distinct = _distinct(pair, local, SAME_POINT * size[pair])
    pair, local = pair[distinct], local[:, distinct]
    gap = local[2].copy()
    local[2] = frame.half[2, pair] + 0.5 * gap
    point = frame.origin[:, pair] + (frame.world[:, :, pair] * local).sum(axis=1)
    of_b = of_b[pair]
    normal = np.where(of_b, -1.0, 1.0) * frame.world[:, 2, pair]
    zeros = np.zeros_like(normal)
    return Contacts(a.index[pairs[pair]], b.index[pairs[pair]], point, normal, gap,
                    np.where(of_b, FACE_B, FACE_A), zeros, zeros)


class _Frame:
    """The reference rectangle and the incident parallelogram of q pairs."""

    def __init__(self, a, b, axes, pairs, of_b):
        columns = np.arange(len(pairs))
        half_a, half_b = a.half_extents[:, pairs], b.half_extents[:, pairs]
        half, other_half = np.where(of_b, (half_b, half_a), (half_a, half_b))
        relative = axes.relative[:, :, pairs]
        relative = np.where(of_b, relative.transpose(1, 0, 2), relative)
        offset = np.where(of_b, -axes.offset_b[:, pairs], axes.offset_a[:, pairs])
        axis = np.where(of_b, axes.faces_b[:, pairs], axes.faces_a[:, pairs]).argmax(axis=0)
        rows = np.stack((_NEXT[axis], _AFTER[axis], axis))
        facing = np.abs(relative[axis, :, columns]).argmax(axis=1)
        other_rows = np.stack((_NEXT[facing], _AFTER[facing], facing))
        # the third axis of the frame is the outward normal of the reference face
        outward = np.copysign(1.0, offset[axis, columns])
        turned = relative[rows[:, np.newaxis], other_rows, columns]
        turned[2] *= outward
        other_half = other_half[other_rows, columns]
        center = offset[rows, columns]
        center[2] *= outward
        center -= np.copysign(other_half[2], turned[2, 2]) * turned[:, 2]

        self.half = half[rows, columns]
        """(3, q) [m]: half the sides of the rectangle; its distance from the centre."""
        center[2] -= self.half[2]
        self.center = center
        """(3, q) [m]: middle of the incident face."""
        self.side_x = other_half[0] * turned[:, 0]
        self.side_y = other_half[1] * turned[:, 1]
        """(3, q) [m]: half its sides."""
        self.origin = np.where(of_b, b.center[:, pairs], a.center[:, pairs])
        """(3, q) [m]: centre of the reference box, world axes."""
        world = np.where(of_b, axes.rotation_b[:, :, pairs], axes.rotation_a[:, :, pairs])
        self.world = world[:, rows, columns]
        """(3, 3, q): frame to world axes, without the origin."""
        self.world[:, 2] *= outward


def _clip(frame, tolerance):
    """Return the 12 candidate points, (3, 12, q), x, y, height, and which of them exist."""
    start = (frame.center[:, np.newaxis] + _CORNER_X * frame.side_x[:, np.newaxis]
             + _CORNER_Y * frame.side_y[:, np.newaxis])
    run = np.stack((-2 * frame.side_x, -2 * frame.side_y,
                    2 * frame.side_x, 2 * frame.side_y), axis=1)
    border = (frame.half[:2] + tolerance)[:, np.newaxis]
    flat_run = run[:2] + _TINY
    one, two = (-border - start[:2]) / flat_run, (border - start[:2]) / flat_run
    enter = np.maximum(np.minimum(one, two).max(axis=0), 0.0)
    leave = np.minimum(np.maximum(one, two).min(axis=0), 1.0)
    exists = enter <= leave
    corners, inside = _corners_inside(frame)
    points = np.concatenate((start + enter * run, start + leave * run, corners), axis=1)
    return points, np.concatenate((exists, exists & (leave < 1.0), inside))


def _corners_inside(frame):
    """Return the reference corners, (3, 4, q), on the incident face, and which are inside it."""
    x, y = _CORNER_X * frame.half[0], _CORNER_Y * frame.half[1]
    side_x, side_y = frame.side_x, frame.side_y
    from_x, from_y = x - frame.center[0], y - frame.center[1]
    # never small: of all faces the incident one is turned most towards the reference face
    area = side_x[0] * side_y[1] - side_x[1] * side_y[0]
    along_x = (from_x * side_y[1] - from_y * side_y[0]) / area
    along_y = (from_y * side_x[0] - from_x * side_x[1]) / area
    height = frame.center[2] + along_x * side_x[2] + along_y * side_y[2]
    return (np.stack((x, y, height)),
            (np.abs(along_x) <= 1.0) & (np.abs(along_y) <= 1.0))


def _distinct(pair, points, tolerance):
    """Return which of the points, (3, k), are not one that came before in the same pair, (k,)."""
    distinct = np.ones(len(pair), dtype=bool)
    for back in range(1, np.bincount(pair, minlength=1).max()):
        apart = np.abs(points[:2, back:] - points[:2, :-back]).max(axis=0)
        distinct[back:] &= (pair[back:] != pair[:-back]) | (apart >= tolerance[back:])
    return distinct


def _keep_support(frame, points, valid, margin):
    """
    Give pairs without any point their lowest one, moved into the rectangle.

    Boxes that overlap, or touch within the margin, have a contact even if the incident face misses
    the reference face, as it can where a corner cuts a corner.
    """
    empty = np.flatnonzero(~valid.any(axis=0))
    if not len(empty):
        return
    side_x, side_y = frame.side_x[:, empty], frame.side_y[:, empty]
    lowest = (frame.center[:, empty] - np.copysign(1.0, side_x[2]) * side_x
              - np.copysign(1.0, side_y[2]) * side_y)
    border = frame.half[:2, empty]
    inside = np.clip(lowest[:2], -border, border)
    aside = np.abs(inside - lowest[:2]).max(axis=0)
    points[:2, 0, empty] = inside
    points[2, 0, empty] = lowest[2]
    margin = margin[empty]
    valid[0, empty] = (lowest[2] <= 0) | ((lowest[2] < margin) & (aside < margin))
