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

"""Cells: what failed is never fast, and one engine's end is not the benchmark's."""

from dataclasses import replace
import os

import numpy as np
import pytest
from rigid_sim_ros.benchmark.engines import Engine, ENGINES
from rigid_sim_ros.benchmark.measuring import Effort, FAILED, measure, OK, read_times
from rigid_sim_ros.benchmark.problems import PROBLEMS
from rigid_sim_ros.benchmark.processes import RunFailed, Worker
from rigid_sim_ros.benchmark.timing import measured_time, Timing, TimingPlan
from rigid_sim_ros.benchmark.trajectories import record, Trajectory
from rigid_sim_ros.scene import load_scene

QUICK = Effort(repeats=1, least_time=0.0, timeout=30.0)
SLIDE = PROBLEMS['slide']


class Answers:
    """A worker that gives prepared answers: a trajectory to a task, a timing to a plan."""

    def __init__(self, trajectory, timing=Timing(build=0.001, run=0.3, repeats=7)):
        self.trajectory, self.timing, self.plans = trajectory, timing, []

    def ask(self, task, plan=None, timeout=None):
        self.plans.append(plan)
        answer = self.timing if plan else self.trajectory
        if isinstance(answer, Exception):
            raise answer
        return answer


def sliding(x):
    """Return a trajectory of the sliding cube with these x [m]."""
    count = len(SLIDE.times)
    position = np.zeros((count, 1, 3))
    position[:, 0, 0], position[:, 0, 2] = x, 0.1
    orientation = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1, 1))
    return Trajectory(np.array(SLIDE.times), position, orientation, np.zeros((count, 1, 3)),
                      np.zeros((count, 1, 3)), np.zeros(1, bool))


def measured(worker):
    return measure(SLIDE, load_scene(SLIDE.scene()), 'mujoco', 240, worker, QUICK)


def test_result_has_errors_and_times():
    result = measured(Answers(sliding(1.0)))
    assert (result.status, result.reason) == (OK, '')
    # 9 / (2 * 0.3 * 9.81) m is where the cube should be
    assert result.measures['distance_error_relative'] == pytest.approx(1 - 0.6 * 9.81 / 9)
    assert result.run_cpu_ms == pytest.approx(300.0)
    assert result.build_cpu_ms == pytest.approx(1.0)
    assert result.run_cpu_us_per_step == pytest.approx(0.3 / 360 * 1e6)
    assert (result.timed_runs, result.simulated_s, result.bodies) == (7, 1.5, 1)


@pytest.mark.parametrize('x, reason', [
    (np.nan, 'not finite'), (np.inf, 'not finite'), (5e3, 'blew up: a body is 5e+03 m away')])
def test_what_blew_up_is_failed_and_has_no_time(x, reason):
    worker = Answers(sliding(x))
    result = measured(worker)
    assert (result.status, result.reason) == (FAILED, reason)
    assert (result.run_cpu_ms, result.run_cpu_us_per_step, result.measures) == (None, None, {})
    assert worker.plans == [None]


def test_an_error_that_is_no_number_is_failed():
    unknown = replace(SLIDE, measure=lambda trajectory: {'angle_error_rad': float('nan')})
    result = measure(unknown, load_scene(SLIDE.scene()), 'mujoco', 240, Answers(sliding(1.0)),
                     QUICK)
    assert (result.status, result.reason) == (FAILED, 'angle_error_rad is nan')


def test_a_run_that_fails_in_either_half_is_failed():
    for worker in (Answers(RunFailed('crashed: SIGSEGV')),
                   Answers(sliding(1.0), RunFailed('crashed: SIGSEGV'))):
        result = measured(worker)
        assert (result.status, result.reason) == (FAILED, 'crashed: SIGSEGV')
        assert result.run_cpu_ms is None


def test_times_of_reading():
    assert read_times(SLIDE, 240) == SLIDE.times
    every = read_times(PROBLEMS['drift_10'], 240)
    assert len(every) == 120 and every[0] == 1 / 240 and every[-1] == 0.5


@pytest.fixture(scope='module')
def worker():
    with Worker('stepped') as running:
        yield running


