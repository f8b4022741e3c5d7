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
The contact forces of one body on one plane, in plain floats.

Which points stick and which slide along known directions is tried first: one small linear system
for the forces as unknowns, in as many columns as there are independent ones, so that the choice
among redundant forces is the canonical one (`solvers.canonical`):

- four corners, all sliding: pressure c0 + c1 x + c2 y, three unknowns; two more if one of them
  sticks;
- two sticking corners: equal friction along the line between them, five unknowns;
- otherwise what a point has, one unknown if it slides and three if it sticks.

Where that is not the solution, or there are more redundant ones, the general solver decides. The
commonest cases have closed forms, in `patterns`.
"""

from math import hypot

import numpy as np

from rigid_sim_ros.engine.lasting_contact.automaton.plane_body import cross, dot
from rigid_sim_ros.engine.solvers import ContactProblem, solve
from rigid_sim_ros.engine.solvers.single import solve_one

_AXES = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
"""Normal and tangents, in the order of a contact problem's rows."""

LEAST_RESPONSE = 0.02
"""Of the normal response without friction: the least that friction may leave of it."""


def contact_forces(body, turn, arms, free, slips):
    """
    Return the forces (3,) on points so that none accelerates into the plane.

    Parameters
    ----------
    body : PlaneBody
        The body on the plane.
    turn : rotation matrix
        Of its state.
    arms, free : lists of (3,)
        Of the points in contact: from the centre [m], and the acceleration without contact
        [m/s^2].
    slips : list of (2,) or None
        The direction in which a point slides; None where it may stick.

    """
    if len(arms) == 1:
        return [one_point(body, turn, arms[0], free[0], slips[0])]
    forces = _guessed(body, turn, arms, free, slips)
    if forces is not None and _allowed(body, forces, slips):
        return forces
    return general_forces(body, turn, arms, free, slips)


def accelerations(body, turn, arms, forces):
    """Return the linear and angular acceleration, (3,) each, due to forces at points."""
    total = [sum(part) for part in zip(*forces)]
    torque = [sum(part) for part in zip(*(cross(r, f) for r, f in zip(arms, forces)))]
    m = body.inverse_mass
    return (m * total[0], m * total[1], m * total[2]), body.turned(turn, torque)


def held(body, turn, arms, motion, sticks):
    """
    Return the change of linear and angular motion (3,) that stops points.

    Of all the motion along the normal, of those that stick all of it; or None if that stops the
    body altogether. The change is the least in the metric of mass: it can only take energy.
    """
    sticking = [point for point, stick in enumerate(sticks) if stick]
    if len(arms) > 2 and len(sticking) > 1:
        return None
    if len(arms) > 3 and sticking:
        # one point that sticks and two that stay on the plane leave nothing to a fourth
        point = next(point for point, stick in enumerate(sticks) if not stick)
        arms, motion, sticks = (
            [each for which, each in enumerate(rows) if which != point]
            for rows in (arms, motion, sticks))
    slips = [None if stick else (0.0, 0.0) for stick in sticks]
    forces = _guessed(body, turn, arms, motion, slips)
    return None if forces is None else accelerations(body, turn, arms, forces)


def _allowed(body, forces, slips):
    """Return whether all push and those that stick are in their cones."""
    for (x, y, z), slip in zip(forces, slips):
        if z < 0.0 or slip is None and hypot(x, y) > body.friction * z:
            return False
    return True


def _guessed(body, turn, arms, free, slips):
    """Return the forces if all points are closed and do what `slips` says, or None."""
    count = len(arms)
    sticking = sum(slip is None for slip in slips)
    if sticking < 2 and count > 3:
        columns, rows = _affine_columns(body, arms, slips)
    elif sticking == 2 and count == 2:
        columns, rows = _edge_columns(arms)
    elif sticking and 3 * sticking + count - sticking > 5:
        return None
    else:
        columns, rows = _point_columns(body, arms, slips)
    matrix = []
    motions = [_motion_by(body, turn, arms, column) for column in columns]
    for point, axis in rows:
        r, e = arms[point], axis
        t = cross(r, e)
        matrix.append([e[0] * a + e[1] * b + e[2] * c + t[0] * d + t[1] * f + t[2] * g
                       for a, b, c, d, f, g in motions] + [-dot(e, free[point])])
    sizes = _eliminate(matrix)
    if sizes is None:
        return None
    forces = [[0.0, 0.0, 0.0] for _ in arms]
    for size, column in zip(sizes, columns):
        for point, direction in column:
            force = forces[point]
            force[0] += size * direction[0]
            force[1] += size * direction[1]
            force[2] += size * direction[2]
    return forces


def _motion_by(body, turn, arms, column):
    """Return the linear and angular acceleration (6,) due to forces (3,) at points."""
    fx = fy = fz = tx = ty = tz = 0.0
    for point, (x, y, z) in column:
        r = arms[point]
        fx += x
        fy += y
        fz += z
        tx += r[1] * z - r[2] * y
        ty += r[2] * x - r[0] * z
        tz += r[0] * y - r[1] * x
    m = body.inverse_mass
    return m * fx, m * fy, m * fz, *body.turned(turn, (tx, ty, tz))


def _point_columns(body, arms, slips):
    """Return columns [(point, force (3,))] and rows (point, axis (3,)) of independent points."""
    columns, rows = [], []
    for point, slip in enumerate(slips):
        if slip is None:
            columns += [[(point, axis)] for axis in _AXES]
            rows += [(point, axis) for axis in _AXES]
        else:
            columns.append([(point, _sliding(body, slip))])
            rows.append((point, _AXES[0]))
    return columns, rows


