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

"""Control of time: a session driven by the wall clock, paused, stepped and reset."""

from contextlib import contextmanager

from numpy.linalg import LinAlgError

from rigid_sim_ros.nodes.announcement import paused_text
from rigid_sim_ros.nodes.pacing import Pacer
from rigid_sim_ros.nodes.signals import Interrupted

IDLE = 0.125
"""Wall time [s] between two looks at the world while paused."""

CANNOT_GO_ON = ArithmeticError, LinAlgError
"""What the engine raises if it cannot compute what it was told to."""


class Control:
    """
    Drives a `session.Session` at the pace the parameters ask for.

    Wall times [s] are those of `now()`, a monotonic clock.
    """

    def __init__(self, session, parameters, stop, now, logger):
        """Take the parameters as they are and as they will be; see `start`."""
        self._session = session
        self._parameters = parameters
        self._stop = stop
        self._now = now
        self._logger = logger
        self.failure = ''
        """Why the simulation cannot go on, one line; empty while it can."""
        session.paused = parameters.start_paused
        self.pacer = Pacer(parameters.real_time_factor, 1 / parameters.publish_rate)
        self._take_parameters()
        parameters.when_changed('publish_rate', self._change_rate)
        parameters.when_changed('real_time_factor', self._change_pace)
        parameters.when_changed('pause_on_collision', self._take_parameters)

    @property
    def paused(self):
        """Whether simulated time stands still."""
        return self._session.paused

    @property
    def ending(self):
        """Whether the process was told to end."""
        return self._stop.requested

    def start(self):
        """Let the session's time be due now, and the rest follow."""
        self.pacer.anchor(self._session.time, self._now())

    def set_paused(self, paused):
        """Stop simulated time, or let it go on from where it is if it can; tell whether it did."""
        if self.failure and not paused:
            return False
        if self._session.paused and not paused:
            self.start()
        self._session.paused = paused
        return True

    def step(self):
        """Advance by the parameter `step_duration`, if paused and able to; tell whether it did."""
        if self.failure or not self._session.paused:
            return False
        try:
            with self.failing_softly(), self._stop.breakable():
                self._session.step(self._parameters.step_duration, lambda: self._stop.requested)
        except Interrupted:
            # not passed on: executors print what ends a service, and the loop ends anyway
            self.failure = 'the simulation was broken off: the process has to end'
        self._session.paused = True
        return not self.failure

    def reset(self, time_from_zero, keep_bodies=False):
        """Begin again as `Session.reset` does, paused or running as before."""
        self.failure = ''
        self._session.reset(time_from_zero, keep_bodies)
        self.start()

    @contextmanager
    def failing_softly(self):
        """
        Pause for good if the engine cannot compute what it was told to.

        A torque that is a number like any other can spin a body up to where nothing can follow
        it. The node stays, for a reset or for whoever wants to know what happened.
        """
        try:
            yield
        except CANNOT_GO_ON as error:
            self._fail(error)

    def work(self, now):
        """
        Simulate and publish one state if it is due at `now` [s]; return when to look again [s].

        A state is computed when it is due and not before, so that a command is seen in the very
        next state published after it arrived.
        """
        session, pacer = self._session, self.pacer
        if session.paused:
            return now + IDLE
        time = session.next_time
        due = pacer.due(time)
        if now < due:
            return due
        try:
            with self._stop.breakable():
                session.advance()
        except CANNOT_GO_ON as error:
            self._fail(error)
        else:
            if session.paused:
                self._logger.info(paused_text(session.simulation, session.time))
        begun, now = now, self._now()
        pacer.published(time, begun, now)
        return now + IDLE if session.paused else pacer.due(session.next_time)

    def _fail(self, error):
        self._session.paused = True
        self.failure = f'the simulation cannot go on, only be reset: {error}'
        self._logger.error(self.failure)

    def _change_rate(self):
        self._session.set_publish_rate(self._parameters.publish_rate)
        self._change_pace()

    def _change_pace(self):
        parameters = self._parameters
        self.pacer.change(parameters.real_time_factor, 1 / parameters.publish_rate,
                          self._session.time, self._now())

    def _take_parameters(self):
        self._session.pause_on_collision = self._parameters.pause_on_collision
