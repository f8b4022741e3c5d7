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
One contact, solved in plain floats.

With two tangential rows the friction of a sliding contact is found by a scalar: sliding is
motion_t = -s force_t with s >= 0, so that (response_tt + s) force_t = -(the rest), and s is where
|force_t| reaches the cone. At s = 0 the contact sticks, and for large s the friction vanishes, so
a root lies between: there is always a solution, for any friction coefficient (no jamming).
"""

from math import hypot, inf

_MAX_ITERATIONS = 100
_ROUNDING = 4e-16

_NOTHING = 1e-100
"""Friction below which there is none: its reciprocal must not overflow."""


def solve_one(response, free, friction, floor=0.0):
    """
    Return the force (normal, first, second) that solves a `ContactProblem` of one contact.

    The response is given as its six entries (nn, n1, n2, 11, 12, 22), the free motion as three.
    """
    if floor > 0.0:
        return _above_floor(response, free, friction, floor)
    if free[0] >= 0.0:
        return 0.0, 0.0, 0.0
    if friction < _NOTHING:
        return -free[0] / response[0], 0.0, 0.0
    return _closing_force(response, free, friction)


def slide_one(response, free_n, friction, slip):
    """
    Return the force of a contact that slides along a known direction (2,), or None if it jams.

    It jams if the friction that goes with a normal force presses harder than that force.
    """
    if free_n >= 0.0:
        return 0.0, 0.0, 0.0
    nn, n1, n2 = response[:3]
    first, second = -friction * slip[0], -friction * slip[1]
    yielding = nn + first * n1 + second * n2
    if yielding <= 0.0:
        return None
    normal = -free_n / yielding
    return normal, first * normal, second * normal


def friction_under(response, free_1, free_2, limit):
    """
    Return the friction (first, second) of a contact whose largest friction is given.

    The response is its tangential part (11, 12, 22). The answer is unique: it minimises a convex
    quadratic over a disc.
    """
    if limit < _NOTHING or (free_1 == 0.0 and free_2 == 0.0):
        return 0.0, 0.0
    r11, r12, r22 = response

    def evaluate(s):
        a, d = r11 + s, r22 + s
        determinant = a * d - r12 * r12
        first = (r12 * free_2 - d * free_1) / determinant
        second = (r12 * free_1 - a * free_2) / determinant
        return limit - hypot(first, second), limit, first, second

    return _root(evaluate, hypot(free_1, free_2) / limit, 0.5 * (r11 + r22))[1:]


def _above_floor(response, free, friction, floor):
    """
    Return the force of a contact with a normal force of at least `floor`.

    Friction follows the normal force, and the normal motion grows with it beyond all bounds, so
    that some force above the floor ends the approach if the floor does not.
    """
    nn, n1, n2, _, _, _ = response

    def evaluate(normal):
        first, second = friction_under(
            response[3:], free[1] + n1 * normal, free[2] + n2 * normal, friction * normal)
        return free[0] + nn * normal + n1 * first + n2 * second, (normal, first, second)

    motion, force = evaluate(floor)
    if motion >= 0.0:
        return force
    low, high = floor, floor - motion / nn
    while evaluate(high)[0] < 0.0:
        low, high = high, 2.0 * high
    for _ in range(_MAX_ITERATIONS):
        middle = 0.5 * (low + high)
        motion, force = evaluate(middle)
        if middle in (low, high):
            break
        if motion < 0.0:
            low = middle
        else:
            high = middle
    return force


def _closing_force(response, free, friction):
    """Return the force with which an approaching contact ends at rest along the normal."""
    nn, n1, n2, r11, r12, r22 = response
    free_n, free_1, free_2 = free

    def evaluate(s):
        a, d = r11 + s, r22 + s
        determinant = a * d - r12 * r12
        g1 = (d * n1 - r12 * n2) / determinant
        g2 = (a * n2 - r12 * n1) / determinant
        normal = ((g1 * free_1 + g2 * free_2 - free_n) / (nn - g1 * n1 - g2 * n2))
        first = (r12 * free_2 - d * free_1) / determinant - g1 * normal
        second = (r12 * free_1 - a * free_2) / determinant - g2 * normal
        return friction * normal - hypot(first, second), normal, first, second

    unhindered = -free_n / nn
    drive = hypot(free_1 + n1 * unhindered, free_2 + n2 * unhindered)
    return _root(evaluate, drive / (friction * unhindered), 0.5 * (r11 + r22))


def _root(evaluate, resistance, stiffness):
    """
    Return (normal, first, second) for the least s >= 0 found at which friction is on the cone.

    `evaluate(s)` gives the room left in the cone and the force. The secant runs on the ratio of
    limit to friction, which is linear in s where the response is isotropic; it is kept inside a
    bracket. `resistance` / 1 is s + stiffness in that case, and so the first guess.
    """
    room, normal, first, second = evaluate(0.0)
    if room >= 0.0:
        return normal, first, second
    low, high = 0.0, inf
    s = max(resistance - stiffness, 1e-3 * stiffness)
    previous_s, previous_ratio = 0.0, _ratio(room, first, second)
    for _ in range(_MAX_ITERATIONS):
        room, normal, first, second = evaluate(s)
        length = hypot(first, second)
        if abs(room) <= _ROUNDING * length or low == s or high == s:
            break
        ratio = room / length
        if room < 0.0:
            low = s
        else:
            high = s
        slope = ratio - previous_ratio
        following = s - ratio * (s - previous_s) / slope if slope else inf
        if not low < following < high:
            following = 0.5 * (low + high) if high < inf else 4.0 * (s + stiffness)
        previous_s, previous_ratio, s = s, ratio, following
    return normal, first, second


def _ratio(room, first, second):
    """Return the room in the cone relative to the friction."""
    return room / hypot(first, second)
