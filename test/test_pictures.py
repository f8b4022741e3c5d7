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

"""The pictures of the documentation are small, and made by commands that are understood."""

from pathlib import Path
import re
import shlex

from rigid_sim_ros.view.command_line import read_arguments

FOLDER = Path(__file__).parents[1] / 'docs' / 'pictures'
LARGEST = 200_000
"""[bytes]; a clone should stay quick."""


def test_every_picture_has_its_command():
    text = (FOLDER / 'README.md').read_text(encoding='utf-8')
    commands = [shlex.split(line) for line in re.findall('^rigid_sim_view .*', text, re.M)]
    made = {read_arguments(arguments).output.name for _, *arguments in commands}
    assert all(str(read_arguments(arguments).output.parent) == 'docs/pictures'
               for _, *arguments in commands)
    there = {path.name for path in FOLDER.iterdir()} - {'README.md'}
    assert made == there == set(re.findall(r'!\[.*?\]\((.*?)\)', text))


def test_pictures_are_small():
    assert {path.name for path in FOLDER.iterdir() if path.stat().st_size > LARGEST} == set()
