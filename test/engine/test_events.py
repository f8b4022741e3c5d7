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

import numpy as np

from rigid_sim_ros.engine.events import BEGIN, COLLISION, END, EventLog, IMPACT, renumbered


def test_kinds_are_the_documented_numbers():
    assert (IMPACT, BEGIN, END) == (0, 1, 2)


def test_events_come_out_in_order_of_time_with_ties_as_appended():
    log = EventLog()
    log.append(2.0, 0, 1, IMPACT, (1, 2, 3), (0, 0, 1), (4, 5, 6), 7.5)
    log.append(1.0, 2, 3, BEGIN, (0, 0, 0), (1, 0, 0))
    log.append(2.0, 4, 5, END, (0, 0, 0), (0, 1, 0))
    events = log.take()
    assert events.dtype == COLLISION
    assert events['time'].tolist() == [1.0, 2.0, 2.0]
    assert events['body_a'].tolist() == [2, 0, 4]
    assert events['body_b'].tolist() == [3, 1, 5]
    assert events['kind'].tolist() == [BEGIN, IMPACT, END]
    assert events[1]['point'].tolist() == [1, 2, 3]
    assert events[1]['normal'].tolist() == [0, 0, 1]
    assert events[1]['impulse'].tolist() == [4, 5, 6]
    assert events['speed'].tolist() == [0, 7.5, 0]
    assert not len(log.take())
    assert log.take().shape == (0,)


def test_an_event_keeps_its_vectors_when_the_array_they_came_from_changes():
    position = np.array([1.0, 2.0, 3.0])
    log = EventLog()
    log.append(0.0, 0, 1, IMPACT, position, position)
    position[:] = 0
    assert log.take()['point'].tolist() == [[1, 2, 3]]


def test_bodies_get_other_numbers_and_those_that_are_gone_no_events():
    log = EventLog()
    for time, (a, b) in enumerate(((0, 1), (0, 2), (1, 2))):
        log.append(time, a, b, END, (0, 0, 0), (0, 0, 1))
    numbers = np.array((3, -1, 0))
    log.renumber(numbers)
    taken = log.take()
    assert taken[['time', 'body_a', 'body_b']].tolist() == [(1, 3, 0)]
    assert renumbered(taken, np.array((1, -1, -1, 0))).tolist() != taken.tolist()
    assert not len(renumbered(taken, np.array((-1, 1, 2, 0))))
