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

"""A small recording for the tests here: made anew for each, or once as a folder to copy."""

from dataclasses import replace
import time

import numpy as np
import pytest
from rigid_sim_ros import messages, topics
from rigid_sim_ros.recording import Recorder

NAMES = ('cube_a', 'cube_b', 'cube_c')
SCENE = 'gravity: [0, 0, -9.81]\n'
OPTIONS = {'names': NAMES, 'all_names': [*NAMES, 'ground'], 'method': 'exact'}


class Run:
    """Made-up states of three bodies, whose every number tells where it comes from."""

    names = NAMES
    scene = SCENE
    options = OPTIONS
    rows = tuple(replace(row, name=topics.resolve(row.name))
                 for row in (*topics.PUBLISHED, *topics.COMMANDS, topics.JOURNAL))

    def __init__(self):
        self._poses = messages.PoseArrayEncoder('world', 3)
        self._states = messages.MultiDOFJointStateEncoder('world', NAMES)
        self._collisions = messages.CollisionEncoder('world')

    @staticmethod
    def values(step, width, kind):
        """Return (3, width) numbers of a step, different for each kind of quantity."""
        return np.arange(3.0 * width).reshape(3, width) + 100 * kind + 0.1 * step

    def poses(self, step, time_ns):
        return self._poses.encode(time_ns, self.values(step, 3, 0), self.values(step, 4, 1))

    def states(self, step, time_ns):
        return self._states.encode(
            time_ns, self.values(step, 3, 0), self.values(step, 4, 1),
            *(self.values(step, 3, kind) for kind in (2, 3, 4, 5)))

    def events(self, time_ns):
        event = (time_ns / 1e9 - 0.001, 0, 3, 0, (1, 2, 3), (0, 0, -1), (0, 0, 0.1), 2.5)
        return np.array([event], dtype=messages.COLLISION_TYPE)

    def collisions(self, time_ns):
        return self._collisions.encode(time_ns, self.events(time_ns))

    def write(self, recorder, first, last, period_ns=10_000_000):
        """Write the states of steps from first to last, and an event every ten."""
        for step in range(first, last):
            time_ns = step * period_ns
            recorder.write('/rigid_sim/poses', time_ns, self.poses(step, time_ns))
            recorder.write('/rigid_sim/states', time_ns, self.states(step, time_ns))
            if step % 10 == 5:
                recorder.write('/rigid_sim/collisions', time_ns, self.collisions(time_ns))

    def recorder(self, path, **options):
        return Recorder(path, self.rows, **{'scene': SCENE, 'options': OPTIONS, **options})


@pytest.fixture(scope='session')
def run():
    return Run()


@pytest.fixture(scope='session')
def bag(run, tmp_path_factory):
    """Return a sound bag of 100 steps in several chunks; tests must not change it."""
    path = tmp_path_factory.mktemp('bags') / 'sound'
    recorder = run.recorder(path, chunk_seconds=0.1)
    recorder.write('/rigid_sim/scene', 0, messages.encode_string(SCENE))
    for part in range(4):
        run.write(recorder, 25 * part, 25 * part + 25)
        wait_until(lambda part=part: recorder.state().message_count >= 52 * part + 50)
    state = recorder.close()
    assert (state.phase, state.error, state.dropped_count) == ('closed', '', 0)
    return path


def wait_until(condition, seconds=10.0):
    """Wait until a condition is true, at most so long."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, 'waited in vain'
        time.sleep(0.01)
