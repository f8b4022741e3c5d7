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
Which bodies turn about an axis that stays.

Those with equal moments and a torque that is zero or along the rate, among them those driven from
rest; those at rest without torque; and those whose rate and torque are both along the same
principal axis. All to the last digit: a rate next to the middle axis leaves it.
"""

from math import hypot

import numpy as np

from rigid_sim_ros.engine.flight.plain_rotation import to_body


def staying_axis(moments, quaternion, rate, torque):
    """
    Return (axis, speed, growth), or None if the axis does not stay.

    One body in plain floats: principal moments (3,), unit quaternion, rate [rad/s] and torque
    (3,) in world axes. `axis` is a unit vector in world axes, `speed` the rate about it and
    `growth` the change of that rate [rad/s^2], which may be negative.
    """
    turning, driven = any(rate), any(torque)
    if not turning and not driven:
        return (0.0, 0.0, 1.0), 0.0, 0.0
    moment = moments[0]
    if moments[1] != moment or moments[2] != moment:
        moment = _principal_moment(moments, to_body(quaternion, rate), to_body(quaternion, torque))
        if moment is None:
            return None
    elif driven and turning and not _parallel(rate, torque):
        return None
    direction = rate if turning else torque
    length = hypot(*direction)
    x, y, z = axis = tuple(component / length for component in direction)
    growth = (x * torque[0] + y * torque[1] + z * torque[2]) / moment
    return axis, length if turning else 0.0, growth


def staying_axes(moments, quaternion, rate, torque):
    """
    Return (axis (3, k), speed (k,), growth (k,), stays (k,) bool) of k bodies.

    As `staying_axis`, for arrays (3, k) and (4, k); where the axis does not stay the rest is
    finite and means nothing.
    """
    turning, driven = rate.any(axis=0), torque.any(axis=0)
    equal = (moments[0] == moments[1]) & (moments[0] == moments[2])
    # along one body axis only, the same for both
    moving = np.not_equal(to_body(quaternion, rate), 0) | np.not_equal(
        to_body(quaternion, torque), 0)
    principal = moving.sum(axis=0) == 1
    moment = np.where(equal | ~principal, moments[0], (moments * moving).sum(axis=0))
    stays = np.where(equal, _are_parallel(rate, torque), principal) | ~(turning | driven)
    direction = np.where(turning, rate, torque)
    length = np.hypot(np.hypot(direction[0], direction[1]), direction[2])
    axis = direction / np.where(length > 0, length, 1.0)
    growth = (axis[0] * torque[0] + axis[1] * torque[1] + axis[2] * torque[2]) / moment
    return axis, np.where(turning, length, 0.0), growth, stays


def _principal_moment(moments, rate, torque):
    """Return the moment about the body axis that rate and torque share, or None."""
    axes = [axis for axis in range(3) if rate[axis] or torque[axis]]
    return moments[axes[0]] if len(axes) == 1 else None


def _parallel(rate, torque):
    """
    Return whether a torque is along a rate to the last digit, neither zero.

    Each is divided by its own size: products of components would underflow for tiny rates.
    """
    largest_rate, largest_torque = max(map(abs, rate)), max(map(abs, torque))
    rate = [component / largest_rate for component in rate]
    torque = [component / largest_torque for component in torque]
    return rate == torque or rate == [-component for component in torque]


def _are_parallel(rate, torque):
    """Return the same of vectors (3, k); zero is along everything."""
    largest_rate, largest_torque = abs(rate).max(axis=0), abs(torque).max(axis=0)
    nothing = (largest_rate == 0) | (largest_torque == 0)
    rate = rate / np.where(nothing, 1.0, largest_rate)
    torque = torque / np.where(nothing, 1.0, largest_torque)
    return nothing | (rate == torque).all(axis=0) | (rate == -torque).all(axis=0)
