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

"""The command line, the tables, the CSV and the plots."""

import csv

import pytest
from rigid_sim_ros.benchmark import report_command, run_command
from rigid_sim_ros.benchmark.engines import ENGINES
from rigid_sim_ros.benchmark.machine import machine_facts, processor_name
from rigid_sim_ros.benchmark.main import main
from rigid_sim_ros.benchmark.measuring import FAILED, Result
from rigid_sim_ros.benchmark.problems import PROBLEMS
from rigid_sim_ros.benchmark.report import markdown_tables, terminal_table, titled
from rigid_sim_ros.benchmark.results import read_csv, write_csv
from rigid_sim_ros.benchmark.run_command import cells_of

FACTS = {'processor': 'Any', 'python': '3.12', 'numpy': '2.0', 'date': '2030-01-02T03:04:05'}


def result(problem='slide', engine='exact', rate=240, **changes):
    values = {'version': '1.0', 'bodies': 1, 'simulated_s': 1.5,
              'measures': {'distance_error_relative': 2e-6, 'lift_m': 0.0},
              'build_cpu_ms': 1.25, 'run_cpu_ms': 50.0, 'run_cpu_us_per_step': 138.9,
              'timed_runs': 5, **changes}
    return Result(problem, engine, rate_hz=rate, **values)


def failed(**changes):
    return result(status=FAILED, reason='not finite', measures={}, build_cpu_ms=None,
                  run_cpu_ms=None, run_cpu_us_per_step=None, timed_runs=None, **changes)


CROWD = {'problem': 'drift_100', 'bodies': 100}

SOME = [result(), result(rate=60, run_cpu_ms=20.0), result(engine='mujoco', run_cpu_ms=2.0),
        failed(engine='rapier'),
        result(measures={'position_error_m': 1e-16, 'angle_error_rad': 1e-15}, **CROWD),
        result(engine='mujoco', measures={'angle_error_rad': 1e-14}, run_cpu_us_per_step=70.0,
               **CROWD)]


def test_csv_comes_back_as_it_was(tmp_path):
    write_csv(tmp_path / 'results.csv', SOME, FACTS)
    assert read_csv(tmp_path / 'results.csv') == (SOME, FACTS)


def test_csv_has_facts_then_columns_with_units(tmp_path):
    path = tmp_path / 'results.csv'
    write_csv(path, SOME, FACTS)
    lines = path.read_text(encoding='utf-8').splitlines()
    assert lines[0] == '# processor: Any'
    rows = list(csv.reader(lines[len(FACTS):]))
    assert rows[0] == ['problem', 'engine', 'version', 'rate_hz', 'bodies', 'simulated_s',
                       'status', 'reason', 'build_cpu_ms', 'run_cpu_ms', 'run_cpu_us_per_step',
                       'timed_runs', 'distance_error_relative', 'lift_m', 'position_error_m',
                       'angle_error_rad']
    assert len(rows) == 1 + len(SOME)
    lost = dict(zip(rows[0], rows[4]))
    assert (lost['status'], lost['reason'], lost['run_cpu_ms']) == ('failed', 'not finite', '')


@pytest.mark.parametrize('name, expected', [
    ('apex_time_error_s', ('apex time error', 's')),
    ('spin_error_relative', ('spin error', 'relative')),
    ('speed_at_end_m_s', ('speed at end', 'm/s')), ('tilt_rad', ('tilt', 'rad'))])
def test_units_of_measures(name, expected):
    assert titled(name) == expected


def test_terminal_table_shows_figures_and_why_a_run_failed():
    lines = terminal_table('slide', SOME[:4]).splitlines()
    assert lines[0] == 'slide: cube sliding to rest, mu 0.3 from 3 m/s'
    assert lines[3].split()[-4:] == ['2e-06', '0', '1.25', '50']
    assert lines[-1].startswith('Rapier') and lines[-1].endswith('failed: not finite')


