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

"""The simulation as its users see it: motion by closed form, commands, collisions, errors."""

from fractions import Fraction

import numpy as np
import pytest

from rigid_sim_ros.engine import CommandError, rotation, Simulation
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.scene import load_scene

NO_GRAVITY = (0.0, 0.0, 0.0)


def cube(name, edge=1.0, mass=2.0, **values):
    """Return a cube body."""
    shape = Cube(edge)
    return Body(name, shape, mass, shape.inertia(mass), **values)


def test_report_dynamics_is_the_closed_form():
    """Five cubes for 10 s: parabolas, and constant or linearly growing turns about an axis."""
    scene = load_scene('report_dynamics')
    simulation = Simulation(scene)
    for _ in range(100):
        simulation.advance(0.1)
    time = 10.0
    for row, body in enumerate(scene.bodies):
        force, torque = np.array(body.force), np.array(body.torque)
        velocity, rate = np.array(body.velocity), np.array(body.angular_velocity)
        # every cube of the scene turns about one axis, or about none
        assert np.allclose(np.cross(rate, torque), 0)
        acceleration = force / body.mass + np.array(scene.gravity)
        growth = torque / body.inertia[0]
        position = body.position + velocity * time + acceleration * time ** 2 / 2
        turn = rotation.from_rotation_vector(rate * time + growth * time ** 2 / 2)
        expected = rotation.multiply(turn, np.array(body.orientation))
        np.testing.assert_allclose(simulation.position[row], position, atol=1e-9)
        assert rotation.angle_between(expected, simulation.orientation[row]) < 1e-9
        np.testing.assert_allclose(simulation.linear_velocity[row],
                                   velocity + acceleration * time, atol=1e-9)
        np.testing.assert_allclose(simulation.angular_velocity[row], rate + growth * time,
                                   atol=1e-9)


def test_report_collision_keeps_what_is_conserved():
    """Momentum, angular momentum and, e = 1, energy across the impulse: 1e-12 relative."""
    simulation = Simulation(load_scene('report_collision'))
    momentum, spin = simulation.momentum(), simulation.angular_momentum()
    energy = simulation.energy()
    count = 0
    for _ in range(300):
        simulation.advance(0.01)
        count += len(simulation.collisions)
    assert count > 0
    scale = np.abs(simulation.linear_velocity).max() * simulation.scene.bodies[0].mass
    np.testing.assert_allclose(simulation.momentum(), momentum, atol=1e-12 * scale)
    np.testing.assert_allclose(simulation.angular_momentum(), spin, rtol=1e-12,
                               atol=1e-12 * np.linalg.norm(spin))
    assert simulation.energy() == pytest.approx(energy, rel=1e-12)
    assert np.linalg.norm(simulation.angular_velocity) > 0.1, 'the hit is off-centre'


def test_elastic_drop_bounces_for_ever():
    """A cube dropped flat with e = 1 is back at its height after each 2 sqrt(2 h / g)."""
    material = Material(restitution=1.0, friction=0.5)
    scene = Scene(bodies=(cube('a', position=(0, 0, 1.5), material=material),),
                  planes=(Plane('ground'),))
    simulation = Simulation(scene)
    period = 2 * np.sqrt(2 * 1.0 / 9.81)
    for bounce in range(4):
        simulation.advance(period)
        np.testing.assert_allclose(simulation.position[0], (0, 0, 1.5), atol=1e-11)
        assert {event['kind'] for event in simulation.collisions} == {0}
        np.testing.assert_allclose(simulation.collisions['speed'], np.sqrt(2 * 9.81), rtol=1e-12)
        np.testing.assert_allclose(simulation.collisions['time'], (bounce + 0.5) * period,
                                   rtol=1e-12)
    np.testing.assert_allclose(simulation.orientation[0], (0, 0, 0, 1), atol=1e-12)


@pytest.mark.parametrize('shape', [Cube(1.0), Sphere(0.5)])
def test_restitution_may_grow_with_the_speed(shape):
    """What comes at v leaves at e v^2 / v0: a face with four contacts and a ball, three times."""
    material = Material(restitution=0.9, friction=0.0, restitution_speed=8.0)
    body = Body('a', shape, 2.0, shape.inertia(2.0), position=(0, 0, 1.5), material=material)
    simulation = Simulation(Scene(bodies=(body,), planes=(
        Plane('ground', material=Material(restitution=0.0)),)))
    speed = np.sqrt(2 * 9.81)
    simulation.advance(speed / 9.81 + 1e-6)
    for _ in range(3):
        np.testing.assert_allclose(simulation.collisions['speed'], speed, rtol=1e-9)
        speed *= 0.9 * speed / 8.0
        assert simulation.linear_velocity[0, 2] == pytest.approx(speed, abs=2e-5)
        simulation.advance(2 * speed / 9.81)


