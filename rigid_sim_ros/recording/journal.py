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
* on `~/journal`, a `parameters` line at the start and whenever one of them is changed, and a
  `reset` line for every reset, before the first state after it.

The scene and the options of the engine are attached to the file by `Recorder`. A line of JSON is
one std_msgs/String.
"""

import json

from rigid_sim_ros.messages import decode_string, encode_string, MessageError

PARAMETERS, RESET = 'parameters', 'reset'


def encode_parameters(command_axes, command_timeout):
    """Return a line: commands are read in these axes, and held so long [s], from now on."""
    return _encode({'event': PARAMETERS, 'command_axes': command_axes,
                    'command_timeout': command_timeout})


def encode_reset(time_from_zero):
    """Return a line: the scene begins again, with simulated time at zero or running on."""
    return _encode({'event': RESET, 'time_from_zero': time_from_zero})


def _encode(line):
    return encode_string(json.dumps(line))


_FIELDS = {PARAMETERS: {'command_axes': str, 'command_timeout': (int, float)},
           RESET: {'time_from_zero': bool}}


def decode_journal(data):
    """Return the dict in a line; MessageError if it is not one that is written here."""
    text = decode_string(data)
    try:
        line = json.loads(text)
        fields = _FIELDS[line['event']]
        if not all(isinstance(line[name], kind) for name, kind in fields.items()):
            raise TypeError('a field has another type')
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise MessageError(f'not a line of a journal: {text[:80]!r} ({error})') from error
    return line
