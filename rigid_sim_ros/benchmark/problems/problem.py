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

"""What a problem is, and how its scenes are written."""

from dataclasses import dataclass
from typing import Callable

import numpy as np

FRAME_RATE = 60
"""[Hz]. Readings are at whole frames, so that every step of 1 / (60 k) s meets them."""

RATES = (60, 240, 960)
"""Steps a second that are tried, unless a problem says otherwise."""

PLANE = {'name': 'ground'}


@dataclass(frozen=True)
class Problem:
    """One row of the benchmark."""

    name: str
    """As on the command line."""

    title: str

    scene: Callable
    """Returns the scene as the mapping that `load_scene` takes."""

    times: tuple
    """When poses are read [s], each a whole frame; the last is the end."""

    measure: Callable
    """From a `Trajectory` to a mapping of measures; names end in the unit."""

    plotted: str
    """The measure that plots and summaries show."""

    rates: tuple = RATES
    """Steps a second."""

    reads_every_step: bool = False
    """Whether poses are read in each step of the timed run, and not only at `times`."""

    may_sleep: bool = False
    """Whether engines that let one choose may put bodies to sleep."""

    reach: float = 1e3
    """A body this far [m] from where bodies start has blown up."""

    bodies: int = 1
    """Of the moving bodies."""

    @property
    def duration(self):
        """Return how much time is simulated [s]."""
        return self.times[-1]


def frames(duration, every=1):
    """Return the times [s] of every so-manieth frame up to a duration, as a tuple."""
    count = round(duration * FRAME_RATE)
    return tuple(frame / FRAME_RATE for frame in range(every, count + 1, every))


def frames_near(instants, offset):
    """
    Return frames for parabolas: three for each instant [s], at it and an offset [s] either side.

    Each is the nearest whole frame.
    """
    numbers = {round((instant + side * offset) * FRAME_RATE)
               for instant in instants for side in (-1, 0, 1)}
    return tuple(number / FRAME_RATE for number in sorted(numbers))


def cube(name, position, edge=0.2, **others):
    """Return a cube of 1 kg, as in a scene file."""
    return {'name': name, 'cube': {'edge': edge}, 'mass': 1.0, 'position': list(position),
            **{key: value if isinstance(value, dict) else list(value)
               for key, value in others.items()}}


def scene(bodies, planes=(PLANE,), restitution=0.0, friction=0.5, gravity=(0.0, 0.0, -9.81)):
    """Return a scene mapping with one material for all."""
    return {'gravity': list(gravity), 'planes': [dict(plane) for plane in planes],
            'material': {'restitution': restitution, 'friction': friction},
            'bodies': list(bodies)}


def largest(values):
    """Return the largest magnitude as a float."""
    return float(np.abs(values).max())
