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

"""The files of a bag, as one stream of messages."""

from collections import Counter
import json
import os
import re
from typing import NamedTuple

from rigid_sim_ros.recording.errors import RecordingError
from rigid_sim_ros.recording.mcap_scan import McapScan


class BagMessage(NamedTuple):
    """A message of a bag."""

    topic: str
    time_ns: int
    data: memoryview


class FileOverview(NamedTuple):
    """What is in a file of a bag."""

    counts: Counter
    """Messages by the name of their topic."""

    start_ns: int
    end_ns: int
    """Times of the first and the last message; zero if there is none."""


def bag_files(path):
    """
    Return the paths of the MCAP files of a bag in order: a folder, or one file alone.

    The files are those in the folder, by number; metadata.yaml is not asked, since it may be
    older than they are. Raises `RecordingError` if there is none.
    """
    if os.path.isfile(path):
        return [path]
    try:
        names = os.listdir(path)
    except OSError as error:
        raise RecordingError(f'cannot read {path}: {error.strerror}') from error
    files = sorted((name for name in names if name.endswith('.mcap')), key=_by_number)
    if not files:
        raise RecordingError(f'no MCAP file in {path}')
    return [os.path.join(path, name) for name in files]


def _last_part(name):
    return name.rpartition('/')[2]


def _by_number(name):
    number = re.search(r'_(\d+)\.mcap$', name)
    return (int(number.group(1)[-18:]) if number else -1, name)


class Bag:
    """
    A bag as far as it can be read.

    `messages` goes through it once; what could not be read is in `damage` after that. Raises
    `RecordingError` if there is no bag, or nothing in it is an MCAP file.
    """

    def __init__(self, path):
        self.path = os.path.abspath(os.path.expanduser(path))
        self.files = bag_files(self.path)
        self.damage = []
        """What could not be read, one line each."""

        self.unfinished = []
        """Names of the files that do not end as they should."""

        self.topics = {}
        """`BagTopic` by name."""

        self.attachments = {}
        """Bytes by name, of the first file that has them; there from the first message on."""

        self._kinds = None

    def kind(self, name):
        """
        Return what the node's own name for a topic ends with: poses for /rigid_sim/poses.

        Also of a topic that was remapped, whatever it is called. From the first message on.
        """
        if self._kinds is None:
            names = self.options().get('topics')
            names = names if isinstance(names, dict) else {}
            self._kinds = {resolved: _last_part(own) for own, resolved in names.items()
                           if isinstance(resolved, str)}
        return self._kinds.get(name) or _last_part(name)

    def overviews(self):
        """
        Return a `FileOverview` of each file that can be read; `topics` is complete after that.

        From the ends of the files where these are sound, so that it takes no time; files that
        have none are gone through.
        """
        overviews = []
        for path in self.files:
            try:
                overviews.append(self._overview(path))
            except RecordingError as error:
                self.damage.append(str(error))
        return overviews

    def _overview(self, path):
        scan = McapScan(path)
        statistics = scan.statistics()
        if statistics is None:
            counts, times = Counter(), []
            for message in self._messages_of(McapScan(path)):
                counts[message.topic] += 1
                times = [*times[:1], message.time_ns]
            return FileOverview(counts, times[0] if times else 0, times[-1] if times else 0)
        counts = Counter()
        for channel, count in statistics.channel_message_counts.items():
            if count and channel in scan.topics:
                counts[scan.topics[channel].name] += count
        for topic in scan.topics.values():
            self.topics.setdefault(topic.name, topic)
        return FileOverview(counts, statistics.message_start_time, statistics.message_end_time)

    def messages(self):
        """Go through all messages in the order in which they were recorded."""
        unreadable = 0
        for path in self.files:
            try:
                scan = McapScan(path)
            except RecordingError as error:
                unreadable += 1
                if unreadable == len(self.files):
                    raise
                self.damage.append(str(error))
                continue
            yield from self._messages_of(scan)
            self._take_over(scan)

    def _messages_of(self, scan):
        unknown = set()
        for number, (channel, _, time_ns, data) in enumerate(scan.messages()):
            if number == 0:
                self._take_attachments(scan)
            topic = scan.topics.get(channel)
            if topic is not None:
                self.topics.setdefault(topic.name, topic)
                yield BagMessage(topic.name, time_ns, data)
            elif channel not in unknown:
                unknown.add(channel)
                self.damage.append(f'{scan.name}: messages of the unknown channel {channel} '
                                   'left out')

    def _take_over(self, scan):
        self.damage += scan.damage
        if not scan.finished:
            self.unfinished.append(scan.name)
        for topic in scan.topics.values():
            self.topics.setdefault(topic.name, topic)
        self._take_attachments(scan)

    def _take_attachments(self, scan):
        for attachment in scan.attachments.values():
            self.attachments.setdefault(attachment.name, attachment.data)

    def scene(self):
        """Return the attached scene, YAML; empty if there is none."""
        return self.attachments.get('scene.yaml', b'').decode(errors='replace')

    def history(self):
        """Return what happened before, bytes for `read_history`; empty if it is not attached."""
        return self.attachments.get('history', b'')

    def options(self):
        """Return what else the run was started with, a dict; empty if there is none."""
        try:
            options = json.loads(self.attachments.get('run.json', b'{}'))
        except (ValueError, RecursionError):
            options = None
        if not isinstance(options, dict):
            self.damage.append('the attachment run.json is no JSON object')
            return {}
        return options
