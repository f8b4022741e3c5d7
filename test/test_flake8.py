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

import re
import subprocess
import sys

import pytest

pytest.importorskip('ament_flake8.main')

PATHS = ['rigid_sim_ros', 'test', 'launch', 'setup.py']


@pytest.mark.flake8
@pytest.mark.linter
def test_flake8(pytestconfig):
    # in a process of its own, as flake8 forks, which must not be done beside the threads of ROS
    run = subprocess.run(
        [sys.executable, '-m', 'ament_flake8.main', *PATHS], cwd=pytestconfig.rootpath,
        capture_output=True, text=True, timeout=600)
    errors = re.findall(r'^\S+:\d+:\d+: .*$', run.stdout, flags=re.MULTILINE)
    assert run.returncode == 0, '\n'.join(['flake8 found', *errors, run.stderr])
