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

"""What is written over a picture: the time, contacts as arrows, the directions of the axes."""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

OVERSIZE = 3
"""How much larger lines are drawn before they are made smaller, so that they are smooth."""

CONTACT_COLOR = (214, 20, 20)
AXES = (('x', (190, 50, 40)), ('y', (50, 140, 50)), ('z', (40, 80, 200)))
TEXT_COLOR = (40, 40, 40)


class Labels:
    """
    Writes over the pictures of one camera.

    Parameters
    ----------
    camera : Camera
    arrow_length : float
        Of the arrows of contacts [m].
    moving_count : int
        Bodies with a higher index do not move, and get no arrow.

    """

    def __init__(self, camera, arrow_length, moving_count):
        self._camera = camera
        self._length = arrow_length
        self._moving_count = moving_count
        self._unit = max(camera.height, 160) / 100
        """A hundredth of the picture's height [pixels]."""

        self._font = ImageFont.load_default(size=4.5 * self._unit)
        self._small_font = ImageFont.load_default(size=3.5 * self._unit)
        self._axes = self._layer()
        self._draw_axes(ImageDraw.Draw(self._axes))
        self._axes = self._smaller(self._axes)

    def write(self, image, time, contacts):
        """Write the time [s] and contacts (an array of collision events) over a PIL image."""
        image.paste(self._axes, (0, 0), self._axes)
        if len(contacts):
            layer = self._layer()
            self._draw_contacts(ImageDraw.Draw(layer), contacts)
            layer = self._smaller(layer)
            image.paste(layer, (0, 0), layer)
        draw = ImageDraw.Draw(image)
        margin = 3 * self._unit
        draw.text((margin, margin), f't = {time:.3f} s', fill=TEXT_COLOR, font=self._font)
        for name, end in self._axis_ends(1.35):
            draw.text(end, name, fill=TEXT_COLOR, font=self._small_font, anchor='mm')

    def _layer(self):
        camera = self._camera
        return Image.new('RGBA', (camera.width * OVERSIZE, camera.height * OVERSIZE))

    def _smaller(self, layer):
        return layer.resize((self._camera.width, self._camera.height), Image.Resampling.BOX)

    # -- axes ----------------------------------------------------------------------------------

    def _axis_ends(self, length=1.0):
        """Return (name, (x, y)) of the ends of the axes [pixels], the farthest first."""
        right, down, forward = self._camera.axes
        corner = np.array((11 * self._unit, self._camera.height - 11 * self._unit))
        order = np.argsort(-forward)
        return [(AXES[axis][0],
                 tuple(corner + 6 * length * self._unit * np.array((right[axis], down[axis]))))
                for axis in order]

    def _draw_axes(self, draw):
        colors = dict(AXES)
        corner = np.array((11 * self._unit, self._camera.height - 11 * self._unit))
        for name, end in self._axis_ends():
            self._arrow(draw, corner, np.array(end), colors[name], 0.6)

    # -- contacts ------------------------------------------------------------------------------

    def _draw_contacts(self, draw, contacts):
        """Draw a dot at every contact, and the impulse of each pair on those of it that move."""
        pairs = np.unique(contacts[['body_a', 'body_b']])
        for pair in pairs:
            events = contacts[contacts[['body_a', 'body_b']] == pair]
            impulse = events['impulse'].sum(axis=0)
            size = np.linalg.norm(impulse)
            if size > 0:
                # one arrow where they act together: four at the corners of a face only confuse
                weight = np.linalg.norm(events['impulse'], axis=1)
                point = weight @ events['point'] / weight.sum()
                for body, sign in ((pair['body_a'], -1), (pair['body_b'], 1)):
                    if body < self._moving_count:
                        self._contact_arrow(draw, point, sign / size * impulse)
        x, y, depth = self._camera.project(contacts['point'])
        for at in np.stack((x, y), axis=1)[depth > 0]:
            self._dot(draw, at)

    def _contact_arrow(self, draw, point, direction):
        x, y, depth = self._camera.project(np.stack((point, point + self._length * direction)))
        if depth.min() > 0:
            start, end = np.stack((x, y), axis=1)
            self._arrow(draw, start, end, CONTACT_COLOR, 0.8)

    def _dot(self, draw, at):
        radius = 0.7 * self._unit * OVERSIZE
        at = at * OVERSIZE
        draw.ellipse((*(at - radius), *(at + radius)), fill=CONTACT_COLOR)

    def _arrow(self, draw, start, end, color, width):
        """Draw an arrow between points [pixels] with a width in hundredths of the height."""
        start, end = start * OVERSIZE, end * OVERSIZE
        width = width * self._unit * OVERSIZE
        length = np.linalg.norm(end - start)
        if length < width:
            return
        along = (end - start) / length
        head = min(4 * width, length)
        neck = end - head * along
        across = 0.45 * head * np.array((-along[1], along[0]))
        draw.line((*start, *neck), fill=color, width=max(round(width), 1))
        draw.polygon((*end, *(neck + across), *(neck - across)), fill=color)
