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
Records messages as a rosbag2 bag, beside whoever makes them.

The bag is a folder with `NAME_0.mcap`, `NAME_1.mcap` ... and `metadata.yaml`, there from the
start. Messages are queued and written by a thread of its own, so a slow disk delays nobody.
Whatever goes wrong with the disk ends the recording with one error and leaves what was written
readable; whoever writes goes on.
"""

from collections import deque
from dataclasses import dataclass
import json
import os
from threading import Condition, Thread
from time import monotonic

from rigid_sim_ros.recording.bag_metadata import bag_topic
from rigid_sim_ros.recording.bag_writer import BagWriter
from rigid_sim_ros.recording.errors import RecordingError
from rigid_sim_ros.recording.history import ATTACHMENT, MEDIA_TYPE
from rigid_sim_ros.recording.mcap_file import COMPRESSIONS
from rigid_sim_ros.recording.software import package_version, software

RECORDING, CLOSED, FAILED = 'recording', 'closed', 'failed'
"""The phases of a recorder."""

DROP, WAIT = 'drop', 'wait'
"""What `Recorder.write` does when the queue is full: count a lost message, or wait for room."""

_BATCH_SECONDS = 0.05
"""How long messages gather before the thread takes them, so that it seldom asks for the GIL."""

_BATCH_BYTES = 2**22

_MESSAGE_OVERHEAD = 200
"""Bytes a queued message costs besides its data."""

_CLOSE_SECONDS = 1.2
"""How long closing goes on emptying the queue; the file is finished after that in any case."""

_FINISH_SECONDS = 0.4
"""How long finishing the file may take before closing gives up waiting for it."""


@dataclass(frozen=True)
class RecorderState:
    """How a recorder is doing."""

    phase: str
    path: str
    error: str
    """Why it failed, one line; empty if it did not."""

    message_count: int
    """Messages written to the disk."""

    byte_count: int
    """Bytes written to the disk."""

    queued_count: int
    queued_bytes: int
    dropped_count: int
    """Messages lost because the queue was full or the recording had failed."""


def _attachments(scene, options):
    run = {**(options or {}), **software()}
    return (('scene.yaml', 'application/yaml', scene.encode()),
            ('run.json', 'application/json', json.dumps(run).encode()))


class Recorder:
    """
    A recording in the making; also a context manager that closes it.

    Parameters
    ----------
    uri : str
        The folder to make; its last part names the files. It must not be there yet.
    topics : sequence
        Rows with a full name, a type_name and a quality (depth, reliability, durability).
    compression : str
        'none', 'lz4' or 'zstd', of each chunk.
    chunk_seconds : float
        Wall time [s] after which what has come is on the disk, and so the most that a kill or a
        power cut takes.
    max_bytes, max_duration : int, float
        Size [bytes] and simulated time [s] after which the bag goes on in a new file; 0: never.
    queue_bytes : int
        Memory for messages that wait for the disk.
    when_full : str
        `DROP` or `WAIT`.
    scene : str
        The scene as loaded, attached as `scene.yaml`.
    options : dict
        What else is needed to run it again, attached as `run.json`.
    history : sequence of bytes
        What happened before, as `History.pieces` gives it; attached as `history`.
    on_full : callable
        Called without arguments by `write` when it begins to wait or to count lost messages.

    Raises `RecordingError` if the folder is there already or cannot be made.

    """

    def __init__(self, uri, topics, *, compression='zstd', chunk_seconds=1.0, max_bytes=0,
                 max_duration=0.0, queue_bytes=2**28, when_full=DROP, scene='', options=None,
                 history=(), on_full=lambda: None):
        if compression not in COMPRESSIONS:
            raise RecordingError(f'compression is {compression!r}; allowed: '
                                 f'{", ".join(COMPRESSIONS)}')
        self.path = os.path.abspath(uri)
        topics = tuple(bag_topic(row) for row in topics)
        self._channels = {topic.name: number for number, topic in enumerate(topics, 1)}
        self._chunk_seconds = chunk_seconds
        self._queue_bytes, self._when_full = queue_bytes, when_full
        self._on_full, self._full = on_full, False
        self._condition = Condition()
        self._queue = deque()
        self._queued_bytes = self._dropped_count = 0
        self._phase, self._error = RECORDING, ''
        self._closing_until = None
        self._history = history
        self._bag = self._begin(topics, compression, _attachments(scene, options), max_bytes,
                                round(max_duration * 1e9))
        self._thread = Thread(target=self._run, name='recorder', daemon=True)
        self._thread.start()

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    @property
    def error(self):
        """Why the recording failed, one line; empty while all is well."""
        return self._error

    def state(self):
        """Return a `RecorderState`."""
        with self._condition:
            return RecorderState(
                self._phase, self.path, self._error, self._bag.message_count,
                self._bag.byte_count, len(self._queue), self._queued_bytes, self._dropped_count)

    def write(self, topic_name, time_ns, data):
        """
        Queue a message of a topic at a simulated time [ns]; it returns at once.

        Times that go back begin a new file of the bag. Raises KeyError for a topic that was not
        given at the start, and nothing else; after a failure messages are counted as dropped.
        """
        channel = self._channels[topic_name]
        size = len(data) + _MESSAGE_OVERHEAD
        with self._condition:
            if not self._queue:
                self._full = False
            while self._phase == RECORDING and self._queued_bytes + size > self._queue_bytes:
                if not self._full:
                    self._full = True
                    self._on_full()
                if self._when_full == DROP or not self._queue:
                    break
                self._condition.wait()
            if self._phase != RECORDING or self._queued_bytes + size > self._queue_bytes:
                self._dropped_count += 1
                return
            self._queue.append((channel, time_ns, data))
            self._queued_bytes += size
            if len(self._queue) == 1 or self._queued_bytes >= _BATCH_BYTES:
                self._condition.notify_all()

    def close(self):
        """
        Write what is queued, finish the bag, and return the `RecorderState`.

        Takes at most 2 s, however slow the disk is, and may be called again, also after it was
        interrupted: the work is done by the recorder's thread.
        """
        with self._condition:
            if self._closing_until is None:
                self._closing_until = monotonic() + _CLOSE_SECONDS
            self._condition.notify_all()
        self._thread.join(max(0.0, self._closing_until + _FINISH_SECONDS - monotonic()))
        if self._thread.is_alive():
            # no error if only the disk has not confirmed yet: the phase is `CLOSED` then
            self._fail('the disk does not take the rest; once it does, '
                       f'rigid_sim_recover {self.path} finishes the bag')
        return self.state()

    def _begin(self, topics, *options):
        try:
            if os.path.lexists(self.path):
                raise RecordingError(f'{self.path} is there already; a recording never replaces '
                                     'another')
            return BagWriter(self.path, topics, options[0], f'rigid_sim_ros {package_version()}',
                             *options[1:])
        except OSError as error:
            raise RecordingError(
                f'cannot record to {self.path}: {error.strerror or error}') from error

    # -- the thread ----------------------------------------------------------------------------

    def _run(self):
        try:
            if self._history:
                # by this thread, as it may be large
                self._bag.attach(ATTACHMENT, MEDIA_TYPE, self._history)
                self._history = ()
            self._write_until_closed()
            self._bag.finish()
            with self._condition:
                if self._phase == RECORDING:
                    self._phase = CLOSED
            # whole for all who read it by now; a slow disk keeps nobody waiting
            self._bag.sync_finished()
        except OSError as error:
            self._fail(error.strerror or str(error))
            self._bag.save()
        finally:
            with self._condition:
                if self._phase == RECORDING:
                    self._fail('the recorder stopped unexpectedly')
                self._condition.notify_all()

    def _write_until_closed(self):
        chunk_due = None
        while True:
            batch = self._next_batch(chunk_due)
            for index, message in enumerate(batch):
                if self._out_of_time():
                    self._drop(len(batch) - index)
                    break
                self._bag.add(*message)
            if batch and chunk_due is None:
                # the oldest message may have waited for one batch and will wait for another
                chunk_due = monotonic() + max(0.0, self._chunk_seconds - 2 * _BATCH_SECONDS)
            self._bag.check()
            if chunk_due is not None and monotonic() >= chunk_due:
                self._bag.flush()
                chunk_due = None
            if self._closing_until is not None and not self._queue:
                return

    def _next_batch(self, chunk_due):
        """Wait until there is something to do and return the messages queued, maybe none."""
        with self._condition:
            self._condition.wait_for(
                lambda: self._queue or self._closing_until is not None,
                None if chunk_due is None else max(0.0, chunk_due - monotonic()))
            self._condition.wait_for(
                lambda: self._queued_bytes >= _BATCH_BYTES or self._closing_until is not None,
                _BATCH_SECONDS)
            batch = list(self._queue)
            self._queue.clear()
            self._queued_bytes = 0
            self._condition.notify_all()
        return batch

    def _out_of_time(self):
        return self._closing_until is not None and monotonic() > self._closing_until

    def _fail(self, reason):
        with self._condition:
            if self._phase == RECORDING:
                self._phase = FAILED
                self._error = f'recording to {self.path} stopped: {reason}'
                self._dropped_count += len(self._queue)
                self._queue.clear()
                self._queued_bytes = 0

    def _drop(self, count):
        with self._condition:
            self._dropped_count += count
