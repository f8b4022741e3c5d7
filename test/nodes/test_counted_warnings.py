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

"""Warnings on a made-up clock: one a kind and interval, all counted."""

from rigid_sim_ros.nodes.counted_warnings import (
    CountedWarnings, LONGEST_NAME, near_names, REPEAT_AFTER, shown)


def test_one_warning_of_a_kind_until_the_interval_is_over():
    texts, clock = [], [0.0]
    warnings = CountedWarnings(texts.append, now=lambda: clock[0])
    for _ in range(1000):
        warnings.add('unknown body', lambda: 'no such body')
        warnings.add('not finite', lambda: 'not a number')
    assert texts == ['no such body', 'not a number']
    clock[0] = REPEAT_AFTER
    warnings.add('unknown body', lambda: 'no such body')
    assert texts[2:] == ['no such body (999 more like it since the last warning)']
    assert warnings.counts == {'unknown body': 1001, 'not finite': 1000}
    assert warnings.total == 2001


def test_the_last_one_held_back_is_told_when_the_interval_is_over():
    """Who mends one wrong name into another is told of that one too."""
    texts, clock = [], [0.0]
    warnings = CountedWarnings(texts.append, now=lambda: clock[0])
    for text in ('first', 'second', 'third'):
        warnings.add('kind', lambda text=text: text)
    warnings.report()
    assert texts == ['first']
    clock[0] = REPEAT_AFTER
    warnings.report()
    assert texts[1:] == ['third (1 more like it since the last warning)']
    clock[0] = 3 * REPEAT_AFTER
    warnings.report()
    assert len(texts) == 2 and warnings.total == 3


def test_text_of_a_silent_warning_is_not_made():
    made = []
    warnings = CountedWarnings(lambda text: None, now=lambda: 0.0)
    for _ in range(3):
        warnings.add('kind', lambda: made.append(1) or '')
    assert len(made) == 1


def test_names_are_shown_short_and_escaped():
    assert shown('cube_1') == "'cube_1'"
    assert shown('a\nb\x1b[31m') == r"'a\nb\x1b[31m'"
    long = shown('x' * 10_000_000)
    assert len(long) < LONGEST_NAME + 40
    assert '10000000 characters' in long


def test_near_names_come_first():
    names = tuple(f'cube_{number}' for number in range(1, 11)) + ('sphere',)
    assert near_names('spere', names) == 'near names: sphere'
    assert 'cube_1' in near_names('cube1', names)
    assert near_names('wagon', names) == (
        'the names are: cube_1, cube_2, cube_3, cube_4, cube_5, ... (11 in all)')
    assert near_names('a', ()) == 'this scene has no moving bodies'
