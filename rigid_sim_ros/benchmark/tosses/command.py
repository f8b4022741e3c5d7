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

"""The command `rigid_sim_benchmark tosses`: simulate measured tosses of a real cube."""

from itertools import product
from math import inf
from pathlib import Path
import sys

import numpy as np
from rigid_sim_ros.benchmark.engines import ENGINES
from rigid_sim_ros.benchmark.errors import BenchmarkError
from rigid_sim_ros.benchmark.processes import RunFailed, Worker
from rigid_sim_ros.benchmark.run_command import chosen_engines
from rigid_sim_ros.benchmark.timing import TimingPlan
from rigid_sim_ros.benchmark.tosses.data import LENGTH_SCALE, read_tosses
from rigid_sim_ros.benchmark.tosses.fitting import best_fit
from rigid_sim_ros.benchmark.tosses.flight_fit import fitted_start
from rigid_sim_ros.benchmark.tosses.scores import score
from rigid_sim_ros.benchmark.trajectories import fault
from rigid_sim_ros.engine.impacts import IMPACT_LAWS
from rigid_sim_ros.scene import load_scene
from tqdm import tqdm

FRICTIONS = (0.14, 0.16, 0.17, 0.18, 0.19, 0.2, 0.22)
RESTITUTIONS = (0.0, 0.1, 0.15, 0.2, 0.3, 0.4)

STEPS_A_SAMPLE = {'exact': 1, 'rapier': 1}
"""Steps between two samples, where 10 are not better: contact and impacts are not first order, or
the substeps are enough."""

REACH = 10.0
"""[m]. A toss that goes further has blown up."""


def add_options(parser):
    """
    Simulate measured tosses of a cube and tell how far from them an engine ends up.

    Each toss starts from a ballistic arc and a constant turn fitted to its flight. Friction and
    restitution are chosen from a grid, and the errors given for the tosses fitted to and, by
    random halves, for tosses the fit did not see. Errors are means over samples, then over tosses:
    distance of the centres in % of the cube's width, angle between the attitudes in degrees.

    DATA.npz is not part of this package. The public tosses are those of Pfrommer, Halm and Posa
    (ContactNets, CoRL 2020): repository DAIRLab/contact-nets, folder data/tosses_processed, BSD
    3-Clause; `rigid_sim_ros.benchmark.tosses.data.read_tosses` says which arrays the file has.
    """
    parser.add_argument('data', type=Path, metavar='DATA.npz', help='measured tosses')
    parser.add_argument('--engines', nargs='+', metavar='ENGINE', default=['exact'],
                        help='names of engines (default exact)')
    parser.add_argument('--steps-a-sample', type=int, metavar='N',
                        help='steps between two samples (1 for exact and rapier, 10 for others)')
    parser.add_argument('--frictions', type=float, nargs='+', default=FRICTIONS, metavar='MU')
    parser.add_argument('--restitutions', type=float, nargs='+', default=RESTITUTIONS,
                        metavar='E', help='values to choose from; one of each: no fit')
    parser.add_argument('--restitution-speed', type=float, metavar='M/S', default=0.0,
                        help='speed of approach with these restitutions; slower is in proportion '
                             '(%(default)g: the same at all; methods of this package only)')
    parser.add_argument('--impact-law', choices=tuple(IMPACT_LAWS), default='poisson',
                        help='of the methods of this package (%(default)s)')
    parser.add_argument('--count', type=int, metavar='N', help='only the first N tosses')
    parser.add_argument('--length-scale', type=float, default=LENGTH_SCALE, metavar='S',
                        help='measured over true lengths (%(default)s, as in the public data)')
    parser.add_argument('--timeout', type=float, default=60.0, metavar='SECONDS',
                        help='longest time of one toss (%(default)g)')


def run(options):
    """Run the command with its parsed options."""
    engines = chosen_engines(options.engines)
    _check(options)
    tosses = read_tosses(options.data, options.length_scale)[:options.count]
    starts = [fitted_start(toss) for toss in tosses]
    grid = [{'friction': friction, 'restitution': restitution,
             'restitution_speed': options.restitution_speed}
            for friction, restitution in product(options.frictions, options.restitutions)]
    print(f'{len(tosses)} tosses of {options.data}; starts fitted to the flight')
    print(f'{"engine":20}{"":24}position [%]  rotation [deg]  right face [%]  CPU time [s]')
    for name in engines:
        with Worker(name) as worker:
            _run_engine(name, worker, tosses, starts, grid, options)