def test_markdown_has_errors_and_times_at_one_rate():
    text = markdown_tables(SOME, FACTS, 240)
    assert ('| cube sliding to rest, mu 0.3 from 3 m/s | distance error [relative] | '
            '2.0e-06, 50 | 2.0e-06, 2 | failed |') in text
    assert '| 139 (1.0e-15) | 70 (1.0e-14) |' in text.replace('| - |', '|')
    assert '20' not in [cell.split(', ')[-1].strip() for cell in text.split('|')]
    assert text.endswith('Any, one thread, Python 3.12, NumPy 2.0; rigid_sim_ros 1.0, '
                         'mujoco 1.0, rapier3d 1.0; 2030-01-02.\n')


def test_plots_have_a_line_for_each_engine_that_did_not_fail(tmp_path):
    plots = pytest.importorskip('rigid_sim_ros.benchmark.plots')
    panel = plots.work_precision_figure(['slide'], SOME).axes[0]
    assert [line.get_label() for line in panel.lines] == ['rigid_sim exact', 'MuJoCo']
    assert panel.lines[0].get_xydata().tolist() == [[50.0, 2e-6], [20.0, 2e-6]]
    assert (panel.get_xscale(), panel.get_yscale()) == ('log', 'log')
    assert panel.get_ylabel() == 'distance error [relative]'
    names = {path.name for path in plots.write_plots(tmp_path, SOME)}
    assert names == {f'{name}.{kind}' for kind in ('png', 'svg')
                     for name in ('work_precision', 'error_slide', 'scaling')}
    assert all((tmp_path / name).stat().st_size > 5000 for name in names)


def test_errors_of_zero_are_drawn_at_the_lower_end():
    plots = pytest.importorskip('rigid_sim_ros.benchmark.plots')
    exact = result(measures={'distance_error_relative': 0.0})
    panel = plots.work_precision_figure(['slide'], [exact]).axes[0]
    assert panel.lines[0].get_ydata().tolist() == [plots.SMALLEST_ERROR]


def test_each_engine_has_its_own_colour_and_marker():
    plots = pytest.importorskip('rigid_sim_ros.benchmark.plots')
    assert len(set(plots.COLORS)) == len(set(plots.MARKERS)) == len(ENGINES)


def test_problems_too_large_for_an_engine_are_left_out():
    cells = cells_of(['drift_10', 'drift_100', 'slide'], ['exact', 'report'], [])
    assert cells['drift_10'] == [('exact', 240), ('report', 240)]
    assert cells['drift_100'] == [('exact', 240)]
    assert cells_of(['slide'], ['exact'], [120])['slide'] == [('exact', 120)]


def test_machine(tmp_path):
    assert {'date', 'processor', 'python', 'numpy', 'threads'} <= set(machine_facts())
    information = tmp_path / 'cpuinfo'
    information.write_text('processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\n')
    assert processor_name(information) == 'Some CPU @ 2 GHz'


def test_list(capsys):
    assert main(['list']) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in (*PROBLEMS, *ENGINES))


@pytest.mark.parametrize('arguments, expected', [
    (['slid'], "no problem is named 'slid'; near names: slide"),
    (['run', 'drop_elastik'], "no problem is named 'drop_elastik'; near names: drop_elastic"),
    (['slide', '--engines', 'exakt'], "no engine is named 'exakt'; near names: exact"),
    (['slide', '--rates', '100'], '--rates 100; allowed: positive multiples of 60'),
    (['slide', '--repeats', '0'], '--repeats 0; allowed: 1 or more'),
    (['slide', '--timeout', '0'], '--timeout 0; allowed: a positive number'),
    (['tosses', 'none.npz'], 'none.npz is not an archive of tosses: '),
    (['tosses', 'none.npz', '--count', '0'], '--count 0; allowed: 1 or more'),
    (['tosses', 'none.npz', '--restitutions', '2'], '--restitutions 2; allowed: 0 to 1')])
def test_what_cannot_be_run_is_refused_in_one_line(arguments, expected, capsys):
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.startswith('rigid_sim_benchmark: ' + expected)
    assert error.count('\n') == 1


def test_help_says_where_tosses_come_from(capsys):
    with pytest.raises(SystemExit, match='0'):
        main(['tosses', '--help'])
    assert 'DAIRLab/contact-nets' in capsys.readouterr().out


