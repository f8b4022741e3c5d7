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
Lasting contact: islands of bodies that touch, advanced until they part or rest.

Build an `Island` of its members and of the pairs that may touch, and `advance_island` it step by
step, as long as members and pairs stay the same.
"""

from rigid_sim_ros.engine.lasting_contact.advance import advance_island, FEW, Outcome
from rigid_sim_ros.engine.lasting_contact.bearing import Bearing
from rigid_sim_ros.engine.lasting_contact.island import Island

__all__ = ['advance_island', 'Bearing', 'FEW', 'Island', 'Outcome']
