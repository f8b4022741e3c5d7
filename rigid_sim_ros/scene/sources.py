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

"""Where a scene comes from: a file, a shipped scene by its name, or text."""

import os
from pathlib import Path

from rigid_sim_ros.scene.errors import listed, nearest, SceneError
from rigid_sim_ros.shared_files import config_folder

SUFFIX = '.yaml'


def shipped_scenes():
    """Return the names of the shipped scenes, sorted."""
    return sorted(path.stem for path in _scenes_folder().glob('*' + SUFFIX))


def scene_text(source):
    """
    Return (text, label) of a scene given as path, name or text; the label starts messages.

    Text is what has a line break in it; a path has a / or ends in .yaml or .yml (or is a Path);
    ~ is the user's home.
    """
    if not isinstance(source, (str, Path)):
        raise TypeError(f'a scene is a path, a name, text or a dict, not {type(source).__name__}')
    if isinstance(source, str) and '\n' in source:
        return source, 'scene'
    if isinstance(source, Path) or '/' in source or source.endswith((SUFFIX, '.yml')):
        return _file_text(Path(os.path.expanduser(source))), str(source)
    path = _scenes_folder() / (source + SUFFIX)
    names = shipped_scenes()
    if source not in names:
        raise SceneError(f'no shipped scene is named {source!r}{nearest(source, names)}; '
                         f'they are {listed(names)} (a path has a / or ends in {SUFFIX})')
    return _file_text(path), str(path)


def _scenes_folder():
    return config_folder() / 'scenes'


def _file_text(path):
    try:
        content = _file_bytes(path)
    except FileNotFoundError:
        raise SceneError(f'{path}: no such file') from None
    except (OSError, ValueError) as error:
        # a ValueError is what open() has for a path with a NUL character
        reason = getattr(error, 'strerror', None) or error
        raise SceneError(f'{path}: cannot be read: {reason}') from None
    if content is None:
        kind = 'a folder' if path.is_dir() else 'not a regular file'
        raise SceneError(f'{path}: {kind}; a scene is a YAML file')
    try:
        return content.decode('utf-8-sig')
    except UnicodeDecodeError as error:
        raise SceneError(f'{path}: not UTF-8 text: byte {error.object[error.start]:#04x} '
                         f'at offset {error.start}') from None


def _file_bytes(path):
    """Return the content of a file, or None of what has none or no end: folders, devices."""
    if path.exists() and not path.is_file():
        return None
    return path.read_bytes()