def test_a_short_run_prints_and_writes(tmp_path, capsys):
    pytest.importorskip('matplotlib')
    arguments = ['run', 'constant_wrench', '--engines', 'exact', 'stepped', '--rates', '60',
                 '--repeats', '1', '--output', str(tmp_path / 'out'),
                 '--markdown', str(tmp_path / 'table.md'), '--markdown-rate', '60']
    assert main(arguments) == 0
    assert 'rigid_sim stepped' in capsys.readouterr().out
    results, facts = read_csv(tmp_path / 'out' / 'results.csv')
    assert [(row.engine, row.status) for row in results] == [('exact', 'ok'), ('stepped', 'ok')]
    assert results[0].measures['angle_error_rad'] < 1e-13 < results[1].measures['angle_error_rad']
    assert all(row.run_cpu_ms > 0 for row in results)
    assert facts['threads'] == '1'
    assert (tmp_path / 'out' / 'work_precision.svg').exists()
    assert (tmp_path / 'table.md').read_text().startswith('| error, CPU time [ms]')


def test_report_joins_files_and_the_last_one_counts(tmp_path, capsys):
    pytest.importorskip('matplotlib')
    write_csv(tmp_path / 'first.csv', SOME[:3], FACTS)
    write_csv(tmp_path / 'second.csv', [result(engine='mujoco', run_cpu_ms=7.5)], FACTS)
    assert main(['report', str(tmp_path / 'first.csv'), str(tmp_path / 'second.csv'),
                 '--problems', 'slide', '--markdown', str(tmp_path / 'table.md'),
                 '--plots', str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines()[-2].split()[-1] == '7.5'
    assert '| 2.0e-06, 50 | 2.0e-06, 7.5 |' in (tmp_path / 'table.md').read_text()
    assert (tmp_path / 'error_slide.png').exists()


def test_report_refuses_other_files(tmp_path, capsys):
    other = tmp_path / 'other.csv'
    other.write_text('a,b\n1,2\n')
    assert main(['report', str(other)]) == 2
    assert capsys.readouterr().err.startswith(
        f'rigid_sim_benchmark: {other} is not a file of results')


def test_tosses_of_a_cube_that_only_flies(tmp_path, capsys):
    from test_tosses import write
    path = write(tmp_path / 'tosses.npz', offset=[0, 12])
    assert main(['tosses', str(path), '--frictions', '0.2', '--restitutions', '0.1']) == 0
    row = capsys.readouterr().out.splitlines()[-1]
    assert 'friction 0.2, restitution 0.1' in row
    # what is only flight is what the fit was made of
    assert row.split()[-4:-1] == ['0.0', '0.0', '100']


def test_outputs_that_cannot_be_written_are_told_before_anything_is_measured(tmp_path, capsys):
    path = tmp_path / 'results.csv'
    write_csv(path, SOME, FACTS)
    for command in (['run', 'slide', '--no-plots', '--output', str(tmp_path / 'out')],
                    ['report', str(path)]):
        assert main([*command, '--markdown', str(tmp_path / 'none' / 'tables.md')]) == 2
        shown = capsys.readouterr()
        assert 'there is no folder' in shown.err and not shown.out
    assert not (tmp_path / 'out').exists()
    bare = tmp_path / 'bare.csv'
    bare.write_text(''.join(line for line in path.read_text().splitlines(keepends=True)
                            if not line.startswith('#')))
    assert main(['report', str(bare)]) == 2
    assert 'does not say on what machine' in capsys.readouterr().err


@pytest.mark.parametrize('missing, arguments', [
    ('mpmath', ['run', 'slide', '--no-plots']), ('matplotlib', ['run', 'slide']),
    ('matplotlib', ['report', 'results.csv', '--plots', '.'])])
def test_what_is_not_installed_is_told_first(missing, arguments, monkeypatch, capsys):
    for module in (report_command, run_command):
        monkeypatch.setattr(module, 'find_spec', lambda name: None if name == missing else name)
    assert main(arguments) == 2
    assert f'pip install {missing}' in capsys.readouterr().err
