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

"""Poses for the times at which they will most likely be read next, evaluated together."""

import numpy as np

MOST_TIMES = 32
"""Times evaluated together: of ten bodies each then costs a tenth of what it does alone."""

MOST_POSES = 4096
"""Poses evaluated together: more would delay the state that is waited for, for those to come."""


class ReadAhead:
    """
    The poses of all bodies in flight, whenever they are asked for.

    A call of NumPy costs what the arithmetic for a hundred bodies does, so where states are read
    again and again and no flight is begun in between, those of several times to come are evaluated
    in one go: of twice as many times as the last, as long as they are indeed the ones that are
    read. What is returned is the same, to the bit.
    """

    def __init__(self, flights, world):
        """Read `Flights`, at the times that the world expects."""
        self._flights = flights
        self._world = world
        self._most = max(1, min(MOST_TIMES, MOST_POSES // max(1, world.bodies.count)))
        self._changes = None
        self._times = ()
        """Those evaluated, and the one after them if there is one."""
        self._count = self._place = 0
        """How many are evaluated, and which of all is expected next."""

    def poses(self, time):
        """Return positions (3, n) [m] and unit quaternions (4, n) at `time` [s], now."""
        known = (self._flights.changes == self._changes and self._place < len(self._times)
                 and time == self._times[self._place])
        if not known or self._place == self._count:
            self._evaluate(time, min(2 * self._count, self._most) if known else 1)
        place, self._place = self._place, self._place + 1
        return self._position[place], self._orientation[place]

    def _evaluate(self, time, count):
        """Evaluate poses at `time` [s] and, with it, at `count` times in all, if there are."""
        flights = self._flights
        if not flights.axes_stay:
            count = 1
        self._times = [time, *self._world.coming_times(count)]
        self._count = count = min(count, len(self._times))
        self._changes, self._place = flights.changes, 0
        self._world.work.pose_evaluations += count
        if count > 1:
            self._position, self._orientation = flights.poses_together(
                np.array(self._times[:count]))
        else:
            self._position, self._orientation = ([part] for part in flights.poses(time))
