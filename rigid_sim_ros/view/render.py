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
Draws bodies and planes with the right one in front: a depth for every pixel.

Every surface is met exactly by the rays of its pixels, not cut into triangles, so spheres are
round and bodies that touch or penetrate are seen where they do. Shadows show how far a body is
above the ground.
"""

import numpy as np

from rigid_sim_ros.engine import rotation
from rigid_sim_ros.view.rays import dot, hit_ball, hit_box, hit_plane, to_axes

SUPERSAMPLING = 2
"""Samples a side of a pixel: what makes edges smooth."""

COLORS = np.array([
    (0.90, 0.62, 0.00), (0.34, 0.71, 0.91), (0.00, 0.62, 0.45), (0.94, 0.89, 0.26),
    (0.00, 0.45, 0.70), (0.84, 0.37, 0.00), (0.80, 0.47, 0.65)])
"""Okabe and Ito 2008: colours that colour-blind people tell apart; one body after the other."""

FIXED_COLOR = np.array((0.62, 0.62, 0.62))
GROUND_COLOR = np.array((0.88, 0.88, 0.86))
SKY_COLORS = np.array(((0.93, 0.95, 0.97), (1.0, 1.0, 1.0)))

LIGHT = (-0.6, 0.3, 1.0)
"""Where light comes from: that far to the right, towards the camera, and up."""

AMBIENT = 0.45
"""Light that comes from everywhere, and all there is in the shade."""

DIFFUSE = 0.6
"""Light of a surface that faces where it comes from, besides."""

GROUND_SHADE = 0.7
"""Brightness of the shadows on planes."""

EDGE_WIDTH = 1.2
"""Width of the dark edges of boxes [samples]."""

EDGE_DARKNESS = 0.6
OCTANT_DARKNESS = 0.75

GRID_WIDTH = 0.012
"""Half the width of the lines on a plane, over their spacing."""

GRID_DARKNESS = 0.14

NO_BODY = -1


class Canvas:
    """A picture under way: what each sample shows so far."""

    def __init__(self, color, depth):
        self.color = color
        self.depth = depth
        self.owner = np.full(depth.shape, NO_BODY)
        self.shade = np.full(depth.shape, GROUND_SHADE)


class Renderer:
    """
    Draws a scene's bodies at any poses, seen by one camera.

    Parameters
    ----------
    bodies : sequence of model.Body
        Of which shape and `fixed` matter; poses are given to `render`.
    planes : sequence of model.Plane
        Those that the camera is in front of are drawn; seen from behind they would hide all.
    camera : Camera

    """

    def __init__(self, bodies, planes, camera):
        self.camera = camera.scaled(SUPERSAMPLING)
        self._rays = self.camera.rays()
        self._planes = [plane for plane in planes
                        if self.camera.position @ plane.normal > plane.offset]
        right = camera.axes[0]
        toward = np.cross(right, (0.0, 0.0, 1.0))
        light = LIGHT[0] * right + LIGHT[1] * toward + LIGHT[2] * np.array((0.0, 0.0, 1.0))
        self._light = light / np.linalg.norm(light)
        self._shapes = [body.shape for body in bodies]
        moving = iter(range(len(bodies)))
        self._colors = [FIXED_COLOR if body.fixed else COLORS[next(moving) % len(COLORS)]
                        for body in bodies]
        self._background = None

    def render(self, position, orientation):
        """
        Return the picture, (height, width, 3), and what shows bodies, (height, width).

        Colours are from 0 to 1; the second is 1 in pixels that show only bodies, 0 without any.

        Parameters
        ----------
        position : (n, 3) [m]
            Of all bodies, in the order given.
        orientation : (n, 4)
            Quaternions x, y, z, w, body to world.

        """
        if self._background is None:
            self._background = self._draw_background(position)
        canvas = Canvas(*(each.copy() for each in self._background))
        matrices = np.moveaxis(rotation.matrix(np.asarray(orientation, dtype=float).T), -1, 0)
        for index, (place, matrix) in enumerate(zip(position, matrices)):
            self._draw_body(index, place, matrix, canvas)
        if self._planes:
            self._draw_shadows(position, matrices, canvas)
        color = np.clip(np.stack([_smaller(part) for part in canvas.color], axis=-1), 0, 1)
        return color, _smaller((canvas.owner != NO_BODY).astype(float))

    # -- planes --------------------------------------------------------------------------------

    def _draw_background(self, position):
        """Return colour and depth of all that does not move: sky and planes."""
        height, width = self._rays.shape[1:]
        upward = np.linspace(0, 1, height)[:, np.newaxis]
        sky = np.stack([np.broadcast_to(low + (high - low) * upward, (height, width))
                        for low, high in zip(*SKY_COLORS)])
        color, depth = sky.copy(), np.full((height, width), np.inf)
        middle = np.mean(position, axis=0)
        reach = np.linalg.norm(self.camera.position - middle)
        for plane in self._planes:
            found = hit_plane(self.camera.position, self._rays, plane.normal, plane.offset)
            point = self._points(np.where(np.isfinite(found), found, 0))
            # far away a plane fades into the sky: its grid would only flicker
            away = point - middle[:, np.newaxis, np.newaxis]
            share = np.exp(-(dot(away, away) / (1.3 * reach) ** 2) ** 2)
            brightness = self._grid(point, np.array(plane.normal), found, reach)
            nearer = found < depth
            for part, surface, behind in zip(color, GROUND_COLOR, sky):
                part[nearer] = (share * surface * brightness + (1 - share) * behind)[nearer]
            depth[nearer] = found[nearer]
        return color, depth

    def _points(self, depth, window=np.s_[:, :]):
        """Return the points, (3, ...) [m], that samples show at their depths [m]."""
        origin = self.camera.position.reshape(3, *[1] * depth.ndim)
        return origin + depth * self._rays[(np.s_[:], *window)]

    def _grid(self, point, normal, depth, reach):
        """Return the brightness, (height, width), of a plane with a grid of round spacing."""
        spacing = _round_length(reach / 12)
        first = np.cross(normal, (0, 1, 0) if abs(normal[1]) < 0.9 else (1, 0, 0))
        first /= np.linalg.norm(first)
        slant = np.abs(dot(normal, self._rays)) / np.sqrt(dot(self._rays, self._rays))
        # what one sample covers of the plane: lines thinner than that are drawn fainter
        sample = self.camera.pixel * np.where(np.isfinite(depth), depth, 1) \
            / np.maximum(slant, 0.05)
        brightness = np.ones_like(depth)
        for along in (first, np.cross(normal, first)):
            distance = np.abs((dot(along, point) / spacing + 0.5) % 1 - 0.5) * spacing
            cover = np.clip((GRID_WIDTH * spacing - distance) / sample + 0.5, 0, 1)
            brightness -= GRID_DARKNESS * cover * np.minimum(1, 0.05 * spacing / sample)
        return brightness

    # -- bodies --------------------------------------------------------------------------------

    def _draw_body(self, index, place, matrix, canvas):
        shape = self._shapes[index]
        window = self._window(_corners(shape, place, matrix))
        if window is None:
            return
        origin = to_axes(matrix, self.camera.position - place)
        rays = to_axes(matrix, self._rays[(np.s_[:], *window)])
        enter, leave = _hit(shape, origin, rays)
        seen = (enter < leave) & (enter > 0) & (enter < canvas.depth[window])
        enter = enter[seen]
        point = origin[:, np.newaxis] + enter * rays[:, seen]
        normal, brightness = _surface(shape, point, EDGE_WIDTH * self.camera.pixel * enter)
        light = AMBIENT + DIFFUSE * np.maximum(dot(to_axes(matrix, self._light), normal), 0)
        for part, share in zip(canvas.color, self._colors[index]):
            part[window][seen] = share * brightness * light
        canvas.shade[window][seen] = AMBIENT / light
        canvas.depth[window][seen] = enter
        canvas.owner[window][seen] = index

    def _draw_shadows(self, position, matrices, canvas):
        """Darken what a body keeps the light from: planes and other bodies."""
        shaded = np.zeros(canvas.depth.shape, dtype=bool)
        for index, (place, matrix) in enumerate(zip(position, matrices)):
            shape = self._shapes[index]
            window = self._window(self._shadow_volume(_corners(shape, place, matrix)))
            if window is None:
                continue
            depth = canvas.depth[window]
            point = self._points(np.where(np.isfinite(depth), depth, 0), window)
            start = to_axes(matrix, point - place[:, np.newaxis, np.newaxis])
            enter, leave = _hit(shape, start, to_axes(matrix, self._light))
            # what touches the body is not in its shade by rounding
            touching = 1e-3 * shape.bounding_radius
            shaded[window] |= ((enter < leave - touching) & (leave > touching)
                               & (canvas.owner[window] != index) & np.isfinite(depth))
        for part in canvas.color:
            part[shaded] *= canvas.shade[shaded]

    def _shadow_volume(self, corners):
        """Return points around a body, of which the corners are given, and all its shadows."""
        points = [corners]
        for plane in self._planes:
            toward = self._light @ plane.normal
            if toward > 0.05:
                height = np.maximum(corners @ plane.normal - plane.offset, 0)
                points.append(corners - (height / toward)[:, np.newaxis] * self._light)
        return np.concatenate(points)

    def _window(self, points):
        """Return slices (rows, columns) of the samples around points, or None if outside."""
        x, y, depth = self.camera.project(points)
        height, width = self._rays.shape[1:]
        if depth.min() < 0.01 * depth.max():
            # beside or behind the camera projections mean nothing
            return (slice(0, height), slice(0, width)) if depth.max() > 0 else None
        left, right = int(max(x.min(), 0)), int(min(x.max() + 2, width))
        top, bottom = int(max(y.min(), 0)), int(min(y.max() + 2, height))
        return (slice(top, bottom), slice(left, right)) if left < right and top < bottom else None


def _hit(shape, origin, rays):
    if shape.kind == 'sphere':
        return hit_ball(origin, rays, shape.radius)
    return hit_box(origin, rays, shape.half_extents)


def _corners(shape, place, matrix):
    """Return the corners, (8, 3) [m], of the box around a shape."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return place + (signs * shape.half_extents) @ matrix.T


def _surface(shape, point, edge_width):
    """Return normals (3, k) and brightness (k,) of points (3, k) of a surface, in body axes."""
    if shape.kind == 'sphere':
        # darker octants, or nobody could see it turn
        return point / shape.radius, np.where(np.prod(point, axis=0) < 0, OCTANT_DARKNESS, 1.0)
    half = np.array(shape.half_extents)[:, np.newaxis]
    face = np.argmax(np.abs(point) / half, axis=0)
    on_face = face == np.arange(3)[:, np.newaxis]
    normal = np.where(on_face, np.sign(point), 0.0)
    to_edge = np.where(on_face, np.inf, half - np.abs(point)).min(axis=0)
    return normal, np.where(to_edge < edge_width, EDGE_DARKNESS, 1.0)


def _smaller(samples):
    """Return the means of blocks of samples (h, w): one value a pixel."""
    step = SUPERSAMPLING
    return sum(samples[row::step, column::step]
               for row in range(step) for column in range(step)) / step ** 2


def _round_length(length):
    """Return the 1, 2 or 5 times a power of ten next below a length."""
    power = 10.0 ** np.floor(np.log10(length))
    return power * max(step for step in (1, 2, 5) if step * power <= length * (1 + 1e-9))
