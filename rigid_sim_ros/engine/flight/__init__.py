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
Flight: where bodies are between contacts, as formulas of time.

`Flights` is all that the rest of the engine uses. Inside, one module a kind of motion:
`translations`; `fixed_axis`; `free_rotation` by theta functions, from the `polhode` in the form
`trigonometric` or `hyperbolic`; `driven_rotation` by power series, of which `equal_moments` and
`unequal_moments` are the two laws.
"""

from rigid_sim_ros.engine.flight.flights import Flights

__all__ = ['Flights']
