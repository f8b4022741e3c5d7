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
"""Simulations watched step by step: what must hold at any time, whatever the scene."""

from contextlib import contextmanager
import signal

import numpy as np

from rigid_sim_ros.engine import Simulation


class TimeLimitExceeded(Exception):
    """Raised in the middle of what takes too long."""


@contextmanager
def cpu_limit(seconds):
    """Raise `TimeLimitExceeded` where the body is after so much CPU time [s]."""
    def stop(*_):
        raise TimeLimitExceeded(f'more than {seconds} s of CPU time')

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


class Watch:
    """
    A simulation of a scene, and the worst that was seen of it.

    Parameters
    ----------
    scene : model.Scene
    step : float
        [s]
    interval : float or None
        Between readings [s]; each step if None.

    """

    def __init__(self, scene, step=1 / 240, interval=None):
        self.simulation = simulation = Simulation(scene, max_step=step)
        self.interval = step if interval is None else interval
        self.size = min(2 * min(body.shape.half_extents) for body in scene.bodies
                        if not body.fixed)
        """Thickness [m] of the thinnest moving body."""
        self.energy_scale = self._energy_scale(scene)
        """Kinetic energy at the start, and that of a fall through the scene [J]."""
        self.penetration = 0.0
        """The deepest so far, in parts of `size`."""
        self.energy_rise = 0.0
        """The most the energy has risen above any before, in parts of `energy_scale`."""
        self.momentum_change = self.spin_change = 0.0
        """The largest changes since the start, in parts of what flies about."""
        self.isolated = (not any(scene.gravity) and not scene.planes
                         and not any(body.fixed for body in scene.bodies))
        """Whether nothing external acts."""
        self._lowest_energy = simulation.energy()
        self._momentum = simulation.momentum()
        self._spin = simulation.angular_momentum()
        mass = np.array([body.mass for body in scene.bodies if not body.fixed])
        speed = np.linalg.norm(simulation.linear_velocity, axis=1)
        self._momentum_scale = float((mass * speed).sum())
        self._spin_scale = float((mass * speed).sum() * np.ptp(simulation.position, axis=0).max()
                                 + np.abs(self._spin).max())

    def _energy_scale(self, scene):
        simulation = self.simulation
        mass = np.array([body.mass for body in scene.bodies if not body.fixed])
        gravity = np.array(scene.gravity)
        strength = float(np.linalg.norm(gravity))
        height = self.size
        if strength:
            height += float(np.ptp(simulation.position @ gravity)) / strength
            if scene.planes:
                height = max(height, float(simulation.position[:, 2].max()))
        kinetic = simulation.energy() + float(mass @ (simulation.position @ gravity))
        return kinetic + mass.sum() * strength * height or 1.0

    def run(self, duration, until_rest=False):
        """Advance by a duration [s] and watch; return whether all sleep in the end."""
        simulation = self.simulation
        for _ in range(round(duration / self.interval)):
            simulation.advance(self.interval)
            self._look()
            if until_rest and simulation.asleep.all():
                break
        return bool(simulation.asleep.all())

    def _look(self):
        simulation = self.simulation
        for values in (simulation.position, simulation.orientation, simulation.linear_velocity,
                       simulation.angular_velocity):
            assert np.isfinite(values).all(), f'not finite at {simulation.time} s'
        self.penetration = max(self.penetration, simulation.penetration() / self.size)
        energy = simulation.energy()
        rise = (energy - self._lowest_energy) / self.energy_scale
        self.energy_rise = max(self.energy_rise, rise)
        self._lowest_energy = min(self._lowest_energy, energy)
        if self._momentum_scale:
            change = np.abs(simulation.momentum() - self._momentum).max()
            self.momentum_change = max(self.momentum_change, change / self._momentum_scale)
            change = np.abs(simulation.angular_momentum() - self._spin).max()
            self.spin_change = max(self.spin_change, change / self._spin_scale)