def test_a_dropped_cube_comes_to_rest():
    """A cube dropped tilted ends on a face: half its edge above the ground."""
    scene = Scene(bodies=(cube('a', position=(0, 0, 2), orientation=(0.2, 0.1, 0.3, 0.9)),),
                  planes=(Plane('ground'),))
    simulation = Simulation(load_like(scene))
    simulation.advance(6.0)
    np.testing.assert_allclose(simulation.position[0, 2], 0.5, atol=1e-4)
    assert np.abs(simulation.linear_velocity).max() < 1e-2


def load_like(scene):
    """Return the scene with unit quaternions."""
    bodies = []
    for body in scene.bodies:
        quaternion = np.array(body.orientation) / np.linalg.norm(body.orientation)
        bodies.append(Body(**{**vars(body), 'orientation': tuple(quaternion)}))
    return Scene(**{**vars(scene), 'bodies': tuple(bodies)})


@pytest.mark.parametrize('method', ['exact', 'stepped', 'report'])
def test_commands_change_the_motion(method):
    """Velocity at once, force and torque from then on: closed form within the method's order."""
    scene = Scene(gravity=NO_GRAVITY, bodies=(cube('a'), cube('b', position=(9, 0, 0))))
    simulation = Simulation(scene, method)
    simulation.advance(0.25)
    simulation.set_velocity('b', linear=(1, 2, 3), angular=(0.1, 0.2, 0.3))
    np.testing.assert_array_equal(simulation.linear_velocity, [(0, 0, 0), (1, 2, 3)])
    np.testing.assert_array_equal(simulation.angular_velocity, [(0, 0, 0), (0.1, 0.2, 0.3)])
    simulation.set_velocity('b', angular=(0, 0, 0))
    np.testing.assert_array_equal(simulation.linear_velocity[1], (1, 2, 3))
    simulation.apply_wrench('a', force=(4, 0, 0), torque=(0, 0.5, 0))
    simulation.advance(1.0)
    exact = 1e-12 if method == 'exact' else 1e-2
    np.testing.assert_allclose(simulation.position, [(1, 0, 0), (10, 2, 3)], atol=exact)
    np.testing.assert_allclose(simulation.linear_velocity, [(2, 0, 0), (1, 2, 3)], atol=1e-12)
    np.testing.assert_allclose(simulation.angular_velocity[0], (0, 1.5, 0), rtol=1e-12)
    simulation.apply_wrench('a')
    simulation.advance(1.0)
    np.testing.assert_allclose(simulation.linear_velocity[0], (2, 0, 0), atol=1e-12)
    simulation.set_pose('a', position=(0, 5, 0), orientation=(0, 0, 2, 0))
    np.testing.assert_array_equal(simulation.position[0], (0, 5, 0))
    np.testing.assert_array_equal(simulation.orientation[0], (0, 0, 1, 0))


def test_commands_for_all_bodies_at_once():
    """Arrays of rows do what single commands do."""
    scene = Scene(gravity=NO_GRAVITY, bodies=(cube('a'), cube('b', position=(9, 0, 0))))
    one, other = Simulation(scene), Simulation(scene)
    forces, torques = np.array([(1, 0, 0), (0, 2, 0)]), np.array([(0, 0, 1), (1, 1, 0)])
    linear, angular = np.array([(-1, 0, 1), (0, 2, 2)]), np.array([(0, 3, 1), (1, 0, 0)])
    one.apply_wrenches(forces, torques)
    one.set_velocities(linear, angular)
    for row, name in enumerate('ab'):
        other.apply_wrench(name, forces[row], torques[row])
        other.set_velocity(name, linear[row], angular[row])
    for simulation in (one, other):
        simulation.advance(0.7)
    np.testing.assert_allclose(one.position, other.position, atol=1e-14)
    np.testing.assert_allclose(one.orientation, other.orientation, atol=1e-14)


