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

"""The march of one pair in plain floats, where NumPy's overhead would be most of the time."""

from math import inf, nextafter, sqrt

from rigid_sim_ros.engine.time_of_impact.march import ARM, HOVER_COUNT, RELEASE, ROUNDING


def march_one(lines, size, start, end, armed):
    """
    Return the first touch [s] of one pair, or infinity: `march.march` in plain floats.

    `lines(time)` returns what `march.Lines` holds as a tuple: heights, speeds and pulls (lists of
    m), limit, held speeds and the held pull (None and 0 if nothing turns), apart and scale.
    `armed` lists which of the m lines are, or one for all of them.
    """
    time, hovering = start, 0
    guarded = not all(armed)
    while True:
        heights, speeds, pulls, limit, held_speeds, held_pull, apart, scale = lines(time)
        if guarded:
            if len(armed) < len(heights):
                armed = armed * len(heights)
            armed = _armed(armed, heights, speeds, pulls, limit, size)
            guarded = not all(armed)
            heights = [z if watched else z + RELEASE * size for z, watched in zip(heights, armed)]
        lowest = min(heights)
        level = ROUNDING * scale
        if lowest <= level and any(u <= 0 and z <= level for z, u in zip(heights, speeds)):
            return time
        step, falling = first_end(heights, speeds, pulls)
        if step > limit and held_speeds:
            step = max(limit, first_end(heights, held_speeds, [held_pull] * len(heights))[0])
        hovering = hovering + 1 if lowest < ARM * size else 0
        reached = time + max(step, apart)
        if falling and reached <= time or hovering > HOVER_COUNT:
            return time
        if reached > end:
            return inf
        time = max(reached, nextafter(time, inf))


def _armed(armed, heights, speeds, pulls, limit, size):
    """Return which lines are well above zero now, were before, or surely will be."""
    result = []
    for watched, z, u, pull in zip(armed, heights, speeds, pulls):
        lacking = ARM * size - z
        result.append(watched or lacking < 0
                      or u > 0 and u * u > 2 * pull * lacking and u * limit > 2 * lacking)
    return result


def first_end(heights, speeds, pulls):
    """Return when [s] the first minorant ends, and whether its line is falling now."""
    first, falling = inf, False
    for z, u, pull in zip(heights, speeds, pulls):
        if pull > 0:
            # concave: still above zero at the first end so far, so it ends later
            if first < inf and z + first * (u - 0.5 * pull * first) > 0:
                continue
        elif u >= 0:
            continue
        z = max(z, 0.0)
        square = u * u + 2 * pull * z
        if square < 0:
            continue
        root = sqrt(square)
        if u > 0:
            ends = (u + root) / pull
        elif root > u:
            ends = 2 * z / (root - u)
        else:
            ends = 0.0 if z == 0 else inf
        if ends < first:
            first, falling = ends, u <= 0
    return first, falling
