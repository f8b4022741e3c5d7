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

"""Impacts: textbook formulas, what must be conserved, and laws that never add energy."""

from itertools import permutations

from hypothesis import given, settings, strategies as st

import numpy as np

import pytest

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.contacts import Contacts
from rigid_sim_ros.engine.impacts import (
    IMPACT_LAWS, laws, one_contact, resolve_impact, separate_contacts)
from rigid_sim_ros.engine.impacts.stronge import stronge_one
from rigid_sim_ros.engine.model import Body, Material, Plane, Scene
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.engine.solvers import contact_rows

LAWS = tuple(IMPACT_LAWS)


def touching(pairs, points, normals):
    """Return contacts of pairs (k, 2) at points (k, 3) with normals (k, 3) from a to b."""
    count = len(pairs)
    pairs = np.array(pairs)
    zero = np.zeros((3, count))
    return Contacts(pairs[:, 0], pairs[:, 1], np.array(points, float).T,
                    np.array(normals, float).T, np.zeros(count), np.zeros(count, int), zero, zero)


def scene_of(*shapes, masses=None, restitution=1.0, friction=0.0, planes=1):
    """Return `Bodies` of shapes and ground planes, all of one material."""
    material = Material(restitution, friction)
    masses = masses or [1.0] * len(shapes)
    return bodies_of(Scene(
        bodies=tuple(Body(f'b{i}', shape, mass, shape.inertia(mass), material=material)
                     for i, (shape, mass) in enumerate(zip(shapes, masses))),
        planes=tuple(Plane(f'p{i}', material=material) for i in range(planes))))


class Motion:
    """Poses and velocities of all bodies, and an impact applied to them."""

    def __init__(self, bodies, position, orientation=None, linear=None, angular=None):
        self.bodies = bodies
        self.position = self._padded(position, 3)
        self.orientation = self._padded(orientation, 4)
        self.orientation[3, np.abs(self.orientation).sum(axis=0) == 0] = 1
        self.linear = self._padded(linear, 3)
        self.angular = self._padded(angular, 3)

    def _padded(self, rows, size):
        array = np.zeros((size, self.bodies.count))
        if rows is not None:
            array[:, :len(rows)] = np.array(rows, float).T
        return array

    def hit(self, contacts, law='poisson', threshold=0.0):
        """Apply an impact and return it."""
        impact = resolve_impact(self.bodies, contacts, self.position, self.orientation,
                                self.linear, self.angular, law, threshold)
        self.linear[:, impact.touched] += impact.linear
        self.angular[:, impact.touched] += impact.angular
        return impact

    def spin(self):
        """Return the angular momenta about the centres of mass, (3, n)."""
        turn = rotation.matrix(self.orientation)
        body = rotation.transform_transposed(turn, self.angular) * self.bodies.inertia
        return rotation.transform(turn, body)

    def energy(self):
        """Return the kinetic energy of the moving bodies."""
        moving = self.bodies.inverse_mass > 0
        mass = np.where(moving, 1 / np.where(moving, self.bodies.inverse_mass, 1), 0)
        return 0.5 * ((mass * self.linear ** 2).sum()
                      + (moving * self.angular * self.spin()).sum())

    def momenta(self):
        """Return momentum and angular momentum about the origin of all moving bodies, (6,)."""
        moving = self.bodies.inverse_mass > 0
        momentum = np.where(moving, self.linear / np.where(moving, self.bodies.inverse_mass, 1), 0)
        turning = rotation.cross(self.position, momentum) + moving * self.spin()
        return np.concatenate((momentum.sum(axis=1), turning.sum(axis=1)))


