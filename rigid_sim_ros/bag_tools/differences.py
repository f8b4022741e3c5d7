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

"""How far what was made again is from what was recorded."""

from dataclasses import dataclass

import numpy as np
from rigid_sim_ros.engine import rotation
from rigid_sim_ros.messages import (
    decode_collisions, decode_pose_array, MessageError, MultiDOFJointStateDecoder)

_QUANTITIES = {'poses': (('position', 3), ('orientation', 4)),
               'states': (('position', 3), ('orientation', 4), ('linear velocity', 3),
                          ('angular velocity', 3), ('force', 3), ('torque', 3))}


def first_difference(pair, names):
    """
    Describe the first difference in a pair of messages that are not the same bytes, one line.

    Raises `MessageError` if the recorded message cannot be read.
    """
    time = f'{pair.time_ns / 1e9:.9f} s'
    if pair.kind == 'collisions':
        return _collision_difference(pair, time)
    recorded, again = (_rows(pair.kind, data) for data in (pair.recorded, pair.again))
    if recorded.shape != again.shape:
        return f'{time}: {len(recorded)} bodies recorded, {len(again)} simulated'
    # as bits, so that -0.0 and NaN count too
    different = recorded.view(np.uint64) != again.view(np.uint64)
    if not different.any():
        return f'{time}: {pair.kind}: the numbers are equal, the names, frame or stamp differ'
    body = int(np.argmax(different.any(axis=1)))
    column = int(np.argmax(different[body]))
    for quantity, width in _QUANTITIES[pair.kind]:
        if column < width:
            break
        column -= width
    start = sum(size for name, size in _QUANTITIES[pair.kind][:[
        name for name, _ in _QUANTITIES[pair.kind]].index(quantity)])
    values = [rows[body, start:start + width].tolist() for rows in (recorded, again)]
    return f'{time}: {names[body]}: {quantity} {values[0]} recorded, {values[1]} simulated'


def _rows(kind, data):
    if kind == 'poses':
        poses = decode_pose_array(data)
        return np.hstack([poses.position, poses.orientation])
    state = MultiDOFJointStateDecoder().decode(data)
    return np.hstack([state.transforms, state.twists, state.wrenches])


def _collision_difference(pair, time):
    recorded, again = decode_collisions(pair.recorded), decode_collisions(pair.again)
    if len(recorded) != len(again):
        return f'{time}: {len(recorded)} collision events recorded, {len(again)} simulated'
    for number, (one, other) in enumerate(zip(recorded, again)):
        for name in recorded.dtype.names:
            if one[name].tobytes() != other[name].tobytes():
                return (f'{time}: collision event {number}: {name} {one[name].tolist()} recorded, '
                        f'{other[name].tolist()} simulated')
    return f'{time}: collisions: the same events, other bytes'


@dataclass
class _Deviation:
    """How far the bodies of one state are apart in one quantity."""

    time: float
    largest: float
    name: str
    """Of the body that is farthest off."""

    median: float
    root_mean_square: float


class Deviations:
    """Distances and angles between recorded and simulated bodies, state by state."""

    def __init__(self):
        self.distances, self.angles = [], []
        """Between centres of mass [m]; of the turns from one attitude to the other [rad]."""

    def add(self, pair, names):
        """Take in a pair of poses of bodies; raises `MessageError` if they do not compare."""
        recorded, again = decode_pose_array(pair.recorded), decode_pose_array(pair.again)
        if recorded.position.shape != again.position.shape:
            raise MessageError(f'{len(recorded.position)} bodies recorded, '
                               f'{len(again.position)} simulated')
        if not len(names):
            return
        distance = np.linalg.norm(recorded.position - again.position, axis=1)
        angle = rotation.angle_between(recorded.orientation.T, again.orientation.T)
        # the product of a quaternion and its inverse is not quite one
        angle[(recorded.orientation == again.orientation).all(axis=1)] = 0.0
        for found, values in ((self.distances, distance), (self.angles, angle)):
            worst = int(np.argmax(values))
            found.append(_Deviation(
                pair.time_ns / 1e9, float(values[worst]), names[worst], float(np.median(values)),
                float(np.sqrt(np.mean(values ** 2)))))

    @property
    def found(self):
        """Whether any pose differs."""
        return any(one.largest != 0 for one in (*self.distances, *self.angles))

    def report(self):
        """Return lines that tell the largest deviations and those at the end."""
        if not self.distances:
            return ['no bodies']
        lines = []
        for what, found, unit in (('position', self.distances, 'm'),
                                  ('attitude', self.angles, 'rad')):
            # what is not a number is the worst of all
            worst = max(found, key=lambda one: (one.largest != one.largest, one.largest))
            lines.append(
                f'{what}: largest deviation {worst.largest:.6g} {unit} '
                f'({worst.name} at {worst.time:.9f} s), '
                f'root mean square at the end {found[-1].root_mean_square:.6g} {unit}')
        return lines

    def plot(self, path):
        """Draw the largest deviations over time into a file; needs matplotlib."""
        import matplotlib
        matplotlib.use('Agg')
        from matplotlib import pyplot
        figure, axes = pyplot.subplots(2, 1, sharex=True)
        for axis, found, label in zip(axes, (self.distances, self.angles),
                                      ('position [m]', 'attitude [rad]')):
            time = [one.time for one in found]
            axis.plot(time, [one.largest for one in found], label='largest')
            axis.plot(time, [one.median for one in found], label='median')
            if any(one.largest > 0 for one in found):
                # of nothing but zeros there is no logarithm
                axis.set_yscale('log')
            axis.set_ylabel(label)
            axis.grid(True)
        axes[0].legend()
        axes[1].set_xlabel('simulated time [s]')
        figure.savefig(path)
        pyplot.close(figure)
