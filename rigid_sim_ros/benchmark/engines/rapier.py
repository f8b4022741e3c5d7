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

"""Rapier, through its Python package (float32)."""

import numpy as np
import rapier3d

from rigid_sim_ros.benchmark.engines import Engine

POSE_BYTES = 36
"""A pose as `Isometry3.to_bytes` writes it: 8 of header, then float32 x, y, z, w, x, y, z."""


class Rapier(Engine):
    """
    Default solver: 4 iterations (substeps), the simplified friction model; one thread.

    More iterations gain no more than a shorter step of the same cost, and the friction model with
    a constraint a point lets a cube creep down an incline. The largest restitution and the
    geometric mean of the frictions are chosen as in scene files. A plane is a half space
    through its point nearest the origin.
    Forces and torques are held by Rapier until reset. Poses are read as bytes, the fastest way
    there is (a quarter of the time of the attributes).
    """

    def build(self, scene, step, sleeping):
        """Make the world."""
        world = rapier3d.PhysicsWorld(gravity=scene.gravity)
        world.set_num_threads(1)
        parameters = world.integration_parameters
        parameters.dt = step
        for plane in scene.planes:
            point = tuple(np.multiply(plane.normal, plane.offset))
            world.add_body(rapier3d.RigidBody.fixed(translation=point),
                           [_with_material(rapier3d.Collider.halfspace(plane.normal),
                                           plane.material)])
        handles = [_add_body(world, body, sleeping) for body in scene.bodies]
        self.world = world
        self.step = step
        self.bodies = [world.rigid_bodies[handle]
                       for handle, body in zip(handles, scene.bodies) if not body.fixed]

    def advance(self, duration):
        """Advance by so many steps."""
        step = self.world.step
        for _ in range(round(duration / self.step)):
            step()

    def read_poses(self):
        """Return positions and orientations, turned into float64."""
        data = b''.join([body.position.to_bytes() for body in self.bodies])
        rows = np.frombuffer(data, np.float32).reshape(-1, POSE_BYTES // 4)[:, 2:].astype(float)
        return rows[:, 4:], rows[:, :4]

    def read_velocities(self):
        """Return linear and angular velocities."""
        return (np.array([body.linvel.to_tuple() for body in self.bodies]),
                np.array([body.angvel.to_tuple() for body in self.bodies]))

    def asleep(self):
        """Return which bodies sleep."""
        return np.array([body.is_sleeping for body in self.bodies])


def _add_body(world, body, sleeping):
    """Add one body with the mass and principal inertia of the scene; return its handle."""
    if body.shape.kind == 'sphere':
        collider = rapier3d.Collider.ball(body.shape.radius)
    else:
        collider = rapier3d.Collider.cuboid(*body.shape.half_extents)
    collider = _with_material(collider, body.material)
    x, y, z, w = body.orientation
    pose = rapier3d.Isometry3(tuple(body.position), rapier3d.Quaternion(w, x, y, z))
    if body.fixed:
        return world.add_body(rapier3d.RigidBody.fixed().position(pose), [collider])
    collider = collider.mass_properties(rapier3d.MassProperties(
        local_com=(0.0, 0.0, 0.0), mass=body.mass, principal_inertia=tuple(body.inertia)))
    builder = (rapier3d.RigidBody.dynamic().position(pose)
               .linvel(tuple(body.velocity)).angvel(tuple(body.angular_velocity))
               .can_sleep(sleeping).gyroscopic_forces(True))
    handle = world.add_body(builder, [collider])
    added = world.rigid_bodies[handle]
    added.add_force(tuple(body.force))
    added.add_torque(tuple(body.torque))
    return handle


def _with_material(collider, material):
    return (collider.friction(material.friction).restitution(material.restitution)
            .friction_combine_rule(rapier3d.CoefficientCombineRule.GEOMETRIC_MEAN)
            .restitution_combine_rule(rapier3d.CoefficientCombineRule.MAX))
