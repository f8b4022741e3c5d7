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
Recording from the node: what is published, what was commanded, and what else a rerun needs.

The `Recorder` knows topics and bytes; this decides which topics, where to, and what is said.
"""

from dataclasses import replace
from datetime import datetime
import os
from pathlib import Path

from rigid_sim_ros.messages import DiagnosticStatus, ERROR, OK, WARN
from rigid_sim_ros.recording import Recorder, RECORDING, RecordingError, WAIT
from rigid_sim_ros.recording.history import History
from rigid_sim_ros.recording.journal import encode_bodies, encode_parameters
from rigid_sim_ros.topics import COMMANDS, EVERY_SECOND, JOURNAL, PUBLISHED

FOLDER = 'recordings'
"""Where recordings go, below the working folder, if no path is given."""

_NOT_RECORDED = ('visualization_msgs/msg/MarkerArray',)
"""Types of what shows the poses a second time, at fifteen times their size."""


_NO_HISTORY = ('; it cannot be simulated again, as more commands came before than are kept; what '
               'is recorded after a reset can')


class Recording:
    """
    At most one recording at a time, and what one that begins later will need.

    Outputs are given to `write`; all that changes the simulation is given to the methods whose
    names begin with `note`, whether it is recorded or not.
    """

    def __init__(self, node, parameters, source):
        """Record what belongs to a `rclpy` node and a `topics.Source`, when told to."""
        self._node = node
        self._parameters = parameters
        self._source = source
        self._scene_text = source.scene_text  # as loaded, whatever bodies are added later
        self._names = {row.name: node.resolve_topic_name(row.name)
                       for row in (*PUBLISHED, *COMMANDS, JOURNAL)}
        self._recorded = frozenset(
            row.name for row in PUBLISHED
            if row.when != EVERY_SECOND and row.type_name not in _NOT_RECORDED)
        self._history = History([row.name for row in (*COMMANDS, JOURNAL)])
        self._recorder = None
        self._remark = ''
        self._count = 0
        self._reported = ''

    @property
    def begun(self):
        """Whether a recording was begun and not yet stopped, even if it has failed."""
        return self._recorder is not None

    @property
    def active(self):
        """Whether messages are recorded."""
        return self._recorder is not None and not self._recorder.error

    @property
    def text(self):
        """Where it records, as a phrase."""
        if self._recorder is None:
            return 'not recording'
        return self._recorder.error or f'recording to {self._recorder.path}{self._remark}'

    def start(self, time):
        """
        Begin a recording at simulated time `time` [ns].

        Raises `RecordingError` if it cannot be made, or if there is one already.
        """
        if self.active:
            raise RecordingError(f'already {self.text}')
        self.stop()
        self._recorder = self._new_recorder()
        self._remark = '' if self._history.complete else _NO_HISTORY
        self.write(JOURNAL.name, time, self._line_of_parameters())

    def stop(self):
        """Finish the recording, if there is one; return whether it went well, and a phrase."""
        if self._recorder is None:
            return False, 'not recording'
        recorder, self._recorder = self._recorder, None
        state = recorder.close()
        if state.error:
            return False, state.error
        lost = f', {state.dropped_count} lost' if state.dropped_count else ''
        return True, (f'recorded {state.message_count} messages, '
                      f'{state.byte_count / 1e6:.1f} MB{lost}, to {state.path}')

    @property
    def wanted(self):
        """Return the names of the rows of `PUBLISHED` whose messages are recorded now."""
        return self._recorded if self.active else frozenset()

    def write(self, name, time, data):
        """Record a message of a topic, named as in `topics`, at simulated time `time` [ns]."""
        if self._recorder is not None:
            self._recorder.write(self._names[name], time, data)

    def begin(self, time, lines):
        """Note that the scene begins at `time` [ns], with the bodies that lines tell of."""
        self._history.begin(time)
        for line in (self._line_of_parameters(), *lines):
            self._history.add_message(JOURNAL.name, time, line)

    def note(self, name, time, data):
        """Note a command, the bytes received on a topic, that took effect at `time` [ns]."""
        self._history.add_message(name, time, data)
        self.write(name, time, data)

    def note_line(self, time, line):
        """Note a line of the journal."""
        self.note(JOURNAL.name, time, line)

    def note_parameters(self, time):
        """Note the parameters that commands depend on."""
        self.note_line(time, self._line_of_parameters())

    def note_state(self, time):
        """Note that the simulation was advanced to `time` [ns], if it was."""
        self._history.add_state(time)

    def note_bodies(self, time):
        """Write down, for readers, the bodies there are now."""
        simulation = self._source.simulation
        self.write(JOURNAL.name, time, encode_bodies(
            len(simulation.names), simulation.all_names))

    def report(self, log_error):
        """Say by `log_error(text)`, once, that the recording failed; call now and then."""
        error = self._recorder.error if self._recorder is not None else ''
        if error and error != self._reported:
            log_error(error)
        self._reported = error

    def status(self, node_name):
        """Return the status for `/diagnostics`."""
        name = f'{node_name}: recording'
        if self._recorder is None:
            return DiagnosticStatus(OK, name, 'not recording')
        state = self._recorder.state()
        level = ERROR if state.phase != RECORDING else WARN if state.dropped_count else OK
        return DiagnosticStatus(level, name, self.text, {
            'path': state.path, 'messages written': state.message_count,
            'bytes written': state.byte_count, 'messages waiting': state.queued_count,
            'messages lost': state.dropped_count})

    def _new_recorder(self):
        parameters = self._parameters
        number = self._count
        while True:
            number += 1
            path = self._path(number)
            try:
                recorder = Recorder(
                    path, self._rows(), compression=parameters.record_compression,
                    when_full=parameters.record_when_full,
                    max_bytes=round(1e6 * parameters.record_split_size),
                    max_duration=parameters.record_split_duration, scene=self._scene_text,
                    options=self._options(), history=self._history.pieces(),
                    on_full=self._warn_full)
            except RecordingError:
                # what is there stays; another name will do, unless it was given
                if path == parameters.record_path or not os.path.lexists(
                        os.path.expanduser(path)):
                    raise
            else:
                self._count = number
                return recorder

    def _path(self, number):
        """Return the path of the recording of a number, counted from 1 for the first."""
        given = self._parameters.record_path
        if not given:
            scene = Path(self._parameters.scene).stem
            given = f'{FOLDER}/{scene}_{datetime.now():%Y_%m_%d-%H_%M_%S}'
        return given if number == 1 else f'{given}_{number}'

    def _warn_full(self):
        consequence = ('simulated time waits for it' if self._parameters.record_when_full == WAIT
                       else 'messages are lost')
        self._node.get_logger().warning(
            f'the disk is too slow for recording to {self._recorder.path}: {consequence}')

    def _line_of_parameters(self):
        return encode_parameters(self._parameters.command_axes, self._parameters.command_timeout)

    def _rows(self):
        rows = [row for row in PUBLISHED if row.name in self._recorded]
        return [replace(row, name=self._names[row.name]) for row in (*rows, *COMMANDS, JOURNAL)]

    def _options(self):
        simulation, parameters = self._source.simulation, self._parameters
        return {
            'names': simulation.names, 'all_names': simulation.all_names,
            'topics': self._names,
            'method': simulation.method, 'max_step': simulation.max_step,
            'publish_rate': parameters.publish_rate, 'world_frame': parameters.world_frame}