def random_pair(seed, restitution, friction):
    """Return two boxes of different mass that approach at a random point, and the contact."""
    random = np.random.default_rng(seed)
    bodies = scene_of(Box(tuple(random.uniform(0.1, 2, 3))), Box(tuple(random.uniform(0.1, 2, 3))),
                      masses=list(10 ** random.uniform(-1, 1, 2)), restitution=restitution,
                      friction=friction)
    normal = random.normal(size=3)
    normal /= np.linalg.norm(normal)
    orientation = random.normal(size=(2, 4))
    orientation /= np.linalg.norm(orientation, axis=1)[:, None]
    motion = Motion(bodies, random.normal(size=(2, 3)), orientation,
                    np.outer((2, -2), normal) + random.normal(size=(2, 3)),
                    0.3 * random.normal(size=(2, 3)))
    return motion, touching([(0, 1)], [random.normal(size=3)], [normal])


def velocity_across(motion, contacts):
    """Return velocities of b minus a, (3, k), at the contact points."""
    def at(body):
        arm = contacts.point - motion.position[:, body]
        return motion.linear[:, body] + rotation.cross(motion.angular[:, body], arm)

    return at(contacts.body_b) - at(contacts.body_a)


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('law', LAWS)
def test_frictionless_pair_has_the_textbook_impulse(seed, law):
    """J = -(1 + e) u / (1/m_a + 1/m_b + n . (I_a^-1 (r_a x n)) x r_a + the same of b)."""
    motion, contacts = random_pair(seed, 0.6, 0.0)
    normal = contacts.normal[:, 0]
    approach = normal @ velocity_across(motion, contacts)[:, 0]
    assert approach < 0
    response = 0.0
    for body in range(2):
        turn = rotation.matrix(motion.orientation[:, body])
        inverse = turn @ np.diag(motion.bodies.inverse_inertia[:, body]) @ turn.T
        arm = contacts.point[:, 0] - motion.position[:, body]
        response += (motion.bodies.inverse_mass[body]
                     + normal @ np.cross(inverse @ np.cross(arm, normal), arm))
    impact = motion.hit(contacts, law)
    expected = -1.6 * approach / response * normal
    np.testing.assert_allclose(impact.impulse[:, 0], expected, rtol=2e-15, atol=1e-15)
    assert impact.speed[0] == pytest.approx(-approach, rel=1e-14)
    np.testing.assert_allclose(normal @ velocity_across(motion, contacts)[:, 0], -0.6 * approach,
                               rtol=1e-13)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.integers(0, 2 ** 32 - 1), st.floats(0, 1), st.floats(0, 1.5), st.sampled_from(LAWS))
def test_pairs_conserve_momenta_and_never_gain_energy(seed, restitution, friction, law):
    """Momentum and angular momentum to rounding; energy may only fall; friction in its cone."""
    motion, contacts = random_pair(seed, restitution, friction)
    before, energy = motion.momenta(), motion.energy()
    impact = motion.hit(contacts, law)
    np.testing.assert_allclose(motion.momenta(), before, atol=1e-13 * np.abs(before).max() + 1e-13)
    assert motion.energy() <= energy * (1 + 1e-13)
    along = contacts.normal[:, 0] @ impact.impulse[:, 0]
    across = np.linalg.norm(impact.impulse[:, 0] - along * contacts.normal[:, 0])
    assert across <= friction * along * (1 + 1e-12) + 1e-15
    assert (contacts.normal[:, 0] @ velocity_across(motion, contacts))[0] >= -1e-12


@pytest.mark.parametrize('law', LAWS)
def test_elastic_frictionless_pair_conserves_energy(law):
    """With e = 1 and no friction the energy is the same to rounding."""
    for seed in range(20):
        motion, contacts = random_pair(seed, 1.0, 0.0)
        before = motion.energy()
        motion.hit(contacts, law)
        assert motion.energy() == pytest.approx(before, rel=1e-14)


