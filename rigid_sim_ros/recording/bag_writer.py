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

"""Writes the files of a bag: `NAME_0.mcap`, `NAME_1.mcap` ... and metadata.yaml."""

import os

from rigid_sim_ros.recording.bag_metadata import bag_metadata, to_yaml, write_metadata
from rigid_sim_ros.recording.disk import sync_path
from rigid_sim_ros.recording.mcap_file import McapFile


class BagWriter:
    """
    A bag that is being written; every method may raise OSError.

    Parameters
    ----------
    path : str
        The folder, which must not be there yet.
    topics : sequence of BagTopic
        All that may be written; channels are their numbers from 1.
    compression, library, attachments
        As for `McapFile`.

    """

    def __init__(self, path, topics, compression, library, attachments):
        self._path, self._topics = path, topics
        self._compression, self._library = compression, library
        self._attachments = attachments
        self._summaries = []
        self._unsynced = set()
        self._finished_bytes = 0
        os.makedirs(path)
        self._open_file()
        self._write_sidecar()

    @property
    def message_count(self):
        """Messages written to the disk."""
        return sum(summary.message_count for summary in self._summaries)

    @property
    def byte_count(self):
        """Bytes written to the disk."""
        return self._finished_bytes + self._file.size

    def write(self, chunk):
        """Write a chunk to the file that it belongs to; return by how much that grew [bytes]."""
        if chunk.file_number == len(self._summaries):
            self._next_file()
        before = self._file.size
        self._file.write(chunk)
        return self._file.size - before

    def attach(self, name, media_type, parts):
        """Attach data in parts to the file that is being written, and to none after it."""
        self._file.attach(name, media_type, parts)

    def sync(self):
        """Make everything that was written safe from a power cut."""
        self._file.sync()
        self.sync_finished()

    def sync_finished(self):
        """Make what was finished since the last time safe from a power cut."""
        while self._unsynced:
            sync_path(self._unsynced.pop())

    def check(self):
        """Raise FileNotFoundError if the file was removed meanwhile."""
        if not self._file.is_there():
            raise FileNotFoundError(0, 'the file was removed')

    def finish(self):
        """Finish the last file and the sidecar; `sync_finished` is left to do."""
        self._finish_file()
        self._write_sidecar()

    def save(self):
        """Finish the bag after a failure, as far as the disk allows."""
        try:
            self._file.finish()
            self._write_sidecar()
        except (OSError, ValueError):
            # nothing more can be written, or the file is closed: what is there stays as it is
            self._file.abandon()

    def _open_file(self):
        name = f'{os.path.basename(self._path)}_{len(self._summaries)}.mcap'
        self._file = McapFile(os.path.join(self._path, name), self._topics, self._compression,
                              self._library, self._attachments)
        self._summaries.append(self._file.summary)
        self._write_bag_metadata()

    def _next_file(self):
        self._finish_file()
        self._finished_bytes += self._file.size
        self._open_file()
        self._write_sidecar()

    def _finish_file(self):
        self._write_bag_metadata()
        self._file.finish()
        self._unsynced |= {self._file.path, self._path}

    def _write_bag_metadata(self):
        self._file.write_metadata('rosbag2', {
            'serialized_metadata': to_yaml(bag_metadata(self._topics, self._summaries))})

    def _write_sidecar(self):
        self._unsynced.add(write_metadata(self._path, self._topics, self._summaries))
