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

"""Every file says whose it is and under which licence."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ('rigid_sim_ros', 'test', 'launch')
SOURCES = sorted(
    [ROOT / 'setup.py', *(file for folder in FOLDERS for file in (ROOT / folder).rglob('*.py'))])
COPYRIGHT = '# Copyright 2026 The rigid_sim_ros authors\n'


def licence_notice():
    """Return the notice that the appendix of the licence says to attach, as comment lines."""
    text = (ROOT / 'LICENSE').read_text(encoding='utf-8')
    start = text.index('   Licensed under the Apache License', text.index('APPENDIX'))
    lines = [line.strip() for line in text[start:].rstrip().splitlines()]
    return ''.join(f'# {line}'.rstrip() + '\n' for line in lines)


@pytest.mark.parametrize('path', SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_file_starts_with_copyright_and_licence(path):
    words = path.read_text(encoding='utf-8').split()
    expected = (COPYRIGHT + '#\n' + licence_notice()).split()
    # Compared word by word, because the notice may be wrapped at another column.
    given = [word for word in words[:2 * len(expected)] if word != '#']
    expected = [word for word in expected if word != '#']
    assert given[:len(expected)] == expected


@pytest.mark.copyright
@pytest.mark.linter
def test_ament_copyright(monkeypatch):
    main = pytest.importorskip('ament_copyright.main').main
    monkeypatch.chdir(ROOT)
    assert main(argv=[*FOLDERS, 'LICENSE', 'CONTRIBUTING.md']) == 0
