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

"""
An island: bodies in lasting contact with each other and with what does not move, by themselves.

An island has its own small `Bodies`, so that its steps cost what it needs and not what the scene
has. Its columns are its members, then what they may touch that does not move: fixed bodies,
planes, bodies asleep.
"""

from dataclasses import replace

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.engine.lasting_contact.motion import FreeMotion, Motion
from rigid_sim_ros.engine.lasting_contact.near import memory_of, Near, same_poses
from rigid_sim_ros.engine.lasting_contact.scales import Scales
from rigid_sim_ros.engine.narrow_phase import PairGroups
from rigid_sim_ros.engine.spin_friction import resists_spin
from rigid_sim_ros.engine.turning_bounds import TurningBounds


class Island:
    """
    What stays the same about an island while its members and pairs are the same.

    Parameters
    ----------
    world : World
    members : (m,) int
        The indices of its moving bodies.
    pairs_a, pairs_b : (p,) int
        Pairs that may touch, at least one of each a member; what is not a member does not move.
    older : list of Island
        Those it takes the place of: what they remember saves it time.

    """

    def __init__(self, world, members, pairs_a, pairs_b, older=()):
        self.world = world
        self.members = np.asarray(members)
        others = np.setdiff1d(np.concatenate((pairs_a, pairs_b)), members)
        self.columns = np.concatenate((self.members, others)).astype(int)
        self.bodies = _own_bodies(world.bodies, self.columns, len(self.members))
        self._keys = frozenset((pairs_a * world.bodies.count + pairs_b).tolist())
        local = np.empty(world.bodies.count, dtype=int)
        local[self.columns] = np.arange(len(self.columns))
        self.pairs = PairGroups(self.bodies, local[pairs_a], local[pairs_b])
        self.thickness = _thickness(self.bodies, self.pairs.pairs_a, self.pairs.pairs_b)
        """(p,) [m]: half of the thinner of a pair; no end of it with a plane."""
        self._turning = TurningBounds(self.bodies)
        self.resists_spin = resists_spin(self.bodies)
        """Whether there is friction against rolling or pivoting."""
        self.automata = {}
        """What has been set up for one member on one plane, by the place of the pair."""
        self.forces = memory_of(older, pairs_a, pairs_b)
        """Impulses per time of the last step's halves, by name: see `Near.struck`."""
        self._found = None
        """The margins [m], the `Motion` and its contacts that were found last."""
        self._near = None
        """The margin [m] and the `Near` that were found last."""
        self.pile = None
        """What many members keep from step to step."""
        self.displaced = False
        """Whether a member may have been put elsewhere since a pile has looked."""
        self._parts = {}
        """Islands of some of the members, by these and their pairs."""
        self.older_piles = [island.pile for island in older if island.pile is not None]

    def covers(self, pairs_a, pairs_b):
        """Return whether all these pairs (p,), as for the constructor, are looked after."""
        return self._keys.issuperset((pairs_a * self.world.bodies.count + pairs_b).tolist())

    def others(self, moving_count):
        """Return which of the scene's first `moving_count` bodies it takes for fixed, (k,) int."""
        others = self.columns[self.member_count:]
        return others[others < moving_count]

    def part(self, members, pairs):
        """Return the island of some of the members (k,) int and of the pairs (p,) int."""
        if len(members) == self.member_count and len(pairs) == len(self.pairs.pairs_a):
            return self
        key = members.tobytes(), pairs.tobytes()
        if key not in self._parts:
            columns = self.columns
            self._parts[key] = Island(
                self.world, self.members[members], columns[self.pairs.pairs_a[pairs]],
                columns[self.pairs.pairs_b[pairs]], (self,))
        return self._parts[key]

    @property
    def member_count(self):
        """Count of moving bodies."""
        return len(self.members)

    def free_motion(self, state):
        """Return the `FreeMotion` under the forces of a `State` of the whole scene."""
        bodies, columns = self.bodies, self.columns
        moving = bodies.inverse_mass > 0
        acceleration = (self.world.gravity[:, None] * moving
                        + bodies.inverse_mass * state.force[:, columns])
        return FreeMotion(bodies, acceleration, state.torque[:, columns] * moving)

    def scales(self, free):
        """Return the `Scales` of the island under a `FreeMotion`."""
        acceleration = free.acceleration
        return Scales(float(self.bodies.bounding_radius[:self.member_count].min()),
                      float(np.sqrt((acceleration * acceleration).sum(axis=0).max())))

    def gather(self, state):
        """Return the island's `Motion` out of a `State` of the whole scene."""
        columns, moving = self.columns, self.bodies.inverse_mass > 0
        return Motion(state.position[:, columns], state.orientation[:, columns],
                      state.linear_velocity[:, columns] * moving,
                      state.angular_velocity[:, columns] * moving)

    def scatter(self, motion, state):
        """Put the members' columns of a `Motion` into a `State` of the whole scene."""
        count = self.member_count
        for quantity, columns in (
                ('position', motion.position), ('orientation', motion.orientation),
                ('linear_velocity', motion.linear), ('angular_velocity', motion.angular)):
            state.change(quantity, self.members, columns[:, :count])

    def speeds(self, free, motion):
        """Return how fast points of bodies are (n,) [m/s], and how soon faster (n,) [m/s^2]."""
        return _length(motion.linear) + self.turning(motion), _length(free.acceleration)

    def reach(self, free, motion, duration):
        """Return how far [m] any point of the bodies (n,) comes in a time [s] without impacts."""
        speed, pull = self.speeds(free, motion)
        return duration * (speed + duration * pull)

    def turning(self, motion):
        """Return bounds (n,) of how fast [m/s] the points of bodies go about their centres."""
        return self._turning.speeds(motion.orientation, motion.angular)

    def closing(self, motion):
        """Return bounds (p,) of how fast [m/s] the points of pairs approach or pass each other."""
        a, b = self.pairs.pairs_a, self.pairs.pairs_b
        turning, linear = self.turning(motion), motion.linear
        return _length(linear[:, b] - linear[:, a]) + turning[a] + turning[b]

    def find_contacts(self, motion, margin):
        """Return the contacts (own columns) with gaps below a margin [m], (p,) or one."""
        last = self._found
        if last is None or not (np.array_equal(last[0], margin) and same_poses(last[1], motion)):
            self.world.work.narrow_phases += len(self.pairs.pairs_a)
            last = self._found = margin, motion, self.pairs.find_contacts(
                motion.position, motion.orientation, margin)
        return last[2]

    def disturb(self, indices):
        """Note that something has happened to these bodies (k,) of the scene, members or not."""
        if self.pile is not None:
            self.pile.quiet.forget(indices)
        for part in self._parts.values():
            part.disturb(indices)

    def displace(self):
        """Note that bodies have been put elsewhere, members or not."""
        self.displaced = True
        for part in self._parts.values():
            part.displace()

    def near(self, motion, margin):
        """Return the contacts `Near` a `Motion`, with gaps below a margin [m]."""
        last = self._near
        if last is None or last[0] < margin or not last[1].is_at(motion):
            last = self._near = margin, Near(self, motion, self.find_contacts(motion, margin))
        return last[1]

    def remember(self, near, margin):
        """Take these contacts `Near` a pose, known up to a margin [m], for what is found there."""
        self._near = margin, near