@pytest.mark.parametrize('command, message', [
    (lambda s: s.apply_wrench('cube_11'), r"no body is named 'cube_11'; near names: cube_1"),
    (lambda s: s.apply_wrench('ground'), r"'ground' does not move"),
    (lambda s: s.apply_wrench('rock'), r"'rock' does not move"),
    (lambda s: s.apply_wrench('cube_1', force=(0, float('nan'), 0)), 'force .* finite'),
    (lambda s: s.apply_wrench('cube_1', torque=(0, float('inf'), 0)), 'torque .* finite'),
    (lambda s: s.apply_wrench('cube_1', force=(0, 0)), r'force has the shape \(2,\)'),
    (lambda s: s.apply_wrench('cube_1', force='fast'), "force is 'fast'; allowed: numbers"),
    (lambda s: s.set_velocity('cube_1', linear=(float('nan'),) * 3), 'linear velocity .* finite'),
    (lambda s: s.set_velocity('cube_1', linear=(0, 1e31, 0)), r'linear velocity .* 1e\+30'),
    (lambda s: s.set_pose('cube_1', orientation=(0, 0, 0, 0)), 'orientation .* not zero'),
    (lambda s: s.apply_wrench('cube_1', force=('1', '2', '3')), 'allowed: numbers'),
    (lambda s: s.apply_wrench('cube_1', force=(1j, 0, 0)), 'allowed: numbers'),
    (lambda s: s.apply_wrench('cube_1', force=(10 ** 400, 0, 0)), 'allowed: numbers'),
    (lambda s: s.apply_wrench('cube_1', force=np.ones((40, 3))), r'the shape \(40, 3\)'),
    (lambda s: s.apply_wrench('cube_1', force=np.full((40, 3), 'x')), 'allowed: numbers'),
    (lambda s: s.apply_wrench(['cube_1']), r"no body is named \['cube_1'\]"),
    (lambda s: s.set_velocities(np.zeros((1, 3)), indices=[[0], [0, 1]]), 'whole numbers'),
    (lambda s: s.apply_wrenches(np.zeros((2, 3)), np.zeros((1, 3))), r'forces .*\(1, 3\)'),
    (lambda s: s.set_velocities(np.zeros((1, 3)), np.full((1, 3), np.inf)), 'angular .* finite'),
])
def test_bad_commands_change_nothing(command, message):
    """One line says what was given and what is allowed; the state is what it was."""
    scene = Scene(bodies=(cube('cube_1', position=(0, 0, 5)), cube('rock', fixed=True)),
                  planes=(Plane('ground', offset=-1.0),))
    simulation, untouched = Simulation(scene), Simulation(scene)
    with pytest.raises(CommandError, match=message) as raised:
        command(simulation)
    assert '\n' not in str(raised.value)
    for each in (simulation, untouched):
        each.advance(0.1)
    np.testing.assert_array_equal(simulation.position, untouched.position)
    np.testing.assert_array_equal(simulation.orientation, untouched.orientation)


@pytest.mark.parametrize('arguments, message', [
    ({'method': 'magic'}, "method is 'magic'; allowed: exact, stepped, report"),
    ({'max_step': 0.0}, 'max_step is 0.0 s; allowed: a positive number'),
    ({'max_step': float('nan')}, 'max_step is nan'),
    ({'max_step': '1'}, "max_step is '1' s; allowed: a positive number"),
    ({'max_step': None}, 'max_step is None s'),
])
def test_bad_options_are_refused(arguments, message):
    """What is allowed is in the message."""
    with pytest.raises(ValueError, match=message):
        Simulation(Scene(), **arguments)


def test_what_is_no_scene_is_refused():
    """The likeliest slip: a scene's name in place of the scene."""
    with pytest.raises(TypeError, match="scene is 'ten_cubes'; allowed: a Scene, as load_scene"):
        Simulation('ten_cubes')


@pytest.mark.parametrize('duration', [
    np.array(0.5), np.float32(0.5), np.float64(0.5), np.longdouble(0.5), Fraction(1, 2)])
def test_every_real_number_is_a_duration(duration):
    """Whatever its type, one half is one half."""
    simulation = Simulation(Scene())
    simulation.advance(duration)
    assert simulation.time == 0.5


@pytest.mark.parametrize('duration', [2, np.array(2), np.int8(2), np.uint64(2)])
def test_every_whole_number_is_a_duration(duration):
    """Whatever its type, two is two."""
    simulation = Simulation(Scene())
    simulation.advance(duration)
    assert simulation.time == 2.0


@pytest.mark.parametrize('duration', [
    -1.0, float('nan'), float('inf'), '1', None, 1j, 10**400, -10**400, np.array(-1),
    np.array('1'), np.array(1j), np.array([0.1])])
def test_bad_durations_are_refused(duration):
    """Time goes forward by finite amounts."""
    with pytest.raises(ValueError, match=r'^duration is .*allowed: a finite number, 0 or more$'):
        Simulation(Scene()).advance(duration)


def test_what_was_read_stays_as_it_was():
    """Arrays given out do not change when the simulation goes on, and cannot be written."""
    simulation = Simulation(load_scene('ten_cubes'))
    for method in ('exact', 'stepped', 'report'):
        simulation = Simulation(load_scene('ten_cubes'), method)
        position = simulation.position
        before = position.copy()
        simulation.advance(0.5)
        np.testing.assert_array_equal(position, before)
        assert not np.array_equal(simulation.position, before)
        with pytest.raises(ValueError):
            simulation.position[0, 0] = 1.0
        work = simulation.work
        simulation.advance(0.1)
        assert work != simulation.work
        with pytest.raises(AttributeError):
            simulation.method = 'magic'
        with pytest.raises(AttributeError):
            simulation.max_step = 1.0


