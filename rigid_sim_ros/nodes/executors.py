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

"""The executors that can run the node's callbacks, by the value of the parameter `executor`."""

from rclpy.executors import SingleThreadedExecutor

try:
    from rclpy.experimental import EventsExecutor
except ImportError:
    EventsExecutor = None

AUTO, EVENTS, SINGLE_THREADED = 'auto', 'events', 'single_threaded'

EXECUTORS = (AUTO, EVENTS, SINGLE_THREADED)

LONGEST_WAIT = 0.125
"""
Longest time [s] given to `spin_once`. Waiting happens in C++, where a signal is only noticed by
Python when it is over; and the events executor of Jazzy waits for ever, deaf to signals and
timers, if it is given no time at all.
"""


def make_executor(name, context=None):
    """
    Return an executor for one of `EXECUTORS`, and None or what has to be said about it.

    The events executor takes a quarter of the processor time of the single-threaded one at
    1 kHz, but is marked experimental and missing before rclpy 7.1.4.
    """
    if name != SINGLE_THREADED and EventsExecutor is not None:
        return EventsExecutor(context=context), None
    remark = None
    if name == EVENTS:
        remark = 'this rclpy has no EventsExecutor: using the single-threaded executor'
    return SingleThreadedExecutor(context=context), remark
