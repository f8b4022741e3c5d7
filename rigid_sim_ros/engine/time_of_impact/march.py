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
The march to a first touch, which cannot miss one.

Two convex bodies are apart as long as there is a direction along which every vertex of the one is
above every vertex of the other. Along a direction each pair of vertices (a *line*) has a height z
and a speed u now, and however the bodies turn it stays above a minorant z + u s - K s^2 / 2 for
some time. Until the first minorant of all lines ends nothing can touch. March there, choose the
best direction again, repeat: the times converge to the first touch, from before, and as nothing
is sampled or bracketed a graze is found as well as a blow.

Directions are n + s n', turned at first order with the faces or edges that make them. Then the
vertices of a face, or of two edges that cross, keep the same height among themselves, and the
march converges quadratically; with the direction held it would be linear, as a turning edge puts
one end down. Of a direction held, however, K is smaller: it makes the longer steps far away.

A pair that was just resolved touches within rounding and must not be found again. Its lines have
the level -RELEASE of their size in the place of zero until they have been, or will for certain
be, above ARM of it.
"""

from dataclasses import dataclass

import numpy as np

ARM = 1e-9
"""A line of a guarded pair that gets above this part of the size is watched like any other."""

RELEASE = 1e-10
"""Until then it may sink below zero by this part of the size before it counts as a touch."""

HOVER_COUNT = 128
"""
So many marches in a row within ARM of the size of a touch count as one: what neither comes nor
goes is in contact. A graze takes about 50.
"""

ROUNDING = 2.3e-16
"""Of the lengths a height is made of: lower than this it cannot be told from zero."""


@dataclass
class Lines:
    """The m lines of q pairs now, along the direction that separates each pair best."""

    height: np.ndarray
    """(m, q) [m]; the lowest is the pair's signed distance along the direction."""

    speed: np.ndarray
    """(m, q) [m/s] at which the heights grow along the turning direction."""

    pull: np.ndarray
    """(m, q) or (q,) [m/s^2]: K of the turning direction, for as long as `limit`."""

    limit: np.ndarray
    """(q,) [s]."""

    held_speed: np.ndarray
    """(m, q) [m/s], or None: the same with the direction held, where it turns."""

    held_pull: np.ndarray
    """(q,) [m/s^2], until the end."""

    apart: np.ndarray
    """(q,) [s]: the bounding spheres stay apart for so long; zero if they overlap."""

    scale: np.ndarray
    """(q,) [m]: the lengths that were subtracted from each other for the heights."""


def march(lines, size, start, end, guarded, few):
    """
    Return the times [s], (p,), of first touches, infinite where there is none by `end`.

    Also what is not decided yet once no more than `few` pairs are left: which they are, (q,), the
    times they are free of touches until, (q,), and which lines are armed, (m, q).

    Parameters
    ----------
    lines : callable
        lines(pairs, times) returns the `Lines` of some of the pairs, (q,) int, at times (q,).
    size : (p,) [m]
        Of each pair, the smaller bounding radius.
    start : (p,) [s]
        When the search begins.
    end : float [s]
        When it ends.
    guarded : (p,) bool
        Which of the pairs touch at the start and were just resolved.
    few : int
        How many pairs may be left over.

    """
    result = np.full(len(size), np.inf)
    pairs, time = np.arange(len(size)), start
    hovering = np.zeros(len(size), dtype=int)
    armed = ~guarded[np.newaxis]
    while len(pairs) > few:
        now = lines(pairs, time)
        unit = size[pairs]
        height = now.height
        if not armed.all():
            armed = armed | _arming(now, unit)
            height = height + np.where(armed, 0.0, RELEASE * unit)
        step, falling = _safe_step(now, height)
        reached = time + step
        hovering = np.where(height.min(axis=0) < ARM * unit, hovering + 1, 0)
        touching = (((now.speed <= 0) & (height <= ROUNDING * now.scale)).any(axis=0)
                    | (falling & (reached <= time)) | (hovering > HOVER_COUNT))
        result[pairs[touching]] = time[touching]
        going = ~touching & (reached <= end)
        pairs, hovering, armed = pairs[going], hovering[going], armed[:, going]
        # at least to the next number: what rises slowly from zero must not stop the march
        time = np.maximum(reached, np.nextafter(time, np.inf))[going]
    return result, pairs, time, armed


def _arming(now, unit):
    """Return which lines, (m, q), are well above zero or surely will be before they sink."""
    lacking = ARM * unit - now.height
    rising = np.maximum(now.speed, 0.0)
    return (lacking < 0) | ((rising * rising > np.maximum(2 * now.pull * lacking, 0.0))
                            & (rising * now.limit > 2 * lacking))


def _safe_step(now, height):
    """Return how long [s], (q,), nothing touches, and whether what ends it is falling."""
    steps = _ends(height, now.speed, now.pull)
    first = steps.argmin(axis=0), np.arange(steps.shape[1])
    step, falling = np.minimum(steps[first], now.limit), now.speed[first] <= 0
    if now.held_speed is not None:
        far = np.flatnonzero(step == now.limit)
        if len(far):
            held = _ends(height[:, far], now.held_speed[:, far], now.held_pull[far])
            step[far] = np.maximum(step[far], held.min(axis=0))
    return np.maximum(step, now.apart), falling


def _ends(height, speed, pull):
    """Return how long [s], (m, q), height + speed s - pull s^2 / 2 stays above zero."""
    height = np.maximum(height, 0.0)
    square = speed * speed + 2 * pull * height
    root = np.sqrt(np.maximum(square, 0.0))
    rising = speed > 0
    # the same root of the quadratic in the form in which nothing cancels
    above = np.where(rising, speed + root, 2 * height)
    below = np.where(rising, pull, root - speed)
    falls = (below > 0) & (square >= 0)
    return np.where(falls, above / np.where(falls, below, 1.0), np.inf)
