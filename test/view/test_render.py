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

"""What is in front hides what is behind, sizes are right, and shadows fall where light says."""

import numpy as np
import pytest
from rigid_sim_ros.engine.model import Body, Plane
from rigid_sim_ros.engine.shapes import Box, Cube, Sphere
from rigid_sim_ros.view.camera import frame
from rigid_sim_ros.view.render import COLORS, LIGHT, Renderer

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
SIZE = (160, 120)


def body(shape, position, orientation=UPRIGHT, **changes):
    return Body('b', shape, 1.0, (1.0,) * 3, position, orientation, **changes)


def draw(bodies, planes=(), view=(270, 0), size=SIZE):
    """Return the picture, the share of bodies, and the camera, which frames the first body."""
    first = np.array([bodies[0].position])
    camera = frame(first, np.array([2 * bodies[0].shape.bounding_radius]), *view, *size)
    color, cover = Renderer(bodies, planes, camera).render(
        np.array([each.position for each in bodies]),
        np.array([each.orientation for each in bodies]))
    return color, cover, camera


def at(picture, camera, point):
    x, y, _ = camera.project(np.array([point], dtype=float))
    return picture[int(y[0]), int(x[0])]


def hue(color):
    """Return a colour without its brightness."""
    return color / np.linalg.norm(color)


def assert_shows(color, index):
    assert hue(color) == pytest.approx(hue(COLORS[index]), abs=0.01)


NEAR, FAR = (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)


@pytest.mark.parametrize('shapes', [
    (Cube(1.0), Cube(1.0)), (Sphere(0.5), Cube(1.0)), (Cube(1.0), Sphere(0.5)),
    (Sphere(0.6), Sphere(0.5)), (Box((3.0, 0.1, 0.2)), Cube(0.4))])
def test_the_nearer_body_hides_the_farther_in_any_order(shapes):
    for places in ((NEAR, FAR), (FAR, NEAR)):
        color, _, camera = draw([body(shape, place) for shape, place in zip(shapes, places)])
        # a little off the middle, where a ball's octants meet
        assert_shows(at(color, camera, (0.03, 0, 0.03)), places.index(NEAR))


def test_bodies_that_pass_through_each_other_are_seen_where_each_is_in_front():
    # two crossed bars, each behind at one end: a painter who sorts them cannot be right
    turned = (0.0, 0.0, np.sin(np.pi / 8), np.cos(np.pi / 8))
    back = (0.0, 0.0, -np.sin(np.pi / 8), np.cos(np.pi / 8))
    bars = [body(Box((2.0, 0.2, 0.4)), (0, 0, 0), turned),
            body(Box((2.0, 0.2, 0.4)), (0, 0, 0), back)]
    color, _, camera = draw(bars)
    # seen from -y: on the left the first bar is in front, on the right the second
    assert_shows(at(color, camera, (-0.4, -0.5, 0.1)), 0)
    assert_shows(at(color, camera, (0.4, -0.5, 0.1)), 1)


def test_a_cube_covers_its_area():
    _, cover, camera = draw([body(Cube(1.0), (0, 0, 0))], size=(640, 480))
    # head-on only the front face is seen: half an edge nearer than the centre
    distance = -camera.position[1] - 0.5
    assert cover.sum() == pytest.approx((1 / (distance * camera.pixel)) ** 2, rel=0.01)


def test_a_ball_covers_its_area():
    _, cover, camera = draw([body(Sphere(0.5), (0, 0, 0))], size=(640, 480))
    # its outline is where rays touch it: tan(asin(r / d)) at distance 1
    distance = -camera.position[1]
    outline = np.tan(np.arcsin(0.5 / distance)) / camera.pixel
    assert cover.sum() == pytest.approx(np.pi * outline ** 2, rel=0.01)


def test_nothing_is_drawn_outside_of_the_picture_or_behind_the_camera():
    color, cover, camera = draw([body(Cube(1.0), (0, 0, 0))])
    more = [body(Cube(1.0), (0, 0, 0)), body(Cube(1.0), (0, -100, 0)),
            body(Cube(1.0), (100, 0, 0))]
    again, cover_again, _ = draw(more)
    assert (again == color).all() and (cover_again == cover).all()


def test_a_body_around_the_camera_does_not_hide_the_others():
    room = body(Box((60.0, 60.0, 60.0)), (0, 0, 0), fixed=True)
    color, _, camera = draw([body(Cube(1.0), (0, 0, 0)), room])
    assert_shows(at(color, camera, (0, -0.5, 0)), 0)


GROUND = Plane('ground', (0.0, 0.0, 1.0), 0.0)


def light(view):
    """Return the direction to the light as documented: right, towards the camera, up."""
    azimuth = np.radians(view[0])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    toward = np.array([np.cos(azimuth), np.sin(azimuth), 0])
    return LIGHT[0] * right + LIGHT[1] * toward + LIGHT[2] * np.array([0, 0, 1.0])


def test_a_shadow_falls_opposite_to_the_light():
    view = (250, 35)
    cube = body(Cube(0.4), (0, 0, 0.7))
    color, cover, camera = draw([cube], [GROUND], view)
    middle = np.array(cube.position) - 0.7 * light(view) / light(view)[2]
    across = np.array([light(view)[1], -light(view)[0], 0]) / np.hypot(*light(view)[:2])
    # the upright cube's shadow is a band along the light; half a diagonal across it ends
    bright, edge = [], 0.2 * np.sqrt(2)
    for distance in (0, 0.1, edge + 0.05, edge + 0.3):
        point = middle - distance * across
        assert at(cover, camera, point) == 0
        bright.append(at(color, camera, point).mean())
    assert max(bright[:2]) < 0.8 * min(bright[2:])


def test_a_body_shades_another():
    view = (250, 35)
    place = np.array((0, 0, 0.2))
    above = place + 1.2 * light(view)
    lower = body(Cube(0.4), tuple(place))
    shaded, _, camera = draw([lower, body(Cube(0.4), tuple(above))], [GROUND], view)
    lit, _, _ = draw([lower], [GROUND], view)
    top = place + [0, 0, 0.2]
    assert_shows(at(shaded, camera, top), 0)
    assert at(shaded, camera, top).mean() < 0.7 * at(lit, camera, top).mean()


def test_the_ground_hides_what_is_below_it_but_not_a_view_from_below():
    below = body(Cube(0.4), (0, 0, -1.0))
    color, cover, _ = draw([below], [GROUND], (270, 30))
    assert not cover.any()
    above = body(Cube(0.4), (0, 0, 0.3))
    color, cover, camera = draw([above], [GROUND], (270, -60))
    assert camera.position[2] < 0 and cover.any()
    assert_shows(at(color, camera, (0.03, 0.03, 0.1)), 0)


def test_fixed_bodies_are_grey():
    color, _, camera = draw([body(Cube(1.0), (0, 0, 0), fixed=True)])
    assert np.ptp(at(color, camera, (0.1, -0.5, 0.1))) < 1e-9
