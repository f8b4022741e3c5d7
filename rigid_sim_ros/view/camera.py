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

"""A pinhole camera: which ray a pixel sees, and where on the picture a point is."""

from dataclasses import dataclass
from math import cos, radians, sin, tan

import numpy as np

FIELD_OF_VIEW = radians(20)
"""Vertical angle: a short telephoto, so that cubes look like cubes."""

MARGIN = 1.1
"""How much farther away the camera stands than it has to."""


@dataclass(frozen=True)
class Camera:
    """Where the camera is, what it looks at, and the size of its picture."""

    position: np.ndarray
    """(3,) [m], world axes."""

    axes: np.ndarray
    """(3, 3), rows: to the right, down, and forward; unit vectors in world axes."""

    width: int
    """[pixels]."""

    height: int
    """[pixels]."""

    @property
    def pixel(self):
        """Side of a pixel [m] at a distance of 1 m."""
        return 2 * tan(FIELD_OF_VIEW / 2) / self.height

    def rays(self):
        """
        Return a world vector for each pixel, (3, height, width), from the camera through it.

        Its component along the view is 1, so that a multiple of it is a depth [m].
        """
        x = (np.arange(self.width) + 0.5 - self.width / 2) * self.pixel
        y = (np.arange(self.height) + 0.5 - self.height / 2) * self.pixel
        right, down, forward = self.axes
        return (np.multiply.outer(right, x)[:, np.newaxis]
                + np.multiply.outer(down, y)[:, :, np.newaxis]
                + forward[:, np.newaxis, np.newaxis])

    def project(self, points):
        """Return x, y [pixels] and depth [m], each (k,), of points (k, 3) [m]."""
        x, y, depth = self.axes @ (np.asarray(points) - self.position).T
        with np.errstate(divide='ignore', invalid='ignore'):
            return (x / depth / self.pixel + self.width / 2,
                    y / depth / self.pixel + self.height / 2, depth)

    def scaled(self, factor):
        """Return the same view with `factor` times as many pixels a side."""
        return Camera(self.position, self.axes, self.width * factor, self.height * factor)


def frame(center, radius, azimuth, elevation, width, height):
    """
    Return the nearest `Camera` that has balls wholly in its picture.

    Parameters
    ----------
    center : (k, 3) [m]
        Of the balls.
    radius : (k,) [m]
        Of the balls.
    azimuth, elevation : float
        Where the camera stands, seen from the balls [degrees]: azimuth 0 is on +x, 90 on +y;
        elevation 90 is above.
    width, height : int
        [pixels].

    """
    a, e = radians(azimuth), radians(elevation)
    forward = -np.array([cos(e) * cos(a), cos(e) * sin(a), sin(e)])
    right = np.array([-sin(a), cos(a), 0.0])
    axes = np.stack((right, np.cross(forward, right), forward))
    middle = ((center - radius[:, np.newaxis]).min(axis=0)
              + (center + radius[:, np.newaxis]).max(axis=0)) / 2
    x, y, z = axes @ (center - middle).T
    half_y = FIELD_OF_VIEW / 2
    half_x = np.arctan(tan(half_y) * width / height)
    # a ball is inside a side of the view where its distance from that plane is its radius
    distance = max(np.max((np.abs(side) * cos(half) + radius) / sin(half) - z)
                   for side, half in ((x, half_x), (y, half_y)))
    return Camera(middle - MARGIN * distance * forward, axes, width, height)
