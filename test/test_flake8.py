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

"""The style checks of ROS 2, with ament's own configuration."""

import pytest

main = pytest.importorskip('ament_flake8.main')

PATHS = ['rigid_sim_ros', 'test', 'launch', 'setup.py']


@pytest.mark.flake8
@pytest.mark.linter
def test_flake8(monkeypatch, pytestconfig, capsys):
    monkeypatch.chdir(pytestconfig.rootpath)
    return_code, errors = main.main_with_errors(argv=PATHS)
    capsys.readouterr()  # a list of all the files checked
    assert return_code == 0, f'{len(errors)} errors:\n' + '\n'.join(errors)
