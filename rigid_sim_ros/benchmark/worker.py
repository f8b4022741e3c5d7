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
The process in which one engine runs: it takes tasks from a pipe and sends back what came out.

Started by `processes.Worker` as `python -m rigid_sim_ros.benchmark.worker ENGINE PIPE`. A task is
(scene, step, sleeping, times) with, for a timed run, a `TimingPlan`; what is sent back is a
`Trajectory`, a `Timing`, or the exception's text as a str.
"""

from multiprocessing.connection import Connection
import sys

from rigid_sim_ros.benchmark.engines import ENGINES
from rigid_sim_ros.benchmark.timing import measured_time
from rigid_sim_ros.benchmark.trajectories import record


def main():
    """Serve tasks until the pipe closes."""
    row = ENGINES[sys.argv[1]]
    with Connection(int(sys.argv[2])) as pipe:
        while True:
            try:
                task, plan = pipe.recv()
            except EOFError:
                return
            try:
                pipe.send(done(row.load(), task, plan))
            # whatever an engine raises is a failed run of that engine, and no more than that
            except Exception as error:  # noqa: B902
                pipe.send(f'{type(error).__name__}: {error}')


def done(engine, task, plan):
    """Return the `Trajectory` of a task or, with a plan, its `Timing`."""
    if plan:
        return measured_time(engine, task, plan)
    scene, step, sleeping, times = task
    engine.build(scene, step, sleeping)
    return record(engine, times)


if __name__ == '__main__':
    main()
