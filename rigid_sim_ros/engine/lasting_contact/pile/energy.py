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
What the impulses of a pile's step may do: never add energy, however well they are solved for.

In scaled velocities kinetic energy is half a square. A step from v by the kick k of the forces and
the change c of the contacts, which moves bodies at v + s (k + c) with a share s of each, raises
kinetic and potential energy together by

    c . (v + (1 - s) k) + (c . c - (2 s - 1) k . k) / 2,

since the potential falls by k . (v + s (k + c)). It is not positive where contacts have closed by
a converged solution. One that has not converged is only followed so far that it is not.
"""

from math import sqrt


def kept_part(before, kick, change, share):
    """
    Return (how much of a change (n,) of scaled velocities may be made, the energy lost then [J]).

    Bodies move at a share (n,) of what they gain. Momenta are kept whatever the part.
    """
    along, size = float(change @ (before + (1.0 - share) * kick)), float(change @ change)
    allowed = float(kick @ ((2.0 * share - 1.0) * kick))
    part = 1.0
    if 2.0 * along + size > allowed:
        part = (sqrt(along * along + size * allowed) - along) / size
    return part, max(0.0, 0.5 * (allowed - part * (2.0 * along + part * size)))


def rebound_part(velocity, change, lost):
    """
    Return how much of a change (n,) of scaled velocities may be made that gives energy back.

    No more than what was lost [J]; poses do not change with it.
    """
    along, size = float(change @ velocity), float(change @ change)
    if 2.0 * along + size <= 2.0 * lost:
        return 1.0
    return max(0.0, (sqrt(along * along + 2.0 * size * lost) - along) / size)
