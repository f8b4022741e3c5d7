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
The node's parameters: one table, from which they are declared, described and documented.

What only makes sense at the start is read-only. A value that is not allowed is refused, with
what is, both at the start and by `ros2 param set`.
"""

from dataclasses import dataclass
from functools import partial
from math import isfinite
from typing import Any, Optional

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.parameter import Parameter

from rigid_sim_ros.engine.methods import METHODS
from rigid_sim_ros.nodes.commands import BODY_AXES, WORLD_AXES
from rigid_sim_ros.nodes.counted_warnings import near_names_only, shown
from rigid_sim_ros.nodes.executors import AUTO, EXECUTORS
from rigid_sim_ros.recording import DROP, WAIT
from rigid_sim_ros.recording.mcap_file import COMPRESSIONS

ARRIVAL, STAMP = 'arrival', 'stamp'
"""When a command takes effect: as soon as it arrives, or at the simulated time of its stamp."""


class ParameterError(ValueError):
    """A parameter has a value that is not allowed; the text is one line."""


@dataclass(frozen=True)
class Row:
    """A parameter."""

    name: str
    default: Any
    description: str
    unit: str = ''
    smallest: Optional[float] = None
    largest: Optional[float] = None
    choices: tuple = ()
    read_only: bool = False

    @property
    def allowed(self):
        """Return what values are allowed, as a phrase."""
        if self.choices:
            return ', '.join(self.choices)
        if self.smallest is not None:
            return f'{self.smallest:g} to {self.largest:g} {self.unit}'.rstrip()
        return {bool: 'true, false', str: 'text'}[type(self.default)]

    def checked(self, value):
        """Return a value in the parameter's type, or raise `ParameterError`."""
        if isinstance(self.default, float) and type(value) is int:
            value = float(value)
        if (not isinstance(value, type(self.default))
                or self.choices and value not in self.choices
                or self.smallest is not None
                and not (isfinite(value) and self.smallest <= value <= self.largest)):
            raise ParameterError(f'parameter {self.name} is {value!r}; allowed: {self.allowed}')
        return value

    def descriptor(self):
        """Return the `ParameterDescriptor` that `ros2 param describe` shows."""
        unit = f' [{self.unit}]' if self.unit else ''
        ranges = []
        if self.smallest is not None:
            ranges = [FloatingPointRange(from_value=self.smallest, to_value=self.largest)]
        return ParameterDescriptor(
            description=self.description + unit, read_only=self.read_only,
            additional_constraints=f'allowed: {self.allowed}' if self.choices else '',
            floating_point_range=ranges)


PARAMETERS = (
    Row('scene', 'ten_cubes', 'path of a scene file, or name of a shipped scene',
        read_only=True),
    Row('method', 'exact', 'how motion is computed', choices=tuple(METHODS), read_only=True),
    Row('max_step', 0.01, 'longest step of lasting contact, or of everything in methods that '
        'step', 's', 1e-6, 1.0, read_only=True),
    Row('publish_rate', 100.0, 'states published per second of simulated time', 'Hz', 0.1, 1e4),
    Row('real_time_factor', 1.0, 'simulated seconds per second; 0 is as fast as possible', '',
        0.0, 100.0),
    Row('start_paused', False, 'begin paused', read_only=True),
    Row('pause_on_collision', False, 'pause at the instant at which bodies first collide; if '
        'they were in lasting contact, at the end of the step'),
    Row('step_duration', 0.01, 'simulated time of a call of `~/step`', 's', 1e-6, 60.0),
    Row('reset_time', False, '`~/reset` sets simulated time to zero too; otherwise it runs on'),
    Row('command_axes', WORLD_AXES, 'axes of the vectors in commands; body: turned into world '
        'axes when the command takes effect', choices=(WORLD_AXES, BODY_AXES)),
    Row('command_timeout', 0.0, 'simulated time after which a commanded wrench is replaced by '
        'that of the scene; 0 is never', 's', 0.0, 1e6),
    Row('command_timing', ARRIVAL, 'when commands take effect: at the simulated time at which '
        'they arrive, or at the one in their stamp', choices=(ARRIVAL, STAMP)),
    Row('world_frame', 'world', 'frame_id of everything published', read_only=True),
    Row('publish_clock', True, 'publish simulated time on `/clock`; unless it is set, '
        'only while nobody else does'),
    Row('publish_tf', False, 'publish the poses on `/tf` too, with the names of bodies as frames; '
        'needs tf2_msgs', read_only=True),
    Row('reliability', 'reliable', 'quality of service of poses, states and markers',
        choices=('reliable', 'best_effort'), read_only=True),
    Row('executor', AUTO, 'executor of the callbacks; auto: the events executor if there is one',
        choices=EXECUTORS, read_only=True),
    Row('record', False, 'record from the start', read_only=True),
    Row('record_path', '', 'folder to make for the recording; empty: named by scene and date, '
        'in the folder recordings', read_only=True),
    Row('record_compression', 'zstd', 'compression of recordings', choices=tuple(COMPRESSIONS),
        read_only=True),
    Row('record_split_size', 0.0, 'size after which a recording goes on in a new file; 0 is '
        'never', 'MB', 0.0, 1e6, read_only=True),
    Row('record_split_duration', 0.0, 'simulated time after which it does; 0 is never', 's', 0.0,
        1e6, read_only=True),
    Row('record_when_full', WAIT, 'what happens if the disk is too slow: simulated time waits '
        'for it, or messages are dropped', choices=(WAIT, DROP), read_only=True),
)
"""Every parameter, apart from those rclpy adds (`use_sim_time`, `qos_overrides...`)."""