@pytest.mark.parametrize('law', LAWS)
@pytest.mark.parametrize('spin, friction', [(2.0, 0.6), (30.0, 0.2), (-30.0, 0.2)])
def test_spinning_ball_on_ground(law, spin, friction):
    """
    A ball falls on ground, turning about y.

    It sticks if 2/7 of its sliding speed at the contact is within mu (1 + e) v: its point of
    contact then ends at rest. Otherwise it loses mu (1 + e) v of speed to friction. Its normal
    and tangential motions are not coupled, so that all laws agree.
    """
    radius, fall, restitution = 0.5, 3.0, 0.7
    bodies = scene_of(Sphere(radius), masses=[2.0], restitution=restitution, friction=friction)
    motion = Motion(bodies, [(0, 0, radius)], linear=[(1.0, 0, -fall)], angular=[(0, spin, 0)])
    motion.hit(touching([(0, 1)], [(0, 0, 0)], [(0, 0, -1)]), law)
    sliding = 1.0 - spin * radius
    kick = min(2 / 7 * abs(sliding), friction * (1 + restitution) * fall) * -np.sign(sliding)
    np.testing.assert_allclose(motion.linear[:, 0], (1 + kick, 0, restitution * fall), atol=1e-14)
    # I = 2/5 m r^2, torque arm r
    np.testing.assert_allclose(motion.angular[:, 0], (0, spin - kick / (0.4 * radius), 0),
                               atol=1e-13)


@pytest.mark.parametrize('law', LAWS)
def test_end_of_a_rod_hits_a_frictionless_plane(law):
    """A level thin rod, hit at its end: J = (1 + e) v / (1/m + (l/2)^2 / I)."""
    length, mass, fall, restitution = 2.0, 0.7, 1.5, 0.4
    shape = Box((length, 0.01, 0.01))
    bodies = scene_of(shape, masses=[mass], restitution=restitution)
    motion = Motion(bodies, [(0, 0, 1)], linear=[(0, 0, -fall)])
    motion.hit(touching([(0, 1)], [(length / 2, 0, 1)], [(0, 0, -1)]), law)
    inertia = mass / 12 * (length ** 2 + 0.01 ** 2)
    impulse = (1 + restitution) * fall / (1 / mass + length ** 2 / 4 / inertia)
    assert motion.linear[2, 0] == pytest.approx(-fall + impulse / mass, rel=1e-14)
    assert motion.angular[1, 0] == pytest.approx(-impulse * length / 2 / inertia, rel=1e-14)


def test_sticking_corner_ends_at_rest_or_rebounds_straight():
    """Newton's law, high friction: the corner leaves at e times its approach, without sliding."""
    bodies = scene_of(Cube(1.0), restitution=0.5, friction=5.0)
    motion = Motion(bodies, [(0, 0, 0.6)], linear=[(0.2, 0.1, -2)], angular=[(0.3, -0.2, 0.5)])
    contacts = touching([(0, 1)], [(0.4, 0.3, 0)], [(0, 0, -1)])
    before = velocity_across(motion, contacts)
    motion.hit(contacts, 'newton')
    after = velocity_across(motion, contacts)[:, 0]
    np.testing.assert_allclose(after, (0, 0, -0.5 * before[2, 0]), atol=1e-14)


def test_slow_contacts_do_not_rebound():
    """At or below the threshold the restitution counts as zero."""
    bodies = scene_of(Sphere(0.5), restitution=0.9)
    contacts = touching([(0, 1)], [(0, 0, 0)], [(0, 0, -1)])
    slow = Motion(bodies, [(0, 0, 0.5)], linear=[(0, 0, -0.01)])
    slow.hit(contacts, threshold=0.01)
    assert slow.linear[2, 0] == 0
    fast = Motion(bodies, [(0, 0, 0.5)], linear=[(0, 0, -0.0101)])
    fast.hit(contacts, threshold=0.01)
    assert fast.linear[2, 0] == pytest.approx(0.9 * 0.0101)


def corners(edge):
    """Return the lower corners of a cube of this edge [m] on the ground, as contacts."""
    points = [(x, y, 0) for x in (-edge / 2, edge / 2) for y in (-edge / 2, edge / 2)]
    return points, [(0, 0, -1)] * 4


