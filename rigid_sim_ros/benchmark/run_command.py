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

"""The command `rigid_sim_benchmark run`: measure, print tables, write CSV and plots."""

from contextlib import ExitStack
from datetime import datetime
from importlib.util import find_spec
from pathlib import Path
import sys

from rigid_sim_ros.benchmark.engines import ENGINES, installed_engines
from rigid_sim_ros.benchmark.errors import BenchmarkError, chosen
from rigid_sim_ros.benchmark.machine import machine_facts
from rigid_sim_ros.benchmark.measuring import Effort, measure
from rigid_sim_ros.benchmark.problems import FRAME_RATE, PROBLEMS
from rigid_sim_ros.benchmark.processes import Worker
from rigid_sim_ros.benchmark.report import terminal_table
from rigid_sim_ros.benchmark.report_command import (
    add_output_options, check_outputs, write_reports)
from rigid_sim_ros.benchmark.results import write_csv
from rigid_sim_ros.scene import load_scene
from tqdm import tqdm


def add_options(parser):
    """
    Measure problems and print a table of each; write results.csv and plots into a folder.

    A run that is not finite, flies away, goes through the ground, crashes or takes too long is
    marked as failed and has no time. Peers that are not installed are left out.
    """
    parser.add_argument('problems', nargs='*', metavar='PROBLEM',
                        help='names of problems (see `rigid_sim_benchmark list`); default all')
    parser.add_argument('--engines', nargs='+', metavar='ENGINE', default=[],
                        help='names of engines; default all that are installed')
    parser.add_argument('--rates', nargs='+', type=int, metavar='HZ', default=[],
                        help=f'steps a second, multiples of {FRAME_RATE}')
    parser.add_argument('--repeats', type=int, default=Effort.repeats,
                        help='least number of timed runs (%(default)s); the median counts')
    parser.add_argument('--timeout', type=float, default=Effort.timeout, metavar='SECONDS',
                        help='longest time of one run (%(default)g)')
    parser.add_argument('--output', type=Path, metavar='FOLDER',
                        help='where to write; files there are replaced; default '
                        'benchmark_DATE_TIME')
    parser.add_argument('--no-plots', action='store_true', help='write no plots')
    add_output_options(parser)


def run(options):
    """Run the command with its parsed options."""
    problems = chosen('problem', options.problems, list(PROBLEMS))
    engines = chosen_engines(options.engines)
    _check(options)
    effort = Effort(repeats=options.repeats, timeout=options.timeout,
                    least_time=Effort.least_time if options.repeats > 1 else 0.0)
    folder = options.output or Path(f'benchmark_{datetime.now():%Y%m%d_%H%M%S}')
    folder.mkdir(parents=True, exist_ok=True)
    facts = machine_facts()
    results = []
    with ExitStack() as stack:
        workers = {engine: stack.enter_context(Worker(engine)) for engine in engines}
        cells = cells_of(problems, engines, options.rates)
        with tqdm(total=sum(map(len, cells.values())), unit='run', file=sys.stderr,
                  dynamic_ncols=True, disable=None) as progress:
            for problem, rows in cells.items():
                measured = measure_problem(problem, rows, workers, effort, progress)
                results += measured
                with tqdm.external_write_mode():
                    print(terminal_table(problem, measured), end='\n\n', flush=True)
                # after each problem, so that what was measured is not lost
                write_csv(folder / 'results.csv', results, facts)
    if not options.plots and not options.no_plots:
        options.plots = folder
    write_reports(options, results, facts)
    print(f'written to {folder}')


def chosen_engines(names):
    """Return the names of engines that can be run; raise `BenchmarkError` for others."""
    installed = installed_engines()
    for name in chosen('engine', names, list(ENGINES)):
        if names and name not in installed:
            raise BenchmarkError(f'engine {name} is not installed: '
                                 f'pip install {ENGINES[name].distribution}')
    return chosen('engine', names, installed)


def cells_of(problems, engines, rates):
    """Return the engine and rate of each cell, by problem; too large problems are left out."""
    return {name: [(engine, rate) for engine in engines
                   if PROBLEMS[name].bodies <= ENGINES[engine].most_bodies
                   for rate in (rates or PROBLEMS[name].rates)]
            for name in problems}


def measure_problem(name, cells, workers, effort, progress):
    """Return the `Result`s of the cells of one problem."""
    problem = PROBLEMS[name]
    scene = load_scene(problem.scene())
    results = []
    for engine, rate in cells:
        progress.set_description(f'{name}, {engine}, {rate} Hz')
        results.append(measure(problem, scene, engine, rate, workers[engine], effort))
        progress.update()
    return results


def _check(options):
    """Raise `BenchmarkError` for options that cannot be carried out."""
    for rate in options.rates:
        if rate <= 0 or rate % FRAME_RATE:
            raise BenchmarkError(f'--rates {rate}; allowed: positive multiples of {FRAME_RATE}')
    if options.repeats < 1:
        raise BenchmarkError(f'--repeats {options.repeats}; allowed: 1 or more')
    if not options.timeout > 0:
        raise BenchmarkError(f'--timeout {options.timeout:g}; allowed: a positive number')
    if not options.no_plots and not find_spec('matplotlib'):
        raise BenchmarkError('plots need matplotlib: pip install matplotlib, or say --no-plots')
    if not find_spec('mpmath'):
        raise BenchmarkError('exact answers need mpmath: pip install mpmath')
    check_outputs(options)
