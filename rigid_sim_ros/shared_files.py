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

"""
Where the files shipped beside the code are: the parameters, the scenes, the layouts of viewers.

They are not inside the Python package, because `ros2 launch` and `ros2 run` look for them under
share/rigid_sim_ros, so where they lie depends on how the package was installed.
"""

from pathlib import Path

PACKAGE = 'rigid_sim_ros'


def config_folder(package_folder=Path(__file__).resolve().parent):
    """
    Return the folder config/ that belongs to this code, as an absolute path.

    In a source tree (and so after `pip install -e` or `colcon build --symlink-install`) it is
    beside the package. Installed, it is <prefix>/share/rigid_sim_ros/config, with the package
    somewhere below the same prefix: a virtual environment, /usr/local, ~/.local, a colcon
    workspace, /opt/ros/jazzy, or the folder of `pip install --target`. Raises FileNotFoundError
    if there is neither.
    """
    source_tree = package_folder.parent
    if (source_tree / 'resource' / PACKAGE).is_file() and (source_tree / 'config').is_dir():
        return source_tree / 'config'
    for prefix in package_folder.parents:
        folder = prefix / 'share' / PACKAGE / 'config'
        if folder.is_dir():
            return folder
    raise FileNotFoundError(
        f'the folder config of {PACKAGE} is neither in {source_tree} nor in '
        f'share/{PACKAGE} of any folder above it: install the package again')
