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

from pathlib import Path

from setuptools import find_packages, setup

NAME = 'rigid_sim_ros'

# Real rclpy with Fast DDS for machines without a ROS installation.
ROS_WHEELS = [
    'ros-jazzy-rclpy==7.1.6',
    'ros-rclpy[fastrtps]==7.1.6',
    'ros-rmw-fastrtps-cpp<=8.4.3',
    'ros-jazzy-common-interfaces==5.3.6',
]

# The linters of ROS 2 Jazzy on Ubuntu 24.04, so that both kinds of machine judge alike.
LINTERS = [
    'ros-ament-flake8==0.17.3',
    'ros-ament-pep257==0.17.3',
    'flake8==7.0.0',
    'flake8-blind-except==0.2.1',
    'flake8-builtins==2.1.0',
    'flake8-class-newline==1.6.0',
    'flake8-comprehensions==3.14.0',
    'flake8-deprecated==2.2.1',
    'flake8-docstrings==1.7.0',
    'flake8-import-order==0.19.2',
    'flake8-quotes==3.4.0',
    'pydocstyle==6.3.0',
]


def shared_files(folder):
    """Return the data_files rows that put a folder and all below it under share/."""
    folders = [Path(folder), *(path for path in Path(folder).rglob('*') if path.is_dir())]
    return [
        (f'share/{NAME}/{path}', sorted(str(file) for file in path.iterdir() if file.is_file()))
        for path in sorted(folders)]


setup(
    name=NAME,
    version='0.1.0',
    description='A rigid-body simulator as a ROS 2 node, exact where a formula exists.',
    author='The rigid_sim_ros authors',
    maintainer='The rigid_sim_ros authors',
    maintainer_email='maintainers@rigid-sim-ros.org',
    license='Apache-2.0',
    packages=find_packages(exclude=['test', 'test.*']),
    package_data={NAME: ['**/*.json']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        *shared_files('config'),
        *shared_files('launch'),
    ],
    python_requires='>=3.10',
    install_requires=['numpy>=1.26', 'mcap>=1.2', 'PyYAML>=6.0', 'tqdm'],
    extras_require={
        'ros': ROS_WHEELS,
        # pybullet has no wheels for later Pythons, and takes a quarter of an hour to build.
        'peers': ['mujoco', 'rapier3d', 'pybullet; python_version < "3.12"'],
        'benchmark': ['matplotlib', 'mpmath'],
        # CRC-32 by the processor's own instructions: a tenth of a core less at 200 MB a second.
        'record': ['isal>=1.0'],
        'view': ['matplotlib', 'pillow>=10.1'],
        'test': ['pytest>=7.4', 'hypothesis', 'scipy', 'mpmath', 'rosbags', 'mcap-ros2-support',
                 'catkin_pkg', *LINTERS],
    },
    zip_safe=True,
    entry_points={
        'console_scripts': [
            'rigid_sim_node = rigid_sim_ros.nodes.simulation_node:main',
            'rigid_sim_ros2 = rigid_sim_ros.nodes.ros2_command:main',
            'rigid_sim_recover = rigid_sim_ros.bag_tools.recover:main',
            'rigid_sim_info = rigid_sim_ros.bag_tools.info:main',
            'rigid_sim_replay = rigid_sim_ros.bag_tools.replay:main',
            'rigid_sim_player = rigid_sim_ros.nodes.player:main',
            'rigid_sim_view = rigid_sim_ros.view.command_line:main',
            'rigid_sim_benchmark = rigid_sim_ros.benchmark.main:main',
        ],
    },
)
