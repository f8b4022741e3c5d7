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

"""Bodies that are spawned, deleted and placed in a session, without ROS."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.nodes.commands import body_command
from rigid_sim_ros.nodes.entities import (
    BadDescription, BadPlace, described_body, Entities, EntityError, NameTaken, UnknownEntity)
from rigid_sim_ros.nodes.pacing import NANOSECONDS
from rigid_sim_ros.nodes.session import Session
from rigid_sim_ros.scene import load_scene

SCENE = {
    'gravity': [0, 0, 0],
    'planes': [{'name': 'ground', 'normal': [0, 0, 1], 'offset': -10.0}],
    'bodies': [
        {'name': 'one', 'cube': {'edge': 0.2}, 'mass': 2.0, 'velocity': [1, 0, 0]},
        {'name': 'wall', 'cube': {'edge': 1}, 'mass': 1.0, 'position': [0, 5, 0], 'fixed': True},
        {'name': 'two', 'sphere': {'radius': 0.1}, 'mass': 1.0, 'position': [0, -5, 0]}]}

CUBE = '{cube: {edge: 0.2}, mass: 3, position: [0, 0, 3], velocity: [0, 2, 0]}'


@pytest.fixture
def session():
    return Session(Simulation(load_scene(SCENE)), 100.0, lambda time, collisions: None)


@pytest.fixture
def entities(session):
    return Entities(session)


def test_spawned_body_moves_and_the_others_go_on(session, entities):
    session.step(1.0)
    assert entities.spawn(described_body(CUBE, ''), 'new') == 'new'
    assert session.simulation.names == ('one', 'two', 'new')
    assert entities.names == ('one', 'wall', 'two', 'new')
    session.commands.carry_out(body_command('new', force=[0, 0, 6]), session.time)
    session.step(0.5)
    assert_allclose(session.simulation.position,
                    [[1.5, 0, 0], [0, -5, 0], [0, 1, 3 + 0.5 * 2 * 0.25]], atol=1e-12)


def test_deleted_body_is_gone_and_its_commands_are_refused(session, entities):
    refused = []
    session.commands.on_refused = refused.append
    session.commands.schedule(body_command('one', force=[1, 0, 0]), NANOSECONDS // 2, 0, 0)
    session.commands.schedule(body_command('two', force=[0, 2, 0]), NANOSECONDS // 2, 0, 0)
    entities.delete('one')
    assert session.simulation.names == ('two',)
    session.step(1.0)
    assert [reason.kind for reason in refused] == ['unknown body']
    assert_allclose(session.simulation.position, [[0, -5 + 0.5 * 2 * 0.25, 0]], atol=1e-12)


def test_wrench_is_released_from_the_right_body_after_one_was_deleted(session, entities):
    session.commands.timeout = 0.5
    session.commands.carry_out(body_command('two', force=[0, 0, 1]), 0)
    entities.spawn(described_body(CUBE, ''), 'new')
    entities.delete('one')
    assert_array_equal(session.simulation.force, [[0, 0, 1], [0, 0, 0]])
    session.step(0.6)
    assert_array_equal(session.simulation.force, np.zeros((2, 3)))


def test_reset_undoes_it_or_keeps_it(session, entities):
    entities.spawn(described_body(CUBE, ''), 'new')
    entities.delete('two')
    session.step(1.0)
    session.reset(False, keep_bodies=True)
    assert session.simulation.names == ('one', 'new')
    assert_array_equal(session.simulation.position, [[0, 0, 0], [0, 0, 3]])
    session.reset(False)
    assert session.simulation.names == ('one', 'two')
    assert session.added_names == ()


def test_names(entities):
    body = described_body(CUBE, '')
    with pytest.raises(NameTaken, match="named 'one' already"):
        entities.spawn(body, 'one')
    with pytest.raises(NameTaken):
        entities.spawn(body, 'ground')
    assert entities.spawn(body, 'one', rename=True) == 'one_1'
    with pytest.raises(BadDescription, match='printable'):
        entities.spawn(body, 'a\nb')
    with pytest.raises(UnknownEntity, match="'onw'; near names: one"):
        entities.delete('onw')
    assert entities.matching('^o') == ('one', 'one_1')
    assert entities.matching('') == ('one', 'wall', 'two', 'one_1')


@pytest.mark.parametrize('pattern', ['(', 'a{99999999999}', '(' * 10_000 + ')' * 10_000])
def test_what_is_no_regular_expression(entities, pattern):
    with pytest.raises(EntityError, match='no regular expression') as error:
        entities.matching(pattern)
    assert len(str(error.value)) < 300 and '\n' not in str(error.value)


@pytest.mark.parametrize('pattern', [
    '(e+)+$', '(e|ee)*$', r'([^)]|\w){20}$', '(?x)(e+) +$', 'e*' * 5 + '$', 'e?' * 30 + '$'])
def test_pattern_that_may_take_for_ever(entities, pattern):
    entities.spawn(described_body(CUBE, ''), 'e' * 30 + '!')
    with pytest.raises(EntityError, match='may take for ever'):
        entities.matching(pattern)


@pytest.mark.parametrize('pattern, expected', [
    (r'^o\w+$', ('one',)), ('(o|z)', ('one', 'two')), ('[n*+?]e$', ('one',)),
    (r'\)*[)*+?{]*wa(l{1,2})?$', ('wall',)), ('^.+_.+_.+_.+$', ())])
def test_patterns_that_are_found_at_once(entities, pattern, expected):
    assert entities.matching(pattern) == expected


@pytest.mark.parametrize('text, uri, reason', [
    ('{cube: {edge: -1}, mass: 1}', '', 'edge'), ('{cube: {edge: 1}}', '', 'mass'),
    ('cube: [', '', 'not valid YAML'),
    ('{cube: {edge: 1}, mass: 2001-13-45}', '', 'mass'),
    ('{cube: {edge: 1}, mass: 1, mass: 2}', '', "the key 'mass' is given twice"),
    ('[' * 20_000 + ']' * 20_000, '', 'nested deeper than'), ('{1: 2}', '', 'unknown key'),
    ('[{a: 1}]', '', 'must be a mapping'), ('\x00', '', 'not valid YAML'),
    ('<sdf/>', '', 'scene'), ('', 'ten_cubes', '10 bodies'),
    ('', '/nowhere.yaml', 'no such file'), ('', '', 'no shipped scene')])
def test_bad_descriptions(text, uri, reason):
    with pytest.raises(BadDescription, match=reason) as error:
        described_body(text, uri)
    assert '\n' not in str(error.value)


def test_body_that_the_method_does_not_know_is_refused():
    scene = {**SCENE, 'bodies': SCENE['bodies'][:1]}
    simulation = Simulation(load_scene(scene), 'report', 0.001)
    session = Session(simulation, 100.0, lambda time, collisions: None)
    with pytest.raises(BadDescription, match="'report'.*'sphere'"):
        Entities(session).spawn(described_body('{sphere: {radius: 1}, mass: 1}', ''), 'ball',
                                position=(0, 0, 3))
    assert (simulation.all_names, session.added_names) == (('one', 'ground'), ())
    session.step(1.0)
    assert_allclose(simulation.position, [[1, 0, 0]], atol=1e-12)


def test_numbers_are_read_as_in_a_scene_file():
    assert described_body('{cube: {edge: 1e-1}, mass: 1}', '').shape.half_extents == (
        pytest.approx([0.05] * 3))


def test_fixed_body_may_stand_in_the_ground_and_in_fixed_ones(session, entities):
    post = described_body('{cube: {edge: 0.4}, fixed: true}', '')
    entities.spawn(post, 'in the ground', position=(0, 0, -10))
    entities.spawn(post, 'in the wall', position=(0, 5, 0.5))
    # as in a scene file, not so in what moves, wherever it has moved to
    session.step(1.0)
    with pytest.raises(BadPlace, match='overlap one by'):
        entities.spawn(post, 'post', position=(1, 0, 0))
    assert entities.spawn(post, 'post', position=(0, 0, 0)) == 'post'


def test_no_two_bodies_in_one_place(session, entities):
    body = described_body(CUBE, '')
    session.step(1.0)
    entities.spawn(body, 'above')
    with pytest.raises(BadPlace, match='above'):
        entities.spawn(body, 'again')
    with pytest.raises(BadPlace, match='overlap two by'):
        entities.place('one', position=(0, -5, 0.05))
    with pytest.raises(BadPlace, match='ground'):
        entities.place('one', position=(0, 0, -10))
    with pytest.raises(EntityError, match='orientation'):
        entities.place('one', orientation=(0, 0, 0, 0))
    with pytest.raises(EntityError, match='velocity'):
        entities.place('one', velocity=(np.nan, 0, 0), position=(7, 7, 7))
    with pytest.raises(EntityError, match=r'angular_velocity is \[0.0, 2000000000.0, 0.0\]; allo'):
        entities.place('one', angular_velocity=(0, 2e9, 0))
    with pytest.raises(EntityError, match='fixed'):
        entities.place('wall', position=(7, 7, 7))
    assert_allclose(entities.body('one').position, (1, 0, 0), atol=1e-12)


def test_placed_body_has_what_it_was_given(session, entities):
    entities.place('one', position=(0, 0, 9), orientation=(0, 0, 2, 0), velocity=(0, 0, 1),
                   angular_velocity=(3, 0, 0))
    session.step(0.5)
    body = entities.body('one')
    assert_allclose(body.position, (0, 0, 9.5), atol=1e-12)
    # half a turn about z, then 1.5 rad about x
    assert_allclose(np.abs(body.orientation), (0, np.sin(0.75), np.cos(0.75), 0), atol=1e-12)
    assert body.velocity == (0, 0, 1)
    assert entities.body('wall').position == (0, 5, 0)
