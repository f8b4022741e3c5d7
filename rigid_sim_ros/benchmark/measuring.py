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

"""One cell of the benchmark: a problem, an engine and a step, measured for error and for time."""

from dataclasses import dataclass, field
from math import isfinite

from rigid_sim_ros.benchmark.engines import ENGINES
from rigid_sim_ros.benchmark.processes import RunFailed
from rigid_sim_ros.benchmark.timing import TimingPlan
from rigid_sim_ros.benchmark.trajectories import fault

OK, FAILED = 'ok', 'failed'


@dataclass(frozen=True)
class Effort:
    """How much time a cell may take."""

    repeats: int = 5
    """The least number of timed runs."""

    least_time: float = 0.2
    """CPU time [s] that the timed runs should reach together."""

    budget: float = 10.0
    """CPU time [s] after which no further timed run is started."""

    timeout: float = 60.0
    """Longest time [s] of a run. With warm-up and repeats: twice as much, and the budget."""


@dataclass(frozen=True)
class Result:
    """What was measured in one cell."""

    problem: str
    engine: str
    version: str
    rate_hz: int
    """Steps a second."""

    bodies: int
    simulated_s: float
    status: str = OK
    """'ok' or 'failed'. A failed run has no time: it was not fast, whatever it took."""

    reason: str = ''
    """Why it failed, one line."""

    measures: dict = field(default_factory=dict)
    """Errors by name, the unit at the end of the name."""

    build_cpu_ms: float = None
    run_cpu_ms: float = None
    """Median CPU time of the whole run, poses read."""

    run_cpu_us_per_step: float = None
    timed_runs: int = None


def measure(problem, scene, engine, rate, worker, effort):
    """
    Return the `Result` of one cell: first the errors, then, in other runs, the time.

    The scene is the problem's, loaded; the worker is that of the engine.
    """
    row = ENGINES[engine]
    result = {
        'problem': problem.name, 'engine': engine, 'version': row.version(), 'rate_hz': rate,
        'bodies': problem.bodies, 'simulated_s': problem.duration}
    step = 1 / rate
    try:
        trajectory = worker.ask((scene, step, problem.may_sleep, problem.times),
                                timeout=effort.timeout)
        reason = fault(trajectory, scene, problem.reach)
        if reason:
            raise RunFailed(reason)
        measures = problem.measure(trajectory)
        unknown = [name for name, value in measures.items() if not isfinite(value)]
        if unknown:
            raise RunFailed(f'{unknown[0]} is {measures[unknown[0]]}')
        timing = worker.ask((scene, step, problem.may_sleep, read_times(problem, rate)),
                            TimingPlan(effort.repeats, effort.least_time, effort.budget),
                            timeout=2 * effort.timeout + effort.budget)
    except RunFailed as error:
        return Result(**result, status=FAILED, reason=str(error))
    return Result(
        **result, measures=measures, timed_runs=timing.repeats,
        build_cpu_ms=timing.build * 1e3, run_cpu_ms=timing.run * 1e3,
        run_cpu_us_per_step=timing.run / (problem.duration * rate) * 1e6)


def read_times(problem, rate):
    """Return when poses are read in a timed run [s]."""
    if not problem.reads_every_step:
        return problem.times
    return tuple(count / rate for count in range(1, round(problem.duration * rate) + 1))
