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
The points of a body that are in contact with a plane, what the plane does to them, and landing.

A point is closed, and then held on the plane as long as it is pressed; or open and armed, and then
touches at the plane; or open and not armed, having just been hit or released, and then touches a
hair's breadth below it, so that it is not hit twice. What rebounds slower than `stick` stays: what
that takes from it is what the bounces left out would have, to second order.
"""

from math import hypot, sqrt

from rigid_sim_ros.engine.friction import restitution_of_one
from rigid_sim_ros.engine.lasting_contact.automaton.ball_resistance import resisted, turning_of
from rigid_sim_ros.engine.lasting_contact.automaton.forces import accelerations, held
from rigid_sim_ros.engine.lasting_contact.automaton.patterns import constrained
from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import displaced, normalized
from rigid_sim_ros.engine.lasting_contact.automaton.plane_impacts import plane_impulses

TOUCH = 1e-9
"""Of the length scale: points lower than this are hit together; higher ones are armed again."""

UNARMED = -1e-10
"""Of the length scale: how deep one must be to touch that has just been hit or released."""

SLIP = 3e-5
"""Of the speed scale: what slides slower may stick, and its direction is not used."""

RELEASE = 1e-7
"""Of the acceleration scale: what accelerates more without force lifts off."""

STICKS = 1 - 1e-6
"""Of the friction there may be: with less a point that is slow sticks."""

DRIFT = 1e-12
"""Of length and speed: what is put back onto the plane."""

MANY_IMPACTS = 25
"""
Impacts between two readings after which slow sliding is stopped: corners may trade slips for ever.
"""


class Hit:
    """An impact of one point, for the log; vectors are in the plane's frame."""

    def __init__(self, time, point, impulse, speed):
        """Hold a time of the automaton [s], a place, an impulse and the speed of approach."""
        self.time = time
        self.point = point
        self.impulse = impulse
        self.speed = speed


