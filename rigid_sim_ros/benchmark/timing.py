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

"""Timing runs of one engine: a warm-up, repeats, medians of process CPU time."""

from dataclasses import dataclass
import gc
from statistics import median
from time import process_time

WARM_UP = 0.2
"""Longest warm-up [s of CPU time]: caches, lazy imports and first allocations are over by then."""


@dataclass(frozen=True)
class TimingPlan:
    """How often and how long to time."""

    repeats: int
    """The least number of runs, as long as the budget allows them."""

    least_time: float
    """CPU time [s] that all runs together should reach, so that short ones are repeated more."""

    budget: float
    """CPU time [s] after which no further run is started."""

    most_repeats: int = 50


@dataclass(frozen=True)
class Timing:
    """Medians of process CPU time [s]."""

    build: float
    """Until the simulation is ready to advance."""

    run: float
    """Advancing through all times and reading the poses at each."""

    repeats: int


def measured_time(engine, task, plan):
    """Return the `Timing` of a task: a warm-up, then repeated runs, each of a new simulation."""
    timed(engine, task, limit=WARM_UP)
    builds, runs = [], []
    while len(runs) < plan.most_repeats:
        build, run = timed(engine, task)
        builds.append(build)
        runs.append(run)
        spent = sum(runs) + sum(builds)
        enough = len(runs) >= plan.repeats and sum(runs) >= plan.least_time
        if enough or spent + build + run > plan.budget:
            break
    return Timing(build=median(builds), run=median(runs), repeats=len(runs))


def timed(engine, task, limit=None):
    """Build and run a task once, up to a limit [s]; return the CPU times [s] of both."""
    scene, step, sleeping, times = task
    gc.collect()
    start = process_time()
    engine.build(scene, step, sleeping)
    built = process_time()
    engine.expect(times)
    now = 0.0
    for time in times:
        engine.advance(time - now)
        engine.read_poses()
        now = time
        if limit is not None and process_time() - built > limit:
            break
    return built - start, process_time() - built
