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

"""What the package promises to the tools that install and start it."""

import ast
from importlib.util import find_spec
from pathlib import Path
import re
import runpy
import sys
import types
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).parents[1]
MANIFEST = ElementTree.parse(ROOT / 'package.xml').getroot()

# Names by which rosdep knows what pip calls otherwise.
ROSDEP_KEYS = {
    'matplotlib': 'python3-matplotlib', 'mcap': 'mcap-ros2-support', 'numpy': 'python3-numpy',
    'pillow': 'python3-pil', 'PyYAML': 'python3-yaml', 'tqdm': 'python3-tqdm'}


@pytest.fixture
def setup_arguments(monkeypatch):
    """Return what setup.py hands to setuptools."""
    setuptools = pytest.importorskip('setuptools')
    given = {}
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(setuptools, 'setup', lambda **arguments: given.update(arguments))
    runpy.run_path('setup.py')
    return given


def test_setup_and_manifest_tell_the_same(setup_arguments):
    maintainer = MANIFEST.find('maintainer')
    assert {key: setup_arguments[key] for key in (
        'name', 'version', 'license', 'maintainer', 'maintainer_email')} == {
            'name': MANIFEST.findtext('name'),
            'version': MANIFEST.findtext('version'),
            'license': MANIFEST.findtext('license'),
            'maintainer': maintainer.text,
            'maintainer_email': maintainer.get('email')}


def test_every_folder_with_code_is_installed(setup_arguments):
    folders = {path.parent for path in (ROOT / 'rigid_sim_ros').rglob('*.py')}
    expected = {'.'.join(folder.relative_to(ROOT).parts) for folder in folders}
    assert set(setup_arguments['packages']) == expected


def test_every_shared_file_is_installed_where_ros_looks(setup_arguments):
    installed = {
        f'{target}/{Path(file).name}': file
        for target, files in setup_arguments['data_files'] for file in files}
    expected = {
        'share/ament_index/resource_index/packages/rigid_sim_ros': 'resource/rigid_sim_ros',
        'share/rigid_sim_ros/package.xml': 'package.xml'}
    for folder in ('config', 'launch'):
        for path in (ROOT / folder).rglob('*'):
            if path.is_file() and '__pycache__' not in path.parts:
                name = str(path.relative_to(ROOT))
                expected[f'share/rigid_sim_ros/{name}'] = name
    assert installed == expected
    assert all((ROOT / file).is_file() for file in installed.values())


def test_every_executable_has_its_function(setup_arguments):
    scripts = setup_arguments['entry_points']['console_scripts']
    assert scripts
    for script in scripts:
        module, function = script.split('=')[1].strip().split(':')
        path = ROOT.joinpath(*module.split('.')).with_suffix('.py')
        tree = ast.parse(path.read_text(encoding='utf-8'))
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert function in defined, f'{script}: {path} does not define {function}'


def test_rosdep_installs_what_pip_would(setup_arguments):
    keys = {node.text for node in MANIFEST.findall('exec_depend')}
    lines = setup_arguments['install_requires'] + setup_arguments['extras_require']['view']
    assert {ROSDEP_KEYS[line.split('>')[0].split('=')[0]] for line in lines} <= keys


