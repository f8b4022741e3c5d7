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
"""Bodies that join and leave a simulation: what is refused, and whom collisions name."""

from dataclasses import replace

import numpy as np

import pytest

from rigid_sim_ros.engine import CommandError, Simulation
from rigid_sim_ros.engine.events import BEGIN, END, IMPACT
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Cube, Sphere
from rigid_sim_ros.scene import load_scene

NAN = float('nan')


def cube(name, **values):
    """Return a cube of 1 kg."""
    shape = Cube(0.2)
    return Body(name, shape, 1.0, shape.inertia(1.0), **values)


def falling():
    """Return a simulation of a cube above the ground."""
    return Simulation(Scene(bodies=(cube('a', position=(0, 0, 0.2)),), planes=(Plane('ground'),)))


@pytest.mark.parametrize('values, message', [
    ({'position': (NAN, 0, 0)}, "body 'b': position .* finite"),
    ({'velocity': (0, 1e31, 0)}, r"body 'b': velocity .* 1e\+30"),
    ({'force': (0, 1)}, r"body 'b': force has the shape \(2,\)"),
    ({'orientation': (0, 0, 0, 0)}, "body 'b': orientation .* a unit quaternion"),
    ({'mass': 0.0}, "body 'b': mass is 0.0; allowed: above 0"),
    ({'mass': NAN}, "body 'b': mass is nan"),
    ({'mass': 'heavy'}, "body 'b': mass is 'heavy'"),
    ({'inertia': (1.0, 1.0, -1.0)}, "body 'b': inertia is -1.0; allowed: above 0"),
    ({'inertia': (1.0, 1.0, 3.0)}, 'no moment larger than the other two together'),
    ({'shape': Cube(-0.2)}, "body 'b': half_extents is -0.1"),
    ({'shape': 'cube'}, "body 'b': shape is 'cube'; allowed: a Shape"),
    ({'material': Material(restitution=2.0)}, "body 'b': restitution is 2.0; allowed: 0 to 1"),
    ({'material': Material(friction=NAN)}, "body 'b': friction is nan"),
    ({'name': 'a'}, "already something named 'a'"),
    ({'name': ''}, "the name of a body is ''; allowed: text"),
])
def test_what_cannot_be_simulated_is_refused(values, message):
    """In one line, and the simulation goes on as if nothing had been asked for."""
    simulation, untouched = falling(), falling()
    with pytest.raises(CommandError, match=message) as raised:
        simulation.add(replace(cube('b', position=(5, 0, 1)), **values))
    assert '\n' not in str(raised.value)
    for each in (simulation, untouched):
        each.advance(0.3)
    assert simulation.names == ('a',)
    np.testing.assert_array_equal(simulation.position, untouched.position)


def test_what_is_no_body_is_refused():
    """The likeliest slip: a mapping as in a scene file."""
    with pytest.raises(CommandError, match='body is {.*allowed: a model.Body, as in the bodies'):
        falling().add({'name': 'b', 'cube': {'edge': 0.2}, 'mass': 1})


def test_a_body_of_a_loaded_scene_is_taken():
    """That is how one is made in README."""
    simulation = falling()
    simulation.add(load_scene({'bodies': [
        {'name': 'b', 'sphere': {'radius': 1}, 'mass': 1, 'position': [9, 0, 2]}]}).bodies[0])
    simulation.advance(0.1)
    assert simulation.position[1, 2] == pytest.approx(2 - 9.81 * 0.1 ** 2 / 2)


def test_a_shape_the_method_does_not_know_is_refused_and_nothing_changes():
    """The report's engine has boxes only."""
    scene = Scene(bodies=(cube('a', position=(0, 0, 2)),))
    simulation = Simulation(scene, method='report')
    ball = Body('ball', Sphere(0.1), 1.0, Sphere(0.1).inertia(1.0))
    with pytest.raises(CommandError, match="'report' was given the shape 'sphere'"):
        simulation.add(ball)
    assert simulation.all_names == ('a',) and simulation.scene == scene
    np.testing.assert_array_equal(simulation.position, [(0, 0, 2)])
    with pytest.raises(ValueError, match="'report' was given the shape 'sphere'"):
        Simulation(Scene(bodies=(ball,)), method='report')


def test_collisions_name_the_same_bodies_when_others_come_and_go():
    """Indices are those of `all_names` as it is now; events of what has left are gone."""
    simulation = falling()
    simulation.advance(0.3)
    assert {(a, b) for a, b, kind in simulation.collisions[['body_a', 'body_b', 'kind']].tolist()
            if kind == IMPACT} == {(0, 1)}
    simulation.add(cube('b', position=(5, 0, 9)))
    simulation.add(cube('rock', position=(9, 0, 9), fixed=True))
    names = simulation.all_names
    assert names == ('a', 'b', 'rock', 'ground')
    for event in simulation.collisions:
        assert (names[event['body_a']], names[event['body_b']]) == ('a', 'ground')
    simulation.remove('a')
    assert not len(simulation.collisions)


def test_contact_goes_on_when_others_come_and_go():
    """It has begun once and ends once; what a body lay on that is gone is told by nobody."""
    simulation = Simulation(Scene(bodies=(cube('a', position=(0, 0, 0.1)),
                                          cube('b', position=(0, 0, 0.3))),
                                  planes=(Plane('ground'),)))
    assert kinds_after(simulation, 0.3) == {('a', 'b'): [BEGIN], ('a', 'ground'): [BEGIN]}
    simulation.add(cube('c', position=(5, 0, 9)))
    assert kinds_after(simulation, 0.3) == {}
    simulation.remove('c')
    simulation.add(cube('rock', position=(9, 0, 9), fixed=True))
    assert kinds_after(simulation, 0.3) == {}
    assert simulation.asleep.all()
    simulation.set_velocity('b', (0, 0, 1))
    assert kinds_after(simulation, 0.1) == {('a', 'b'): [END]}
    simulation.remove('a')
    assert IMPACT in kinds_after(simulation, 2.0)['b', 'ground']


def kinds_after(simulation, duration):
    """Return the kinds of the events of a time [s] by the names of pairs."""
    simulation.advance(duration)
    names, kinds = simulation.all_names, {}
    for a, b, kind in simulation.collisions[['body_a', 'body_b', 'kind']].tolist():
        kinds.setdefault((names[a], names[b]), []).append(kind)
    return kinds