class ContactState:
    """
    A `PlaneBody` and what it touches.

    Parameters
    ----------
    body : PlaneBody
    state : list of 13 floats, see `plane_body`
    scales : Scales
    stick : float [m/s]
        What rebounds slower stays.
    surfaces : list of (restitution, its speed [m/s])
        Of the body and the plane, see `friction.restitution_of_one`.
    law : str
        A key of `impacts.IMPACT_LAWS`.

    """

    def __init__(self, body, state, scales, stick, surfaces, law):
        """See the class."""
        self.body = body
        self.state = body.raised(normalized(state), TOUCH * scales.length)
        self.time = 0.0
        self.hits = []
        self.scales = scales
        self._stick = stick
        self._least_slip = self._slip = SLIP * scales.speed
        self._surfaces, self._law = surfaces, law
        self._impacts = 0
        gaps = body.gaps(self.state)
        low = [point for point in body.points if gaps[point] < TOUCH * scales.length]
        self._unarmed = set(low)
        self.closed = []
        if low:
            self.land()

    def take_hits(self):
        """Return the impacts since this was last called, each a `Hit`; their count begins anew."""
        hits, self.hits = self.hits, []
        self._impacts = 0
        self._slip = self._least_slip
        return hits

    # -- motion --------------------------------------------------------------------------------

    def rates(self, state, going=None):
        """
        Return the derivative of a state, and keep what was found on the way.

        `going` is how a ball has been turning, for `turning_of`.
        """
        body, closed = self.body, self.closed
        turn = body.turn(state)
        acceleration, turning = body.acceleration, body.free_turning(state, turn)
        arms = velocities = forces = slips = going_on = ()
        if closed:
            arms = body.arms(turn, closed)
            velocities = body.velocities(state, arms)
            slips = self._slips_of(velocities)
            if body.resists_spin:
                going_on = turning_of(body, state, going, self._slip)
                force, acceleration, turning = resisted(
                    body, slips[0], going_on, acceleration, turning)
                forces = (force,)
            else:
                forces, acceleration, turning = constrained(
                    body, state, turn, closed, arms, slips, acceleration, turning)
        self.solved = (arms, velocities, slips, forces, acceleration, turning, going_on)
        x, y, z, w = state[3:7]
        p, q, r = state[10:]
        return [*state[7:10],
                0.5 * (p * w + q * z - r * y), 0.5 * (q * w + r * x - p * z),
                0.5 * (r * w + p * y - q * x), -0.5 * (p * x + q * y + r * z),
                *acceleration, *turning]

    def _slips_of(self, velocities):
        """Return the directions in which points slide, None for those that may stick."""
        slips = []
        for x, y, _ in velocities:
            speed = sqrt(x * x + y * y)
            slips.append((x / speed, y / speed) if speed > self._slip else None)
        return slips

    # -- contact -------------------------------------------------------------------------------

    def begin(self):
        """Let go what lifts off, put the rest on the plane, and return the rates here."""
        while True:
            rates = self.rates(self.state)
            lifting = self.lifting()
            if not lifting:
                break
            self.closed = [point for point in self.closed if point not in lifting]
            self._unarmed.update(lifting)
        return self.put_down() if self.drifting() else rates

    def lifting(self):
        """Return the closed points that have no force on them and leave the plane."""
        arms, _, _, forces, acceleration, turning, _ = self.solved
        idle = [which for which, force in enumerate(forces) if force[2] <= 0.0]
        if not idle:
            return []
        leaving = self.body.accelerations(
            self.state, [arms[which] for which in idle], acceleration, turning)
        return [self.closed[which] for which, motion in zip(idle, leaving)
                if motion[2] > RELEASE * self.scales.acceleration]

    def drifting(self):
        """Return whether closed points have left the plane, or move where they cannot."""
        if not self.closed:
            return False
        gaps = self.body.gaps(self.state)
        arms = self.body.arms(self.body.turn(self.state), self.closed)
        limit = DRIFT * self.scales.speed
        return (max(abs(gaps[point]) for point in self.closed) > DRIFT * self.scales.length
                or any(abs(z) > limit or sticks and max(abs(x), abs(y)) > limit
                       for (x, y, z), sticks in zip(
                           self.body.velocities(self.state, arms), self._sticking())))

    def _sticking(self):
        """
        Return which closed points stick: slow, and held by less friction than there may be.

        Whatever velocity such a point came with it would keep, and friction would do work on it.
        """
        _, _, slips, forces, *_ = self.solved
        most = STICKS * self.body.friction
        return [slip is None and hypot(x, y) < most * z
                for slip, (x, y, z) in zip(slips, forces)]

    def put_down(self):
        """Put closed points on the plane, stop them where they may not go; return the rates."""
        body = self.body
        sticks = self._sticking()
        turn = body.turn(self.state)
        arms = body.arms(turn, self.closed)
        gaps = body.gaps(self.state)
        if max(abs(gaps[point]) for point in self.closed) > DRIFT * self.scales.length:
            moves = held(body, turn, arms, [(0.0, 0.0, gaps[point]) for point in self.closed],
                         [False] * len(arms))
            self.state = normalized(displaced(self.state, *moves))
        self.hold(self.closed, sticks)
        return self.rates(self.state)

    def rearm(self):
        """Arm the points that have risen high enough to touch again."""
        if self._unarmed:
            gaps = self.body.gaps(self.state)
            self._unarmed = {point for point in self._unarmed
                             if gaps[point] < TOUCH * self.scales.length}

    def hold(self, points, sticks=None):
        """
        Stop points along the normal, and altogether those that stick, a list of bool.

        If it is not given, those that slide slowly.
        """
        body = self.body
        turn = body.turn(self.state)
        arms = body.arms(turn, points)
        velocities = body.velocities(self.state, arms)
        if sticks is None:
            sticks = [slip is None for slip in self._slips_of(velocities)]
        change = held(body, turn, arms, velocities, sticks)
        if change is None:
            self.state = [*self.state[:7], *[0.0] * 6]
        else:
            self.state = [*self.state[:7], *(v + d for v, d in zip(
                self.state[7:], (*change[0], *change[1])))]

    # -- events --------------------------------------------------------------------------------

    def level(self, point):
        """Return the gap [m] at which a point that is not closed touches."""
        return UNARMED * self.scales.length if point in self._unarmed else 0.0

    def slow(self, speed):
        """Return whether sliding this fast [m/s] is as good as sticking."""
        return speed <= self._slip

    def land(self):
        """Hit the plane with all points that are low, and close those that do not rebound."""
        gaps = self.body.gaps(self.state)
        points = [point for point in self.body.points
                  if gaps[point] < TOUCH * self.scales.length or point in self.closed]
        if not points:
            return
        self._impacts += 1
        if self._impacts > MANY_IMPACTS:
            self._slip = max(self._slip, self._stick)
        before = self.state
        if not self._rebound(points, self._restitution_of):
            self.state = before
            self._rebound(points, lambda speed: 0.0)

    def _restitution_of(self, speed):
        """Return the restitution at a speed of approach [m/s]; none if it makes no bounce."""
        restitution = restitution_of_one(self._surfaces, speed) if speed > 0.0 else 0.0
        return restitution if speed * restitution > self._stick else 0.0

    def _rebound(self, points, restitution):
        """
        Resolve the impact with a restitution, a function of the speed of approach [m/s].

        Return whether all points leave that do not stay, or none rebounds anyway.
        """
        body, state = self.body, self.state
        turn = body.turn(state)
        arms = body.arms(turn, points)
        velocities = body.velocities(state, arms)
        shares = [restitution(-z) for _, _, z in velocities]
        hits = []
        if min(z for _, _, z in velocities) < 0.0:
            impulses = plane_impulses(body, turn, arms, velocities, shares, self._law)
            linear, angular = accelerations(body, turn, arms, impulses)
            self.state = [*state[:7], *(v + d for v, d in zip(state[7:], (*linear, *angular)))]
            hits = [Hit(self.time, [a + b for a, b in zip(state[:3], arm)], impulse, -z) for
                    arm, impulse, (_, _, z) in zip(arms, impulses, velocities) if -z > self._stick]
        after = body.velocities(self.state, arms)
        closed = [point for point, (_, _, z) in zip(points, after) if z < self._stick]
        if closed:
            self.hold(closed)
        left = body.velocities(self.state, arms)
        # what the others hold has a speed of rounding, whose sign may not decide
        done = not any(shares) or all(z > DRIFT * self.scales.speed for point, (_, _, z) in zip(
            points, left) if point not in closed)
        if done:
            self.closed = closed
            self._unarmed.update(point for point in points if point not in closed)
            self.hits += hits
        return done
