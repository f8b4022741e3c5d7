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
The methods a simulation can use: a file and a row of `METHODS` each.

A method is made of a `World`, a `State` and the time [s] of that state. It has `time`, `state`
(all of it at that time), `advance(duration, until_collision)`,
`set_motion(indices, **quantities)`, `set_wrench(indices, force, torque)` and `asleep`.
"""

from rigid_sim_ros.engine.methods.exact import Exact
from rigid_sim_ros.engine.methods.report import Report
from rigid_sim_ros.engine.methods.stepped import Stepped

METHODS = {'exact': Exact, 'stepped': Stepped, 'report': Report}
"""Every method by its name."""
