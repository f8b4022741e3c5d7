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
Finishes a bag whose recorder was killed, or whose files were damaged.

Every file that does not end as it should is written anew from what can be read, and takes the
place of the old one only when it is complete. The old file is kept beside it, with `.damaged`
behind its name, if more than its end was missing. Then metadata.yaml is written to match.
"""

import os

from rigid_sim_ros.recording.bag import bag_files
from rigid_sim_ros.recording.bag_metadata import (
    bag_metadata, FileSummary, to_yaml, write_metadata)
from rigid_sim_ros.recording.chunk import Chunk, CHUNK_BYTES
from rigid_sim_ros.recording.disk import is_being_written, sync_path
from rigid_sim_ros.recording.errors import RecordingError
from rigid_sim_ros.recording.mcap_file import declarations, McapFile
from rigid_sim_ros.recording.mcap_scan import McapScan

_COMPRESSION = 'zstd'


def recover(path):
    """
    Make a bag whole as far as it can be read; return what was done, one line each.

    A bag that is sound stays as it is. Raises `RecordingError` if nothing can be read, the bag
    was not recorded by this package, or it cannot be written.
    """
    if not os.path.isdir(path):
        raise RecordingError(f'{path} is not the folder of a bag')
    try:
        return _recover(path)
    except OSError as error:
        raise RecordingError(f'cannot write to {path}: {error.strerror or error}') from error


def _recover(path):
    topics, summaries, report = {}, [], []
    files = bag_files(path)
    for file in files:
        try:
            scan = McapScan(file)
        except RecordingError as error:
            if len(files) == 1:
                raise
            os.replace(file, file + '.damaged')
            report.append(f'{error}: set aside as {os.path.basename(file)}.damaged')
            continue
        summary = _recount(scan)
        if scan.damage or not scan.finished:
            _check_may_rewrite(scan)
            summary = _rewrite(file, summaries, report)
        for topic in scan.topics.values():
            topics.setdefault(topic.name, topic)
        summaries.append(summary)
    write_metadata(path, tuple(topics.values()), summaries)
    return report or [f'{path} is whole already: {_total(summaries)} messages']


def _total(summaries):
    return sum(summary.message_count for summary in summaries)


def _recount(scan):
    """Go through a file and return its `FileSummary`."""
    summary = FileSummary(scan.name)
    for channel, _, time_ns, _ in scan.messages():
        if channel in scan.topics:
            summary.add(scan.topics[channel].name, time_ns)
    return summary


def _check_may_rewrite(scan):
    if not scan.library.startswith('rigid_sim_ros'):
        raise RecordingError(f'{scan.path} was not recorded by this package but by '
                             f'{scan.library!r}; its own tools recover it')
    if is_being_written(scan.path):
        raise RecordingError(f'{scan.path} is being recorded now')


def _rewrite(path, summaries, report):
    scan = McapScan(path)
    new = path + '.recovered'
    _remove(new)  # left by a recovery that was itself interrupted
    try:
        file = _write_anew(new, scan, summaries)
        sync_path(new)
    except OSError:
        _remove(new)  # the disk may be full
        raise
    if scan.finished or len(scan.damage) > 1:
        os.replace(path, path + '.damaged')
    os.replace(new, path)
    report += [*scan.damage, f'{scan.name} finished with {file.summary.message_count} messages']
    return file.summary


def _remove(path):
    if os.path.exists(path):
        os.remove(path)


def _write_anew(path, scan, summaries):
    file, chunk, channels = None, Chunk(), {}
    for channel, sequence, time_ns, data in scan.messages():
        if file is None:
            file = _begin(path, scan, chunk, channels)
        if channel in channels:
            chunk.add(channels[channel], sequence, time_ns, data)
            if chunk.size >= CHUNK_BYTES:
                file.write(chunk)
                chunk.clear()
    if file is None:
        file = _begin(path, scan, chunk, channels)
    file.write(chunk)
    file.summary.path = scan.name
    file.write_metadata('rosbag2', {'serialized_metadata': to_yaml(
        bag_metadata(tuple(scan.topics.values()), [*summaries, file.summary]))})
    file.finish()
    return file


def _begin(path, scan, chunk, channels):
    """Open the new file with the channels known by now, which are all: they come first."""
    channels.update((channel, number) for number, channel in enumerate(scan.topics, 1))
    topics = tuple(scan.topics.values())
    chunk.clear(declarations(topics))
    attachments = [(attachment.name, attachment.media_type, attachment.data)
                   for attachment in scan.attachments.values()]
    return McapFile(path, topics, _COMPRESSION, scan.library, attachments)
