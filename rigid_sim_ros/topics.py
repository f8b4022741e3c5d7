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
The topics and services of the node `rigid_sim`: one table each.

A published topic is a row of `PUBLISHED`: its name, type, quality of service, and how its bytes
are made. The node and the recorder go through the rows; adding a topic is adding one. Nothing
here needs ROS.
"""

from dataclasses import dataclass
from typing import Any, Callable, Optional

import numpy as np
from rigid_sim_ros import messages


@dataclass(frozen=True)
class Quality:
    """Quality of service, in the words of ROS 2; history is always keep last."""

    depth: int = 10
    reliability: str = 'reliable'
    durability: str = 'volatile'


EVERY_STEP = 'step'
"""A message after every advance of simulated time."""

ON_EVENTS = 'events'
"""A message after an advance in which there were collision events; never an empty one."""

FOR_DISPLAY = 'display'
"""A message for human eyes: after an advance, but not more often than they can follow."""

ON_CHANGE = 'change'
"""A message at the start and after the scene was replaced."""

EVERY_SECOND = 'second'
"""A message each second of wall time, also while paused."""


@dataclass
class Source:
    """What messages are made from; the node keeps it up to date."""

    simulation: Any
    """A `rigid_sim_ros.engine.Simulation`."""

    frame_id: str = 'world'
    scene_text: str = ''
    """The scene as loaded, YAML."""

    collisions: Any = None
    """The events since the last message, fields as in `Simulation.collisions`."""

    statuses: tuple = ()
    """`messages.DiagnosticStatus` of the node, the engine and the recorder."""

    shared: Optional[dict] = None
    """What the messages of one state share while they are made together; None at other times."""


@dataclass(frozen=True)
class Published:
    """
    A published topic.

    `encoder(source)` is called once for a `Source`, and gives a function from a time [ns] to the
    message at that time: bytes, or a view of them that holds until the next call, as not everybody
    needs a copy. An encoder holds what does not change while the source has the same bodies.
    """

    name: str
    type_name: str
    quality: Quality
    encoder: Callable
    when: str
    what: str
    parameter: Optional[str] = None
    """The parameter that turns the topic on, if it is one that can be off."""


@dataclass(frozen=True)
class Command:
    """A subscribed topic."""

    name: str
    type_name: str
    quality: Quality
    what: str


@dataclass(frozen=True)
class Service:
    """A service."""

    name: str
    type_name: str
    what: str


def _poses(source):
    simulation = source.simulation
    encoder = messages.PoseArrayEncoder(source.frame_id, len(simulation.names))

    def encode(time_ns):
        message = encoder.view(time_ns, simulation.position, simulation.orientation)
        if source.shared is not None:
            source.shared['poses'] = encoder.poses
        return message

    return encode


def _states(source):
    simulation = source.simulation
    encoder = messages.MultiDOFJointStateEncoder(source.frame_id, simulation.names)
    held = {}

    def encode(time_ns):
        if source.shared:
            encoder.copy_poses(source.shared['poses'])
        else:
            encoder.write_poses(simulation.position, simulation.orientation)
        for name, part in encoder.steady_parts.items():
            rows = getattr(simulation, name)
            # the engine never writes into an array of its state: the same has the same values
            if rows.base is not held.get(name):
                part[...] = rows
                held[name] = rows.base
        return encoder.view(time_ns)

    return encode


def _collisions(source):
    encoder = messages.CollisionEncoder(source.frame_id)
    return lambda time_ns: encoder.encode(time_ns, source.collisions)


def _collision_text(source):
    names = source.simulation.all_names
    return lambda time_ns: messages.encode_string(
        messages.collision_lines(source.collisions, names))


def _scene(source):
    return lambda time_ns: messages.encode_string(source.scene_text)


def _clock(source):
    return messages.encode_clock


def _diagnostics(source):
    return lambda time_ns: messages.encode_diagnostic_array(time_ns, source.statuses)


_COLORS = np.array([
    (0.90, 0.62, 0.00), (0.34, 0.71, 0.91), (0.00, 0.62, 0.45), (0.94, 0.89, 0.26),
    (0.00, 0.45, 0.70), (0.84, 0.37, 0.00), (0.80, 0.47, 0.65)])
"""Okabe and Ito 2008: colours that colour-blind people tell apart, one body after the other."""

_CONTACT_ARROW_LENGTH = 0.1
"""[m], along the contact normal."""

_LARGEST_ARROW_COUNT = 100
"""More contacts than that are not drawn; the events topic has them all."""

_PLANE_SIZE = (20.0, 20.0, 0.01)
"""Sides [m] of the slab that stands for a plane."""


def _plane_pose(plane):
    """Return position and orientation of a slab whose upper side lies in a plane."""
    normal = np.array(plane.normal)
    position = normal * (plane.offset - _PLANE_SIZE[2] / 2)
    # the shortest turn of the z axis to the normal; half a turn about x if they are opposite
    turn = np.array([-normal[1], normal[0], 0.0, 1.0 + normal[2]])
    length = np.linalg.norm(turn)
    return position, turn / length if length > 1e-9 else np.array([1.0, 0.0, 0.0, 0.0])


def _slabs_and_solids(scene):
    """Return kinds, sides, positions and orientations: moving bodies, fixed ones, planes."""
    bodies = sorted(scene.bodies, key=lambda body: body.fixed)
    poses = [(body.position, body.orientation) for body in bodies]
    poses += [_plane_pose(plane) for plane in scene.planes]
    kinds = [messages.SPHERE if body.shape.kind == 'sphere' else messages.CUBE for body in bodies]
    sides = [tuple(2 * extent for extent in body.shape.half_extents) for body in bodies]
    return (kinds + [messages.CUBE] * len(scene.planes),
            sides + [_PLANE_SIZE] * len(scene.planes),
            np.array([position for position, _ in poses], dtype=float).reshape(-1, 3),
            np.array([orientation for _, orientation in poses], dtype=float).reshape(-1, 4))


def _markers(source):
    simulation = source.simulation
    moving_count = len(simulation.names)
    kinds, sides, position, orientation = _slabs_and_solids(simulation.scene)
    color = np.ones((len(kinds), 4))
    color[:, :3] = _COLORS[np.arange(len(kinds)) % len(_COLORS)]
    color[moving_count:, :3] = 0.5
    encoder = messages.MarkerArrayEncoder(source.frame_id, kinds, sides, color)

    def encode(time_ns):
        position[:moving_count] = simulation.position
        orientation[:moving_count] = simulation.orientation
        events = source.collisions
        start = np.empty((0, 3)) if events is None else events['point'][-_LARGEST_ARROW_COUNT:]
        end = start + _CONTACT_ARROW_LENGTH * (
            0 if events is None else events['normal'][-_LARGEST_ARROW_COUNT:])
        return encoder.encode(time_ns, position, orientation, start, end)

    return encode


PUBLISHED = (
    Published('~/poses', 'geometry_msgs/msg/PoseArray', Quality(10), _poses, EVERY_STEP,
              'the moving bodies, in the order of the names in `~/scene`'),
    Published('~/states', 'sensor_msgs/msg/MultiDOFJointState', Quality(10), _states, EVERY_STEP,
              'names, poses, twists and held wrenches of the moving bodies'),
    Published('~/collisions', 'sensor_msgs/msg/PointCloud2', Quality(100), _collisions, ON_EVENTS,
              'one point an event: x y z, normal, impulse, speed, time_offset, body_a, body_b, '
              'kind'),
    Published('~/collision_text', 'std_msgs/msg/String', Quality(100), _collision_text, ON_EVENTS,
              'the same events with names, a line of JSON each'),
    Published('~/scene', 'std_msgs/msg/String', Quality(1, durability='transient_local'), _scene,
              ON_CHANGE, 'the scene as loaded, YAML'),
    Published('~/markers', 'visualization_msgs/msg/MarkerArray', Quality(1), _markers,
              FOR_DISPLAY, 'the bodies and the latest contacts for RViz and Foxglove'),
    Published('/clock', 'rosgraph_msgs/msg/Clock', Quality(1, reliability='best_effort'), _clock,
              EVERY_STEP, 'simulated time', parameter='publish_clock'),
    Published('/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray', Quality(10), _diagnostics,
              EVERY_SECOND, 'how the simulation, the node and the recorder are doing'),
)
"""Every topic the node publishes."""


def _transforms(source):
    simulation = source.simulation
    encoder = messages.TransformsEncoder(source.frame_id, simulation.names)
    return lambda time_ns: encoder.encode(time_ns, simulation.position, simulation.orientation)


TRANSFORMS = Published(
    '/tf', 'tf2_msgs/msg/TFMessage', Quality(100), _transforms, EVERY_STEP,
    'the poses once more, as transforms from the world to frames named like the bodies',
    parameter='publish_tf')
"""Published if it is asked for and tf2_msgs is there, which is not part of a bare rclpy."""

COMMANDS = (
    Command('~/cmd_force', 'geometry_msgs/msg/Vector3Stamped', Quality(10),
            'hold a force [N] on the body named by header.frame_id'),
    Command('~/cmd_torque', 'geometry_msgs/msg/Vector3Stamped', Quality(10),
            'hold a torque [N m] on it'),
    Command('~/cmd_wrench', 'geometry_msgs/msg/WrenchStamped', Quality(10),
            'hold both on it'),
    Command('~/cmd_vel', 'geometry_msgs/msg/TwistStamped', Quality(10),
            'set its velocity [m/s] and rate [rad/s] at once'),
    Command('~/cmd_states', 'sensor_msgs/msg/MultiDOFJointState', Quality(10),
            'wrenches and/or twists of many bodies by name'),
)
"""Every topic the node takes commands from."""

JOURNAL = Command(
    '~/journal', 'std_msgs/msg/String', Quality(100),
    'in recordings only: resets, bodies that come, go and are placed, and parameters that '
    'commands depend on, a line of JSON each; '
    '`rigid_sim_ros.recording.journal` says what a recording must hold to be run again')
"""Written to recordings beside what is published and commanded; not on the network."""

SERVICES = (
    Service('~/pause', 'std_srvs/srv/SetBool', 'stop simulated time, or let it go on'),
    Service('~/step', 'std_srvs/srv/Trigger', 'advance by `step_duration` while paused'),
    Service('~/reset', 'std_srvs/srv/Trigger', 'start again from the scene as loaded'),
    Service('~/record', 'std_srvs/srv/SetBool', 'start or stop a recording'),
)
"""Every service the node offers."""


def resolve(name, node='/rigid_sim'):
    """Return a topic's full name: `~` is the node's name."""
    return node + name[1:] if name.startswith('~') else name
