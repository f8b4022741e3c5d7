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

"""Control of a session at the pace of parameters, without ROS's machinery."""

from types import SimpleNamespace

import pytest

pytest.importorskip('rclpy')

from rigid_sim_ros.engine import Simulation  # noqa: E402, I100
from rigid_sim_ros.nodes.control import Control  # noqa: E402
from rigid_sim_ros.nodes.session import Session  # noqa: E402
from rigid_sim_ros.nodes.signals import StopRequest  # noqa: E402
from rigid_sim_ros.scene import load_scene  # noqa: E402

MICROSECOND = 1000

SCENE = {'gravity': [0, 0, 0], 'bodies': [{'name': 'one', 'cube': {'edge': 0.2}, 'mass': 2.0}]}


class Parameters(SimpleNamespace):
    """Values that change when told to."""

    def when_changed(self, name, action):
        self.actions[name] = action

    def change(self, name, value):
        setattr(self, name, value)
        self.actions[name]()


@pytest.fixture
def parameters():
    return Parameters(start_paused=True, real_time_factor=1.0, publish_rate=100.0,
                      pause_on_collision=False, step_duration=0.0034, actions={})


def test_only_another_rate_begins_another_grid(parameters):
    times = []
    session = Session(Simulation(load_scene(SCENE)), 100.0, lambda time, _: times.append(time))
    control = Control(session, parameters, StopRequest(), lambda: 0.0, None)
    control.step()
    parameters.change('real_time_factor', 2.0)
    session.advance()
    assert times == [3400 * MICROSECOND, 10_000 * MICROSECOND]
    control.step()
    parameters.change('publish_rate', 50.0)
    session.advance()
    assert times[2:] == [13_400 * MICROSECOND, 33_400 * MICROSECOND]
