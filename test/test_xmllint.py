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

"""The manifest is what ROS 2 tools accept."""

from pathlib import Path
import shutil
from urllib.error import URLError
from urllib.request import urlopen
import warnings

import pytest

ROOT = Path(__file__).parents[1]
SCHEMA = 'http://download.ros.org/schema/package_format3.xsd'


def test_manifest_is_accepted_without_a_warning():
    # colcon takes a package whose manifest is refused for plain Python, with no more than a
    # warning; `ros2 run` then cannot find it.
    package = pytest.importorskip('catkin_pkg.package')
    refused = []
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        manifest = package.parse_package(ROOT, warnings=refused)
        manifest.validate(warnings=refused)
    assert refused == []
    assert manifest.package_format == 3
    assert manifest.get_build_type() == 'ament_python'


@pytest.mark.linter
@pytest.mark.xmllint
def test_xmllint(monkeypatch):
    main = pytest.importorskip('ament_xmllint.main').main
    if shutil.which('xmllint') is None:
        pytest.skip('xmllint is not installed')
    try:
        urlopen(SCHEMA, timeout=10).close()
    except URLError as error:
        pytest.skip(f'{SCHEMA} is out of reach: {error}')
    monkeypatch.chdir(ROOT)
    assert main(argv=['package.xml']) == 0
