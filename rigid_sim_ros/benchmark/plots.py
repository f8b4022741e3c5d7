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

"""Work-precision plots: error against CPU time, one line an engine; and time against bodies."""

from math import ceil
from textwrap import wrap

import matplotlib
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from rigid_sim_ros.benchmark.engines import ENGINES
from rigid_sim_ros.benchmark.measuring import OK
from rigid_sim_ros.benchmark.problems import PROBLEMS
from rigid_sim_ros.benchmark.report import titled

COLORS = ('#000000', '#D55E00', '#999999', '#0072B2', '#56B4E9', '#009E73', '#CC79A7')
"""Of the engines in the order of their table: Okabe and Ito's, safe for colour-blind readers."""

MARKERS = ('o', 's', 'x', '^', 'v', 'D', 'P')

SMALLEST_ERROR = 1e-17
"""Errors of zero have no place on a logarithmic axis and are drawn here."""

COLUMNS = 3
PANEL = 3.4, 2.7
"""Width and height of a panel [inch]."""

SCALED = {'drift_': 'drifting, spinning, never touching',
          'pile_': 'dropped from a jittered grid', 'heap_': 'dropped tumbled'}
"""Problems that come in sizes: how their names begin, and the panel's title."""


def write_plots(folder, results):
    """Write all plots as PNG and SVG into a folder; return the paths."""
    paths = []
    names = [name for name in dict.fromkeys(result.problem for result in results)
             if not PROBLEMS[name].reads_every_step]
    drawn = [name for name in names if any(
        result.status == OK for result in results if result.problem == name)]
    if drawn:
        paths += _save(work_precision_figure(drawn, results), folder, 'work_precision')
        for name in drawn:
            paths += _save(work_precision_figure([name], results), folder, f'error_{name}')
    figure = scaling_figure(results)
    if figure:
        paths += _save(figure, folder, 'scaling')
    return paths


def work_precision_figure(names, results):
    """Return a figure with a panel of error against CPU time for each problem."""
    figure, panels = _panels(len(names))
    for panel, name in zip(panels, names):
        rows = [result for result in results if result.problem == name and result.status == OK]
        measure = PROBLEMS[name].plotted
        _lines(panel, rows, lambda result: result.run_cpu_ms,
               lambda result, measure=measure: max(result.measures[measure], SMALLEST_ERROR))
        title, unit = titled(measure)
        panel.set_title(_wrapped(PROBLEMS[name].title), fontsize=9)
        panel.set_ylabel(f'{title} [{unit}]', fontsize=8)
        panel.set_xlabel('CPU time [ms]', fontsize=8)
    _add_legend(figure, panels)
    return figure


def scaling_figure(results):
    """Return a figure of CPU time a step against the number of bodies, None without any."""
    groups = {}
    for beginning, title in SCALED.items():
        rows = [result for result in results
                if result.problem.startswith(beginning) and result.status == OK]
        if rows:
            groups[title] = rows
    if not groups:
        return None
    figure, panels = _panels(len(groups))
    for panel, (title, rows) in zip(panels, groups.items()):
        _lines(panel, rows, lambda result: result.bodies,
               lambda result: result.run_cpu_us_per_step)
        panel.set_title(_wrapped(f'cubes {title}'), fontsize=9)
        panel.set_xlabel('number of cubes', fontsize=8)
        panel.set_ylabel('CPU time a step, poses read [us]', fontsize=8)
    _add_legend(figure, panels)
    return figure


def _panels(count):
    """Return a figure and its panels, with room for a legend below."""
    columns = min(COLUMNS, count)
    rows = ceil(count / columns)
    figure = Figure(figsize=(max(PANEL[0] * columns, 5.0), PANEL[1] * rows + 0.7),
                    layout='constrained')
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    for panel in panels[count:]:
        panel.remove()
    return figure, panels[:count]


def _lines(panel, rows, abscissa, ordinate):
    """Draw one line an engine, from the least to the largest abscissa's step."""
    for number, engine in enumerate(ENGINES):
        points = [(abscissa(row), ordinate(row)) for row in rows if row.engine == engine]
        if points:
            # a hollow marker leaves the one below it visible where engines agree
            panel.plot(*zip(*points), color=COLORS[number], marker=MARKERS[number],
                       label=ENGINES[engine].title, markersize=5, linewidth=1.2,
                       markerfacecolor='none' if number else COLORS[number])
    panel.set_xscale('log')
    panel.set_yscale('log')
    panel.grid(visible=True, which='major', linewidth=0.4, color='#cccccc')
    panel.tick_params(labelsize=8)
    for axis in (panel.xaxis, panel.yaxis):
        axis.set_minor_formatter(NullFormatter())
    low, high = panel.get_xlim()
    panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 100 * low else (1,)))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f'{value:g}'))


def _add_legend(figure, panels):
    """Add one legend for all panels below them."""
    handles = {}
    for panel in panels:
        handles.update(dict(zip(*reversed(panel.get_legend_handles_labels()))))
    order = [row.title for row in ENGINES.values() if row.title in handles]
    figure.legend([handles[title] for title in order], order, loc='outside lower center',
                  ncols=min(len(order), 4), fontsize=8, frameon=False)


def _wrapped(title, width=42):
    """Return a title broken into lines of about equal length where it is long."""
    lines = ceil(len(title) / width)
    return '\n'.join(wrap(title, width=min(width, len(title) // lines + 8)))


def _save(figure, folder, name):
    """Write a figure as PNG and as SVG; return both paths."""
    paths = [folder / f'{name}.png', folder / f'{name}.svg']
    with matplotlib.rc_context({'svg.fonttype': 'none', 'svg.hashsalt': name}):
        for path in paths:
            figure.savefig(path, dpi=150, metadata={'Date': None} if path.suffix == '.svg' else {})
    return paths
