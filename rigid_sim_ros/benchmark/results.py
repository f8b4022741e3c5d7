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

"""Results as CSV: a header of facts about the machine, then one row a cell."""

import csv
from dataclasses import asdict, fields

from rigid_sim_ros.benchmark.measuring import Result

COLUMNS = tuple(part.name for part in fields(Result) if part.name != 'measures')


def measure_names(results):
    """Return the names of all measures, in the order in which they first come."""
    return list(dict.fromkeys(name for result in results for name in result.measures))


def write_csv(path, results, facts):
    """
    Write results to a file, replacing it.

    First a line `# fact: value` for each fact; then the columns of `Result` and one for each
    measure, units at the end of the names, empty where there is no figure.
    """
    measures = measure_names(results)
    with open(path, 'w', encoding='utf-8', newline='') as file:
        for fact, value in facts.items():
            file.write(f'# {fact}: {value}\n')
        writer = csv.DictWriter(file, (*COLUMNS, *measures), lineterminator='\n')
        writer.writeheader()
        for result in results:
            row = asdict(result)
            writer.writerow({**row.pop('measures'), **row})


def read_csv(path):
    """Return the rows of a file that `write_csv` made, as `Result`s, and its facts."""
    with open(path, encoding='utf-8', newline='') as file:
        lines = file.read().splitlines()
    facts = dict(line[2:].split(': ', 1) for line in lines if line.startswith('# '))
    rows = csv.DictReader(line for line in lines if not line.startswith('# '))
    return [_result(row) for row in rows], facts


def _result(row):
    """Return the `Result` of one row of texts."""
    numbers = {'rate_hz': int, 'bodies': int, 'timed_runs': int}
    texts = ('problem', 'engine', 'version', 'status', 'reason')
    values = {name: row[name] if name in texts
              else numbers.get(name, float)(row[name]) if row[name] else None
              for name in COLUMNS}
    measures = {name: float(value) for name, value in row.items()
                if name not in COLUMNS and value}
    return Result(**values, measures=measures)
