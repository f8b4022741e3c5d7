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

"""The shared files are found however the package is installed."""

from pathlib import Path

import pytest

from rigid_sim_ros.shared_files import config_folder


def make_config(folder):
    config = folder / 'config'
    config.mkdir(parents=True)
    return config


def test_the_folder_in_use_holds_the_scenes():
    assert (config_folder() / 'scenes').is_dir()


def test_source_tree_has_config_beside_the_package(tmp_path):
    config = make_config(tmp_path)
    (tmp_path / 'resource').mkdir()
    (tmp_path / 'resource' / 'rigid_sim_ros').touch()
    assert config_folder(tmp_path / 'rigid_sim_ros') == config


@pytest.mark.parametrize('library', [
    'lib/python3.12/site-packages',
    'lib64/python3.12/site-packages',
    'local/lib/python3.12/dist-packages',
    '.'])
def test_installed_package_finds_share_of_its_prefix(tmp_path, library):
    config = make_config(tmp_path / 'share' / 'rigid_sim_ros')
    assert config_folder(tmp_path / library / 'rigid_sim_ros') == config


def test_a_foreign_config_beside_an_installed_package_is_not_taken(tmp_path):
    make_config(tmp_path)
    config = make_config(tmp_path / 'share' / 'rigid_sim_ros')
    assert config_folder(tmp_path / 'rigid_sim_ros') == config


def test_missing_folder_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match='config of rigid_sim_ros.*install'):
        config_folder(Path(tmp_path) / 'rigid_sim_ros')
