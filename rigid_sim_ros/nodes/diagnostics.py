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

"""How the node and its simulation are doing: the statuses in `/diagnostics`."""

from rigid_sim_ros.messages import DiagnosticStatus, ERROR, OK, WARN
from rigid_sim_ros.nodes.pacing import NANOSECONDS

PERIOD = 1.0
"""Wall time [s] between two messages."""


class Diagnostics:
    """Measures over periods of wall time, from `start` on, and sums them up."""

    def __init__(self, node_name, session, control, refused, late, recording):
        self._name = node_name
        self._session = session
        self._control = control
        self._refused = refused
        self._late = late
        self._recording = recording
        self._missed = 0
        self._given_up = 0.0
        self._factor = self._lateness = 0.0
        self._newly_missed = 0
        self.start(float('inf'))

    def start(self, now):
        """Begin the first period at wall time `now` [s]."""
        self._begin, self._due = now, now + PERIOD
        self._advanced = self._session.advanced

    def due(self, now):
        """Tell whether a period is over at wall time `now` [s]; then the next begins."""
        if now < self._due:
            return False
        self._measure(now)
        self.start(now)
        return True

    def statuses(self):
        """Return the statuses of the period that is over."""
        return (self._pace(), self._simulation(), self._commands(),
                self._recording.status(self._name))

    def complain(self, warn):
        """Warn, by `warn(text)`, if the schedule had to be given up since this was last called."""
        given_up = self._control.pacer.time_given_up - self._given_up
        self._given_up += given_up
        if given_up:
            warn(f'simulated time fell {given_up:.1f} s behind and goes on from there: this scene '
                 'cannot be computed in real time here, or the process was stopped')

    def _measure(self, now):
        pacer = self._control.pacer
        simulated = (self._session.advanced - self._advanced) / NANOSECONDS
        self._factor = simulated / (now - self._begin)
        self._lateness, pacer.worst_lateness = pacer.worst_lateness, 0.0
        self._newly_missed = pacer.missed_deadlines - self._missed
        self._missed = pacer.missed_deadlines

    def _pace(self):
        session, pacer, missed = self._session, self._control.pacer, self._newly_missed
        state = 'paused' if session.paused else 'running'
        return DiagnosticStatus(
            WARN if missed else OK, f'{self._name}: time',
            f'{state}, missed {missed} deadlines since the last report' if missed else state, {
                'simulated time [s]': f'{session.time / NANOSECONDS:.9f}',
                'real-time factor, last period': f'{self._factor:.4f}',
                'missed deadlines, in all': pacer.missed_deadlines,
                'wall time given up, in all [s]': f'{pacer.time_given_up:.3f}',
                'worst lateness, last period [ms]': f'{self._lateness * 1e3:.3f}'})

    def _simulation(self):
        if self._control.failure:
            return DiagnosticStatus(ERROR, f'{self._name}: simulation', self._control.failure)
        simulation = self._session.simulation
        count = len(simulation.names)
        return DiagnosticStatus(
            OK, f'{self._name}: simulation', simulation.method, {
                'bodies': count,
                'awake bodies': count - int(simulation.asleep.sum()),
                'energy [J]': repr(float(simulation.energy())),
                'deepest penetration [m]': f'{float(simulation.penetration()):.3g}',
                **{name.replace('_', ' '): value
                   for name, value in vars(simulation.work).items()}})

    def _commands(self):
        refused, commands = self._refused, self._session.commands
        return DiagnosticStatus(
            OK, f'{self._name}: commands', f'{refused.total} refused' if refused.total else '', {
                'carried out': commands.taken,
                'waiting for their time': commands.pending,
                'late': self._late.total,
                'refused': refused.total,
                **{f'refused, {kind}': count for kind, count in sorted(refused.counts.items())}})
