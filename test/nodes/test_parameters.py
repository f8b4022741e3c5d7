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

"""The table of parameters, and the file that repeats its defaults for users to edit."""

import pytest

pytest.importorskip('rclpy')

from rigid_sim_ros.nodes.parameters import ParameterError, PARAMETERS  # noqa: E402, I100
from rigid_sim_ros.shared_files import config_folder  # noqa: E402
import yaml  # noqa: E402

ROWS = {row.name: row for row in PARAMETERS}
TEXT = (config_folder() / 'rigid_sim.yaml').read_text(encoding='utf-8')


def test_file_has_every_default():
    values = yaml.safe_load(TEXT)['/**']['ros__parameters']
    # told in the file, every node that reads it would publish the clock, however many there are
    assert {**values, 'publish_clock': True} == {row.name: row.default for row in PARAMETERS}
    assert '    # publish_clock: true\n' in TEXT
    for name, value in values.items():
        assert type(value) is type(ROWS[name].default), name


def comments():
    """Return the words above each parameter in the file, by its name."""
    found, words = {}, []
    body = TEXT[TEXT.index('ros__parameters:'):].splitlines()[1:]
    for line in map(str.strip, body):
        name = line.lstrip('# ').split(': ')[0]
        if name in ROWS:
            found[name], words = ' '.join(words), []
        elif line:
            assert line.startswith('# '), line
            words.append(line[2:])
    assert not words
    return found


def test_file_says_of_each_what_the_node_says():
    def words(row):
        limits = f'; allowed: {row.allowed}' if row.choices or row.smallest is not None else ''
        return row.description + limits + (' (start)' if row.read_only else '')

    assert comments() == {row.name: words(row) for row in PARAMETERS}


@pytest.mark.parametrize('name, value', [
    ('publish_rate', 0.0999), ('publish_rate', 10001.0), ('publish_rate', float('inf')),
    ('real_time_factor', float('nan')), ('real_time_factor', -0.0001), ('publish_rate', True),
    ('method', 'Exact'), ('scene', 3), ('record', 'yes'), ('command_timeout', '1')])
def test_wrong_values_are_refused_with_what_is_allowed(name, value):
    with pytest.raises(ParameterError) as error:
        ROWS[name].checked(value)
    assert str(error.value) == (f'parameter {name} is {value!r}; allowed: {ROWS[name].allowed}')


@pytest.mark.parametrize('name, value, taken', [
    ('publish_rate', 50, 50.0), ('publish_rate', 0.1, 0.1), ('publish_rate', 10000.0, 10000.0),
    ('real_time_factor', 0, 0.0), ('record', True, True), ('scene', 'x.yaml', 'x.yaml')])
def test_right_values_are_taken_in_their_type(name, value, taken):
    result = ROWS[name].checked(value)
    assert result == taken and type(result) is type(taken)
