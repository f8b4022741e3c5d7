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
Publishes a recording again, as it was published.

Every topic has the quality of service it was recorded with, and every message is the bytes that
were recorded. Simulated time is on `/clock` if it was recorded, or if asked for.
"""

import argparse
import os
import sys
import time

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from rigid_sim_ros.messages import encode_clock
from rigid_sim_ros.nodes.arguments import not_negative, positive
from rigid_sim_ros.nodes.executors import AUTO, make_executor
from rigid_sim_ros.nodes.interfaces import interface, quality_of_service
from rigid_sim_ros.nodes.lateness import Lateness
from rigid_sim_ros.nodes.playback import Playback
from rigid_sim_ros.nodes.running import drive, readable, USER_ERROR
from rigid_sim_ros.recording import RecordingError
from rigid_sim_ros.recording.bag_metadata import quality_profiles
from rigid_sim_ros.topics import PUBLISHED, Quality
from std_srvs.srv import SetBool, Trigger

EXECUTABLE = 'rigid_sim_player'

CLOCK = next(row for row in PUBLISHED if row.name == '/clock')

_IDLE = 0.1
"""Wall time [s] between two looks at the world while paused."""

_LONGEST_BURST = 0.02
"""Wall time [s] of publishing what is overdue, before callbacks have their turn."""

_GOODBYE = 0.3
"""Wall time [s] for subscribers to acknowledge the last messages."""

_DURABILITIES, _RELIABILITIES = ('volatile', 'transient_local'), ('reliable', 'best_effort')

_LARGEST_DEPTH = 1000


def run(arguments, stop):
    """Play with command line arguments (argv[0] included); return the exit code."""
    try:
        own = remove_ros_args(arguments)[1:]
    except RuntimeError as error:
        return _fail(readable(error))
    options = _parser().parse_args(own)
    try:
        playback = Playback(options.bag, options.topics, options.rate, options.start,
                            options.loop)
    except RecordingError as error:
        return _fail(error)
    rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    try:
        player = Player(playback, options.clock, options.paused, stop)
        executor, _ = make_executor(AUTO)
        executor.add_node(player.ros)
        player.start()
        drive([player], executor, stop)
        player.close()
    except UnknownType as error:
        return _fail(error)
    finally:
        rclpy.try_shutdown()
    return 0


def _parser():
    parser = argparse.ArgumentParser(
        prog=EXECUTABLE, description='Publish a recording again. Services ~/pause '
        '(std_srvs/SetBool) and ~/step (std_srvs/Trigger) control it. ROS arguments follow '
        '--ros-args.')
    parser.add_argument('bag', type=os.path.expanduser,
                        help='folder of the bag, or one MCAP file of it')
    parser.add_argument('--rate', type=positive, default=1.0,
                        help='seconds of the recording each second (default 1)')
    parser.add_argument('--start', type=not_negative, default=0.0, metavar='SECONDS',
                        help='begin so far into the recording')
    parser.add_argument('--loop', action='store_true', help='begin again at the end')
    parser.add_argument('--paused', action='store_true', help='wait for ~/pause or ~/step')
    parser.add_argument('--clock', action='store_true',
                        help='publish /clock even if it was not recorded')
    parser.add_argument('--topics', nargs='+', default=(), metavar='NAME',
                        help='what to play (default: all but commands and the journal)')
    return parser


def _fail(error):
    print(f'{EXECUTABLE}: {error}', file=sys.stderr)
    return USER_ERROR


class UnknownType(ValueError):
    """A topic has a type of message that is not installed; the text is one line."""


def quality_of(topic):
    """Return the `topics.Quality` of a `BagTopic`; what it does not say is the usual."""
    profiles = quality_profiles(topic)
    profile = profiles[0] if profiles else {}
    durability, reliability = profile.get('durability'), profile.get('reliability')
    depth = profile.get('depth')
    return Quality(
        depth=min(max(depth, 1), _LARGEST_DEPTH) if isinstance(depth, int) else 10,
        reliability=reliability if reliability in _RELIABILITIES else 'reliable',
        durability=durability if durability in _DURABILITIES else 'volatile')


def _interface(topic):
    try:
        return interface(topic.type_name)
    except (ImportError, AttributeError, ValueError) as error:
        raise UnknownType(
            f'{topic.name} has messages of type {topic.type_name}, which is not installed here: '
            'install it, or choose others with --topics') from error


class Player:
    """
    A `Playback` as a ROS node.

    Whoever has one calls `start` once, then `work` whenever it is due (`running.drive` does), and
    `close` at the end, which it asks for through `stop`.
    """

    def __init__(self, playback, clock, paused, stop, now=time.monotonic):
        self.ros = Node(EXECUTABLE)
        self.lateness = Lateness()
        """Wall times [s] by which messages were late."""
        self._playback, self._paused = playback, paused
        self._stop, self._now = stop, now
        self._publishers = {
            name: self.ros.create_publisher(_interface(topic), name,
                                            quality_of_service(quality_of(topic)))
            for name, topic in playback.topics.items()}
        self._clock = None
        if clock and CLOCK.name not in self._publishers:
            self._clock = self.ros.create_publisher(
                interface(CLOCK.type_name), CLOCK.name, quality_of_service(CLOCK.quality))
        self._time_ns = None
        self.ros.create_service(SetBool, '~/pause', self._pause)
        self.ros.create_service(Trigger, '~/step', self._step)

    def start(self):
        """Begin to play, unless paused."""
        if not self._paused:
            self._playback.anchor(self._now())

    def work(self):
        """Publish what is due; return the wall time [s] at which to call again."""
        begun = self._now()
        if self._paused:
            return begun + _IDLE
        while self._playback.due <= self._now() < begun + _LONGEST_BURST:
            self.lateness.add(self._now() - self._playback.due)
            self._publish()
        if self._playback.message is None:
            self._stop.requested = True
        self._playback.read_ahead()
        return self._playback.due

    def close(self):
        """Say how it went, and leave the ROS graph."""
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=_GOODBYE))
        logger = self.ros.get_logger()
        for line in self._playback.damage:
            logger.warning(f'damaged: {line}')
        if self.lateness.count:
            logger.info(f'{self.lateness.count} messages played; 99 % were at most '
                        f'{1e3 * self.lateness.quantile(0.99):.3g} ms late')
        self.ros.destroy_node()

    def _publish(self):
        message = self._playback.message
        if self._clock is not None and message.time_ns != self._time_ns:
            self._clock.publish(encode_clock(message.time_ns))
        self._time_ns = message.time_ns
        self._publishers[message.topic].publish(bytes(message.data))
        # only now: it may have to read the next from the disk
        self._playback.take()

    def _pause(self, request, response):
        if self._paused and not request.data:
            self._playback.anchor(self._now())
        self._paused = request.data
        response.success = True
        response.message = 'paused' if self._paused else 'playing'
        return response

    def _step(self, request, response):
        """Publish everything that has the next time."""
        if not self._paused or self._playback.message is None:
            response.success = False
            response.message = 'at the end' if self._paused else 'it is playing; pause it first'
            return response
        time_ns = self._playback.message.time_ns
        while self._playback.message is not None and self._playback.message.time_ns == time_ns:
            self._publish()
        response.success = True
        response.message = f'played {time_ns / 1e9:.9f} s'
        return response