def _thickness(bodies, pairs_a, pairs_b):
    """Return the least half extents (p,) [m] of pairs; a plane has no other side to come out."""
    extents = bodies.half_extents
    half = np.where(extents.any(axis=0), extents.min(axis=0), np.inf)
    flat = np.isinf(half[pairs_a]) | np.isinf(half[pairs_b])
    return np.where(flat, np.inf, np.minimum(half[pairs_a], half[pairs_b]))


def _own_bodies(bodies, columns, member_count):
    """Return the `Bodies` of these columns, of which all but the first do not move."""
    mobile = np.arange(len(columns)) < member_count
    kinds = tuple(bodies.kinds[column] for column in columns)
    return replace(
        bodies, names=tuple(bodies.names[column] for column in columns),
        moving_count=member_count, body_count=len(columns), kinds=kinds,
        half_extents=bodies.half_extents[:, columns],
        bounding_radius=bodies.bounding_radius[columns],
        turning_radius=bodies.turning_radius[columns],
        plane_normal=bodies.plane_normal[:, columns], plane_offset=bodies.plane_offset[columns],
        inverse_mass=bodies.inverse_mass[columns] * mobile,
        inertia=np.where(mobile, bodies.inertia[:, columns], 1.0),
        inverse_inertia=bodies.inverse_inertia[:, columns] * mobile,
        restitution=bodies.restitution[columns], friction=bodies.friction[columns],
        restitution_speed=bodies.restitution_speed[columns],
        rolling_friction=bodies.rolling_friction[columns],
        pivoting_friction=bodies.pivoting_friction[columns])


def _length(vectors):
    """Return the lengths (n,) of vectors (3, n)."""
    return np.sqrt(rotation.dot(vectors, vectors))
