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

"""The command `rigid_sim_benchmark report`: tables and plots from results measured before."""

from importlib.util import find_spec
from pathlib import Path

from rigid_sim_ros.benchmark.errors import BenchmarkError, chosen
from rigid_sim_ros.benchmark.problems import PROBLEMS
from rigid_sim_ros.benchmark.report import markdown_tables, terminal_table
from rigid_sim_ros.benchmark.results import read_csv


def add_options(parser):
    """
    Print tables of results.csv files measured before, and write Markdown and plots of them.

    Where several files have the same problem, engine and step, the last one counts. They should
    come from one machine: the first file's facts are those that are written.
    """
    parser.add_argument('results', nargs='+', type=Path, metavar='RESULTS.csv')
    parser.add_argument('--problems', nargs='+', metavar='PROBLEM', default=[],
                        help='names of problems; default all that the files have')
    add_output_options(parser)


def add_output_options(parser):
    """Add the options that say what is written; `run` has them too."""
    parser.add_argument('--markdown', type=Path, metavar='FILE',
                        help='write tables in Markdown, replacing the file')
    parser.add_argument('--markdown-rate', type=int, default=240, metavar='HZ',
                        help='steps a second of those tables (%(default)s)')
    parser.add_argument('--plots', type=Path, metavar='FOLDER',
                        help='write plots as PNG and SVG, replacing those there')


def run(options):
    """Run the command with its parsed options."""
    check_outputs(options)
    wanted = chosen('problem', options.problems, list(PROBLEMS))
    cells, facts = {}, None
    for path in options.results:
        results, facts_there = _read(path)
        facts = facts or facts_there
        cells.update({(row.problem, row.engine, row.rate_hz): row for row in results
                      if row.problem in wanted})
    results = sorted(cells.values(), key=lambda row: list(PROBLEMS).index(row.problem))
    for problem in dict.fromkeys(row.problem for row in results):
        print(terminal_table(problem, [row for row in results if row.problem == problem]),
              end='\n\n')
    write_reports(options, results, facts)


def check_outputs(options):
    """Raise `BenchmarkError` for outputs that could not be written in the end."""
    if options.markdown and not options.markdown.parent.is_dir():
        raise BenchmarkError(f'--markdown {options.markdown}: there is no folder '
                             f'{options.markdown.parent}')
    if options.plots and not find_spec('matplotlib'):
        raise BenchmarkError('--plots needs matplotlib: pip install matplotlib')


def write_reports(options, results, facts):
    """Write what the output options say."""
    if options.markdown:
        options.markdown.write_text(markdown_tables(results, facts, options.markdown_rate),
                                    encoding='utf-8')
    if options.plots:
        # here, as matplotlib is needed for nothing else
        from rigid_sim_ros.benchmark.plots import write_plots
        options.plots.mkdir(parents=True, exist_ok=True)
        write_plots(options.plots, results)


def _read(path):
    """Return the results and facts of a file, or raise `BenchmarkError`."""
    try:
        results, facts = read_csv(path)
    except (OSError, ValueError, KeyError) as error:
        raise BenchmarkError(f'{path} is not a file of results: {error}') from None
    if not facts:
        raise BenchmarkError(f'{path} does not say on what machine its results were measured')
    unknown = [row.problem for row in results if row.problem not in PROBLEMS]
    if unknown:
        raise BenchmarkError(f'{path} has results of an unknown problem: {unknown[0]}')
    return results, facts
