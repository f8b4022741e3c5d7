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

"""The profile that gives large messages room in shared memory is one that Fast DDS takes."""

from pathlib import Path

import pytest

pytest.importorskip('rclpy')

from node_harness import Client, NodeProcess, ROOT  # noqa: E402, I100
from rclpy.utilities import get_rmw_implementation_identifier  # noqa: E402
from rigid_sim_ros.messages import decode_pose_array  # noqa: E402

PROFILE = ROOT / 'config' / 'fastdds' / 'large_messages.xml'

ROOM = 16 * 1024 ** 2
"""Of shared memory [bytes]; half a megabyte without the profile."""

SCENE = """
gravity: [0, 0, 0]
bodies:
  - {name: cube, cube: {edge: 0.2}, mass: 1.0, velocity: [0.1, 0, 0],
     repeat: {count: [25, 20, 20], spacing: [0.5, 0.5, 0.5]}}
"""


def shared_memory(pid):
    """Return the size [bytes] of the largest piece of memory a process shares by Fast DDS."""
    largest = 0
    for line in Path(f'/proc/{pid}/maps').read_text().splitlines():
        if '/dev/shm/fastrtps_' in line:
            start, end = (int(address, 16) for address in line.split()[0].split('-'))
            largest = max(largest, end - start)
    return largest


@pytest.mark.skipif(get_rmw_implementation_identifier() != 'rmw_fastrtps_cpp',
                    reason='for Fast DDS')
def test_poses_of_ten_thousand_bodies_have_room(tmp_path, monkeypatch):
    """Who reads them needs no profile."""
    scene = tmp_path / 'drift.yaml'
    scene.write_text(SCENE)
    with monkeypatch.context() as patch:
        patch.setenv('FASTRTPS_DEFAULT_PROFILES_FILE', str(PROFILE))
        process = NodeProcess(tmp_path / 'node', scene=scene)
    with process, Client(process) as client:
        received = client.listen('~/poses', raw=True)
        client.spin_until(lambda: received, 'poses')
        assert decode_pose_array(received[0]).position.shape == (10000, 3)
        assert ROOM <= shared_memory(process.process.pid) < 2 * ROOM
        assert 'XMLPARSER' not in process.error