def task(**changes):
    values = {'scene': load_scene(PROBLEMS['constant_wrench'].scene()), 'step': 1 / 60,
              'sleeping': False, 'times': (0.5, 1.0), **changes}
    return tuple(values.values())


def test_worker_runs_as_this_process_would(worker):
    engine = ENGINES['stepped'].load()
    theirs = worker.ask(task())
    scene, step, sleeping, times = task()
    engine.build(scene, step, sleeping)
    ours = record(engine, times)
    np.testing.assert_array_equal(theirs.position, ours.position)
    np.testing.assert_array_equal(theirs.orientation, ours.orientation)


def test_worker_times(worker):
    timing = worker.ask(task(), TimingPlan(repeats=3, least_time=0.0, budget=30.0))
    assert timing.repeats == 3
    assert 0 < timing.run < 5 and 0 < timing.build < 5


def test_worker_outlives_an_exception_a_crash_and_a_time_out(worker):
    with pytest.raises(RunFailed, match='TypeError: scene is None'):
        worker.ask(task(scene=None))
    worker.ask(task())
    worker._process.kill()
    with pytest.raises(RunFailed, match='crashed: SIGKILL'):
        worker.ask(task())
    worker.ask(task())
    with pytest.raises(RunFailed, match='took longer than 0.01 s'):
        worker.ask(task(times=(1e4,)), timeout=0.01)
    assert worker.ask(task()).position.shape == (2, 1, 3)


def test_worker_tells_last_words():
    with Worker('no_such_engine') as lost:
        with pytest.raises(RunFailed, match="crashed: KeyError: 'no_such_engine'"):
            lost.ask(task())


def test_one_thread_and_no_choice_of_kernels_in_the_worker(monkeypatch):
    monkeypatch.setenv('OPENBLAS_CORETYPE', 'PRESCOTT')
    monkeypatch.setenv('OMP_NUM_THREADS', '8')
    with Worker('stepped') as running:
        running.ask(task())
        with open(f'/proc/{running._process.pid}/environ', encoding='utf-8') as file:
            environment = dict(row.split('=', 1) for row in file.read().split('\0') if row)
    assert environment['OMP_NUM_THREADS'] == environment['OPENBLAS_NUM_THREADS'] == '1'
    assert 'OPENBLAS_CORETYPE' not in environment
    assert os.environ['OPENBLAS_CORETYPE'] == 'PRESCOTT'


class Clock(Engine):
    """An engine that spends the CPU times it is told to, by the clock it is measured with."""

    def __init__(self, monkeypatch, builds, runs):
        self.now, self.builds, self.runs = 0.0, list(builds), list(runs)
        monkeypatch.setattr('rigid_sim_ros.benchmark.timing.process_time', lambda: self.now)

    def build(self, scene, step, sleeping):
        self.now += self.builds.pop(0)

    def advance(self, duration):
        self.now += self.runs.pop(0)

    def read_poses(self):
        self.now += 0.001


def test_medians_without_the_warm_up(monkeypatch):
    engine = Clock(monkeypatch, [9, 1, 3, 2], [9, 0.5, 0.1, 0.3])
    timing = measured_time(engine, (None, 1.0, False, (1.0,)), TimingPlan(3, 0.0, 100.0))
    assert timing == Timing(build=2, run=pytest.approx(0.301), repeats=3)


def test_short_runs_are_repeated_and_long_ones_end_with_the_budget(monkeypatch):
    short = Clock(monkeypatch, [0] * 100, [0.009] * 100)
    plan = TimingPlan(repeats=3, least_time=0.045, budget=100.0)
    assert measured_time(short, (None, 1.0, False, (1.0,)), plan).repeats == 5
    long = Clock(monkeypatch, [0] * 100, [40.0] * 100)
    assert measured_time(long, (None, 1.0, False, (1.0,)), plan).repeats == 2


def test_warm_up_is_cut_short(monkeypatch):
    engine = Clock(monkeypatch, [0] * 9, [0.15] * 99)
    measured_time(engine, (None, 1.0, False, tuple(range(1, 11))), TimingPlan(1, 0.0, 100.0))
    # two of ten readings in the warm-up, ten in the run
    assert len(engine.runs) == 99 - 2 - 10
