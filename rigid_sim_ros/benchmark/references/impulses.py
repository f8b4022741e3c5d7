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

"""The frictionless impulse between two free bodies that meet in one point, in closed form."""

import numpy as np


def after_impulse(bodies, point, normal, restitution):
    """
    Return the velocities after an impulse without friction, a list of (linear, angular).

    j = -(1 + e) v_rel / (1/m_a + 1/m_b + n . (I_a^-1 (r_a x n)) x r_a + n . (I_b^-1 (r_b x n)) x
    r_b) acts on b along n and on a against it; v_rel is that of the points of contact, of b
    relative to a along n (Baraff 1997, Physically Based Modeling, section 8.2).

    Parameters
    ----------
    bodies : sequence of two mappings
        a and b, each with `mass` [kg], `moment` [kg m^2] (about every axis: cubes and spheres),
        `position` [m], `velocity` [m/s] and `spin` [rad/s], (3,) in world axes.
    point, normal : (3,)
        Where they touch [m], and the unit vector from a to b.
    restitution : float
        Rebound speed over approach speed.

    """
    normal = np.asarray(normal, dtype=float)
    arms = [np.subtract(point, body['position']) for body in bodies]
    speeds = [np.add(body['velocity'], np.cross(body['spin'], arm))
              for body, arm in zip(bodies, arms)]
    approach = normal @ (speeds[1] - speeds[0])
    mobility = sum(
        1 / body['mass'] + normal @ np.cross(np.cross(arm, normal) / body['moment'], arm)
        for body, arm in zip(bodies, arms))
    size = -(1 + restitution) * approach / mobility
    return [(body['velocity'] + sign * size / body['mass'] * normal,
             body['spin'] + sign * size / body['moment'] * np.cross(arm, normal))
            for sign, body, arm in zip((-1, 1), bodies, arms)]
