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

import pytest
from rigid_sim_ros.recording.bag_metadata import BagTopic, quality_profiles, to_yaml
import yaml


@pytest.mark.parametrize('value', [
    {}, [], {'a': {}}, {'a': []}, {'a': ''}, {'a': {'b': [1, {'c': 'd', 'e': [{'f': -1}, 'g']}]}},
    [{'a': 1, 'b': {'c': 2}}, {'a': [[1, 2], [{}]]}],
    ['/topic/name', 'x y', 'yes', 'No', '~', '1.5', '- a', ''],
    {'text': 'a: "b"\n\'c\' # \u00e4 \\', 'true': True, 'flag': False},
    {'huge': 9223372036854775807}])
def test_an_independent_parser_reads_what_is_written(value):
    assert yaml.safe_load(to_yaml(value)) == value


@pytest.mark.parametrize('text, expected', [
    ('- {depth: 1}', [{'depth': 1}]), ('', []), ('[', []), ('3', []), ('- 3', []),
    ('- &a {b: 1}\n- *a', [])])
def test_quality_that_cannot_be_read_is_none(text, expected):
    assert quality_profiles(BagTopic('/a', 'b/msg/C', text, '', '')) == expected