def _sliding(body, slip):
    """Return the force of a sliding point per normal force."""
    return -body.friction * slip[0], -body.friction * slip[1], 1.0


def _affine_columns(body, arms, slips):
    """
    Return columns and rows for four corners of a face: pressure c0 + c1 x + c2 y.

    All slide, or all but one about which the face turns; that has friction of its own.
    """
    forces = [_AXES[0] if slip is None else _sliding(body, slip) for slip in slips]
    middle_x = sum(arm[0] for arm in arms) / len(arms)
    middle_y = sum(arm[1] for arm in arms) / len(arms)
    columns = [list(enumerate(forces))]
    for axis, middle in ((0, middle_x), (1, middle_y)):
        weights = [arm[axis] - middle for arm in arms]
        columns.append([(point, (w * f[0], w * f[1], w * f[2]))
                        for point, (w, f) in enumerate(zip(weights, forces))])
    rows = [(point, _AXES[0]) for point in range(3)]
    if None in slips:
        pivot = slips.index(None)
        columns += [[(pivot, axis)] for axis in _AXES[1:]]
        rows += [(pivot, axis) for axis in _AXES[1:]]
    return columns, rows


def _edge_columns(arms):
    """Return columns and rows for two sticking points: equal forces along their line."""
    (ax, ay, _), (bx, by, _) = arms
    length = hypot(bx - ax, by - ay)
    along = ((bx - ax) / length, (by - ay) / length, 0.0)
    across = (-along[1], along[0], 0.0)
    columns = [[(0, _AXES[0])], [(0, across)], [(1, _AXES[0])], [(1, across)],
               [(0, along), (1, along)]]
    rows = [(0, _AXES[0]), (0, across), (1, _AXES[0]), (1, across), (0, along)]
    return columns, rows


def one_point(body, turn, arm, free, slip):
    """Return the force on a single point; arguments as for `contact_forces`."""
    if free[2] >= 0.0:
        return 0.0, 0.0, 0.0
    response = response_of(body, turn, arm)
    if slip is None:
        normal, first, second = solve_one(response, (free[2], free[0], free[1]), body.friction)
        return first, second, normal
    x, y, _ = _sliding(body, slip)
    nn = response[0]
    # friction that presses the point down as fast as the normal force lifts it (Painleve) has no
    # solution as a force: its coupling is limited, and position errors are projected away
    normal = -free[2] / max(nn + response[1] * x + response[2] * y, LEAST_RESPONSE * nn)
    return normal * x, normal * y, normal


def response_of(body, turn, arm):
    """Return the response (nn, n1, n2, 11, 12, 22) of a point, axes z, x, y."""
    m = body.inverse_mass
    x, y, z = arm
    if body.alike:
        i = body.inverse_inertia[0]
        return (m + i * (x * x + y * y), -i * x * z, -i * y * z,
                m + i * (y * y + z * z), -i * x * y, m + i * (x * x + z * z))
    turns = [cross(arm, axis) for axis in _AXES]
    bodily = [body.turned(turn, t) for t in turns]
    return (m + dot(turns[0], bodily[0]), dot(turns[0], bodily[1]), dot(turns[0], bodily[2]),
            m + dot(turns[1], bodily[1]), dot(turns[1], bodily[2]), m + dot(turns[2], bodily[2]))


def responses_of(body, turn, arms):
    """Return the response (3k, 3k) of points as for a `ContactProblem`, axes z, x, y."""
    jacobian = np.array([(*axis, *cross(arm, axis)) for axis in _AXES for arm in arms])
    turns = np.array(turn)
    bodily = turns * body.inverse_inertia @ turns.T
    scaled = np.hstack((jacobian[:, :3] * body.inverse_mass, jacobian[:, 3:] @ bodily))
    return scaled @ jacobian.T


def rows_of(vectors):
    """Return components (3k,) along z, x, y of k vectors (3,) in the plane's frame."""
    return np.array([vector[axis] for axis in (2, 0, 1) for vector in vectors])


def vectors_of(rows):
    """Return k vectors (3,) in the plane's frame of components (3k,) along z, x, y."""
    normal, first, second = rows.reshape(3, -1).tolist()
    return list(zip(first, second, normal))


def general_forces(body, turn, arms, free, slips):
    """Return the forces by the general solver, which takes anything."""
    count = len(arms)
    known = np.array([slip or (0.0, 0.0) for slip in slips]).T
    solution = solve(ContactProblem(responses_of(body, turn, arms), rows_of(free),
                                    np.full(count, body.friction), np.zeros(count), known),
                     body.last_forces.get(count))
    body.last_forces[count] = solution.start
    return vectors_of(solution.force)


def _eliminate(rows):
    """Return the solution of a small linear system given as rows with right side, or None."""
    count = len(rows)
    for step in range(count):
        pivot = max(range(step, count), key=lambda row: abs(rows[row][step]))
        if rows[pivot][step] == 0.0:
            return None
        rows[step], rows[pivot] = rows[pivot], rows[step]
        top = rows[step]
        for row in rows[step + 1:]:
            factor = row[step] / top[step]
            if factor:
                for column in range(step + 1, count + 1):
                    row[column] -= factor * top[column]
    solution = [0.0] * count
    for step in range(count - 1, -1, -1):
        row = rows[step]
        rest = row[count]
        for column in range(step + 1, count):
            rest -= row[column] * solution[column]
        solution[step] = rest / row[step]
    return solution