def test_every_ros_package_in_use_is_a_dependency():
    standard = sys.stdlib_module_names | {'numpy', 'yaml', 'mcap', 'tqdm', 'rigid_sim_ros'}
    imported = set()
    for folder in (ROOT / 'rigid_sim_ros' / 'nodes', ROOT / 'launch'):
        for path in folder.rglob('*.py'):
            for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
                if isinstance(node, ast.Import):
                    imported |= {alias.name.split('.')[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and not node.level:
                    imported.add(node.module.split('.')[0])
    topics = (ROOT / 'rigid_sim_ros' / 'topics.py').read_text(encoding='utf-8')
    imported |= set(re.findall(r"'(\w+)/(?:msg|srv)/\w+'", topics))
    assert {'rclpy', 'geometry_msgs', 'std_srvs'} <= imported
    assert imported - standard <= {node.text for node in MANIFEST.findall('exec_depend')}


class Recorded:
    """Stands for any class of launch: keeps what it was made with."""

    def __init__(self, *positional, **named):
        self.positional = positional
        self.named = named

    def perform(self, context):
        """Return the value of a launch configuration, as the real class does."""
        return context[self.positional[0]]


@pytest.fixture
def launch_file(monkeypatch):
    """Run the launch file, with stand-ins for the modules of launch, and return its names."""
    for module, names in {
            'launch': ['LaunchDescription'],
            'launch.actions': ['DeclareLaunchArgument', 'OpaqueFunction'],
            'launch.conditions': ['IfCondition'],
            'launch.substitutions': ['LaunchConfiguration', 'PathJoinSubstitution'],
            'launch_ros': [],
            'launch_ros.actions': ['Node'],
            'launch_ros.parameter_descriptions': ['ParameterValue'],
            'launch_ros.substitutions': ['FindPackageShare']}.items():
        stand_in = types.ModuleType(module)
        for name in names:
            setattr(stand_in, name, type(name, (Recorded,), {}))
        monkeypatch.setitem(sys.modules, module, stand_in)
    return runpy.run_path(str(ROOT / 'launch' / 'rigid_sim.launch.py'))


def launched_node(launch_file, **arguments):
    defaults = {'scene': '', 'record': '', 'params_file': 'parameters.yaml', 'rviz': 'false'}
    node, = launch_file['simulation_node'](defaults | arguments)
    return node.named


def test_launch_starts_the_installed_executable(launch_file, setup_arguments):
    node = launched_node(launch_file)
    assert node['package'] == setup_arguments['name']
    scripts = setup_arguments['entry_points']['console_scripts']
    assert node['executable'] in {script.split('=')[0].strip() for script in scripts}


def test_launch_leaves_the_parameters_file_alone_unless_told(launch_file):
    file, = launched_node(launch_file)['parameters']
    assert file.positional == ('params_file',)


@pytest.mark.parametrize('name, value, value_type', [
    ('scene', 'real_toss', str), ('record', 'true', bool), ('record', 'false', bool)])
def test_launch_argument_overrules_the_parameters_file(launch_file, name, value, value_type):
    _, overrules = launched_node(launch_file, **{name: value})['parameters']
    assert list(overrules) == [name]
    assert overrules[name].positional[0].positional == (name,)
    assert overrules[name].named == {'value_type': value_type}


def test_launch_files_named_by_default_are_shipped(launch_file):
    description, = launch_file['generate_launch_description']().positional
    arguments = {
        action.positional[0]: action.named for action in description
        if type(action).__name__ == 'DeclareLaunchArgument'}
    assert set(arguments) == {'scene', 'params_file', 'record', 'rviz'}
    for action in description:
        for path in [action.named.get('default_value'), *action.named.get('arguments', [])]:
            if isinstance(path, Recorded):
                folder, *names = path.positional[0]
                share, config = folder.positional[0]
                assert share.positional == ('rigid_sim_ros',)
                assert ROOT.joinpath(config, *names).is_file()


@pytest.mark.skipif(find_spec('launch_ros') is None, reason='launch is not installed')
def test_launch_file_is_accepted_by_launch():
    from launch import LaunchContext
    from launch.actions import DeclareLaunchArgument

    names = runpy.run_path(str(ROOT / 'launch' / 'rigid_sim.launch.py'))
    context = LaunchContext()
    context.launch_configurations.update(params_file='parameters.yaml', scene='', record='true')
    node, = names['simulation_node'](context)
    assert node.node_executable == 'rigid_sim_node'
    entities = names['generate_launch_description']().entities
    declared = [entity for entity in entities if isinstance(entity, DeclareLaunchArgument)]
    assert [argument.name for argument in declared] == ['scene', 'params_file', 'record', 'rviz']
