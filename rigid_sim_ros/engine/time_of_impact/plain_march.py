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
    m), limit, what returns the held speeds and the held pull (None and 0 if nothing turns), apart
    and scale.
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
            step = max(limit, first_end(heights, held_speeds(), [held_pull] * len(heights))[0])
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
    # likely the lowest line: then hardly any other needs a root
    lowest = heights.index(min(heights))
    first, falling = _end(heights[lowest], speeds[lowest], pulls[lowest]), speeds[lowest] <= 0
    for z, u, pull in zip(heights, speeds, pulls):
        if pull > 0:
            # concave: still above zero at the first end so far, so it ends later
            if z + first * (u - 0.5 * pull * first) > 0:
                continue
        elif u >= 0:
            continue
        ends = _end(z, u, pull)
        if ends < first:
            first, falling = ends, u <= 0
    return first, first < inf and falling


def _end(height, speed, pull):
    """Return how long [s] height + speed s - pull s^2 / 2 stays above zero."""
    if pull <= 0 and speed >= 0:
        return inf
    height = max(height, 0.0)
    square = speed * speed + 2 * pull * height
    if square < 0:
        return inf
    root = sqrt(square)
    if speed > 0:
        return (speed + root) / pull
    if root > speed:
        return 2 * height / (root - speed)
    return 0.0 if height == 0 else inf
