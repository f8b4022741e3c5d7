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

"""README's tables of topics, services and parameters are the code's: every row, and no other."""

from pathlib import Path

import pytest

pytest.importorskip('rclpy')

from rigid_sim_ros.nodes.parameters import PARAMETERS  # noqa: E402, I100
from rigid_sim_ros.topics import COMMANDS, PUBLISHED, SERVICES  # noqa: E402

README = Path(__file__).parents[1] / 'README.md'


def short(type_name):
    """Return 'std_msgs/String' for 'std_msgs/msg/String', as people write it."""
    package, _, name = type_name.split('/')
    return f'{package}/{name}'


def quality(row):
    words = [row.quality.reliability.replace('_', ' '), str(row.quality.depth)]
    if row.quality.durability != 'volatile':
        words.insert(1, 'latched')
    return ' '.join(words)


def topic_table(rows):
    return ['| topic | type | quality of service | what |', '| --- | --- | --- | --- |'] + [
        f'| `{row.name}` | {short(row.type_name)} | {quality(row)} | {row.what} |'
        for row in rows]


def service_table():
    return ['| service | type | what |', '| --- | --- | --- |'] + [
        f'| `{row.name}` | {short(row.type_name)} | {row.what} |' for row in SERVICES]


def default_text(value):
    if isinstance(value, bool):
        return str(value).lower()
    return f'{value:g}' if isinstance(value, float) else value or "''"


def parameter_table():
    return ['| parameter | default | allowed | what |', '| --- | --- | --- | --- |'] + [
        f'| `{row.name}`{" (start)" if row.read_only else ""} | {default_text(row.default)} | '
        f'{row.allowed} | {row.description} |' for row in PARAMETERS]


TABLES = {
    'published': topic_table(PUBLISHED),
    'commands': topic_table(COMMANDS),
    'services': service_table(),
    'parameters': parameter_table(),
}


@pytest.mark.parametrize('table', TABLES.values(), ids=TABLES)
def test_readme_holds_the_table(table):
    expected = '\n'.join(['', *table, ''])
    assert expected in README.read_text(encoding='utf-8'), (
        f'README.md needs this table, followed by an empty line:\n{expected}')


if __name__ == '__main__':
    print('\n\n'.join('\n'.join(table) for table in TABLES.values()))
