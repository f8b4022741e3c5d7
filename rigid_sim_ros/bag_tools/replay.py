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

"""`rigid_sim_replay`: simulate a recording again, and compare."""

import argparse
import os
import sys

from rigid_sim_ros.bag_tools.differences import Deviations, first_difference
from rigid_sim_ros.bag_tools.resimulation import POSES, Resimulation
from rigid_sim_ros.messages import MessageError
from rigid_sim_ros.recording import Bag, RecordingError
from tqdm import tqdm

IDENTICAL, DIFFERENT, IMPOSSIBLE = 0, 1, 2
"""Exit codes."""

_OPTIONS = {'method': str, 'max_step': float}


def main(arguments=None):
    """Run the program; return its exit code."""
    options = _parser().parse_args(arguments)
    try:
        changes = _changes(options.changes)
        if options.plot and not os.path.isdir(os.path.dirname(options.plot) or '.'):
            raise RecordingError(f'--plot {options.plot}: there is no such folder')
        duration = _duration(options.bag)
        resimulation = Resimulation(options.bag, changes)
        if changes:
            return _deviate(resimulation, duration, options)
        return _compare(resimulation, duration)
    except (RecordingError, MessageError) as error:
        print(f'rigid_sim_replay: {error}', file=sys.stderr)
        return IMPOSSIBLE
    except KeyboardInterrupt:
        return 130


def _parser():
    parser = argparse.ArgumentParser(
        prog='rigid_sim_replay',
        description='Simulate a recording again from its scene and commands, as fast as '
                    'possible, and compare every pose, velocity and collision bit for bit. '
                    'Exit code 0: identical; 1: different; 2: it cannot be simulated again.')
    parser.add_argument('bag', type=os.path.expanduser, help='folder of the bag')
    parser.add_argument(
        '--with', dest='changes', default='', metavar='NAME=VALUE,...',
        help='simulate with another method or max_step [s], and tell how far it gets from the '
             'recording')
    parser.add_argument('--plot', type=os.path.expanduser, metavar='FILE',
                        help='where to draw the deviations of --with (default: beside the bag)')
    return parser


def _changes(text):
    changes = {}
    for part in filter(None, text.split(',')):
        name, _, value = part.partition('=')
        if name not in _OPTIONS:
            raise RecordingError(f'--with {part!r}; allowed: method=..., max_step=...')
        try:
            changes[name] = _OPTIONS[name](value)
        except ValueError:
            raise RecordingError(f'--with {part!r}; allowed: a number of seconds') from None
    return changes


def _duration(path):
    """Return the simulated time [s] of all runs in a bag, for the progress bar."""
    total, last = 0, 0
    for overview in Bag(path).overviews():
        # time goes back from one file to the next only
        total += overview.end_ns - min(last, overview.start_ns)
        last = overview.end_ns
    return total / 1e9


def _with_progress(resimulation, duration):
    """Go through the pairs and show how far it is."""
    last = 0.0
    with tqdm(total=round(duration, 3), unit='s', unit_scale=True, disable=None,
              desc='simulating') as bar:
        def show(time_ns):
            nonlocal last
            bar.update(max(0.0, time_ns / 1e9 - last))
            last = time_ns / 1e9

        resimulation.on_progress = show
        for pair in resimulation.pairs():
            show(pair.time_ns)
            yield pair


def _compare(resimulation, duration):
    count, pair = 0, None
    for pair in _with_progress(resimulation, duration):
        if pair.recorded != pair.again:
            print('\n'.join([f'different: {first_difference(pair, resimulation.names)}',
                             *resimulation.other_software]))
            _tell_damage(resimulation)
            return DIFFERENT
        count += 1
    _tell_damage(resimulation)
    print(f'identical: {count} messages up to {pair.time_ns / 1e9:.9f} s')
    return IDENTICAL


def _deviate(resimulation, duration, options):
    deviations = Deviations()
    try:
        for pair in _with_progress(resimulation, duration):
            if pair.kind == POSES:
                deviations.add(pair, resimulation.names)
    except RecordingError:
        if deviations.distances:
            _report(deviations, resimulation, options)
        raise
    _report(deviations, resimulation, options)
    return DIFFERENT if deviations.found else IDENTICAL


def _report(deviations, resimulation, options):
    for line in deviations.report():
        print(line)
    path = _plot_path(options)
    try:
        deviations.plot(path)
    except ImportError:
        print('no plot: matplotlib is not installed')
    except (OSError, ValueError) as error:
        print(f'no plot: {error}')
    else:
        print(f'plot: {path}')
    _tell_damage(resimulation)


def _plot_path(options):
    return options.plot or os.path.abspath(options.bag) + '_deviations.png'


def _tell_damage(resimulation):
    for line in resimulation.damage:
        print(f'damaged: {line}', file=sys.stderr)


if __name__ == '__main__':
    sys.exit(main())
