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
One body on one plane as a hybrid automaton, of high order between its events.

Between events the points in contact are a fixed set: the forces on them solve the contact problem
of accelerations in every stage of an adaptive Runge-Kutta step, so that pressure that vanishes and
sliding that begins need no event. Events are located in time: a point touches, and all that touch
are hit together; sliding ends, and the point may stick; a ball stops turning that is resisted.
"""

from functools import partial
from math import floor, hypot, log2

from rigid_sim_ros.engine.lasting_contact.automaton import events
from rigid_sim_ros.engine.lasting_contact.automaton.ball_attitude import turned_on
from rigid_sim_ros.engine.lasting_contact.automaton.ball_resistance import stopped
from rigid_sim_ros.engine.lasting_contact.automaton.contact_state import ContactState
from rigid_sim_ros.engine.lasting_contact.automaton.dormand_prince import Step
from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import (
    normalized, ORIENTATION, SPIN, VELOCITY)

TOLERANCE = 1e-9
"""Of length, speed and angle: the error allowed in a step."""

SLOWER = 1e-3
"""Of its speed: the least the scale of speed is for that. Without gravity there is no other."""

PIVOTING = 1e-2
"""How much of that where nothing slides: what tips about a point or an edge lets errors grow."""

BALANCE = 1e-12
"""Of the acceleration scale: what is no more than the rounding of forces in balance."""

LONGEST = 0.05
"""Longest step [s], times the root of the length in metres: what happens within is looked for."""

FLAT = 4.0
"""So many times as long with a whole face in contact: nothing else can touch."""

LANDED = 1e-12
"""Of the length scale: how near to the plane a point is that touches it."""

CLOSE = 1e-4
"""Of a step: how far beyond its end, or short of it, its interpolant is as good as the step."""

FACE = 4
"""Corners of one."""

SIZES = 16
"""Step sizes between one and its double."""

_CORRECTIONS = 5

MOST_STEPS = 1000
"""Between two readings; more are not worth it."""


class Automaton(ContactState):
    """
    A body in motion; arguments as for `ContactState`.

    It goes its own steps, as long as its motion allows, and ahead of the times that are asked for:
    between them lies a polynomial.
    """

    def __init__(self, body, state, scales, stick, surfaces, law):
        """See the class."""
        super().__init__(body, state, scales, stick, surfaces, law)
        self.steps = 0
        """Steps tried since it was last asked for anything."""
        self.now = self.state
        """The state at the time that was last asked for."""
        self._longest = self._size = LONGEST * scales.length ** 0.5
        self._taken = None
        """The size [s] and the error of the last step, if it was one of the same motion."""
        speed = max(scales.speed, SLOWER * self._speed()) or 1.0
        self._weights = [1 / (TOLERANCE * unit) for unit in (
            *[scales.length] * 3, *[1.0] * 4, *[speed] * 3, *[speed / scales.length] * 3)]
        if body.is_ball:
            # nothing depends on its attitude, which follows from the spin
            self._weights[ORIENTATION] = [0.0] * 4
        self._rates = self.begin()
        self._ahead = None

    def advance(self, until):
        """Advance to a time [s] since it was made; return whether few enough steps did it."""
        self.steps = 0
        while self.steps <= MOST_STEPS:
            if self._ahead is None:
                if self._stays():
                    self.time, self.now = until, self.state
                    return True
                self._ahead = self._next_step()
            step = self._ahead[0]
            if self.time + step.size > until:
                self.now = self._state_in(step, until - self.time)
                return True
            self._take(*self._ahead)
            self._ahead = None
        return False

    def resting(self, slow, allowed):
        """
        Return whether the body is at rest now.

        That is: no point moves faster than `slow` [m/s], and without that motion none would be
        accelerated by more than `allowed` [m/s^2]. What turns at its turning point is not.
        """
        body = self.body
        if self._speed() > slow or not self.closed:
            return False
        wx, wy, wz = map(abs, self.now[SPIN])
        if body.rolling and max(wx, wy) > 0.0 or body.pivoting and wz > 0.0:
            # its stop is an event
            return False
        return self._balanced(self.rates([*self.now[:7], *[0.0] * 6]), allowed)

    def _speed(self):
        """Return the largest component of velocity now [m/s], of the centre or by turning."""
        return max(*map(abs, self.now[VELOCITY]),
                   self.body.radius * max(map(abs, self.now[SPIN])))

    def _stays(self):
        """Return whether the body does not move, nor will."""
        return not any(self.state[7:]) and self._balanced(
            self._rates, BALANCE * self.scales.acceleration)

    def _balanced(self, rates, allowed):
        """Return whether the accelerations [m/s^2] in the rates are no more than allowed."""
        return (max(map(abs, rates[7:10])) <= allowed
                and self.body.radius * max(map(abs, rates[10:])) <= allowed)

    def _next_step(self):
        """Return (step, event at its end or None, what is solved there)."""
        step, event, self._size = self._step(self._rates, self._size)
        return step, event, self.solved

    def _take(self, step, event, solved):
        """Go to the end of a step and do what happens there."""
        self.time += step.size
        self.state = self._state_in(step, step.size)
        self._rates, self.solved = step.last, solved
        self.rearm()
        if event is not None:
            event()
            self._rates, self._taken = self.begin(), None
        elif self.lifting():
            self._rates, self._taken = self.begin(), None
        elif self.drifting():
            self._rates, self._taken = self.put_down(), None

    def _state_in(self, step, time):
        """Return the state at a time [s] since a step began."""
        state = step.end if time == step.size else step.between(time)
        if not self.body.is_ball:
            return normalized(state)
        return turned_on(step.start, state, step.between, time)

    def _step(self, rates, size):
        """Return (step, event at its end or None, size of the next) of at most `size` [s]."""
        started = self.solved
        slips, going = started[2], started[6]
        allowed = 1.0 if any(slips) or not self.closed else PIVOTING
        while True:
            self.steps += 1
            step = self._tried(rates, size, going)
            error = _largest(map(_weighted, step.error(), self._weights)) / allowed
            if error > 1.0 and self.steps <= MOST_STEPS:
                size = _rounded(size * max(0.2, 0.9 * error ** -0.2))
                continue
            following = min(_rounded(size * self._growth(size, error)), self._most())
            time, event, point, too_long = events.first(self, started, step)
            if too_long and self.steps <= MOST_STEPS:
                size *= 0.5
                continue
            if event is None:
                return step, None, following
            if time < size:
                step = self._step_to(rates, time, size, point, going)
            return step, event, following

    def _most(self):
        """Return how long the next step may be [s], whatever the error."""
        return self._longest * (FLAT if len(self.closed) == FACE else 1.0)

    def _growth(self, size, error):
        """
        Return how much longer the next step may be, after one of `size` [s] with an error.

        If errors grow, as they do towards the end of sliding, steps get shorter at that rate
        before one is too long (Gustafsson 1994, 'Control-theoretic techniques for stepsize
        selection in implicit Runge-Kutta methods').
        """
        if error < 1e-4:
            growth = 4.0
        else:
            growth = 0.9 * error ** -0.2
            if self._taken is not None:
                before, was = self._taken
                growth = min(growth, growth * size / before * (was / error) ** 0.2)
        self._taken = size, max(error, 1e-4)
        return growth

    def _tried(self, rates, size, going):
        """Return a `Step` of `size` [s], in which a ball turns as it has been `going` to."""
        derivative = partial(self.rates, going=going) if going else self.rates
        return Step(derivative, self.state, rates, size)

    def _step_to(self, rates, time, size, point, going):
        """
        Return the step to the time [s] of an event within a step of `size` [s].

        If it is that a point touches, the time is corrected until the point does.
        """
        step = None
        for _ in range(_CORRECTIONS):
            if step is not None and abs(time - step.size) <= CLOSE * step.size:
                step = step.ended(time)
            else:
                step = self._tried(rates, time, going)
            if point is None:
                break
            gap = self.body.gaps(step.end)[point] - self.level(point)
            speed = events.velocity_of(self.body, step.end, point)[2]
            if abs(gap) <= LANDED * self.scales.length or speed >= 0.0:
                break
            time = min(max(time - gap / speed, 0.5 * time), 0.5 * (time + size))
        return step

    def settle(self):
        """Stop what slides or turns slowly: sliding or turning has ended."""
        if self.body.resists_spin:
            self.state = stopped(self.state, self.body.radius, self._slip)
        self.hold(self.closed)


def _rounded(size):
    """
    Return the next shorter one of a fixed choice of step sizes [s], `SIZES` between each double.

    Else their rounding errors grow from step to step, by the rule that errors make sizes, until
    other steps are taken: what is sensitive would end elsewhere with corners numbered otherwise.
    """
    return 2.0 ** (floor(SIZES * log2(size)) / SIZES)


def _largest(errors):
    """
    Return the largest of 13 errors, where that of the attitude is one.

    Its components depend on which way round the axes of the body are, their size does not.
    """
    errors = list(errors)
    errors[ORIENTATION] = [hypot(*errors[ORIENTATION])]
    return max(errors)


def _weighted(error, weight):
    """Return an error in units of what is allowed."""
    return abs(error) * weight
