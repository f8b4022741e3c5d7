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

"""Panels: what is seen from one side, as pictures of 8-bit colours."""

import numpy as np
from PIL import Image

from rigid_sim_ros.view.camera import frame
from rigid_sim_ros.view.labels import Labels
from rigid_sim_ros.view.render import Renderer

FIRST_EXPOSURE = 0.25
LAST_EXPOSURE = 0.6
"""How strongly the first and the last but one of several exposures are seen."""

GAP = 4
"""Between panels [pixels]."""


class Panel:
    """
    One view of a motion: the same camera for all times.

    Parameters
    ----------
    motion : Motion
    states : States
        Everything that will be drawn: the picture has room for all of it.
    view : (azimuth, elevation)
        Where the camera stands [degrees].
    size : (width, height)
        [pixels].

    """

    def __init__(self, motion, states, view, size):
        radius = np.array([body.shape.bounding_radius for body in motion.bodies])
        # fixed bodies are the surroundings: a floor of 100 m must not make the rest tiny
        count = motion.moving_count or len(radius)
        centers = states.position[:, :count].reshape(-1, 3)
        camera = frame(centers, np.tile(radius[:count], len(states.time)), *view, *size)
        self._renderer = Renderer(motion.bodies, motion.planes, camera)
        self._labels = Labels(camera, 1.5 * np.median(radius[:count]), motion.moving_count)

    def picture(self, states, indices):
        """Return a PIL image of the state of the last index, over fainter ones of the others."""
        *earlier, last = indices
        final, final_cover = self._render(states, last)
        picture = final
        strengths = np.linspace(FIRST_EXPOSURE, LAST_EXPOSURE, len(earlier))
        for index, strength in zip(earlier, strengths):
            color, cover = self._render(states, index)
            picture = picture + strength * cover * (color - picture)
        picture = picture + final_cover * (final - picture)
        image = Image.fromarray((picture * 255 + 0.5).astype(np.uint8))
        self._labels.write(image, states.time[last], states.contacts[last])
        return image

    def _render(self, states, index):
        color, cover = self._renderer.render(states.position[index], states.orientation[index])
        return color, cover[..., np.newaxis]


def side_by_side(rows):
    """Return one image of rows of images of the same size."""
    width, height = rows[0][0].size
    total = Image.new('RGB', (len(rows[0]) * (width + GAP) - GAP,
                              len(rows) * (height + GAP) - GAP), 'white')
    for down, row in enumerate(rows):
        for across, image in enumerate(row):
            total.paste(image, (across * (width + GAP), down * (height + GAP)))
    return total
