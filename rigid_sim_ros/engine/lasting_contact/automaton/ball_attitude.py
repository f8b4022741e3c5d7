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
The attitude of a ball, on which nothing else depends: it follows from the spin afterwards.

So a ball that spins fast costs no more steps than one that does not.
"""

from math import ceil, cos, sin, sqrt

from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import (
    cross, normalized, ORIENTATION, POSITION, SPIN)

_ERROR = 1e-10
"""[rad] of one step."""

_SMALL = 1e-4
"""Of the product it is estimated from: the error of a piece, measured."""


def turned_on(start, state, between, time):
    """
    Return the state after a time [s] with the attitude that its spins since `start` give.

    Magnus' series to fourth order (Iserles et al. 2000, 'Lie-group methods', section 5), in as
    many pieces as the change of the spin asks for: a constant one takes one, however fast it is.
    `between` gives the states at the times before.
    """
    change = [after - before for before, after in zip(start[SPIN], state[SPIN])]
    angle = time * max(_length(start[SPIN]), _length(state[SPIN]))
    error = _SMALL * angle ** 3 * time * _length(change)
    pieces = ceil((error / _ERROR) ** 0.25) or 1
    size = time / pieces
    attitude, before = start[ORIENTATION], start[SPIN]
    for piece in range(pieces):
        middle = between((piece + 0.5) * size)[SPIN]
        after = state[SPIN] if piece == pieces - 1 else between((piece + 1) * size)[SPIN]
        attitude, before = _turned(attitude, before, middle, after, size), after
    return normalized([*state[POSITION], *attitude, *state[7:]])


def _turned(attitude, before, middle, after, time):
    """Return a quaternion after a piece of time [s] with these spins at its start, half, end."""
    p, q, r = (0.5 * time * ((a + 4.0 * b + c) / 6.0 + time * d / 12.0)
               for a, b, c, d in zip(before, middle, after, cross(after, before)))
    angle = _length((p, q, r))
    share = sin(angle) / angle if angle else 1.0
    p, q, r, s = p * share, q * share, r * share, cos(angle)
    x, y, z, w = attitude
    return (s * x + p * w + q * z - r * y, s * y + q * w + r * x - p * z,
            s * z + r * w + p * y - q * x, s * w - p * x - q * y - r * z)


def _length(vector):
    """Return the length of a triple."""
    x, y, z = vector
    return sqrt(x * x + y * y + z * z)
