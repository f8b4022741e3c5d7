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

"""From the command line to a running node and to its orderly end."""

import re
import sys
import time

import rclpy
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from rigid_sim_ros.nodes.announcement import EXECUTABLE, usage
from rigid_sim_ros.nodes.executors import LONGEST_WAIT, make_executor
from rigid_sim_ros.nodes.node import SimulationNode
from rigid_sim_ros.nodes.parameters import ParameterError
from rigid_sim_ros.recording import RecordingError
from rigid_sim_ros.scene import SceneError

USER_ERROR = 2
"""Exit code when the user has to change something."""

SPIN_INTERVAL = 1e-3
"""
Wall time [s] between two calls of the executor while states are overdue. A call with nothing to do
takes 0.05 ms, as long as a state of ten cubes.
"""

MOST_SPINS = 10
"""Calls of the executor in a row after a state that took long."""


def run(arguments, stop):
    """Run a node with command line arguments (argv[0] included); return the exit code."""
    try:
        own = remove_ros_args(arguments)[1:]
    except RuntimeError as error:
        return _fail(readable(error))
    if '--help' in own or '-h' in own:
        print(usage(), end='')
        return 0
    if own:
        return _fail(f'argument {own[0]!r} is not known; parameters are given as --ros-args -p '
                     f'NAME:=VALUE; see {EXECUTABLE} --help')
    rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    try:
        return _run_node(stop)
    finally:
        rclpy.try_shutdown()


def readable(error):
    """
    Return what an error of rclpy for unreadable arguments says, without lines of its source.

    They are RuntimeErrors of a private module.
    """
    return re.sub(r', at \S+:\d+', '', str(error))


def _run_node(stop):
    try:
        node = SimulationNode(stop)
    except (ParameterError, RecordingError, SceneError) as error:
        return _fail(error)
    try:
        executor, remark = make_executor(node.parameters.executor)
        if remark:
            node.ros.get_logger().warning(remark)
        executor.add_node(node.ros)
        node.start()
        drive([node], executor, stop)
    finally:
        # whatever ended the loop, the recording is finished: signals change nothing by now
        stop.ignore()
        node.close()
    return 0


def drive(nodes, executor, stop, now=time.monotonic):
    """Let nodes work when they are due and run callbacks in between, until told to stop."""
    spun = now()
    while not stop.requested:
        due = min([node.work() for node in nodes])
        time_left = due - now()
        if time_left > 0:
            executor.spin_once(timeout_sec=min(time_left, LONGEST_WAIT))
            spun = now()
            continue
        for _ in range(min(int((now() - spun) / SPIN_INTERVAL), MOST_SPINS)):
            executor.spin_once(timeout_sec=0)
            spun = now()


def _fail(error):
    print(f'{EXECUTABLE}: {" ".join(str(error).split())}', file=sys.stderr)
    return USER_ERROR
