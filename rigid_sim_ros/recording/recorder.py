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
start. Messages are copied into chunks at once, while they are in the processor's cache. A thread
of its own writes whole chunks: so a slow disk delays nobody, and the interpreter, which the thread
would have to ask for at every message, is seldom held up.
Whatever goes wrong with the disk ends the recording with one error and leaves what was written
readable; whoever writes goes on.
"""

from dataclasses import dataclass
import json
import os
from threading import Condition, RLock, Thread
from time import monotonic

from rigid_sim_ros.recording.bag_metadata import bag_topic
from rigid_sim_ros.recording.bag_writer import BagWriter
from rigid_sim_ros.recording.errors import RecordingError
from rigid_sim_ros.recording.history import ATTACHMENT, MEDIA_TYPE
from rigid_sim_ros.recording.mcap_file import COMPRESSIONS, declarations
from rigid_sim_ros.recording.packing import Packing
from rigid_sim_ros.recording.software import package_version, software

RECORDING, CLOSED, FAILED = 'recording', 'closed', 'failed'
"""The phases of a recorder."""

DROP, WAIT = 'drop', 'wait'
"""What `Recorder.write` does when the queue is full: count a lost message, or wait for room."""

_MARGIN = 0.1
"""How long before its time is up [s] what has come is written."""

_MESSAGE_OVERHEAD = 31
"""Bytes a message takes besides its data."""

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
        The folder to make; its last part names the files. It must not be there yet. `~` is home.
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
        self.path = os.path.abspath(os.path.expanduser(uri))
        topics = tuple(bag_topic(row) for row in topics)
        self._channels = {topic.name: number for number, topic in enumerate(topics, 1)}
        self._chunk_seconds = chunk_seconds
        self._queue_bytes, self._when_full = queue_bytes, when_full
        self._on_full, self._full = on_full, False
        self._lock = RLock()  # is entered by a call of C, unlike the condition
        self._condition = Condition(self._lock)
        self._dropped_count = 0
        self._due = None
        self._phase, self._error = RECORDING, ''
        self._closing_until = None
        self._history = history
        self._bag = self._begin(topics, compression, _attachments(scene, options))
        latched = {self._channels[topic.name] for topic in topics if topic.is_latched}
        self._packing = Packing(latched, declarations(topics), self._bag.byte_count, max_bytes,
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
            waiting = self._packing if self._phase == RECORDING else None
            return RecorderState(
                self._phase, self.path, self._error, self._bag.message_count,
                self._bag.byte_count, waiting.message_count if waiting else 0,
                self._dropped_count)

    def write(self, topic_name, time_ns, data):
        """
        Take a message of a topic at a simulated time [ns]; it returns at once.

        Times that go back begin a new file of the bag. The data is copied. Raises KeyError for a
        topic that was not given at the start, and nothing else; after a failure messages are
        counted as dropped.
        """
        channel = self._channels[topic_name]
        with self._lock:
            packing, size = self._packing, len(data) + _MESSAGE_OVERHEAD
            if (packing.byte_count + size > self._queue_bytes or self._phase != RECORDING) and (
                    not self._make_room(size)):
                self._dropped_count += 1
                return
            packing.add(channel, time_ns, data)
            if self._due is None:
                self._due = monotonic() + max(0.0, self._chunk_seconds - _MARGIN)
                self._condition.notify_all()
            elif packing.closed:
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

    def _make_room(self, size):
        """Tell whether so many bytes can be taken, after waiting for it if that was asked for."""
        packing = self._packing
        while self._phase == RECORDING and packing.byte_count + size > self._queue_bytes:
            if not self._full:
                self._full = True
                self._on_full()
            # however small the queue is, what is in it can be written
            packing.close_chunk()
            self._condition.notify_all()
            if self._when_full == DROP or not packing.byte_count:
                return False
            self._condition.wait()
        return self._phase == RECORDING

    def _begin(self, topics, compression, attachments):
        try:
            if os.path.lexists(self.path):
                raise RecordingError(f'{self.path} is there already; a recording never replaces '
                                     'another')
            return BagWriter(self.path, topics, compression,
                             f'rigid_sim_ros {package_version()}', attachments)
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
        while True:
            chunks, is_due, is_last = self._next_chunks()
            for chunk in chunks:
                if self._out_of_time():
                    with self._condition:
                        self._dropped_count += self._packing.message_count
                    return
                byte_count = self._bag.write(chunk)
                with self._condition:
                    self._packing.give_back(chunk, byte_count)
                    self._full &= self._packing.byte_count > 0
                    self._condition.notify_all()
            self._bag.check()
            if is_due:
                self._bag.sync()
                self._bag.sync_finished()
            if is_last and not self._packing.message_count:
                return

    def _next_chunks(self):
        """Wait for something to do; return chunks, whether time is up, and whether all is over."""
        with self._condition:
            while not self._packing.closed and self._closing_until is None:
                time_left = None if self._due is None else self._due - monotonic()
                if time_left is not None and time_left <= 0:
                    break
                self._condition.wait(time_left)
            is_last = self._closing_until is not None
            is_due = self._due is not None and monotonic() >= self._due
            if is_due or is_last:
                self._packing.close_chunk()
                self._due = None
            return self._packing.take(), is_due, is_last

    def _out_of_time(self):
        return self._closing_until is not None and monotonic() > self._closing_until

    def _fail(self, reason):
        with self._condition:
            if self._phase == RECORDING:
                self._phase = FAILED
                self._error = f'recording to {self.path} stopped: {reason}'
                self._dropped_count += self._packing.message_count
                # whoever waits for room need not wait until the file is closed
                self._condition.notify_all()
