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
What happens to a run besides commands: lines of the topic `~/journal`, in recordings only.

A run can be simulated again from its recording if that holds, in the order in which they
happened and stamped with the simulated time [ns] at which they took effect:

* every state, on `~/poses`: the simulation is advanced from stamp to stamp;
* every command, on its own topic, the bytes as they were received, written when it takes effect
  (not when it arrives, if it waits for its stamp), before the state that first shows it;
* on `~/journal`, a `parameters` line at the start and whenever one of them is changed; a `reset`
  line for every reset; an `add`, `remove` or `place` line for every body that was added, taken
  out or placed; each before the first state that shows it; a `collision` line before every state
  that was published because bodies came together, with the time that was simulated towards;
* what happened before, from the time at which the scene was loaded or last reset on, as the
  attachment `history` (see `rigid_sim_ros.recording.history`).

The scene and the options of the engine are attached to the file by `Recorder`. A `bodies` line
tells readers the names from there on; who simulates again does not need it. A line of JSON is one
std_msgs/String.
"""

import json

from rigid_sim_ros.messages import decode_string, encode_string, MessageError

PARAMETERS, RESET, BODIES = 'parameters', 'reset', 'bodies'

ADD, REMOVE, PLACE = 'add', 'remove', 'place'

COLLISION = 'collision'


def encode_parameters(command_axes, command_timeout):
    """Return a line: commands are read in these axes, and held so long [s], from now on."""
    return _encode({'event': PARAMETERS, 'command_axes': command_axes,
                    'command_timeout': command_timeout})


def encode_reset(time_from_zero, keep_bodies=False):
    """
    Return a line: the scene begins again, with simulated time at zero or running on.

    With the bodies added since it was loaded and without those removed, or as it was loaded.
    """
    return _encode({'event': RESET, 'time_from_zero': time_from_zero,
                    'keep_bodies': keep_bodies})


def encode_add(scene):
    """Return a line: a body is added, the only one of this text of a scene file."""
    return _encode({'event': ADD, 'scene': scene})


def encode_remove(name):
    """Return a line: a body is taken out."""
    return _encode({'event': REMOVE, 'name': name})


def encode_place(name, position, orientation, velocity, angular_velocity):
    """Return a line: a moving body is here [m] and moves so [m/s, rad/s] from now on."""
    return _encode({'event': PLACE, 'name': name, 'position': list(position),
                    'orientation': list(orientation), 'velocity': list(velocity),
                    'angular_velocity': list(angular_velocity)})


def encode_until_collision(end_ns):
    """Return a line: from the last state on towards a time [ns], but to the first collision."""
    return _encode({'event': COLLISION, 'end_ns': end_ns})


def encode_bodies(moving_count, all_names):
    """Return a line: names, as in `Simulation.all_names`, the first so many of moving bodies."""
    return _encode({'event': BODIES, 'moving_count': moving_count, 'all_names': list(all_names)})


def _encode(line):
    # numbers are written so that they come back to the last bit
    return encode_string(json.dumps(line))


def _is_text(value):
    return isinstance(value, str)


def _is_flag(value):
    return isinstance(value, bool)


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _is_count(value):
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _are(check, length=None):
    return lambda value: (isinstance(value, list) and all(map(check, value))
                          and length in (None, len(value)))


_VECTOR, _QUATERNION = _are(_is_number, 3), _are(_is_number, 4)

_FIELDS = {
    PARAMETERS: {'command_axes': _is_text, 'command_timeout': _is_number},
    RESET: {'time_from_zero': _is_flag, 'keep_bodies': _is_flag},
    ADD: {'scene': _is_text},
    REMOVE: {'name': _is_text},
    PLACE: {'name': _is_text, 'position': _VECTOR, 'orientation': _QUATERNION,
            'velocity': _VECTOR, 'angular_velocity': _VECTOR},
    COLLISION: {'end_ns': _is_count},
    BODIES: {'moving_count': _is_count, 'all_names': _are(_is_text)},
}

_LATER = {RESET: {'keep_bodies': False}}
"""Fields that older recordings do not have, with what they mean."""


def decode_journal(data):
    """Return the dict in a line; MessageError if it is not one that is written here."""
    text = decode_string(data)
    try:
        line = json.loads(text)
        line = {**_LATER.get(line['event'], {}), **line}
        wrong = [name for name, check in _FIELDS[line['event']].items() if not check(line[name])]
        if wrong:
            raise TypeError(f'{wrong[0]} is {line[wrong[0]]!r}')
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise MessageError(f'not a line of a journal: {text[:80]!r} ({error})') from error
    return line
