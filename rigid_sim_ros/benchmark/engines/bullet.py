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

"""Bullet, through pybullet."""

from math import sqrt

import numpy as np
import pybullet

from rigid_sim_ros.benchmark.engines import Engine


class Bullet(Engine):
    """
    Sequential impulses, always 50 iterations, friction cones, no damping, rebound at any speed.

    Bullet damps 4 % a second and forgets restitution below 0.2 m/s unless told otherwise. It
    multiplies the restitutions and frictions of a pair, so each surface gets the square root: the
    scene file's rule for frictions, and for restitutions if both are equal.
    Bodies are multi-bodies of one link, pybullet's default: as plain rigid bodies they take up to
    half less time in stacks, but slide to rest seven times less accurately, and off an incline not
    at all. There is one world a process, as naming the world in each call would cost time.
    """

    def build(self, scene, step, sleeping):
        """Make the world; what was built before in this process is gone."""
        if not pybullet.isConnected():
            pybullet.connect(pybullet.DIRECT)
        pybullet.resetSimulation()
        pybullet.setGravity(*scene.gravity)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=step, numSubSteps=0, numSolverIterations=50, enableConeFriction=1,
            solverResidualThreshold=0, restitutionVelocityThreshold=0.0,
            deterministicOverlappingPairs=1)
        for plane in scene.planes:
            shape = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=plane.normal)
            number = pybullet.createMultiBody(
                0, shape, basePosition=np.multiply(plane.normal, plane.offset))
            _set_material(number, plane.material)
        numbers = [_add_body(body, sleeping) for body in scene.bodies]
        moving = [(number, body) for number, body in zip(numbers, scene.bodies) if not body.fixed]
        self.numbers = [number for number, _ in moving]
        self.driven = [(number, body.force, body.torque) for number, body in moving
                       if any(body.force) or any(body.torque)]
        self.step = step

    def advance(self, duration):
        """Advance by so many steps, giving constant forces anew in each as Bullet wants it."""
        for _ in range(round(duration / self.step)):
            for number, force, torque in self.driven:
                position, _ = pybullet.getBasePositionAndOrientation(number)
                pybullet.applyExternalForce(number, -1, force, position, pybullet.WORLD_FRAME)
                pybullet.applyExternalTorque(number, -1, torque, pybullet.WORLD_FRAME)
            pybullet.stepSimulation()

    def read_poses(self):
        """Return positions and orientations, body by body: there is no call for all."""
        poses = [pybullet.getBasePositionAndOrientation(number) for number in self.numbers]
        return (np.array([position for position, _ in poses]),
                np.array([orientation for _, orientation in poses]))

    def read_velocities(self):
        """Return linear and angular velocities."""
        rows = np.array([pybullet.getBaseVelocity(number) for number in self.numbers])
        return rows[:, 0], rows[:, 1]


def _add_body(body, sleeping):
    """Add one body with the mass and principal inertia of the scene; return its number."""
    if body.shape.kind == 'sphere':
        shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=body.shape.radius)
    else:
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX,
                                              halfExtents=body.shape.half_extents)
    number = pybullet.createMultiBody(
        0 if body.fixed else body.mass, shape, basePosition=body.position,
        baseOrientation=body.orientation)
    _set_material(number, body.material)
    if not body.fixed:
        pybullet.changeDynamics(
            number, -1, mass=body.mass, localInertiaDiagonal=body.inertia,
            activationState=(pybullet.ACTIVATION_STATE_ENABLE_SLEEPING if sleeping
                             else pybullet.ACTIVATION_STATE_DISABLE_SLEEPING))
        pybullet.resetBaseVelocity(number, body.velocity, body.angular_velocity)
    return number


def _set_material(number, material):
    pybullet.changeDynamics(
        number, -1, restitution=sqrt(material.restitution),
        lateralFriction=sqrt(material.friction), spinningFriction=0, rollingFriction=0,
        linearDamping=0, angularDamping=0)
