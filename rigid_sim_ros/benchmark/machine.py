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

"""What the figures were measured on."""

from datetime import datetime, timezone
from pathlib import Path
import platform

import numpy as np


def machine_facts():
    """Return facts about the machine and the run as a mapping of texts."""
    return {'date': datetime.now(timezone.utc).isoformat(timespec='seconds'),
            'processor': processor_name(),
            'system': platform.platform(),
            'python': platform.python_version(),
            'numpy': np.__version__,
            'threads': '1'}


def processor_name(information=Path('/proc/cpuinfo')):
    """Return the processor's name as the kernel gives it."""
    try:
        lines = information.read_text(encoding='utf-8', errors='replace').splitlines()
    except OSError:
        lines = []
    names = [line.partition(':')[2].strip() for line in lines if line.startswith('model name')]
    return names[0] if names else platform.machine()