_ROWS = {row.name: row for row in PARAMETERS}

_FOREIGN = ('use_sim_time', 'qos_overrides', 'start_type_description_service')
"""Beginnings of the names of parameters that are rclpy's."""


class Parameters:
    """
    The values of the parameters, as attributes named like them.

    The node is made with `automatically_declare_parameters_from_overrides`, so that what the user
    gave is known before anything is declared: names that do not exist can be told from those
    that do, and a whole number is taken where a real one is meant.
    """

    def __init__(self, node):
        """Declare the parameters on a node; raises `ParameterError`."""
        given = node.get_parameters_by_prefix('')
        self.given = frozenset(name for name in given if name in _ROWS)
        """Names of the parameters the user set."""
        self.unknown = tuple(name for name in given
                             if name not in _ROWS and not name.startswith(_FOREIGN))
        """Names the user set that are no parameters of this node."""
        for row in PARAMETERS:
            value = row.default
            if row.name in given:
                value = row.checked(given[row.name].value)
                node.undeclare_parameter(row.name)
            node.declare_parameter(row.name, value, row.descriptor(), ignore_override=True)
            setattr(self, row.name, value)
        self._changed = {}
        node.add_pre_set_parameters_callback(partial(_prepared, node))
        node.add_on_set_parameters_callback(_check)
        node.add_post_set_parameters_callback(self._take)

    def when_changed(self, name, action):
        """Call `action()` after a parameter was set while the node runs."""
        self._changed[name] = action

    def _take(self, parameters):
        ours = [parameter for parameter in parameters if parameter.name in _ROWS]
        for parameter in ours:
            setattr(self, parameter.name, parameter.value)
        for parameter in ours:
            self._changed.get(parameter.name, _nothing)()


def unknown_parameter_text(name):
    """Say that there is no parameter of a name, and which one may be meant."""
    return f'there is no parameter {name!r}: it has no effect' + _near(name)


def _near(name):
    near = near_names_only(name, _ROWS)
    return f'; {near}' if near else ''


def _nothing():
    pass


def _prepared(node, parameters):
    """
    Turn integers into doubles where a double is declared: `publish_rate 50` is meant well.

    Refuses names that are not declared: rclpy would too, but without saying which.
    """
    for parameter in parameters:
        if not node.has_parameter(parameter.name):
            raise ParameterNotDeclaredException(f'{shown(parameter.name)}{_near(parameter.name)}')
    return [
        Parameter(parameter.name, value=float(parameter.value))
        if parameter.type_ == Parameter.Type.INTEGER and parameter.name in _ROWS
        and isinstance(_ROWS[parameter.name].default, float) else parameter
        for parameter in parameters]


def _check(parameters):
    for parameter in parameters:
        if parameter.name in _ROWS:
            try:
                _ROWS[parameter.name].checked(parameter.value)
            except ParameterError as error:
                return SetParametersResult(successful=False, reason=str(error))
    return SetParametersResult(successful=True)