def _run_engine(name, worker, tosses, starts, grid, options):
    """Try all parameters with one engine and print what came out."""
    tried, failures = [], []
    for parameters in tqdm(grid, desc=name, unit='set', file=sys.stderr, leave=False,
                           disable=None):
        tasks = [_task(name, toss, start, parameters, options)
                 for toss, start in zip(tosses, starts)]
        try:
            tried.append((parameters, [_scored(worker, toss, start, task, options.timeout)
                                       for toss, start, task in zip(tosses, starts, tasks)]))
        except RunFailed as error:
            failures.append((parameters, str(error)))
    title = ENGINES[name].title
    for parameters, reason in failures:
        print(f'{title}: failed with {_text(parameters)}: {reason}')
    if not tried:
        return
    fit = best_fit(tried)
    tasks = [_task(name, toss, start, fit.parameters, options)
             for toss, start in zip(tosses, starts)]
    once = TimingPlan(repeats=1, least_time=0.0, budget=options.timeout)
    try:
        time = sum(worker.ask(task, once, 2 * options.timeout).run for task in tasks)
    except RunFailed as error:
        print(f'{title}: failed when timed with {_text(fit.parameters)}: {error}')
        return
    print(f'{title:20}{_text(fit.parameters):24}{_figures(fit.fitted)}{time:14.3g}')
    if len(grid) > 1:
        print(f'{"":20}{"  unseen halves":24}{_figures(fit.unseen)}', flush=True)


def _task(engine, toss, start, parameters, options):
    """Return the task of a worker: scene, step, whether bodies may sleep, times."""
    step = float(toss.times[1]) / (options.steps_a_sample or STEPS_A_SAMPLE.get(engine, 10))
    cube = {'name': 'cube', 'cube': {'edge': toss.edge}, 'mass': toss.mass,
            'inertia': toss.moment, 'position': start.position.tolist(),
            'orientation': start.orientation.tolist(), 'velocity': start.velocity.tolist(),
            'angular_velocity': start.spin.tolist()}
    scene = load_scene({'gravity': [0.0, 0.0, -toss.gravity], 'material': parameters,
                        'impact_law': options.impact_law, 'planes': [{'name': 'board'}],
                        'bodies': [cube]})
    return scene, step, False, tuple(toss.times[1:].tolist())


def _scored(worker, toss, start, task, timeout):
    """Return the `Score` of one toss, or raise `RunFailed`."""
    trajectory = worker.ask(task, timeout=timeout)
    reason = fault(trajectory, task[0], REACH)
    if reason:
        raise RunFailed(reason)
    return score(toss, np.vstack((start.position, trajectory.position[:, 0])),
                 np.vstack((start.orientation, trajectory.orientation[:, 0])))


def _figures(summary):
    return '{:12.1f}{:16.1f}{:16.0f}'.format(*summary)


def _text(parameters):
    return ', '.join(f'{name} {value:g}' for name, value in parameters.items())


def _check(options):
    """Raise `BenchmarkError` for options that cannot be carried out."""
    for name, value in (('--steps-a-sample', options.steps_a_sample),
                        ('--count', options.count)):
        if value is not None and value < 1:
            raise BenchmarkError(f'{name} {value}; allowed: 1 or more')
    if not options.length_scale > 0:
        raise BenchmarkError(f'--length-scale {options.length_scale:g}; allowed: above 0')
    if not 0 <= options.restitution_speed < inf:
        raise BenchmarkError(
            f'--restitution-speed {options.restitution_speed:g}; allowed: 0 or more')
    for value in options.restitutions:
        if not 0 <= value <= 1:
            raise BenchmarkError(f'--restitutions {value:g}; allowed: 0 to 1')
    for value in options.frictions:
        if not value >= 0:
            raise BenchmarkError(f'--frictions {value:g}; allowed: 0 or more')
