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

"""The layers of the package: who may import whom, and what every file keeps to."""

import ast
from pathlib import Path
import sys

import pytest

ROOT = Path(__file__).parents[1] / 'rigid_sim_ros'
FILES = sorted(ROOT.rglob('*.py'))
LONGEST_FILE = 300

ROS_PACKAGES = {
    'builtin_interfaces', 'diagnostic_msgs', 'geometry_msgs', 'launch', 'launch_ros',
    'rcl_interfaces', 'rclpy', 'rosgraph_msgs', 'rosidl_runtime_py', 'sensor_msgs', 'std_msgs',
    'std_srvs', 'tf2_msgs', 'tf2_ros', 'visualization_msgs'}

# What each part may import of this package. A part is a folder or a module directly below it.
MAY_IMPORT = {
    'engine': set(),
    'messages': set(),
    'shared_files': set(),
    'recording': {'messages', 'shared_files'},
    'scene': {'engine', 'shared_files'},
    'topics': {'engine', 'messages', 'shared_files'},
    'benchmark': {'engine', 'scene', 'shared_files'},
    'view': {'engine', 'scene', 'messages', 'recording', 'shared_files'},
    'bag_tools': {'engine', 'messages', 'nodes', 'recording', 'scene', 'shared_files', 'topics'},
    'nodes': {'engine', 'messages', 'recording', 'scene', 'shared_files', 'topics'},
}


def name_of(path):
    return str(path.relative_to(ROOT))


def part_of(path):
    """Return the part a file belongs to: 'engine' for engine/flight.py, 'scene' for scene.py."""
    return path.relative_to(ROOT).with_suffix('').parts[0]


def imported_modules(tree, path):
    """Return the full names of all modules that a file imports, wherever it does so."""
    package = ['rigid_sim_ros', *path.relative_to(ROOT).parts[:-1]]
    modules = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            modules += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[:len(package) + 1 - node.level] if node.level else []
            module = '.'.join(base + ([node.module] if node.module else []))
            modules += [f'{module}.{alias.name}' for alias in node.names]
    return modules


def imports(path):
    return imported_modules(ast.parse(path.read_text(encoding='utf-8')), path)


def public_definitions(tree):
    """Return the public functions, classes and methods of a module, the nested ones left out."""
    found = []
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            if not node.name.startswith('_'):
                found.append(node)
                if isinstance(node, ast.ClassDef):
                    found += public_definitions(node)
    return found


def is_setter(node):
    """Tell whether a method is the setter of a property, which has its getter's docstring."""
    return any(isinstance(decorator, ast.Attribute) and decorator.attr == 'setter'
               for decorator in node.decorator_list)


every_file = pytest.mark.parametrize('path', FILES, ids=name_of)


def test_the_files_are_found():
    assert {'engine/model.py', 'shared_files.py'} <= {name_of(path) for path in FILES}


@pytest.mark.parametrize('source, expected', [
    ('import rclpy.node', ['rclpy.node']),
    ('def f():\n    from rclpy import qos', ['rclpy.qos']),
    ('from .. import scene', ['rigid_sim_ros.scene']),
    ('from . import flight', ['rigid_sim_ros.engine.flight']),
    ('from ..nodes.player import main', ['rigid_sim_ros.nodes.player.main']),
])
def test_imports_are_seen_in_every_form(source, expected):
    assert imported_modules(ast.parse(source), ROOT / 'engine' / 'any.py') == expected


@every_file
def test_imports_go_down_only(path):
    part = part_of(path)
    if part == '__init__':
        assert imports(path) == []
        return
    allowed = MAY_IMPORT[part] | {part}
    inside = [name for name in imports(path) if name.split('.')[0] == 'rigid_sim_ros']
    assert [name for name in inside if name.split('.')[1] not in allowed] == []


@every_file
def test_only_nodes_know_ros(path):
    if part_of(path) == 'nodes':
        return
    assert ROS_PACKAGES.isdisjoint(name.split('.')[0] for name in imports(path))


@pytest.mark.parametrize(
    'path', [path for path in FILES if part_of(path) == 'engine'], ids=name_of)
def test_engine_needs_numpy_alone_and_is_silent(path):
    tree = ast.parse(path.read_text(encoding='utf-8'))
    packages = {name.split('.')[0] for name in imported_modules(tree, path)}
    assert packages <= {'numpy', 'rigid_sim_ros'} | sys.stdlib_module_names
    assert packages.isdisjoint({'logging', 'warnings'})
    assert 'print' not in {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    assert not {'stdout', 'stderr'} & {
        node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}


@every_file
def test_what_is_public_is_documented(path):
    tree = ast.parse(path.read_text(encoding='utf-8'))
    if path.name != '__init__.py':
        assert ast.get_docstring(tree), 'the module has no docstring'
    assert [f'line {node.lineno}: {node.name}' for node in public_definitions(tree)
            if not is_setter(node) and not ast.get_docstring(node)] == []


@every_file
def test_file_is_short_enough_to_read(path):
    assert len(path.read_text(encoding='utf-8').splitlines()) <= LONGEST_FILE


def test_no_two_test_files_have_the_same_name():
    # pytest imports them all as top-level modules: a second `samples` would be the first one.
    names = [path.name for path in Path(__file__).parent.rglob('*.py')]
    assert {name for name in names if names.count(name) > 1} <= {'conftest.py', '__init__.py'}
