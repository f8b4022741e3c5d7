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
Stronge's impact law for one contact: restitution of energy, sliding followed through the impact.

The velocity across the contact obeys du/dp = response (1, g), where p is the growing normal
impulse and g the friction ratio: minus friction times the direction of sliding (Keller 1986), or
what it takes to stick if that is less. Sliding turns, stops, reverses. Compression ends where the
normal velocity is zero; the impact ends where the normal force has given back e^2 of the work
that compression took (Stronge 1990). Energy never grows, whatever the friction.
"""

from math import hypot, inf, sqrt

from rigid_sim_ros.engine.impacts.laws import poisson_one
from rigid_sim_ros.engine.solvers.single import friction_under

_TURN = 0.05
"""Change of the sliding velocity, relative to it, in one Runge-Kutta piece: error 1e-7 or less."""

_STRAIGHT = 1e-10
"""Of the velocity before: what sliding may still turn aside where it is taken as straight."""

_MAX_PIECES = 1000
_MAX_ROUNDS = 20
_ROUNDING = 4e-16

_NORMAL, _FIRST, _SECOND, _WORK, _IMPULSE, _IMPULSE_1, _IMPULSE_2 = range(7)
"""What a state of an impact holds: velocities, the normal force's work, impulses."""


def stronge_one(response, velocity, friction, restitution):
    """Return the impulse (3,) of one contact; response and velocity as for `solve_one`."""
    if velocity[0] >= 0.0:
        return 0.0, 0.0, 0.0
    state = (*velocity, 0.0, 0.0, 0.0, 0.0)
    small = _STRAIGHT * hypot(*velocity)
    work_at_end = None
    for _ in range(_MAX_PIECES):
        ratio, span = _ratio(response, state, friction, small)
        if ratio is None:
            derivative, advance = _turning(response, friction)
        else:
            derivative, advance = _straight(response, ratio)
        following, ended = _to_event(derivative, advance, state, span, work_at_end)
        if following is None:
            break
        if ended and (work_at_end is not None or restitution == 0.0):
            return following[_IMPULSE:]
        if ended:
            work_at_end = (1.0 - restitution * restitution) * following[_WORK]
            following = (0.0, *following[_FIRST:])
        elif ratio is not None:
            # sliding has stopped: leave no rounding that points anywhere
            following = (following[_NORMAL], 0.0, 0.0, *following[_WORK:])
        state = following
    # sliding that pushes itself deeper without end: only a law at velocity level resolves it
    return poisson_one(response, velocity, friction, restitution)


def _ratio(response, state, friction, small):
    """
    Return the friction ratio (2,) and the normal impulse for which it holds.

    The ratio is None where it changes, and the impulse that of one piece.
    """
    _, n1, n2, r11, r12, r22 = response
    u1, u2 = state[_FIRST], state[_SECOND]
    speed = hypot(u1, u2)
    if speed == 0.0:
        # the ratio that sticks, or the direction in which sliding starts and goes on
        return friction_under((r11, r12, r22), n1, n2, friction), inf
    d1, d2 = u1 / speed, u2 / speed
    rate_1 = n1 - friction * (r11 * d1 + r12 * d2)
    rate_2 = n2 - friction * (r12 * d1 + r22 * d2)
    along, aside = rate_1 * d1 + rate_2 * d2, rate_2 * d1 - rate_1 * d2
    rate = hypot(rate_1, rate_2)
    if abs(aside) * speed <= small * rate:
        return (-friction * d1, -friction * d2), -speed / along if along < 0.0 else inf
    # the second bound keeps up with the direction's own pull towards where it no longer turns
    return None, _TURN * speed / max(rate, 0.25 * friction * (r11 + r22))


def _straight(response, ratio):
    """Return (derivative of a state, its advance by an impulse) with a constant ratio."""
    rates = _rates(response, *ratio)

    def derivative(state):
        return (*rates, state[_NORMAL], 1.0, *ratio)

    def advance(state, impulse):
        # all are linear but the work, for which the mean normal velocity is exact
        middle = (state[_NORMAL] + 0.5 * rates[_NORMAL] * impulse,)
        return tuple(s + impulse * rate for s, rate in zip(state, derivative(middle)))

    return derivative, advance


def _turning(response, friction):
    """Return (derivative of a state, its advance by an impulse) while the ratio turns."""

    def derivative(state):
        factor = -friction / hypot(state[_FIRST], state[_SECOND])
        ratio = state[_FIRST] * factor, state[_SECOND] * factor
        return (*_rates(response, *ratio), state[_NORMAL], 1.0, *ratio)

    def advance(state, impulse):
        half = 0.5 * impulse
        k1 = derivative(state)
        k2 = derivative([s + half * k for s, k in zip(state, k1)])
        k3 = derivative([s + half * k for s, k in zip(state, k2)])
        k4 = derivative([s + impulse * k for s, k in zip(state, k3)])
        return tuple(s + impulse / 6 * (a + 2 * (b + c) + d)
                     for s, a, b, c, d in zip(state, k1, k2, k3, k4))

    return derivative, advance


def _rates(response, g1, g2):
    """Return the change of velocity (3,) per normal impulse."""
    nn, n1, n2, r11, r12, r22 = response
    return (nn + n1 * g1 + n2 * g2, n1 + r11 * g1 + r12 * g2, n2 + r12 * g1 + r22 * g2)


def _to_event(derivative, advance, state, span, work_at_end):
    """
    Return (state, whether it is an end): after `span`, or at the end of the phase if sooner.

    The state is None if there is neither. A phase ends where the normal velocity is zero, or,
    once `work_at_end` is known, where the work of the normal force is that.
    """
    what, goal = (_NORMAL, 0.0) if work_at_end is None else (_WORK, work_at_end)
    if state[what] >= goal:
        return state, True
    if span < inf:
        following = advance(state, span)
        if following[what] < goal:
            return following, False
    rate = derivative(state)[_NORMAL]
    normal, missing = state[_NORMAL], goal - state[what]
    if what == _NORMAL:
        impulse = missing / rate if rate > 0.0 else inf
    else:
        inside = normal * normal + 2.0 * rate * missing
        impulse = 2.0 * missing / (normal + sqrt(inside)) if inside >= 0.0 else inf
    if impulse == inf and span == inf:
        return None, False
    impulse = min(impulse, span)
    for _ in range(_MAX_ROUNDS):
        following = advance(state, impulse)
        step = (goal - following[what]) / derivative(following)[what]
        impulse = min(max(impulse + step, 0.0), span)
        if abs(step) <= _ROUNDING * abs(impulse):
            break
    return following, True
