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

"""Tables of results, for the terminal and for Markdown."""

from rigid_sim_ros.benchmark.engines import ENGINES
from rigid_sim_ros.benchmark.measuring import OK
from rigid_sim_ros.benchmark.problems import PROBLEMS
from rigid_sim_ros.benchmark.results import measure_names

UNITS = {'_rad_s': 'rad/s', '_m_s': 'm/s', '_rad': 'rad', '_m': 'm', '_s': 's',
         '_relative': 'relative', '_share': 'share'}
"""How the names of measures end, and what that means; the longest first."""


def titled(measure):
    """Return the name of a measure as a text and its unit: 'angle error', 'rad'."""
    for ending, unit in UNITS.items():
        if measure.endswith(ending):
            return measure[:-len(ending)].replace('_', ' '), unit
    return measure.replace('_', ' '), ''


def terminal_table(problem, results):
    """Return the results of one problem as lines of aligned text."""
    measures = measure_names(results)
    timed_steps = PROBLEMS[problem].reads_every_step
    heads = [('engine', ''), ('step rate', 'Hz'), *map(titled, measures), ('set-up', 'ms'),
             ('CPU time', 'us a step') if timed_steps else ('CPU time', 'ms')]
    rows = [[name for name, _ in heads], [f'[{unit}]' if unit else '' for _, unit in heads]]
    notes = {}
    for result in results:
        cells = [ENGINES[result.engine].title, str(result.rate_hz)]
        if result.status == OK:
            cells += [f'{result.measures[name]:.2g}' for name in measures]
            time = result.run_cpu_us_per_step if timed_steps else result.run_cpu_ms
            cells += [f'{result.build_cpu_ms:.3g}', f'{time:.3g}']
        else:
            cells += [result.status] + [''] * (len(heads) - 3)
            notes[len(rows)] = result.reason
        rows.append(cells)
    widths = [max(len(row[column]) for row in rows) for column in range(len(heads))]
    lines = ['  '.join(cell.ljust(width) if column == 0 else cell.rjust(width)
                       for column, (cell, width) in enumerate(zip(row, widths))).rstrip()
             for row in rows]
    lines = [f'{line}: {notes[number]}' if number in notes else line
             for number, line in enumerate(lines)]
    return '\n'.join([f'{problem}: {PROBLEMS[problem].title}', *lines])


def markdown_tables(results, facts, rate):
    """
    Return two Markdown tables at one step rate [Hz]: errors with CPU times, and crowds.

    In the first a cell is the problem's `plotted` measure and the CPU time of the whole run; in
    the second it is the CPU time a step and, in brackets, that measure.
    """
    at_rate = [result for result in results if result.rate_hz == rate]
    engines = [name for name in ENGINES if any(result.engine == name for result in at_rate)]
    tables = []
    for every_step, head in ((False, f'error, CPU time [ms]; steps of 1/{rate} s'),
                             (True, f'CPU time a step of 1/{rate} s [us], poses read')):
        rows = []
        for name in dict.fromkeys(result.problem for result in at_rate):
            if PROBLEMS[name].reads_every_step != every_step:
                continue
            cells = {result.engine: result for result in at_rate if result.problem == name}
            title, unit = titled(PROBLEMS[name].plotted)
            rows.append([PROBLEMS[name].title, f'{title} [{unit}]',
                         *(_markdown_cell(cells.get(engine), every_step) for engine in engines)])
        if rows:
            heads = [head, 'error', *(ENGINES[engine].title for engine in engines)]
            tables.append('\n'.join('| ' + ' | '.join(row) + ' |' for row in
                                    (heads, ['---'] * len(heads), *rows)))
    versions = ', '.join(dict.fromkeys(
        f'{ENGINES[result.engine].distribution} {result.version}' for result in at_rate))
    machine = f'{facts["processor"]}, one thread, Python {facts["python"]}, NumPy {facts["numpy"]}'
    return '\n\n'.join([*tables, f'{machine}; {versions}; {facts["date"][:10]}.']) + '\n'


def _markdown_cell(result, every_step):
    """Return what a cell says."""
    if result is None:
        return '-'
    if result.status != OK:
        return result.status
    error = f'{result.measures[PROBLEMS[result.problem].plotted]:.1e}'
    if every_step:
        return f'{result.run_cpu_us_per_step:.3g} ({error})'
    return f'{error}, {result.run_cpu_ms:.3g}'
