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
Friction against rolling and pivoting of a ball on a plane, in closed form.

The law is that of `spin_friction`: a torque of up to a length times the normal force against
turning about axes in the plane, and another about the normal. What turns is resisted in full; what
does not turn is held, as far as that goes. The response of a ball to forces and torques in the
plane has no preferred direction, so that each of the two has a closed form given the other.
"""

from math import copysign, hypot

from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import SPIN

_SWEEPS = 200
"""Where neither is given, as at the start of motion: a sweep leaves 5/7 of an error."""

_ENOUGH = 1e-15
"""Of the largest force: a change of it that ends the sweeps."""


def turning_of(body, state, going, slow):
    """
    Return how a ball turns: (its direction in the plane (2,), its sign about the normal).

    Either is None where the ball does not turn or nothing resists it. Where it has been `going`
    somewhere since the step began, and has come to turn slower than `slow` [m/s] or back, it is
    still going there: forces stay smooth up to the end of the step, in which the stop is found.
    """
    rolls_on, pivots_on = going or (None, None)
    x, y, z = state[SPIN]
    rolling = pivoting = None
    if body.rolling:
        speed = hypot(x, y)
        if rolls_on is None:
            rolling = (x / speed, y / speed) if speed else None
        elif speed * body.radius <= slow:
            rolling = rolls_on
        else:
            speed = copysign(speed, x * rolls_on[0] + y * rolls_on[1])
            rolling = x / speed, y / speed
    if body.pivoting:
        pivoting = pivots_on or (copysign(1.0, z) if z else None)
    return rolling, pivoting


def resisted(body, slip, turning, linear, angular):
    """
    Return (force (3,), linear, angular acceleration (3,)) of a ball of equal moments in contact.

    Parameters
    ----------
    body : PlaneBody
        A ball.
    slip : (2,) or None
        The direction in which its lowest point slides; None where it may stick.
    turning : pair
        As `turning_of` gives it.
    linear, angular : (3,) [m/s^2], [rad/s^2]
        The accelerations without contact.

    """
    mobility, inverse_mass, radius = body.inverse_inertia[0], body.inverse_mass, body.radius
    ax, ay, az = linear
    p, q, r = angular
    normal = max(-az, 0.0) / inverse_mass
    (fx, fy), (tx, ty) = _in_plane(body, normal, slip, turning[0], linear, angular)
    twist = body.pivoting * normal
    tz = min(max(-r / mobility, -twist), twist)
    if turning[1] is not None:
        tz = -turning[1] * twist
    return ((fx, fy, normal),
            (ax + inverse_mass * fx, ay + inverse_mass * fy, max(az, 0.0)),
            (p + mobility * (tx + radius * fy), q + mobility * (ty - radius * fx),
             r + mobility * tz))


def stopped(state, radius, slow):
    """Return the state with a ball's turning stopped where slow [m/s], and its rolling with it."""
    vx, vy, vz, wx, wy, wz = state[7:]
    if radius * hypot(wx, wy) <= slow:
        wx = wy = 0.0
        if hypot(vx, vy) <= slow:
            vx = vy = 0.0
    if radius * abs(wz) <= slow:
        wz = 0.0
    return [*state[:7], vx, vy, vz, wx, wy, wz]


def _in_plane(body, normal, slip, rolling, linear, angular):
    """Return friction [N] and the torque against rolling [N m], (2,) each; see `resisted`."""
    mobility, inverse_mass, radius = body.inverse_inertia[0], body.inverse_mass, body.radius
    ax, ay, _ = linear
    p, q, _ = angular
    grip, width = body.friction * normal, body.rolling * normal
    # the acceleration of the point without contact, and its response to friction
    cx, cy = ax - radius * q, ay + radius * p
    response = inverse_mass + mobility * radius * radius

    def sticking(torque):
        """Return the friction that keeps the point from sliding."""
        return (-(cx - mobility * radius * torque[1]) / response,
                -(cy + mobility * radius * torque[0]) / response)

    def holding(force):
        """Return the torque that keeps the ball from turning."""
        return -p / mobility - radius * force[1], -q / mobility + radius * force[0]

    if slip is not None:
        force = -grip * slip[0], -grip * slip[1]
        if rolling is None:
            return force, _capped(holding(force), width)
        return force, (-width * rolling[0], -width * rolling[1])
    if rolling is not None:
        torque = -width * rolling[0], -width * rolling[1]
        return _capped(sticking(torque), grip), torque
    # both held; where that is too much for the torque alone, it rolls and sticks
    torque = holding((-ax / inverse_mass, -ay / inverse_mass))
    torque = _capped(torque, width)
    force = sticking(torque)
    if hypot(*force) > grip:
        force, torque = _both(sticking, holding, grip, width, torque)
    return force, torque


def _both(sticking, holding, grip, width, torque):
    """Return friction and torque where both may be at their limits, from a torque to start at."""
    force = _capped(sticking(torque), grip)
    for _ in range(_SWEEPS):
        torque = _capped(holding(force), width)
        before, force = force, _capped(sticking(torque), grip)
        if max(abs(force[0] - before[0]), abs(force[1] - before[1])) <= _ENOUGH * grip:
            break
    return force, torque


def _capped(vector, longest):
    """Return a vector (2,) that is no longer than allowed."""
    size = hypot(*vector)
    if size <= longest:
        return vector
    share = longest / size
    return vector[0] * share, vector[1] * share