@pytest.mark.parametrize('law', LAWS)
@pytest.mark.parametrize('restitution, friction', [(1.0, 0.0), (0.5, 0.0), (0.8, 0.5)])
def test_flat_landing_stays_flat(law, restitution, friction):
    """Four corners at one instant: v -> e v, and no turn beyond rounding."""
    bodies = scene_of(Cube(0.2), restitution=restitution, friction=friction)
    points, normals = corners(0.2)
    motion = Motion(bodies, [(0, 0, 0.1)], linear=[(0, 0, -3.0)])
    motion.hit(touching([(0, 1)] * 4, points, normals), law)
    np.testing.assert_allclose(motion.linear[:, 0], (0, 0, 3 * restitution), atol=1e-14)
    # 3 m/s at an arm of 0.1 m is 30 rad/s, and some ten roundings of 1e-16 of that are left
    np.testing.assert_allclose(motion.angular[:, 0], 0, atol=1e-13)


def test_landing_does_not_depend_on_the_names_of_corners():
    """A cube lands flat, sliding and turning; all 24 orders of its corners end alike."""
    bodies = scene_of(Cube(1.0), restitution=0.3, friction=0.3)
    points, normals = corners(1.0)
    results = []
    for order in permutations(range(4)):
        motion = Motion(bodies, [(0, 0, 0.5)], linear=[(2.0, 0.3, -1.0)],
                        angular=[(0.2, 0.1, 5.0)])
        motion.hit(touching([(0, 1)] * 4, [points[i] for i in order], normals))
        results.append(np.concatenate((motion.linear[:, 0], motion.angular[:, 0])))
    np.testing.assert_allclose(results, np.broadcast_to(results[0], (24, 6)), atol=1e-12)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 2 ** 32 - 1), st.floats(0, 1), st.floats(0, 1), st.sampled_from(LAWS))
def test_group_never_gains_energy(seed, restitution, friction, law):
    """Two stacked boxes hit by a ball from the side: momentum across, energy, no approach."""
    random = np.random.default_rng(seed)
    bodies = scene_of(Cube(1.0), Cube(1.0), Sphere(0.5), masses=[1.0, 3.0, 0.5],
                      restitution=restitution, friction=friction)
    points, normals = corners(1.0)
    linear = 0.1 * random.normal(size=(3, 3)) + ((0, 0, -1), (0, 0, -1), (-3, 0, 0))
    motion = Motion(bodies, [(0, 0, 0.5), (0, 0, 1.5), (1, 0, 1.5)], linear=linear,
                    angular=0.3 * random.normal(size=(3, 3)))
    contacts = touching(
        [(0, 3)] * 4 + [(0, 1)] * 4 + [(1, 2)],
        points + [(x, y, 1) for x, y, _ in points] + [(0.5, 0, 1.5)],
        normals + [(0, 0, 1)] * 4 + [(1, 0, 0)])
    energy = motion.energy()
    impact = motion.hit(contacts, law)
    assert motion.energy() <= energy * (1 + 1e-12)
    # the ground alone acts from outside, with the impulse opposite to that on it
    change = ((motion.linear[:, :3] - linear.T) / bodies.inverse_mass[:3]).sum(axis=1)
    np.testing.assert_allclose(change, -impact.impulse[:, :4].sum(axis=1), atol=1e-12)
    separating = (velocity_across(motion, contacts) * contacts.normal).sum(axis=0)
    assert separating.min() >= -1e-11