def test_names_are_moving_then_fixed_then_planes():
    """The order that events index."""
    scene = Scene(bodies=(cube('rock', fixed=True), cube('a', position=(0, 0, 5))),
                  planes=(Plane('ground'),))
    simulation = Simulation(scene)
    assert simulation.names == ('a',)
    assert simulation.all_names == ('a', 'rock', 'ground')
    simulation.advance(5.0)
    assert simulation.position.shape == (1, 3)


def test_an_empty_scene_advances():
    """Nothing is a scene too."""
    simulation = Simulation(Scene())
    simulation.advance(1.0)
    assert simulation.time == 1.0
    assert simulation.position.shape == (0, 3)
    assert simulation.energy() == 0.0


def test_reset_goes_back_to_the_start():
    """State, time and collisions are those of a new simulation, and so is what follows."""
    simulation = Simulation(load_scene('ten_cubes'))
    simulation.advance(0.8)
    end = simulation.position
    simulation.set_velocity('cube_1', (1, 2, 3))
    simulation.reset()
    assert simulation.time == 0.0
    assert len(simulation.collisions) == 0
    simulation.advance(0.8)
    np.testing.assert_array_equal(simulation.position, end)


def test_cost_of_free_flight_does_not_depend_on_its_length():
    """Without collisions no pair is looked at again, whatever the time that passes."""
    bodies = tuple(cube(f'c{i}', position=(3.0 * i, 0, 0), velocity=(0, 0.1 * i, 0),
                        angular_velocity=(1, 2, 3)) for i in range(20))
    simulation = Simulation(Scene(bodies=bodies, gravity=NO_GRAVITY))
    first = vars(simulation.work).copy()
    simulation.advance(1.0)
    simulation.advance(100.0)
    assert vars(simulation.work) == first
    assert simulation.position.shape == (20, 3)
    assert simulation.work.pose_evaluations == 1


def test_box_inertia_is_used():
    """A free box keeps energy and angular momentum while it turns over about its middle axis."""
    shape = Box((0.2, 0.4, 0.6))
    body = Body('b', shape, 1.0, shape.inertia(1.0), angular_velocity=(0.1, 5.0, 0.2))
    simulation = Simulation(Scene(bodies=(body,), gravity=NO_GRAVITY))
    energy, spin = simulation.energy(), simulation.angular_momentum()
    turned = []
    for _ in range(30):
        simulation.advance(0.1)
        assert simulation.energy() == pytest.approx(energy, rel=1e-13)
        np.testing.assert_allclose(simulation.angular_momentum(), spin, rtol=1e-12,
                                   atol=1e-13 * np.linalg.norm(spin))
        turned.append(rotation.rotate(simulation.orientation[0], np.array((0.0, 1.0, 0.0)))[1])
    assert min(turned) < -0.9


@pytest.mark.parametrize('method', ['exact', 'stepped', 'report'])
def test_bodies_come_and_go(method):
    """The others go on as if nothing had happened; reset brings back what was."""
    scene = Scene(gravity=NO_GRAVITY, bodies=(
        cube('a', velocity=(1, 0, 0)), cube('b', position=(0, 9, 0), velocity=(0, 0, 1)),
        cube('rock', position=(0, 0, 9), fixed=True)))
    simulation = Simulation(scene, method)
    simulation.advance(1.0)
    simulation.apply_wrench('b', force=(2, 0, 0))
    simulation.add(cube('c', position=(0, -9, 0), velocity=(0, -1, 0)))
    simulation.remove('a')
    assert simulation.all_names == ('b', 'c', 'rock')
    assert [body.name for body in simulation.scene.bodies] == ['b', 'rock', 'c']
    simulation.advance(1.0)
    assert simulation.time == 2.0
    exact = 1e-12 if method == 'exact' else 1e-2
    np.testing.assert_allclose(simulation.position, [(0.5, 9, 2), (0, -10, 0)], atol=exact)
    for wrong, message in ((lambda: simulation.add(cube('b')), "already something named 'b'"),
                           (lambda: simulation.remove('a'), "no body is named 'a'")):
        with pytest.raises(CommandError, match=message):
            wrong()
    simulation.remove('rock')
    simulation.reset()
    assert simulation.all_names == ('a', 'b', 'rock')
    np.testing.assert_array_equal(simulation.position, [(0, 0, 0), (0, 9, 0)])
