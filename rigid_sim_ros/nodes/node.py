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

"""The node: a session, the topics and services around it, and nothing of its own besides."""

import time

from rclpy.node import Node

from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.nodes.announcement import invitation, show, welcome
from rigid_sim_ros.nodes.clock_source import ClockSource
from rigid_sim_ros.nodes.command_topics import CommandTopics
from rigid_sim_ros.nodes.commands import Refused
from rigid_sim_ros.nodes.control import Control
from rigid_sim_ros.nodes.counted_warnings import CountedWarnings
from rigid_sim_ros.nodes.diagnostics import Diagnostics
from rigid_sim_ros.nodes.display import Display
from rigid_sim_ros.nodes.entities import Entities
from rigid_sim_ros.nodes.namesakes import Namesakes
from rigid_sim_ros.nodes.pacing import NANOSECONDS
from rigid_sim_ros.nodes.parameters import (
    ParameterError, Parameters, STAMP, unknown_parameter_text)
from rigid_sim_ros.nodes.publishing import Publications
from rigid_sim_ros.nodes.recording import Recording
from rigid_sim_ros.nodes.services import Services
from rigid_sim_ros.nodes.session import Session
from rigid_sim_ros.nodes.standard_services import is_available, StandardServices
from rigid_sim_ros.recording import RecordingError
from rigid_sim_ros.scene import dump_scene, load_scene
from rigid_sim_ros.topics import Source, TRANSFORMS

NAME = 'rigid_sim'