@pytest.mark.parametrize('law', LAWS)
def test_touching_balls_in_a_row(law):
    """
    Three equal balls that touch, the first at speed 1, e = 1: (-1/3, 2/3, 2/3).

    By hand: Newton's law asks v2 - v1 = 1 and v3 = v2. Poisson's: all at 1/3 after compression,
    by impulses 2/3 and 1/3, and then the same again.
    """
    bodies = scene_of(*[Sphere(0.5)] * 3)
    motion = Motion(bodies, [(0, 0, 0), (1, 0, 0), (2, 0, 0)], linear=[(1, 0, 0), (0, 0, 0)])
    contacts = touching([(0, 1), (1, 2)], [(0.5, 0, 0), (1.5, 0, 0)], [(1, 0, 0)] * 2)
    before = motion.energy()
    motion.hit(contacts, law)
    np.testing.assert_allclose(motion.linear[0, :3], (-1 / 3, 2 / 3, 2 / 3), atol=1e-14)
    assert motion.energy() == pytest.approx(before, rel=1e-14)


def test_newtons_law_is_kept_from_creating_energy():
    """Newton's law with friction can create energy (Kane and Levinson 1985): e is lowered then."""
    lowered = 0
    for seed in range(300):
        motion, contacts = random_pair(seed, 0.95, 0.8)
        before = motion.energy()
        impact = motion.hit(contacts, 'newton')
        assert motion.energy() <= before * (1 + 1e-12)
        rebound = contacts.normal[:, 0] @ velocity_across(motion, contacts)[:, 0]
        lowered += rebound < 0.95 * impact.speed[0] * (1 - 1e-9)
    assert lowered > 0


@pytest.mark.parametrize('restitution', [0.0, 0.6])
def test_stronge_follows_sliding_through_the_impact(restitution):
    """
    A rod at 45 degrees slides at its lower end, which sticks during the impact.

    In a plane all is piecewise linear in the normal impulse, so it is done by hand: until sliding
    stops, to the greatest compression, and until e^2 of the work of compression is given back.
    """
    length, friction, slide, fall = 1.0, 0.8, 0.05, 1.0
    bodies = scene_of(Box((length, 1e-3, 1e-3)), restitution=restitution, friction=friction)
    arm = length / 2 / np.sqrt(2)
    turn = rotation.from_rotation_vector(np.array((0, np.pi / 4, 0)))
    motion = Motion(bodies, [(0, 0, arm)], [turn], [(slide, 0, -fall)])
    contacts = touching([(0, 1)], [(arm, 0, 0)], [(0, 0, -1)])
    # velocity of the rod's end per impulse on it: along either axis, and of one by the other
    coupled = arm ** 2 / bodies.inertia[1, 0]
    along = 1 + coupled
    stop = slide / (friction * along - coupled)
    rate = along - friction * coupled
    normal_at_stop = -fall + rate * stop
    assert 0 < stop and normal_at_stop < 0 and coupled / along < friction
    work = (-fall + normal_at_stop) / 2 * stop
    # sticking takes a constant ratio of friction
    ratio, rate = coupled / along, along - coupled ** 2 / along
    compression = -normal_at_stop / rate
    work += normal_at_stop / 2 * compression
    restored = np.sqrt(2 * -work * restitution ** 2 / rate)
    normal = stop + compression + restored
    tangential = -friction * stop - ratio * (compression + restored)
    motion.hit(contacts, 'stronge')
    np.testing.assert_allclose(motion.linear[:, 0], (slide + tangential, 0, normal - fall),
                               rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(velocity_across(motion, contacts)[0, 0], 0, atol=1e-14)


def test_stronge_agrees_with_small_steps():
    """Sliding that turns in space: the same equations, integrated by plain Euler steps."""
    random = np.random.default_rng(5)
    for _ in range(3):
        factor = random.normal(size=(3, 6))
        response = factor @ factor.T
        velocity = np.array((-1.0, *random.normal(size=2)))
        found = stronge_one(response[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]].tolist(),
                            velocity.tolist(), 0.3, 0.7)
        coarse, fine = (euler(response, velocity, 0.3, 0.7, count) for count in (4000, 8000))
        # Euler's error halves with the step, so twice the finer less the coarser is closer
        np.testing.assert_allclose(found, 2 * fine - coarse, rtol=1e-6, atol=1e-7)


