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

"""Pairs that fall upon each other again and again: touch, rebound, go on guarded, touch."""

from flying import Flying, touching_contacts

import numpy as np

import pytest

from rigid_sim_ros.engine.rotation import matrix
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.engine.time_of_impact import first_touches

A, B = np.array([0]), np.array([1])
PULL = 8.0  # [m/s^2], of each towards where the other started


def elastic_impulses(contacts, state, inverse_inertia):
    """
    Return the velocities and spins after frictionless impacts that reverse all normal speeds.

    Both bodies have unit mass. `state` is positions, orientations, velocities and spins, columns
    for the two.
    """
    position, orientation, velocity, spin = state
    inverse = [matrix(orientation[:, [k]])[:, :, 0] for k in (0, 1)]
    inverse = [turn @ np.diag(moments) @ turn.T for turn, moments in zip(inverse, inverse_inertia)]
    rows = np.zeros((contacts.count, 12))
    for row, (point, normal) in enumerate(zip(contacts.point.T, contacts.normal.T)):
        arms = [np.cross(point - position[:, k], normal) for k in (0, 1)]
        rows[row] = np.concatenate((-normal, -arms[0], normal, arms[1]))
    weight = np.zeros((12, 12))
    weight[:3, :3] = weight[6:9, 6:9] = np.eye(3)
    weight[3:6, 3:6], weight[9:, 9:] = inverse
    motion = np.concatenate((velocity[:, 0], spin[:, 0], velocity[:, 1], spin[:, 1]))
    approach = rows @ motion
    assert approach.min() < 0, 'a touch without approach'
    impulses = np.linalg.lstsq(rows @ weight @ rows.T, -2 * approach, rcond=None)[0]
    motion = motion + weight @ rows.T @ impulses
    return motion.reshape(2, 2, 3).transpose(1, 2, 0)


def energy(state, inertia, acceleration):
    """Return kinetic and potential energy of the two, unit masses."""
    position, orientation, velocity, spin = state
    result = 0.5 * (velocity ** 2).sum() - (acceleration * position).sum()
    for k in (0, 1):
        body_spin = matrix(orientation[:, [k]])[:, :, 0].T @ spin[:, k]
        result += 0.5 * (inertia[k] * body_spin ** 2).sum()
    return result


def towards_each_other(position):
    """Return accelerations (3, 2) along the line between the centres."""
    between = position[:, 1] - position[:, 0]
    pull = PULL / np.sqrt(between @ between) * between
    return np.stack((pull, -pull), axis=1)


@pytest.mark.parametrize('shapes', [
    (Cube(1.0), Cube(0.7)), (Box((0.3, 0.6, 1.0)), Cube(0.8)), (Box((1.0, 1, 0.05)), Cube(0.3)),
    (Sphere(0.4), Box((0.4, 0.5, 0.6))), (Sphere(0.4), Sphere(0.2))],
    ids=['cubes', 'boxes', 'plate and cube', 'ball and box', 'balls'])
@pytest.mark.parametrize('seed', range(2))
def test_energy_stays_and_nothing_enters_over_many_rebounds(shapes, seed):
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(2, 4))
    q /= np.sqrt((q * q).sum(axis=1, keepdims=True))
    flying = Flying(shapes, position=[(0, 0, 0), (0.1, 0.2, 1.5)], orientation=q)
    flights, inertia = flying.flights, np.array([shape.inertia(1.0) for shape in shapes])
    now, guarded, touches = 0.0, False, 0
    state = *flights.poses(now), 0.1 * rng.normal(size=(3, 2)), rng.normal(size=(3, 2))
    for _ in range(20):
        pull = towards_each_other(state[0])
        before = energy(state, inertia, pull)
        flights.begin(np.arange(2), now, *state, pull, np.zeros((3, 2)))
        time = first_touches(flying.bodies, flights, A, B, now, now + 0.5, [guarded]).item()
        until = time if np.isfinite(time) else now + 0.5
        assert until > now
        between = flying.separations(A, B, np.linspace(now, until, 15))[0]
        assert between.min() > -2e-10  # what a guarded pair may sink
        state = *flights.poses(until), *flights.velocities(until)
        assert energy(state, inertia, pull) == pytest.approx(before, rel=1e-13, abs=1e-13)
        if np.isfinite(time):
            contacts = touching_contacts(flying.bodies, flights, A, B, time)
            state = *state[:2], *elastic_impulses(contacts, state, 1 / inertia)
            assert energy(state, inertia, pull) == pytest.approx(before, rel=1e-12, abs=1e-12)
            touches += 1
        else:  # they slip past each other: aim again
            state = *state[:2], towards_each_other(state[0]) / PULL, state[3]
        now, guarded = until, np.isfinite(time)
    assert touches >= 5
