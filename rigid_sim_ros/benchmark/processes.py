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

"""Engines in processes of their own: what one does to itself leaves the others alone."""

from multiprocessing import Pipe
import os
from signal import Signals
import subprocess
import sys
import tempfile

THREADS = {f'{library}_NUM_THREADS': '1'
           for library in ('OMP', 'OPENBLAS', 'MKL', 'NUMEXPR', 'RAYON')}
"""One thread for everybody, as process CPU time adds all threads up."""

UNSET = ('OPENBLAS_CORETYPE', 'OPENBLAS_L2_SIZE')
"""Choices of a kernel for another processor would slow down NumPy alone."""


class RunFailed(Exception):
    """An engine raised, crashed or took too long; the text says which, in one line."""


class Worker:
    """A process that runs one engine, started when it is needed and again after a crash."""

    def __init__(self, engine):
        """Take the name of an engine, a key of `ENGINES`."""
        self.engine = engine
        self._process = None

    def __enter__(self):
        """Return the worker; its process is ended when the block is left."""
        return self

    def __exit__(self, *_):
        """End the process."""
        self._end()

    def ask(self, task, plan=None, timeout=120.0):
        """
        Have a task done; return a `Trajectory`, or with a `TimingPlan` a `Timing`.

        Raises `RunFailed` if there is none within the timeout [s], or not at all.
        """
        if self._process is None:
            self._start()
        try:
            self._pipe.send((task, plan))
            if not self._pipe.poll(timeout):
                self._end()
                raise RunFailed(f'took longer than {timeout:g} s')
            answer = self._pipe.recv()
        except (EOFError, BrokenPipeError, ConnectionResetError):
            raise RunFailed(f'crashed: {self._last_words()}') from None
        if isinstance(answer, str):
            raise RunFailed(' '.join(answer.split()))
        return answer

    def _start(self):
        """Start the process; what it prints goes to a file that is gone with it."""
        environment = {key: value for key, value in os.environ.items() if key not in UNSET}
        environment.update(THREADS)
        self._pipe, theirs = Pipe()
        self._output = tempfile.TemporaryFile()
        self._process = subprocess.Popen(
            [sys.executable, '-m', 'rigid_sim_ros.benchmark.worker', self.engine,
             str(theirs.fileno())],
            env=environment, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL,
            stdout=self._output, stderr=subprocess.STDOUT)
        theirs.close()

    def _end(self):
        """End the process, if there is one, and wait until it is gone."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None
            self._pipe.close()
            self._output.close()

    def _last_words(self):
        """Return why the process ended: the signal, or the last line that it printed."""
        code = self._process.wait()
        self._output.seek(0)
        lines = self._output.read().decode(errors='replace').split('\n')
        printed = [line.strip() for line in lines if line.strip()]
        self._end()
        if code < 0:
            return Signals(-code).name
        return printed[-1] if printed else f'exit code {code}'
