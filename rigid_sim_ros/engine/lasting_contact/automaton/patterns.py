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
Contact forces and accelerations of one body on one plane: closed forms of the commonest cases.

An edge that sticks turns about itself; a face that slides moves in the plane; a face that sticks
does not move. All three are redundant, and the forces are the canonical ones: least in sum of
squares where all sticks, pressure c0 + c1 x + c2 y where all slides (`solvers.canonical`). Each
form refuses, by returning None, where a point would pull or leave its cone.
"""

from math import hypot

from rigid_sim_ros.engine.lasting_contact.automaton.forces import (
    accelerations, contact_forces, LEAST_RESPONSE, one_point)
from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import cross, dot, SPIN

MOST_RESPONSE = 10.0
"""Bound of the normal response of a point of a box or a ball, in inverse masses."""


def constrained(body, state, turn, points, arms, slips, linear, angular):
    """
    Return (forces (3,) on points, linear, angular acceleration) with points in contact.

    Parameters
    ----------
    body : PlaneBody
        The body on the plane.
    state : list of 13 floats
        Its pose and velocities.
    turn : rotation matrix
        Of the state.
    points, arms : lists of int, of (3,) [m]
        The points in contact, and where they are from the centre.
    slips : list of (2,) or None
        The direction in which a point slides; None where it may stick.
    linear, angular : (3,) [m/s^2], [rad/s^2]
        The accelerations without contact.

    """
    found = _in_closed_form(body, state, turn, points, arms, slips, linear, angular)
    if found is None:
        free = body.accelerations(state, arms, linear, angular)
        found = contact_forces(body, turn, arms, free, slips), None, None
    forces, acceleration, turning = found
    if acceleration is None:
        added = accelerations(body, turn, arms, forces)
        acceleration = [a + b for a, b in zip(linear, added[0])]
        turning = [a + b for a, b in zip(angular, added[1])]
    return forces, acceleration, turning


def _in_closed_form(body, state, turn, points, arms, slips, linear, angular):
    """Return what `constrained` does, or None; no accelerations if they are those of forces."""
    count = len(points)
    if None not in slips:
        form = _sliding_points if count < 3 else _sliding_face
        return form(body, state, turn, arms, slips, linear, angular)
    if count == 1:
        free = body.accelerations(state, arms, linear, angular)
        return (one_point(body, turn, arms[0], free[0], None),), None, None
    if slips == [None] * count:
        if count > 2:
            return _sticking_face(body, state, turn, arms, linear, angular)
        if _is_edge(body, points):
            return _sticking_edge(body, state, turn, arms, linear, angular)
    return None


def _is_edge(body, points):
    """Return whether two corners are the ends of an edge: apart along one body axis."""
    first, second = (body.corners[point] for point in points)
    return sum(a != b for a, b in zip(first, second)) == 1


def _sticking_edge(body, state, turn, arms, linear, angular):
    """
    Return (forces, linear, angular acceleration) of an edge whose ends stick, or None.

    It turns about itself, a principal axis, so that there is no gyroscopic torque.
    """
    (ax, ay, az), (bx, by, bz) = arms
    dx, dy, dz = ax - bx, ay - by, az - bz
    square = dx * dx + dy * dy + dz * dz
    length = square ** 0.5
    edge = dx / length, dy / length, dz / length
    # the centre, seen from the middle of the edge
    out = -0.5 * (ax + bx), -0.5 * (ay + by), -0.5 * (az + bz)
    moment = 1.0 / dot(edge, body.turned(turn, edge))
    mass = 1.0 / body.inverse_mass
    rate = dot(edge, state[SPIN])
    around = cross(edge, out)
    growth = (moment * dot(edge, angular) + mass * dot(around, linear)) / (
        moment + mass * dot(around, around))
    inward = rate * rate
    acceleration = [growth * a - inward * (o - dot(edge, out) * e)
                    for a, o, e in zip(around, out, edge)]
    turning = [growth * e for e in edge]
    force = [mass * (a - b) for a, b in zip(acceleration, linear)]
    torque = _torque(body, turn, turning, angular)
    rest = [t + c for t, c in zip(torque, cross(out, force))]
    hx, hy, hz = cross(rest, (dx / square, dy / square, dz / square))
    fx, fy, fz = (0.5 * f for f in force)
    forces = (fx + hx, fy + hy, fz + hz), (fx - hx, fy - hy, fz - hz)
    return (forces, acceleration, turning) if _in_cones(body, forces) else None


def _torque(body, turn, turning, angular):
    """Return the torque (3,) that makes of one angular acceleration another."""
    x, y, z = (a - b for a, b in zip(turning, angular))
    if body.alike:
        moment = body.inertia[0]
        return moment * x, moment * y, moment * z
    i1, i2, i3 = body.inertia
    (a, b, c), (d, e, f), (g, h, i) = turn
    p, q, r = (i1 * (a * x + d * y + g * z), i2 * (b * x + e * y + h * z),
               i3 * (c * x + f * y + i * z))
    return a * p + b * q + c * r, d * p + e * q + f * r, g * p + h * q + i * r


def _sticking_face(body, state, turn, arms, linear, angular):
    """Return (forces, no accelerations) of three or more sticking corners of a face, or None."""
    count = len(arms)
    mass = 1.0 / body.inverse_mass
    still = (0.0, 0.0, 0.0)
    force = [-mass * a for a in linear]
    torque = _torque(body, turn, still, angular)
    mx, my, mz = (sum(part) / count for part in zip(*arms))
    arms = [(x - mx, y - my) for x, y, _ in arms]
    tx, ty, tz = (t - c for t, c in zip(torque, cross((mx, my, mz), force)))
    xx, xy, yy = (sum(x * x for x, _ in arms), sum(x * y for x, y in arms),
                  sum(y * y for _, y in arms))
    determinant = xx * yy - xy * xy
    if determinant <= 0.0:
        return None
    # forces c + d x arm: along the normal c_z + d_x y - d_y x, in the plane a turn about it
    px, py, pz = ((xx * tx + xy * ty) / determinant, (xy * tx + yy * ty) / determinant,
                  tz / (xx + yy))
    fx, fy, fz = (f / count for f in force)
    forces = [(fx - pz * y, fy + pz * x, fz + px * y - py * x) for x, y in arms]
    if not _in_cones(body, forces):
        return None
    return forces, still, still


def _in_cones(body, forces):
    """Return whether all forces push, with no more friction than is allowed."""
    friction = body.friction
    return all(z >= 0.0 and hypot(x, y) <= friction * z for x, y, z in forces)


def _sliding_points(body, state, turn, arms, slips, linear, angular):
    """Return (forces, linear, angular acceleration) of one or two points that slide, or None."""
    inverse_mass, friction = body.inverse_mass, body.friction
    p, q, r = angular
    wx, wy, wz = state[SPIN]
    square = 0.0 if body.is_ball else wx * wx + wy * wy + wz * wz
    free, sliding, turnings = [], [], []
    for (x, y, z), (u, v) in zip(arms, slips):
        inward = 0.0 if body.is_ball else wz * (wx * x + wy * y + wz * z) - square * z
        free.append(linear[2] + p * y - q * x + inward)
        u, v = -friction * u, -friction * v
        sliding.append((u, v))
        turnings.append(body.turned(turn, (y - z * v, z * u - x, x * v - y * u)))
    normals = _normals(inverse_mass, arms, free, turnings)
    if normals is None:
        return None
    ax, ay, az = linear
    forces = []
    for normal, (u, v), (i, j, k) in zip(normals, sliding, turnings):
        forces.append((normal * u, normal * v, normal))
        normal_acceleration = inverse_mass * normal
        ax += normal_acceleration * u
        ay += normal_acceleration * v
        az += normal_acceleration
        p += normal * i
        q += normal * j
        r += normal * k
    return forces, (ax, ay, az), (p, q, r)


def _normals(inverse_mass, arms, free, turnings):
    """Return the normal forces that hold one or two points with such turning each, or None."""
    x, y, _ = arms[0]
    a = inverse_mass + turnings[0][0] * y - turnings[0][1] * x
    if len(arms) == 1:
        if a < LEAST_RESPONSE * MOST_RESPONSE * inverse_mass:
            return None
        return max(-free[0] / a, 0.0),
    b = inverse_mass + turnings[1][0] * y - turnings[1][1] * x
    x, y, _ = arms[1]
    c = inverse_mass + turnings[0][0] * y - turnings[0][1] * x
    d = inverse_mass + turnings[1][0] * y - turnings[1][1] * x
    determinant = a * d - b * c
    if determinant <= 0.0:
        return None
    normals = (b * free[1] - d * free[0]) / determinant, (
        c * free[0] - a * free[1]) / determinant
    return None if min(normals) < 0.0 else normals


def _sliding_face(body, _state, turn, arms, slips, linear, angular):
    """
    Return (forces, linear, angular acceleration) of a sliding face's corners, or None.

    It moves in the plane: no acceleration along the normal, no turning but about it, which is a
    principal axis.
    """
    friction = body.friction
    tx, ty, _ = _torque(body, turn, (0.0, 0.0, angular[2]), angular)
    pressure = _pressure(arms, slips, -friction * arms[0][2], -linear[2] / body.inverse_mass,
                         tx, ty)
    if pressure is None:
        return None
    c0, c1, c2 = pressure
    forces = []
    fx = fy = tz = 0.0
    for (x, y, _), (u, v) in zip(arms, slips):
        normal = c0 + c1 * x + c2 * y
        if normal < 0.0:
            return None
        p, q = -friction * normal * u, -friction * normal * v
        fx += p
        fy += q
        tz += x * q - y * p
        forces.append((p, q, normal))
    turning = body.turned(turn, (0.0, 0.0, tz))[2]
    inverse_mass = body.inverse_mass
    return (forces, (linear[0] + inverse_mass * fx, linear[1] + inverse_mass * fy, 0.0),
            (0.0, 0.0, angular[2] + turning))


def _pressure(arms, slips, drag, weight, tx, ty):
    """
    Return (c0, c1, c2) of the pressure c0 + c1 x + c2 y of sliding corners, or None.

    It carries a weight [N] and a torque [N m] across the normal; drag [m] is the friction
    coefficient times the height of the centre.
    """
    # moments of the pressure and of its friction
    n0 = n1 = n2 = n11 = n12 = n22 = u0 = u1 = u2 = v0 = v1 = v2 = 0.0
    for (x, y, _), (u, v) in zip(arms, slips):
        n0 += 1.0
        n1 += x
        n2 += y
        n11 += x * x
        n12 += x * y
        n22 += y * y
        u0 += u
        u1 += u * x
        u2 += u * y
        v0 += v
        v1 += v * x
        v2 += v * y
    a1, b1, d1 = n2 - drag * v0, n12 - drag * v1, n22 - drag * v2
    a2, b2, d2 = drag * u0 - n1, drag * u1 - n11, drag * u2 - n12
    m0, m1, m2 = b1 * d2 - d1 * b2, d1 * a2 - a1 * d2, a1 * b2 - b1 * a2
    determinant = n0 * m0 + n1 * m1 + n2 * m2
    if determinant == 0.0:
        return None
    e0, e1, e2 = tx * b2 - b1 * ty, tx * d2 - d1 * ty, tx * a2 - a1 * ty
    return ((weight * m0 - n1 * e1 + n2 * e0) / determinant,
            (n0 * e1 + weight * m1 - n2 * e2) / determinant,
            (-n0 * e0 + n1 * e2 + weight * m2) / determinant)
