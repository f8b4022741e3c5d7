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
What happens in a simulation: impacts, and the beginning and end of lasting contact.

The normal points from body a to body b, the impulse acts on b (and its opposite on a), and the
speed is that of approach, positive. Bodies are numbers: moving bodies in scene order, then fixed
bodies, then planes.
"""

import numpy as np

IMPACT = 0
"""An instant's impulse."""

BEGIN = 1
"""Two bodies started to touch and go on touching."""

END = 2
"""Two bodies that were touching came apart."""

COLLISION = np.dtype([
    ('time', np.float64),  # [s]
    ('body_a', np.int32),
    ('body_b', np.int32),
    ('kind', np.uint8),
    ('point', np.float64, (3,)),  # [m], world axes
    ('normal', np.float64, (3,)),  # unit vector from a to b, world axes
    ('impulse', np.float64, (3,)),  # [N s] on b, normal and friction part, world axes
    ('speed', np.float64),  # approach [m/s] along the normal, before the impulse
])
"""One event, with the conventions of this module."""

NO_EVENTS = np.zeros(0, dtype=COLLISION)
"""What most steps give."""


GONE = -1
"""The number of a body that is not there any more."""


def renumbered(events, numbers):
    """Return events with bodies of other numbers (n,), without those of bodies that are gone."""
    a, b = numbers[events['body_a']], numbers[events['body_b']]
    there = (a != GONE) & (b != GONE)
    events = events[there]
    events['body_a'], events['body_b'] = a[there], b[there]
    return events


class EventLog:
    """Events in the order in which they are found, handed out in order of time."""

    def __init__(self):
        self._rows = []

    @property
    def struck(self):
        """Whether any of these events is an impact."""
        return any(row[3] == IMPACT for row in self._rows)

    def append(self, time, a, b, kind, point, normal, impulse=(0.0, 0.0, 0.0), speed=0.0):
        """
        Note one event: a time [s], two body indices, a kind, and what `COLLISION` holds.

        Vectors are (3,) in world axes and are copied. The impulse and the speed are zero for the
        beginning and the end of contact, which have neither.
        """
        self._rows.append((time, a, b, kind, *point, *normal, *impulse, speed))

    def renumber(self, numbers):
        """Let bodies have other numbers (n,), and forget events of bodies that are gone."""
        rows = ((time, int(numbers[int(a)]), int(numbers[int(b)]), *rest)
                for time, a, b, *rest in self._rows)
        self._rows = [row for row in rows if GONE not in row[1:3]]

    def take(self):
        """
        Return the events as an array of dtype `COLLISION`, in order of time, and forget them.

        Events of the same instant keep the order in which they were appended.
        """
        if not self._rows:
            return NO_EVENTS
        rows = np.array(self._rows, dtype=np.float64)
        self._rows.clear()
        rows = rows[np.argsort(rows[:, 0], kind='stable')]
        events = np.zeros(len(rows), dtype=COLLISION)
        for column, name in enumerate(('time', 'body_a', 'body_b', 'kind')):
            events[name] = rows[:, column]
        events['point'] = rows[:, 4:7]
        events['normal'] = rows[:, 7:10]
        events['impulse'] = rows[:, 10:13]
        events['speed'] = rows[:, 13]
        return events
