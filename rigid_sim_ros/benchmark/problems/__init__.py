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
The problems: scenes whose right answer is known, one row each in `PROBLEMS`.

A row has its scene, the times at which poses are read, and the measures that turn readings into
errors. References come from closed forms and exact arithmetic (`benchmark.references`), never from
the engine.
"""

from rigid_sim_ros.benchmark.problems import bounces, collisions, crowds, flight, friction
from rigid_sim_ros.benchmark.problems.problem import FRAME_RATE, Problem

__all__ = ['FRAME_RATE', 'Problem', 'PROBLEMS']

PROBLEMS = {problem.name: problem
            for part in (flight, bounces, collisions, friction, crowds)
            for problem in part.PROBLEMS}
"""Every problem by name, in the order in which they are run and shown."""