def euler(response, velocity, friction, restitution, count):
    """Return the impulse of Stronge's law by `count` Euler steps or more to full compression."""
    step = -velocity[0] / response[0, 0] / count
    velocity, impulse, work, goal = velocity.copy(), np.zeros(3), 0.0, None
    while True:
        sliding = np.hypot(velocity[1], velocity[2])
        ratio = -friction * velocity[1:] / sliding
        part = step * np.array((1.0, *ratio))
        following = velocity + response @ part
        given = 0.5 * step * (velocity[0] + following[0])
        if goal is not None and work + given >= goal:
            # the rest of the way, within the step
            share = (goal - work) / given
            return impulse + share * part
        work += given
        if goal is None and following[0] >= 0:
            least = work - 0.5 * following[0] ** 2 / (following[0] - velocity[0]) * step
            goal = (1 - restitution ** 2) * least
        impulse, velocity = impulse + part, following


@pytest.mark.parametrize('law', ['poisson', 'newton'])
def test_all_sticking_corners_share_as_the_solver_has_it(law):
    """The forces of four corners are not unique: the shorter way must find the same ones."""
    random = np.random.default_rng(5)
    stuck = 0
    for _ in range(30):
        friction = np.full(4, random.uniform(0.2, 2.0))
        bodies = scene_of(Cube(2.0))
        motion = Motion(bodies, [(0, 0, 1)], linear=[random.normal(size=3) - (0, 0, 3)],
                        angular=[random.normal(size=3)])
        contacts = touching([(0, 1)] * 4, *corners(2.0))
        rows = contact_rows(bodies, contacts, motion.position, motion.orientation)
        problem = rows.response(), rows.motion(motion.linear, motion.angular), friction
        restitution = np.zeros(4)
        expected = IMPACT_LAWS[law].many(*problem, restitution)
        found = IMPACT_LAWS[law].many(*problem, restitution, rows.scaled)
        np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())
        stuck += laws.sticking(rows.scaled, problem[1], friction) is not None
    assert 5 < stuck < 25


@pytest.mark.parametrize('shape', [Cube(2.0), Box((1.0, 2.0, 3.0))])
def test_separate_contacts_are_as_each_alone(shape):
    """Together as arrays, or each in plain floats: bodies on bodies, and bodies on a plane."""
    random = np.random.default_rng(6)
    bodies = scene_of(*[shape] * 6, masses=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], friction=0.5)
    motion = Motion(bodies, random.normal(size=(6, 3)), random.normal(size=(6, 4)),
                    random.normal(size=(6, 3)), random.normal(size=(6, 3)))
    motion.orientation /= np.linalg.norm(motion.orientation, axis=0)
    normals = random.normal(size=(4, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    contacts = touching([(0, 1), (2, 6), (5, 3), (4, 6)], random.normal(size=(4, 3)), normals)
    state = motion.position, motion.orientation, motion.linear, motion.angular
    together = separate_contacts(bodies, contacts, *state)
    impulse = random.normal(size=(3, 4))
    for row in range(4):
        alone = one_contact(bodies, contacts.body_a.item(row), contacts.body_b.item(row),
                            contacts.point[:, row].tolist(), contacts.normal[:, row].tolist(),
                            *state)
        for many, one in ((together.response, alone.response),
                          (together.velocity, alone.velocity),
                          (together.world(impulse), alone.world(impulse[:, row]))):
            np.testing.assert_allclose(np.array(many)[:, row], one, rtol=1e-12, atol=1e-13)
        assert together.friction[row] == pytest.approx(alone.friction, rel=1e-15)
        changes = {index[row]: (np.array(linear)[:, row], np.array(angular)[:, row])
                   for index, linear, angular in together.changes(impulse)}
        for index, linear, angular in alone.changes(impulse[:, row]):
            np.testing.assert_allclose(changes[index], (linear, angular), rtol=1e-11, atol=1e-13)
