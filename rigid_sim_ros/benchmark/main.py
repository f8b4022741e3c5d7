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

"""The command `rigid_sim_benchmark`."""

import argparse
from inspect import getdoc
import sys

from rigid_sim_ros.benchmark import report_command, run_command
from rigid_sim_ros.benchmark.engines import ENGINES, installed_engines
from rigid_sim_ros.benchmark.errors import BenchmarkError
from rigid_sim_ros.benchmark.problems import PROBLEMS
from rigid_sim_ros.benchmark.tosses import command as tosses_command

DESCRIPTION = """\
Run time against error: this engine and, where they are installed, MuJoCo, Rapier and Bullet, on
problems whose right answer is known.

Errors and times are measured in separate runs, each engine in a process of its own on one thread;
times are medians of process CPU time after a warm-up, poses read. Without a command `run` is
meant, so that `rigid_sim_benchmark` runs everything and `rigid_sim_benchmark slide` one problem.
"""


def main(arguments=None):
    """Run the command; exit code 2 and one line on standard error for what cannot be run."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    parser = command_line()
    if not arguments or arguments[0] not in (*COMMANDS, '-h', '--help'):
        arguments = ['run', *arguments]
    options = parser.parse_args(arguments)
    try:
        options.command(options)
    except BenchmarkError as error:
        print(f'rigid_sim_benchmark: {error}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print('rigid_sim_benchmark: interrupted', file=sys.stderr)
        return 130
    return 0


def command_line():
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='rigid_sim_benchmark', description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(title='commands', metavar='COMMAND', required=True)
    for name, (add_options, run, summary) in COMMANDS.items():
        command = commands.add_parser(name, help=summary, description=getdoc(add_options),
                                      formatter_class=argparse.RawDescriptionHelpFormatter)
        add_options(command)
        command.set_defaults(command=run)
    return parser


def add_list_options(parser):
    """List the problems and the engines, and which engines are installed."""


def list_all(options):
    """Print problems and engines."""
    installed = installed_engines()
    width = max(map(len, PROBLEMS))
    print('problems')
    for problem in PROBLEMS.values():
        print(f'  {problem.name:{width}}  {problem.title}')
    print('engines')
    for name, row in ENGINES.items():
        state = (row.version() if name in installed
                 else f'not installed: pip install {row.distribution}')
        print(f'  {name:{width}}  {row.title} ({state})')


COMMANDS = {
    'run': (run_command.add_options, run_command.run, 'measure problems (the default)'),
    'list': (add_list_options, list_all, 'list problems and engines'),
    'report': (report_command.add_options, report_command.run, 'tables and plots of results'),
    'tosses': (tosses_command.add_options, tosses_command.run, 'compare with real cube tosses'),
}
"""By name: what adds the options, what runs, one line of help."""


if __name__ == '__main__':
    sys.exit(main())
