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
The messages of a bag, each when it is due.

Nothing here knows ROS, and wall time comes in as an argument. Bag time runs on where simulated
time was reset: a message that is stamped earlier than the one before follows at once.
"""

from collections import deque

from rigid_sim_ros.nodes.pacing import NANOSECONDS
from rigid_sim_ros.recording import Bag, RecordingError
from rigid_sim_ros.recording.collecting import COMMAND_KINDS

MOST_AHEAD = 64
"""Messages read before the one that is due next is."""


class Playback:
    """
    Goes through a bag at a rate, from an offset, maybe again and again.

    Parameters
    ----------
    path : str
        The bag.
    topics : collection of str
        Names of the topics to play; empty: all that a simulator publishes.
    rate : float
        Seconds of bag time each second of wall time.
    start : float
        Bag time [s] to begin at; of latched topics the last message before is played too.
    loop : bool
        Begin again at the end.

    Raises `RecordingError` if there is nothing to play.

    """

    def __init__(self, path, topics=(), rate=1.0, start=0.0, loop=False):
        self._path, self._chosen = path, frozenset(topics)
        self._rate, self._start_ns, self._loop = rate, round(start * NANOSECONDS), loop
        self.topics = self._survey()
        """`BagTopic` of what is played, by name."""
        self.damage = ()
        """What could not be read so far."""
        self._anchor_wall, self._anchor_ns = float('inf'), 0
        self._ahead = deque()
        self._timed = self._from_start()
        self._go_on()
        if self.message is None:
            raise RecordingError(f'{path} has nothing to play from {start:g} s on')

    @property
    def due(self):
        """Wall time [s] at which `message` is due; infinite at the end, and before `anchor`."""
        if self.message is None:
            return float('inf')
        return self._anchor_wall + (self._elapsed - self._anchor_ns) / NANOSECONDS / self._rate

    def anchor(self, now):
        """Let the next message be due `now` [s], and the rest follow."""
        self._anchor_wall, self._anchor_ns = now, self._elapsed

    def take(self):
        """Return the next message, and go on to the one after it: `message`, None at the end."""
        taken, due = self.message, self.due
        self._go_on()
        if self.message is None and self._loop:
            self._timed = self._from_start()
            self._go_on()
            self.anchor(due)
        return taken

    def read_ahead(self):
        """
        Read what is due together with `message`, and one more.

        To be called while nothing is due: taking a message can mean reading a chunk, two
        milliseconds for a megabyte, and those that are due with it would wait for that.
        """
        ahead = self._ahead
        while len(ahead) < MOST_AHEAD and (not ahead or ahead[-1][0] == self._elapsed):
            following = next(self._timed, None)
            if following is None:
                return
            ahead.append(following)

    def _go_on(self):
        self._elapsed, self.message = (
            self._ahead.popleft() if self._ahead else next(self._timed, (0, None)))

    def _survey(self):
        bag = Bag(self._path)
        there = {name for overview in bag.overviews() for name in overview.counts}
        next(bag.messages(), None)  # what a topic is stands at the beginning
        unknown = sorted(self._chosen - there)
        if unknown:
            raise RecordingError(f'{self._path} has no messages of {unknown[0]!r}, but of '
                                 f'{", ".join(sorted(there))}')
        return {name: bag.topics[name] for name in sorted(there)
                if self._is_wanted(name, bag.kind(name))}

    def _is_wanted(self, name, kind):
        return name in self._chosen if self._chosen else kind not in COMMAND_KINDS

    def _from_start(self):
        """Go through the messages to play: bag time [ns] since its beginning, and message."""
        elapsed, last, latched = 0, None, {}
        bag = Bag(self._path)
        for message in bag.messages():
            if last is not None:
                elapsed += max(0, message.time_ns - last)
            last = message.time_ns
            if message.topic not in self.topics:
                continue
            if elapsed < self._start_ns:
                if self.topics[message.topic].is_latched:
                    latched[message.topic] = message
                continue
            while latched:
                yield elapsed, latched.pop(next(iter(latched)))
            yield elapsed, message
        self.damage = tuple(bag.damage)
