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

"""The table of problems: scenes that load, times that every engine can meet, sound references."""

import numpy as np
import pytest
from rigid_sim_ros.benchmark.penetration import deepest_penetration
from rigid_sim_ros.benchmark.problems import collisions, FRAME_RATE, PROBLEMS
from rigid_sim_ros.benchmark.problems.problem import frames_near
from rigid_sim_ros.benchmark.references.impulses import after_impulse
from rigid_sim_ros.benchmark.report import titled
from rigid_sim_ros.benchmark.trajectories import fault, record, Trajectory
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.scene import load_scene
from scipy.spatial.transform import Rotation

SPEEDS_ONLY = ('tumble_energy', 'toss_10', 'pile_10', 'pile_100', 'heap_10', 'heap_100')
"""Where what starts still is not yet wrong."""

SMALL = [problem for problem in PROBLEMS.values() if problem.bodies <= 100]


@pytest.mark.parametrize('problem', SMALL, ids=lambda problem: problem.name)
def test_scene_loads_and_starts_without_overlap(problem):
    scene = load_scene(problem.scene())
    assert len(scene.bodies) == problem.bodies
    poses = [np.array([getattr(body, part) for body in scene.bodies], float)
             for part in ('position', 'orientation')]
    assert deepest_penetration(scene, *poses) < 1e-12


@pytest.mark.parametrize('problem', PROBLEMS.values(), ids=lambda problem: problem.name)
def test_every_step_meets_every_reading(problem):
    for time in problem.times:
        assert time * FRAME_RATE == pytest.approx(round(time * FRAME_RATE), abs=1e-9)
    assert all(later > earlier for earlier, later in zip(problem.times, problem.times[1:]))
    assert all(rate % FRAME_RATE == 0 for rate in problem.rates)


# tumbling_boxes is tumbling_box twelve times, and its references take seconds
@pytest.mark.parametrize('problem', [row for row in SMALL if row.name != 'tumbling_boxes'],
                         ids=lambda problem: problem.name)
def test_bodies_that_stay_at_the_start_are_wrong(problem):
    scene = load_scene(problem.scene())
    poses, velocities = zip(*(
        (np.array([getattr(body, place) for body in scene.bodies], float),
         np.array([getattr(body, rate) for body in scene.bodies], float))
        for place, rate in (('position', 'velocity'), ('orientation', 'angular_velocity'))))
    count = len(problem.times)
    still = Trajectory(np.array(problem.times),
                       *(np.repeat(part[None], count, axis=0) for part in (*poses, *velocities)),
                       asleep=np.zeros(len(scene.bodies), bool))
    measures = problem.measure(still)
    assert all(titled(name)[1] for name in measures)
    assert problem.plotted in measures
    if problem.name not in ('incline_stick', 'tower_10', *SPEEDS_ONLY):
        assert max(measures.values()) > 1e-3 or np.isnan(list(measures.values())).any()


class BuiltReport:
    """The report's engine, which is right nowhere, as an engine that is built already."""

    def __init__(self, scene):
        self.simulation = Simulation(scene, 'report', 1 / 60)

    def advance(self, duration):
        self.simulation.advance(duration)

    def read_poses(self):
        return self.simulation.position, self.simulation.orientation

    def read_velocities(self):
        return self.simulation.linear_velocity, self.simulation.angular_velocity

    def asleep(self):
        return self.simulation.asleep


def test_three_frames_for_each_instant():
    assert frames_near([0.5, 1.0], 0.1) == tuple(n / 60 for n in (24, 30, 36, 54, 60, 66))


@pytest.mark.parametrize('pair', [collisions.vertex_face_pair, collisions.edge_edge_pair])
def test_pairs_meet_in_one_point_where_the_reference_says_and_only_once(pair):
    a, b, point, normal = pair()
    scene = load_scene(collisions.pair_scene(pair, 1.0))
    span = collisions.GAP / 1.5
    meeting = [{'mass': 1.0, 'moment': collisions.MOMENT, 'spin': np.zeros(3),
                'velocity': body['velocity'],
                'position': body['position'] + body['velocity'] * span} for body in (a, b)]
    orientations = np.array([a['orientation'], b['orientation']])

    def depth(offset):
        return deepest_penetration(scene, np.array(
            [body['position'] + offset * body['velocity'] for body in meeting]), orientations)

    assert depth(-1e-9) == 0.0
    assert depth(1e-6) == pytest.approx(1.5e-6, rel=1e-6)
    for body, orientation in zip(meeting, orientations):
        local = Rotation.from_quat(orientation).apply(point - body['position'], inverse=True)
        assert np.abs(local).max() == pytest.approx(0.1, abs=1e-15)
        assert normal @ (point - body['position']) * (1 if body is meeting[0] else -1) > 0
    after = after_impulse(meeting, point, normal, 1.0)
    for later in np.linspace(1e-4, collisions.DURATION - span, 20):
        position = [body['position'] + later * linear
                    for body, (linear, _) in zip(meeting, after)]
        turned = [(Rotation.from_rotvec(later * spin) * Rotation.from_quat(orientation)).as_quat()
                  for orientation, (_, spin) in zip(orientations, after)]
        assert deepest_penetration(scene, np.array(position), np.array(turned)) == 0.0


def test_faults_are_told():
    problem = PROBLEMS['slide']
    scene = load_scene(problem.scene())
    good = record(BuiltReport(load_scene(PROBLEMS['constant_wrench'].scene())), (1.0,))

    def with_position(*place):
        return type(good)(good.times, np.array([[place]]), good.orientation, good.linear_velocity,
                          good.angular_velocity, good.asleep)

    assert fault(with_position(1.0, 0.0, 0.1), scene, 10.0) is None
    assert fault(with_position(np.nan, 0.0, 0.1), scene, 10.0) == 'not finite'
    assert 'blew up' in fault(with_position(1e3, 0.0, 0.1), scene, 10.0)
    assert fault(with_position(1.0, 0.0, -0.01), scene, 10.0) == 'a body went through ground'
