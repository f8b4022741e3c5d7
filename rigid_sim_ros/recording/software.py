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

"""What makes a recording, besides its scene and options."""

from functools import lru_cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
import platform

import numpy

_PACKAGE = Path(__file__).resolve().parents[1]

_DECIDING = ('engine', 'messages', 'nodes', 'scene')
"""Folders of the package with code that what is simulated again depends on."""


def package_version():
    """Return the version of this package, for the header of a file."""
    try:
        return version('rigid_sim_ros')
    except PackageNotFoundError:
        return 'unknown'


def software():
    """Return what besides a scene and its options can change the last bit of a result."""
    return {'version': package_version(), 'code': digest_of_code(),
            'numpy': numpy.__version__, 'machine': platform.machine()}


@lru_cache(maxsize=None)
def digest_of_code(package=_PACKAGE):
    """
    Return a number that tells code from other code of the same version, hexadecimal.

    Of the sources in the package's folder as they are when this is called first.
    """
    digest = sha256()
    for path in sorted(path for folder in _DECIDING for path in (package / folder).rglob('*.py')):
        # parted by what no source holds
        digest.update(path.relative_to(package).as_posix().encode() + b'\0')
        digest.update(path.read_bytes() + b'\0')
    return digest.hexdigest()[:12]
