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
The published topics: bytes made once, for subscribers and recording alike, or not at all.

A row of `topics.PUBLISHED` is a `Publication` here. Its encoder is made when somebody first wants
its messages, and a message is made only if there is a subscriber or a recording at that moment.
"""

from rclpy.qos_overriding_options import QoSOverridingOptions

from rigid_sim_ros.nodes.interfaces import interface, quality_of_service
from rigid_sim_ros.topics import (
    EVERY_SECOND, EVERY_STEP, FOR_DISPLAY, ON_CHANGE, ON_EVENTS, PUBLISHED)


LOOK_INTERVAL = 0.05
"""Wall time [s] for which the counts of subscribers hold: asking costs half of a small message."""


class Publication:
    """One published topic."""

    def __init__(self, node, row, source, recording, reliability):
        self.row = row
        self.encoded = 0
        """Messages made so far."""
        self._source = source
        self._recording = recording
        self._encode = None
        self._publisher = node.create_publisher(
            interface(row.type_name), row.name, quality_of_service(row.quality, reliability),
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        # `publish` itself takes bytes only, so the messages would have to be copied once more
        self._publish = self._publisher.handle.publish_raw
        # what is latched goes to subscribers yet to come
        self._latched = row.quality.durability == 'transient_local'
        self._subscribers_before = 0
        self.look()

    @property
    def topic(self):
        """Return the full name of the topic, after remapping."""
        return self._publisher.topic_name

    def look(self):
        """See who subscribes now."""
        self._subscribers = self._publisher.get_subscription_count()
        self.heard = self._latched or self._subscribers > 0
        """Whether publishing a message reaches anybody."""

    def send(self, time, heard, recorded):
        """Make the message of simulated time `time` [ns] for subscribers, recording or both."""
        if self._encode is None:
            self._encode = self.row.encoder(self._source)
        data = self._encode(time)
        self.encoded += 1
        if heard:
            self._publish(data)
        if recorded:
            self._recording.write(self.row.name, time, data)

    def send_bytes(self, data):
        """Publish a message made elsewhere, to subscribers only."""
        if self.heard:
            self._publish(data)

    def forget_bodies(self):
        """Make the encoder anew for the next message: the source has other bodies now."""
        self._encode = None

    def has_new_subscriber(self):
        """Tell whether there are more subscribers than when this was last asked."""
        before, self._subscribers_before = self._subscribers_before, self._subscribers
        return self._subscribers > before

    def destroy(self, node):
        """Stop publishing the topic."""
        node.destroy_publisher(self._publisher)


class Publications:
    """All published topics of a node."""

    def __init__(self, node, source, recording, reliability, now):
        """
        Create a publisher for every row that no parameter can turn off.

        `now()` is the wall time [s].
        """
        self._node = node
        self._source = source
        self._recording = recording
        self._reliability = reliability
        self._now = now
        self._look_due = float('-inf')
        self._publications = {}
        for row in PUBLISHED:
            if row.parameter is None:
                self.begin(row)

    def __iter__(self):
        return iter(self._publications.values())

    def begin(self, row):
        """Publish a row's topic from now on."""
        if row.name not in self._publications:
            # only the streams: losing an event or the scene is never what anybody wants
            is_stream = row.when in (EVERY_STEP, FOR_DISPLAY) and not row.parameter
            reliability = self._reliability if is_stream else None
            self._publications[row.name] = Publication(
                self._node, row, self._source, self._recording, reliability)
            self._sort()

    def is_open(self, row):
        """Tell whether a row's topic is published."""
        return row.name in self._publications

    def end(self, row):
        """Publish a row's topic no longer."""
        publication = self._publications.pop(row.name, None)
        if publication is not None:
            publication.destroy(self._node)
            self._sort()

    def look(self):
        """See who subscribes now; done by itself, but not with every message."""
        for publication in self:
            publication.look()
        self._look_due = self._now() + LOOK_INTERVAL

    def send_state(self, time, collisions):
        """Publish what belongs to a state: the state, and the events since the last one."""
        self._source.collisions = collisions
        self.send(EVERY_STEP, time)
        if len(collisions):
            self.send(ON_EVENTS, time)

    def show_state(self, time):
        """Publish the state once more, to subscribers only: it is in the recording already."""
        self.send(EVERY_STEP, time, to_recording=False)

    def send_scene(self, time):
        """Publish what only changes with the scene, and make all encoders anew."""
        for publication in self:
            publication.forget_bodies()
        self.send(ON_CHANGE, time)

    def record_scene(self, time):
        """Write to the recording what only changes with the scene: it has just been started."""
        self.send(ON_CHANGE, time, to_subscribers=False)

    def record_state(self, time):
        """Write the state to the recording alone, as it is."""
        self.send(EVERY_STEP, time, to_subscribers=False)

    def send_diagnostics(self, time, statuses):
        """Publish what is sent each second of wall time; `statuses()` is called if it is read."""
        self.look()
        if any(publication.heard for publication in self.of(EVERY_SECOND)):
            self._source.statuses = statuses()
            self.send(EVERY_SECOND, time)

    def has_new_subscriber(self):
        """Tell whether somebody subscribed to a stream since this was last asked."""
        self.look()
        # all are asked: each remembers that it was
        answers = [publication.has_new_subscriber()
                   for publication in (*self.of(EVERY_STEP), *self.of(FOR_DISPLAY))]
        return any(answers)

    def send(self, when, time, to_subscribers=True, to_recording=True):
        """
        Make the messages of an occasion in `topics` at simulated time `time` [ns].

        Those, that is, that a subscriber or the recording wants.
        """
        if self._now() >= self._look_due:
            self.look()
        wanted = self._recording.wanted if to_recording else ()
        self._source.shared = {}
        for publication in self._occasions.get(when, ()):
            heard = to_subscribers and publication.heard
            recorded = publication.row.name in wanted
            if heard or recorded:
                publication.send(time, heard, recorded)
        self._source.shared = None

    def of(self, when):
        """Return the publications sent at one of the occasions in `topics`, as a list."""
        return self._occasions.get(when, ())

    def _sort(self):
        self._occasions = {}
        for publication in self:
            self._occasions.setdefault(publication.row.when, []).append(publication)
