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

"""Docstrings in the form that ROS 2 uses."""

import logging

import pytest

main = pytest.importorskip('ament_pep257.main').main


@pytest.mark.linter
@pytest.mark.pep257
def test_pep257(monkeypatch, pytestconfig, capsys, caplog):
    caplog.set_level(logging.WARNING, logger='pydocstyle.utils')
    monkeypatch.chdir(pytestconfig.rootpath)
    return_code = main(argv=['rigid_sim_ros', 'test', 'launch', 'setup.py'])
    errors = capsys.readouterr().err
    assert return_code == 0, errors
