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

"""Stopping on SIGINT and SIGTERM: once, in order, whatever is pressed how often."""

import signal

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)

PATIENCE = 1.0
"""Wall time [s] an advance may go on after a signal; then it is broken off."""


class Interrupted(BaseException):
    """
    Something was broken off because the process has to end.

    Like KeyboardInterrupt no Exception, so that nothing on the way takes it for its own.
    """


class StopRequest:
    """
    Becomes `requested` on the first SIGINT or SIGTERM; every further one changes nothing.

    Python's own KeyboardInterrupt would be raised anywhere, also while a recording is closed, and
    ROS's handlers shut the context down under whoever is publishing: so neither is used. Ctrl-C
    pressed twice, and a launch system that passes on a signal the process already has, both send
    two.
    """

    def __init__(self):
        self.requested = False
        self._breakable = False
        self._patience = PATIENCE

    def install(self):
        """Take over the signals; only the main thread can."""
        for number in STOP_SIGNALS:
            signal.signal(number, self._request)
        signal.signal(signal.SIGALRM, self._break_off)

    def ignore(self):
        """
        Let signals do nothing from now on, also while Python itself ends.

        Python gives signals with a handler back their deadly default on its way out.
        """
        self.requested = True
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number in STOP_SIGNALS:
            signal.signal(number, signal.SIG_IGN)

    def breakable(self, patience=PATIENCE):
        """
        Return what lets `Interrupted` be raised in a `with` block, so long [s] after a stop.

        It is this itself: the block is entered with every state, so it has to cost nothing.
        """
        self._patience = patience
        return self

    def __enter__(self):
        self._breakable = True

    def __exit__(self, kind, error, traceback):
        self._breakable = False
        if self.requested and isinstance(error, ImportError):
            # what is raised while a C extension is loaded comes out of it as this
            raise Interrupted from error

    def _request(self, number, frame):
        if not self.requested:
            self.requested = True
            if self._breakable and not self._patience:
                raise Interrupted
            signal.setitimer(signal.ITIMER_REAL, PATIENCE)

    def _break_off(self, number, frame):
        if self._breakable:
            raise Interrupted