class SimulationNode:
    """
    A simulation as a ROS node.

    Whoever has one calls `start` once, then `work` whenever it is due, with callbacks run by an
    executor in between (`running.drive` does both), and `close` at the end. Several can share a
    process and an executor.
    """

    def __init__(self, stop, now=time.monotonic, **options):
        """
        Make the node; `options` are those of `rclpy.node.Node`.

        Raises `ParameterError`, `SceneError` and `RecordingError`, with one line for the user.
        """
        self.ros = Node(NAME, automatically_declare_parameters_from_overrides=True, **options)
        try:
            self._build(stop, now)
        except BaseException:
            self.ros.destroy_node()
            raise

    def _build(self, stop, now):
        self.parameters = parameters = Parameters(self.ros)
        logger = self.ros.get_logger()
        for name in parameters.unknown:
            logger.warning(unknown_parameter_text(name))
        scene = load_scene(parameters.scene)
        simulation = _simulation(scene, parameters)
        self._now = now
        self._stop = stop
        self._source = Source(simulation, parameters.world_frame, dump_scene(scene))
        self.session = Session(simulation, parameters.publish_rate, self._publish_state)
        self.control = Control(self.session, parameters, stop, now, logger)
        self.recording = Recording(self.ros, parameters, self._source)
        self.refused = CountedWarnings(logger.warning)
        self.late = CountedWarnings(logger.warning)
        self.publications = Publications(
            self.ros, self._source, self.recording, parameters.reliability, now)
        if parameters.publish_tf:
            self._publish_transforms()
        self._display = Display(self.publications, self._source, now)
        self._clock_source = ClockSource(self.ros, self.publications, parameters)
        self._namesakes = Namesakes(self.ros)
        self._diagnostics = Diagnostics(
            self.ros.get_fully_qualified_name(), self.session, self.control, self.refused,
            self.late, self.recording)
        self._taken_shown = 0
        self.entities = Entities(self.session)
        self.session.on_bodies_changed = self._take_bodies
        self.session.on_note = lambda line: self.recording.note_line(self.session.time, line)
        self.session.on_begin = lambda lines: self.recording.begin(self.session.time, lines)
        self.session.commands.on_refused = lambda reason: self.refused.add(
            reason.kind, reason.describe)
        for name in ('command_axes', 'command_timeout'):
            parameters.when_changed(name, self._change_commands)
        self._change_commands()
        CommandTopics(self.ros, self._take_command, self.refused)
        Services(self.ros, self)
        if is_available():
            StandardServices(self)
        if parameters.record:
            self.recording.start(self.session.time)

    def start(self):
        """Publish the first state and tell the user what there is."""
        self.publications.send_scene(self.session.time)
        self.session.publish_now()
        for line in welcome(self.ros, self.session.simulation, self.parameters,
                            self.publications, self.recording.text):
            self.ros.get_logger().info(line)
        # not by the logger: its prefix would have to be cut off every command before it can be run
        show(invitation(self.ros, self.session.simulation))
        self.control.start()
        self._diagnostics.start(self._now())

    def work(self):
        """Do what is due; return the wall time [s] at which to call again."""
        now = self._now()
        if self.session.paused:
            self._show_changes()
        if self._diagnostics.due(now):
            self._report()
        return self.control.work(now)

    def close(self):
        """Finish the recording, say so, and leave the ROS graph."""
        if self.recording.begun:
            went_well, text = self.recording.stop()
            if went_well:
                self.ros.get_logger().info(text)
            else:
                self.ros.get_logger().error(text)
        self.ros.destroy_node()

    # -- what services do ----------------------------------------------------------------------

    @property
    def time_text(self):
        """Return the simulated time, for people."""
        return f'{self.session.time / NANOSECONDS:.9f} s'

    @property
    def failure(self):
        """Return why the simulation cannot go on, one line; empty while it can."""
        return self.control.failure

    def set_paused(self, paused):
        """Stop simulated time, or let it go on; tell whether that worked."""
        self.publications.look()
        return self.control.set_paused(paused)

    def step(self):
        """Advance by `step_duration`, if paused; tell whether it was."""
        # who subscribes and then calls gets all of it
        self.publications.look()
        return self.control.step()

    def reset(self, time_from_zero=None, keep_bodies=False):
        """Begin again as `Session.reset` does; time as parameter `reset_time` says if None."""
        if time_from_zero is None:
            time_from_zero = self.parameters.reset_time
        self._display.clear(self.session.time)
        self.control.reset(time_from_zero, keep_bodies)

    def end(self):
        """End as after a signal."""
        self._stop.requested = True

    def record(self, wanted):
        """Start or stop recording; return whether that worked, and a text."""
        if not wanted:
            return self.recording.stop()
        try:
            self.recording.start(self.session.time)
        except RecordingError as error:
            return False, str(error)
        self.publications.record_scene(self.session.time)
        if not self.failure:
            self.publications.record_state(self.session.time)
        return True, self.recording.text

    # -- inside --------------------------------------------------------------------------------

    def _publish_state(self, time, collisions):
        self.recording.note_state(time)
        self.publications.send_state(time, collisions)
        self._display.take(time, collisions)

    def _take_bodies(self):
        self.recording.note_bodies(self.session.time)
        self._source.scene_text = dump_scene(self.session.simulation.scene)
        self._display.clear(self.session.time)
        self.publications.send_scene(self.session.time)

    def _report(self):
        self._clock_source.look()
        self._namesakes.look()
        self._diagnostics.complain(self.ros.get_logger().warning)
        self.refused.report()
        self.late.report()
        self.recording.report(self.ros.get_logger().error)
        self.publications.send_diagnostics(
            self.session.time, self._diagnostics.statuses)

    def _publish_transforms(self):
        try:
            self.publications.begin(TRANSFORMS)
        except ImportError:
            raise ParameterError(
                'parameter publish_tf is true, but there is no tf2_msgs here: install it (apt '
                'install ros-jazzy-tf2-msgs), or leave publish_tf false') from None

    def _change_commands(self):
        self.session.commands.axes = self.parameters.command_axes
        self.session.commands.timeout = self.parameters.command_timeout
        self.recording.note_parameters(self.session.time)

    def _take_command(self, command, stamp, rank, topic, data):
        if self.control.failure:
            raise Refused('simulation failed', lambda: self.control.failure)
        session = self.session
        now = session.time
        if self.parameters.command_timing != STAMP or stamp == 0:
            with self.control.failing_softly():
                session.commands.carry_out(command, now)
                self.recording.note(topic, now, data)
            return
        session.commands.schedule(
            command, stamp, rank, now, lambda time: self.recording.note(topic, time, data))
        if stamp < now:
            late = (now - stamp) / NANOSECONDS
            self.late.add('late', lambda: (
                f'{topic}: command stamped {stamp / NANOSECONDS:.9f} s came {late:.6f} s of '
                'simulated time late; it is carried out at the next state'))

    def _show_changes(self):
        """Show the state to new subscribers, and to all if a command changed it."""
        if self.control.failure:
            return
        taken = self.session.commands.taken
        if taken != self._taken_shown or self.publications.has_new_subscriber():
            self.publications.show_state(self.session.time)
            self._display.draw(self.session.time)
        self._display.catch_up(self.session.time)
        self._taken_shown = taken


def _simulation(scene, parameters):
    try:
        return Simulation(scene, parameters.method, parameters.max_step)
    except ValueError as error:
        raise ParameterError(f'scene {parameters.scene!r} cannot be simulated so: {error}'
                             ) from error
