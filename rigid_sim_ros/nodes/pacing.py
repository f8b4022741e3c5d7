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
When each simulated time is due on the wall clock, and what was late.

Time comes in as an argument, so that nothing here reads a clock and all of it can be tested.
Simulated times are integers [ns], wall times are floats [s] of a monotonic clock.
"""

NANOSECONDS = 1_000_000_000

MOST_LATENESS = 1.0
"""
Wall time [s] that is caught up after a stall. What exceeds it is given up: the schedule moves, so
that a node which slept for a minute does not run at twice its speed for the next.
"""

CATCH_UP_SPEED = 2.0
"""
States are begun at most this many times as fast as scheduled while lateness is caught up: a burst
would overrun the queues of subscribers, which are as deep as they need at the usual rate. What is
lost to waking up late is made good, up to a period: a few states then follow at once.
"""


class Pacer:
    """
    The schedule of a run: `real_time_factor` seconds of simulated time each second of wall time.

    A factor of zero is no schedule at all: everything is due at once.
    """

    def __init__(self, real_time_factor, period):
        """Begin with a factor and the simulated time between two states [s]; see `anchor`."""
        self._set_pace(real_time_factor, period)
        self._anchor_time = 0
        self._anchor_wall = 0.0
        self._earliest = float('-inf')
        self.missed_deadlines = 0
        """States published more than one period of wall time after they were due."""
        self.time_given_up = 0.0
        """Wall time [s] by which the schedule was moved because it could not be kept."""
        self.worst_lateness = 0.0
        """Largest lateness [s] since this was last set to zero."""

    def anchor(self, time, now):
        """Let the simulated time `time` [ns] be due `now` [s], and the rest follow from it."""
        self._anchor_time = time
        self._anchor_wall = now
        self._earliest = float('-inf')

    def change(self, real_time_factor, period, time, now):
        """Go on from simulated time `time` [ns] with another factor or period [s]."""
        self._set_pace(real_time_factor, period)
        self.anchor(time, now)

    def due(self, time):
        """Return the wall time [s] at which simulated time `time` [ns] is to be published."""
        if self._factor == 0:
            return float('-inf')
        scheduled = self._anchor_wall + (time - self._anchor_time) / self._speed
        return scheduled if scheduled > self._earliest else self._earliest

    def published(self, time, begun, now):
        """Note that the state of time `time` [ns], begun at `begun` [s], was out at `now` [s]."""
        if self._factor == 0:
            return
        lateness = now - self._anchor_wall - (time - self._anchor_time) / self._speed
        # from where it might have begun, not from now: what takes most of a period to compute, or
        # a processor that wakes up late, would not be caught up at all
        self._earliest = (max(self._earliest, begun - self._wall_period)
                          + self._wall_period / CATCH_UP_SPEED)
        if lateness > self.worst_lateness:
            self.worst_lateness = lateness
        if lateness > self._wall_period:
            self.missed_deadlines += 1
        if lateness > MOST_LATENESS:
            self.time_given_up += lateness
            self._anchor_wall += lateness

    def _set_pace(self, real_time_factor, period):
        self._factor = real_time_factor
        # simulated nanoseconds a second of wall time, and seconds of wall time a state
        self._speed = NANOSECONDS * real_time_factor
        self._wall_period = period / real_time_factor if real_time_factor else 0.0


class PublishGrid:
    """
    The simulated times [ns] at which states are published: whole periods from an origin.

    Every time is rounded from its own multiple of the period, so that a rate whose period is no
    whole number of nanoseconds (240 Hz) does not drift.
    """

    def __init__(self, rate, origin=0):
        """Begin a grid of `rate` [Hz] at `origin` [ns], which is itself on the grid."""
        self._rate = rate
        self._origin = origin
        self._before, self._number, self._next = origin, 1, self._at(1)

    def after(self, time):
        """Return the first time on the grid later than `time` [ns]."""
        # asked again and again while the same state is waited for, and then for the one after it
        if not self._before <= time < self._next:
            number = self._number + 1 if time == self._next else self._number_after(time)
            self._before, self._number, self._next = time, number, self._at(number)
        return self._next

    def following(self, time, count):
        """Return the first `count` times on the grid later than `time` [ns]."""
        first = self._number_after(time)
        return [self._at(number) for number in range(first, first + count)]

    def _number_after(self, time):
        number = int((time - self._origin) * self._rate / NANOSECONDS)
        while self._at(number) > time:
            number -= 1
        while self._at(number) <= time:
            number += 1
        return number

    def _at(self, number):
        return self._origin + round(number * NANOSECONDS / self._rate)
