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
The order of each method, measured by halving the step.

'report' and 'stepped' are of first order: half the step, half the error. 'exact' has no step in
flight: another `max_step` changes nothing, not even the last bit.
"""

import numpy as np
import pytest
from rigid_sim_ros.benchmark.engines import ENGINES
from rigid_sim_ros.benchmark.problems import PROBLEMS
from rigid_sim_ros.benchmark.trajectories import record
from rigid_sim_ros.scene import load_scene

RATES = (240, 480, 960)


def trajectory(problem, method, rate):
    engine = ENGINES[method].load()
    engine.build(load_scene(problem.scene()), 1 / rate, sleeping=False)
    # a tenth of the time, before any angle comes round
    return record(engine, (1.0,))


def order(problem, method, measure):
    errors = [problem.measure(trajectory(problem, method, rate))[measure] for rate in RATES]
    return np.polyfit(np.log(RATES), -np.log(errors), 1)[0]


@pytest.mark.parametrize('method', ['stepped', 'report'])
@pytest.mark.parametrize('measure', ['angle_error_rad', 'position_error_m'])
def test_order_under_a_constant_wrench(method, measure):
    # of errors in these two steps, the part of second order bends the line by 2 % at most
    assert order(PROBLEMS['constant_wrench'], method, measure) == pytest.approx(1.0, abs=0.03)


def test_order_of_stepped_in_a_driven_box():
    assert order(PROBLEMS['driven_box'], 'stepped', 'angle_error_rad') == pytest.approx(1.0,
                                                                                        abs=0.05)


@pytest.mark.parametrize('name', ['constant_wrench', 'driven_box', 'tumbling_boxes'])
def test_exact_does_not_depend_on_the_step_in_flight(name):
    first, second = (trajectory(PROBLEMS[name], 'exact', rate) for rate in (10, 1000))
    for part in ('position', 'orientation', 'linear_velocity', 'angular_velocity'):
        np.testing.assert_array_equal(getattr(first, part), getattr(second, part))
