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

"""The layouts for RViz and Foxglove show topics that are there, with the quality they have."""

import json
import re

import pytest
from rigid_sim_ros import topics
from rigid_sim_ros.shared_files import config_folder
import yaml

PUBLISHED = {topics.resolve(row.name): row for row in topics.PUBLISHED}

RVIZ_TYPES = {
    'rviz_default_plugins/MarkerArray': 'visualization_msgs/msg/MarkerArray',
    'rviz_default_plugins/PoseArray': 'geometry_msgs/msg/PoseArray',
    'rviz_default_plugins/PointCloud2': 'sensor_msgs/msg/PointCloud2'}


def test_rviz_displays():
    path = config_folder() / 'rviz' / 'rigid_sim.rviz'
    manager = yaml.safe_load(path.read_text(encoding='utf-8'))['Visualization Manager']
    assert manager['Global Options']['Fixed Frame'] == topics.Source(None).frame_id
    displays = [display for display in manager['Displays'] if 'Topic' in display]
    assert {display['Topic']['Value'] for display in displays} >= {
        '/rigid_sim/markers', '/rigid_sim/poses'}
    for display in displays:
        topic = display['Topic']
        published = PUBLISHED[topic['Value']]
        assert published.type_name == RVIZ_TYPES[display['Class']]
        assert topic['Reliability Policy'].lower() == published.quality.reliability
        assert topic['Durability Policy'].lower() == published.quality.durability
        assert topic['Depth'] == published.quality.depth


def foxglove():
    path = config_folder() / 'foxglove' / 'rigid_sim.json'
    return json.loads(path.read_text(encoding='utf-8'))


def test_every_foxglove_panel_has_its_place_and_its_settings():
    layout = foxglove()

    def panels(node):
        return [node] if isinstance(node, str) else panels(node['first']) + panels(node['second'])

    assert sorted(panels(layout['layout'])) == sorted(layout['configById'])


def test_foxglove_paths_lead_to_numbers_and_texts():
    panels = foxglove()['configById']
    shown = {*panels['3D!bodies']['topics'], panels['DiagnosticSummary!node']['topicToRender']}
    paths = [path['value'] for panel in panels.values() for path in panel.get('paths', ())]
    paths.append(panels['RawMessages!collisions']['topicPath'])
    assert shown | {path.split('.')[0] for path in paths} <= set(PUBLISHED)
    for path in paths:
        topic, _, fields = path.partition('.')
        assert leads_somewhere(PUBLISHED[topic].type_name, fields)


def message_class(type_name):
    package, *_, name = type_name.split('/')
    return getattr(pytest.importorskip(f'{package}.msg'), name)


def leads_somewhere(type_name, fields):
    """Follow a path through the definitions of messages, as far as a number or text."""
    for field in fields.split('.'):
        types = message_class(type_name).get_fields_and_field_types()
        field = re.sub(r'\[[0-9]+\]$', '', field)
        if field not in types:
            return False
        type_name = re.sub(r'^sequence<(.*)>$', r'\1', types[field])
    return '/' not in type_name
