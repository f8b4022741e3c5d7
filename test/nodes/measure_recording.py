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
What recording costs: a node's share of a core with it and without, and whether it keeps up.

    python test/nodes/measure_recording.py [DURATION]

Cubes drift without touching, each with a motion of its own, nobody subscribes. Each figure is of
so many seconds [s] (5) of wall time. The folder for temporary files needs room: a thousand cubes
at 1 kHz fill 60 MB a second.
"""

import os
from pathlib import Path
import signal
import sys
import tempfile
import time

from measure_publishing import processor_time
from measure_stages import drifting
from node_harness import NodeProcess
import numpy as np
import yaml

COUNTS = (5, 2, 1), (5, 5, 4), (10, 10, 10)
"""Of cubes along x, y and z."""

RATE = 1000.0
"""States a second [Hz]."""

SETTLING = 1.5
"""Wall time [s] from the start of a node on before it is measured."""


def measure(count, record, duration):
    """Return the processor time [s] a second, and the simulated seconds recorded in one."""
    with tempfile.TemporaryDirectory() as folder:
        path, bag = Path(folder) / 'drift.yaml', Path(folder) / 'bag'
        path.write_text(drifting(count))
        with NodeProcess(folder, scene=path, publish_rate=RATE, record=record,
                         record_path=bag) as process:
            process.wait_for_text('try, in another terminal')
            start = time.monotonic()
            time.sleep(SETTLING)
            begin, before = time.monotonic(), processor_time(process.process.pid)
            time.sleep(duration)
            end, after = time.monotonic(), processor_time(process.process.pid)
            process.stop(signal.SIGINT)
        share = (after - before) / (end - begin)
        if not record:
            return share, None
        about = yaml.safe_load((bag / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
        return share, about['duration']['nanoseconds'] / 1e9 / (end - start)


def main(duration):
    """Print a table."""
    print('| cubes | node, of a core | while it records | real-time factor while it does |')
    print('| --- | --- | --- | --- |')
    for count in COUNTS:
        without, _ = measure(count, False, duration)
        share, factor = measure(count, True, duration)
        print(f'| {np.prod(count)} | {without:.1%} | {share:.1%} | {factor:.2f} |', flush=True)


if __name__ == '__main__':
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    main(float(sys.argv[1]) if sys.argv[1:] else 5.0)
