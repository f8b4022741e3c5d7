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

"""Publishing for human eyes: what is drawn, no more often than anybody can see."""

import numpy as np

from rigid_sim_ros.messages import encode_delete_all
from rigid_sim_ros.topics import FOR_DISPLAY

PERIOD = 1 / 30
"""Wall time [s] between two pictures. Markers are fifteen times the size of poses."""


class Display:
    """Publishes the rows of occasion `FOR_DISPLAY`, with all events since the picture before."""

    def __init__(self, publications, source, now):
        """Draw from a `topics.Source`; `now()` is the wall time [s]."""
        self._publications = publications
        self._source = source
        self._now = now
        self._due = float('-inf')
        self._events = []
        self._drawn_time = None

    def take(self, time, collisions):
        """Draw the state of simulated time `time` [ns] if a picture is due."""
        if not self._watched():
            self._events.clear()
            return
        if len(collisions):
            self._events.append(collisions)
        if self._now() >= self._due:
            self.draw(time)

    def draw(self, time):
        """Draw the state as it is now, due or not."""
        source, events = self._source, self._events
        before = source.collisions
        if events:
            source.collisions = np.concatenate(events)
        self._publications.send(FOR_DISPLAY, time)
        source.collisions = before
        events.clear()
        self._drawn_time = time
        self._due = self._now() + PERIOD

    def catch_up(self, time):
        """Draw the state if it is not the one on the screen; for when time stands still."""
        if time != self._drawn_time and self._watched():
            self.draw(time)

    def clear(self, time):
        """Remove everything from the screen: other bodies may follow."""
        self._events.clear()
        self._drawn_time = None
        for publication in self._publications.of(FOR_DISPLAY):
            publication.send_bytes(encode_delete_all(time, self._source.frame_id))

    def _watched(self):
        for publication in self._publications.of(FOR_DISPLAY):
            if publication.heard:
                return True
        return False
