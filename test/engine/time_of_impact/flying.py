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

"""Bodies in flight, for tests of first touches."""

import numpy as np

from rigid_sim_ros.engine.bodies import bodies_of
from rigid_sim_ros.engine.flight import Flights
from rigid_sim_ros.engine.model import Body, Plane, Scene
from rigid_sim_ros.engine.narrow_phase import find_contacts, PairGroups

GRAVITY = 9.81


class Flying:
    """
    Shapes and planes in flight from time zero.

    `state` maps 'position', 'orientation', 'velocity', 'spin', 'acceleration' and 'torque' to
    rows, one for each shape; what is left out is zero, upright or still.
    """

    def __init__(self, shapes, planes=(), **state):
        self.bodies = bodies_of(Scene(
            bodies=tuple(Body(f'body_{number}', shape, 1.0, shape.inertia(1.0))
                         for number, shape in enumerate(shapes)),
            planes=tuple(Plane(f'plane_{number}', tuple(normal), offset)
                         for number, (normal, offset) in enumerate(planes))))
        self.flights = Flights(self.bodies.inertia)
        count = len(shapes)
        upright = np.tile((0.0, 0.0, 0.0, 1.0), (count, 1))
        orientation = np.array(state.get('orientation', upright), dtype=float).T
        values = [np.array(state.get(name, np.zeros((count, 3))), dtype=float).T
                  for name in ('position', 'velocity', 'spin', 'acceleration', 'torque')]
        self.flights.begin(np.arange(count), 0.0, values[0], orientation, *values[1:])

    def separations(self, a, b, times):
        """Return the signed distances [m], (p, K), of pairs (p,) at times (K,)."""
        groups = PairGroups(self.bodies, a, b)
        return np.array([groups.separations(*self.flights.poses(float(time)))
                         for time in times]).T

    def sampled_first_touches(self, a, b, end, sample_count):
        """
        Return first touches, (p,) [s], by sampling and bisection, and the least distances.

        The independent way: it may miss what touches between samples only.
        """
        times = np.linspace(0, end, sample_count)
        distance = self.separations(a, b, times)
        result = np.full(len(a), np.inf)
        for pair in np.flatnonzero((distance <= 0).any(axis=1)):
            later = int(np.flatnonzero(distance[pair] <= 0)[0])
            low, high = times[max(later - 1, 0)], times[later]
            groups = PairGroups(self.bodies, a[pair:pair + 1], b[pair:pair + 1])
            while low < (middle := 0.5 * (low + high)) < high:
                apart = groups.separations(*self.flights.poses(middle))[0] > 0
                low, high = (middle, high) if apart else (low, middle)
            result[pair] = high
        return result, distance.min(axis=1)


def touching_contacts(bodies, flights, pairs_a, pairs_b, time):
    """Return all contact points of pairs (p,) within 1e-9 of their size at `time` [s]."""
    size = np.minimum(bodies.bounding_radius[pairs_a], bodies.bounding_radius[pairs_b])
    return find_contacts(bodies, pairs_a, pairs_b, *flights.poses(time), 1e-9 * size)
