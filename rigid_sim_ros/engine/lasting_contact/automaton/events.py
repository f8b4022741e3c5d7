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

"""What happens within a step of the automaton: what comes first, and when."""

from math import hypot

from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import (
    dot, HEIGHT, SPIN)

_TURNED = 0.5
"""Cosine of how far the direction of sliding may turn in a step."""

_EARLIEST = 1e-6
"""Of a step: what has not risen by then does not rise."""

_AT_ZERO = 1e-9
"""Of a function's value at the end of a step: what is as good as zero at its start."""

_ROUNDS = 60
_ROUNDING = 1e-15


def first(automaton, started, step):
    """
    Return (time [s], event or None, point or None, too_long): what happens first in a `Step`.

    The event is a method of the automaton, to be called in the state at that time; the point is
    the one that touches, if that is the event. The time is as good as the interpolant. `too_long`
    says that the step must be shortened before anything can be said. `started` is what the
    automaton had solved at the start of the step.
    """
    found = []
    for point, end in _touching(automaton, step):
        level = automaton.level(point)
        found.append((_crossing(
            lambda time, point=point: automaton.body.gap(
                step.between(time, HEIGHT), point) - level, end), automaton.land, point))
    for which, point, direction in _stopping(automaton, started):
        if direction is None:
            return step.size, None, None, True
        velocity = automaton.solved[1][which]
        if dot((*direction, 0.0), velocity) > 0.0:
            found.append((step.size, automaton.settle, None))
            continue

        def along(time, point=point, direction=direction):
            return dot((*direction, 0.0), velocity_of(automaton.body, step.between(time), point))

        time = _crossing(along, step.size)
        x, y, _ = velocity_of(automaton.body, step.between(time), point)
        if not automaton.slow(hypot(x, y)):
            return step.size, None, None, True
        found.append((time, automaton.settle, None))
    for direction, axes in _turns(started[6]):
        end = _along(direction, step.end[axes])
        if end < 0.0:
            time = _crossing(lambda time, direction=direction, axes=axes: _along(
                direction, step.between(time)[axes]), step.size)
            if not automaton.slow(automaton.body.radius * hypot(*step.between(time)[axes])):
                return step.size, None, None, True
            found.append((time, automaton.settle, None))
        elif end < _TURNED * hypot(*step.end[axes]):
            return step.size, None, None, True
    if not found:
        return step.size, None, None, False
    return (*min(found, key=lambda each: each[0]), False)


def _touching(automaton, step):
    """Return (point, time [s] at which it is below its level) for the points that touch."""
    body = automaton.body
    after = body.gaps(step.end)
    spin = step.start[SPIN]
    # a point that is low at neither end is not low between, by more than it can fall and rise
    reach = 0.25 * step.size ** 2 * (
        dot(body.acceleration, body.acceleration) ** 0.5 + dot(spin, spin) * body.radius)
    if min(after) > reach:
        return []
    before = body.gaps(step.start)
    found = []
    for point in body.points:
        if point in automaton.closed:
            continue
        if after[point] < automaton.level(point):
            if after[point] < before[point]:
                found.append((point, step.size))
        elif min(before[point], after[point]) < reach:
            time = _lowest(body, step, point)
            if time is not None and body.gaps(
                    step.between(time))[point] < automaton.level(point):
                found.append((point, time))
    return found


def _lowest(body, step, point):
    """Return when in a step a point that falls and rises is lowest [s], or None."""
    falling = velocity_of(body, step.start, point)[2]
    rising = velocity_of(body, step.end, point)[2]
    if falling >= 0.0 or rising <= 0.0:
        return None
    # the height is nearly a parabola, so its rate is nearly linear
    return step.size * falling / (falling - rising)


def _stopping(automaton, started):
    """
    Return (place among the closed points, point, direction) of those whose sliding ends.

    The direction is None where it has turned too far in the step to tell.
    """
    _, _, slips_before, *_ = started
    _, velocities, slips_after, *_ = automaton.solved
    found = []
    for which, direction in enumerate(slips_before):
        if direction is None:
            continue
        x, y, _ = velocities[which]
        along = x * direction[0] + y * direction[1]
        if along < 0.0 or slips_after[which] is None:
            found.append((which, automaton.closed[which], direction))
        elif along < _TURNED * hypot(x, y):
            found.append((which, automaton.closed[which], None))
    return found


def _turns(going):
    """Return (direction, the numbers of a state along it) of each way in which a ball turns."""
    rolling, pivoting = going or (None, None)
    return ([(rolling, slice(SPIN.start, SPIN.start + 2))] * (rolling is not None)
            + [((pivoting,), slice(SPIN.start + 2, SPIN.stop))] * (pivoting is not None))


def _along(direction, values):
    """Return the scalar product of two short vectors."""
    return sum(a * b for a, b in zip(direction, values))


def velocity_of(body, state, point):
    """Return the velocity (3,) [m/s] of a point."""
    return body.velocities(state, body.arms(body.turn(state), (point,)))[0]


def _crossing(function, end):
    """
    Return where in [0, end] a function that ends negative becomes so.

    What starts at zero or below, as a point does that has just been hit, must first have risen:
    that is looked for towards the start. If it has not, the answer is the start.
    """
    low, high = 0.0, end
    value_low, value_high = function(low), function(high)
    if value_high >= 0.0:
        return end
    while value_low <= -_AT_ZERO * value_high:
        low = 0.5 * (high if low == 0.0 else low)
        if low < _EARLIEST * end:
            return 0.0
        value_low = function(low)
    side, middle = 0, high
    for _ in range(_ROUNDS):
        before, middle = middle, (low * value_high - high * value_low) / (value_high - value_low)
        value = function(middle)
        if value == 0.0 or abs(middle - before) <= _ROUNDING * end:
            break
        if value > 0.0:
            low, value_low = middle, value
            value_high *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            high, value_high = middle, value
            value_low *= 0.5 if side == -1 else 1.0
            side = -1
    return middle
