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

from importlib.metadata import PackageNotFoundError, version
import platform

import numpy


def package_version():
    """Return the version of this package, for the header of a file."""
    try:
        return version('rigid_sim_ros')
    except PackageNotFoundError:
        return 'unknown'


def software():
    """Return what besides a scene and its options can change the last bit of a result."""
    return {'version': package_version(), 'numpy': numpy.__version__,
            'machine': platform.machine()}
