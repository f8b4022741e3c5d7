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

"""The pace of the running node: on time, and after a stall without a burst and without a lie."""

import signal
import time

import numpy as np
import pytest

pytest.importorskip('rclpy')

from node_harness import Client, nanoseconds, NodeProcess  # noqa: E402, I100

PERIOD = 10_000_000

MISSED, GIVEN_UP = 'missed deadlines, in all', 'wall time given up, in all [s]'


def value(diagnostics, key):
    """Return a number of the latest diagnostics."""
    return next(float(value.value) for status in diagnostics[-1].status
                for value in status.values if value.key == key)


def offset(poses):
    """Return wall time minus simulated time [s] at the arrival of the latest state."""
    return time.monotonic() - nanoseconds(poses[-1]) / 1e9


@pytest.fixture(scope='module')
def running(tmp_path_factory):
    folder = tmp_path_factory.mktemp('pace')
    with NodeProcess(folder, scene='report_dynamics') as process, Client(process) as client:
        poses, diagnostics = client.listen('~/poses'), client.listen('/diagnostics')
        client.spin_until(lambda: len(poses) > 20 and diagnostics, 'states')
        yield process, client, poses, diagnostics


def test_stall_is_caught_up_and_counted(running):
    process, client, poses, diagnostics = running
    before, missed = offset(poses), value(diagnostics, MISSED)
    process.process.send_signal(signal.SIGSTOP)
    client.spin(0.5)
    process.process.send_signal(signal.SIGCONT)
    # half a second is caught up at twice the speed, so in half a second
    client.spin_until(lambda: offset(poses) < before + 0.1, 'it to catch up')
    client.spin_until(lambda: value(diagnostics, MISSED) >= missed + 30, 'counts')
    assert value(diagnostics, GIVEN_UP) == 0.0
    # every state was published, none twice
    times = np.array([nanoseconds(message) for message in poses])
    assert np.unique(np.diff(times)).tolist() == [PERIOD]


def test_long_stall_moves_the_schedule_and_is_said(running):
    process, client, poses, diagnostics = running
    before = offset(poses)
    process.process.send_signal(signal.SIGSTOP)
    client.spin(1.7)
    process.process.send_signal(signal.SIGCONT)
    process.wait_for_text('simulated time fell')
    client.spin_until(
        lambda: diagnostics and value(diagnostics, GIVEN_UP) > 0, 'counts')
    given_up = value(diagnostics, GIVEN_UP)
    assert 1.0 < given_up < 3.0
    client.spin(0.3)
    # simulated time lags by what was given up, and goes on without a gap
    assert abs(offset(poses) - before - given_up) < 0.5
    times = np.array([nanoseconds(message) for message in poses])
    assert np.unique(np.diff(times)).tolist() == [PERIOD]
