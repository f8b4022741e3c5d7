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

"""MuJoCo."""

from itertools import combinations
from math import log, pi, sqrt

import mujoco
import numpy as np

from rigid_sim_ros.benchmark.engines import Engine

SOFTNESS = 2
"""Contact time constant and 1 / frequency in steps: the stiffest that MuJoCo keeps stable."""

IMPEDANCE = (0.99, 0.99, 0.001, 0.5, 2.0)
"""Nearly rigid at any depth: a tenth of the default's sag, and a rebound true to the spring."""

MANY, MEMORY = 2000, 1 << 30
"""With more bodies, a gigabyte [bytes]: MuJoCo's own estimate grows to a hundred of them."""

TYPES = {'box': mujoco.mjtGeom.mjGEOM_BOX, 'sphere': mujoco.mjtGeom.mjGEOM_SPHERE}


def solver_reference(restitution, step):
    """
    Return MuJoCo's contact parameters `solref` for a restitution and a step [s].

    Without rebound: critically damped, time constant two steps (the shortest that MuJoCo allows).
    With rebound: stiffness and damping given directly (negative values), natural frequency
    1 / (2 steps), damping ratio -ln e / sqrt(pi^2 + ln^2 e) as of a linear spring and damper.
    """
    if restitution == 0:
        return SOFTNESS * step, 1.0
    frequency = 1 / (SOFTNESS * step)
    logarithm = log(restitution)
    ratio = -logarithm / sqrt(pi * pi + logarithm * logarithm)
    return -frequency * frequency, -2 * ratio * frequency


class Mujoco(Engine):
    """
    Default integrator (semi-implicit Euler), Newton solver, elliptic friction cones.

    Elliptic cones with `impratio` 10 are what the manual advises against creep. MuJoCo has no
    coefficient of restitution: `solver_reference`. Where there is no friction contacts have one
    row instead of three. Constant forces are `xfrc_applied`. MuJoCo mixes frictions its own way,
    so where materials differ each pair of bodies is given what the scene file's rule says.
    """

    integrator = mujoco.mjtIntegrator.mjINT_EULER

    def build(self, scene, step, sleeping):
        """Make the model through `MjSpec` and compile it."""
        spec = mujoco.MjSpec()
        if len(scene.bodies) > MANY:
            spec.memory = MEMORY
        self._set_options(spec.option, scene, step, sleeping)
        for plane in scene.planes:
            geom = spec.worldbody.add_geom(name=plane.name, size=(0, 0, 1),
                                           type=mujoco.mjtGeom.mjGEOM_PLANE,
                                           pos=np.multiply(plane.normal, plane.offset),
                                           quat=_z_axis_to(plane.normal))
            _set_material(geom, plane.material, step)
        for body in scene.bodies:
            _add_body(spec, body, step)
        rows = (*scene.planes, *scene.bodies)
        if len({row.material for row in rows}) > 1:
            for first, second in combinations(rows, 2):
                _add_pair(spec, first, second, step)
        moving = [body for body in scene.bodies if not body.fixed]
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.step = step
        self.count = len(moving)
        numbers = [mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, body.name)
                   for body in moving]
        for number, body in zip(numbers, moving):
            self.data.xfrc_applied[number] = (*body.force, *body.torque)
        self.numbers = numbers
        velocities = self.data.qvel.reshape(self.count, 6)
        for row, body in zip(velocities, moving):
            row[:3] = body.velocity
            row[3:] = _to_body(_scalar_first(body.orientation), body.angular_velocity)
        mujoco.mj_forward(self.model, self.data)

    def _set_options(self, option, scene, step, sleeping):
        option.timestep = step
        option.gravity = scene.gravity
        option.integrator = self.integrator
        option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        option.impratio = 10
        option.tolerance = 1e-10
        if sleeping:
            option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)

    def advance(self, duration):
        """Advance by so many steps, in one call."""
        mujoco.mj_step(self.model, self.data, nstep=round(duration / self.step))

    def read_poses(self):
        """Return positions and orientations from the generalised coordinates."""
        rows = self.data.qpos.reshape(self.count, 7)
        return rows[:, :3].copy(), rows[:, (4, 5, 6, 3)]

    def read_velocities(self):
        """Return velocities; MuJoCo's own angular ones are in body axes."""
        rows = self.data.qvel.reshape(self.count, 6)
        angular = np.empty((self.count, 3))
        for result, pose, row in zip(angular, self.data.qpos.reshape(self.count, 7), rows):
            mujoco.mju_rotVecQuat(result, row[3:], pose[3:])
        return rows[:, :3].copy(), angular

    def asleep(self):
        """Return which bodies sleep."""
        return self.data.body_awake[self.numbers] == int(mujoco.mjtSleepState.mjS_ASLEEP)


class MujocoRungeKutta(Mujoco):
    """The same with the fourth-order Runge-Kutta integrator."""

    integrator = mujoco.mjtIntegrator.mjINT_RK4


def _add_body(spec, body, step):
    """Add one body with the exact mass and principal inertia of the scene."""
    pose = {'pos': body.position, 'quat': _scalar_first(body.orientation)}
    if body.fixed:
        target = spec.worldbody.add_body(name=body.name, **pose)
    else:
        target = spec.worldbody.add_body(name=body.name, mass=body.mass, inertia=body.inertia,
                                         ipos=(0, 0, 0), iquat=(1, 0, 0, 0),
                                         explicitinertial=True, **pose)
        target.add_freejoint()
    geom = target.add_geom(name=body.name, type=TYPES[body.shape.kind],
                           size=body.shape.half_extents)
    _set_material(geom, body.material, step)


def _set_material(geom, material, step):
    geom.condim = 3 if material.friction > 0 else 1
    geom.friction = (material.friction, 0.005, 0.0001)
    geom.solref = solver_reference(material.restitution, step)
    geom.solimp = IMPEDANCE


def _add_pair(spec, first, second, step):
    """Give a pair the larger restitution and the geometric mean of the frictions."""
    friction = sqrt(first.material.friction * second.material.friction)
    restitution = max(first.material.restitution, second.material.restitution)
    spec.add_pair(geomname1=first.name, geomname2=second.name, condim=3 if friction > 0 else 1,
                  friction=(friction, friction, 0.005, 0.0001, 0.0001), solimp=IMPEDANCE,
                  solref=solver_reference(restitution, step))


def _scalar_first(orientation):
    x, y, z, w = orientation
    return w, x, y, z


def _to_body(orientation, vector):
    """Return a world vector in body axes; the quaternion is w, x, y, z."""
    inverse, result = np.empty(4), np.empty(3)
    mujoco.mju_negQuat(inverse, np.array(orientation, dtype=float))
    mujoco.mju_rotVecQuat(result, np.array(vector, dtype=float), inverse)
    return result


def _z_axis_to(normal):
    """Return a quaternion w, x, y, z that turns the z axis to a unit normal."""
    result = np.empty(4)
    mujoco.mju_quatZ2Vec(result, np.array(normal, dtype=float))
    return result
