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
Start the simulator: `ros2 launch rigid_sim_ros rigid_sim.launch.py scene:=ten_cubes`.

An argument that is left empty leaves the matter to the parameters file.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'rigid_sim_ros'
PARAMETER_ARGUMENTS = {'scene': str, 'record': bool}


def simulation_node(context):
    """Return the node; arguments that were given overrule the parameters file."""
    given = {
        name: ParameterValue(LaunchConfiguration(name), value_type=value_type)
        for name, value_type in PARAMETER_ARGUMENTS.items()
        if LaunchConfiguration(name).perform(context)}
    return [Node(
        package=PACKAGE,
        executable='rigid_sim_node',
        name='rigid_sim',
        output='screen',
        parameters=[LaunchConfiguration('params_file'), *([given] if given else [])])]


def generate_launch_description():
    """Return the node and, if asked for, RViz showing its markers."""
    config = PathJoinSubstitution([FindPackageShare(PACKAGE), 'config'])
    return LaunchDescription([
        DeclareLaunchArgument(
            'scene', default_value='',
            description='Name of a shipped scene or path of a scene file'),
        DeclareLaunchArgument(
            'params_file', default_value=PathJoinSubstitution([config, 'rigid_sim.yaml']),
            description='Parameters of the node'),
        DeclareLaunchArgument(
            'record', default_value='', choices=['', 'true', 'false'],
            description='Record from the start'),
        DeclareLaunchArgument(
            'rviz', default_value='false', choices=['true', 'false'],
            description='Show the bodies in RViz'),
        OpaqueFunction(function=simulation_node),
        Node(
            package='rviz2',
            executable='rviz2',
            output='screen',
            arguments=['-d', PathJoinSubstitution([config, 'rviz', 'rigid_sim.rviz'])],
            condition=IfCondition(LaunchConfiguration('rviz'))),
    ])
