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

"""Contacts are marked where they are, with arrows along the impulse on what can move."""

import numpy as np
from PIL import Image
import pytest
from rigid_sim_ros.engine.events import BEGIN, COLLISION, IMPACT
from rigid_sim_ros.view.camera import frame
from rigid_sim_ros.view.labels import CONTACT_COLOR, Labels

CAMERA = frame(np.zeros((1, 3)), np.ones(1), 270, 0, 400, 300)
ARROW_LENGTH = 0.5


def event(point, impulse, body_a=0, body_b=1, kind=IMPACT):
    row = np.zeros(1, COLLISION)
    row['point'], row['impulse'] = point, impulse
    row['body_a'], row['body_b'], row['kind'] = body_a, body_b, kind
    return row


def written(*events):
    """Return a function that tells whether the picture is red at a point."""
    image = Image.new('RGB', (400, 300), 'white')
    contacts = np.concatenate(events) if events else np.zeros(0, COLLISION)
    Labels(CAMERA, ARROW_LENGTH, moving_count=2).write(image, 1.5, contacts)
    pixels = np.asarray(image).astype(int)

    def red(x, z):
        column, row, _ = CAMERA.project(np.array([[x, 0, z]], dtype=float))
        return bool(np.abs(pixels[int(row[0]), int(column[0])] - CONTACT_COLOR).max() < 60)
    return red


def test_arrows_push_both_bodies_apart():
    red = written(event((0, 0, 0), (0.01, 0, 0)))
    assert [red(x, 0) for x in (-0.55, -0.3, 0, 0.3, 0.55)] == [False, True, True, True, False]
    assert not red(0, 0.3) and not red(0, -0.3)


@pytest.mark.parametrize('bodies, expected', [((0, 2), [True, False]), ((3, 1), [False, True])])
def test_what_does_not_move_has_no_arrow(bodies, expected):
    red = written(event((0, 0, 0), (5, 0, 0), *bodies))
    assert [red(x, 0) for x in (-0.3, 0.3)] == expected
    assert red(0, 0)


def test_contacts_of_a_pair_have_dots_of_their_own_and_an_arrow_together():
    # together they push up, in the middle of 1 and 3 parts
    red = written(event((-0.4, 0, 0), (1, 0, 1), 2, 0), event((0.4, 0, 0), (-1, 0, 5), 2, 0))
    assert red(-0.4, 0) and red(0.4, 0)
    share = np.sqrt(26) / (np.sqrt(2) + np.sqrt(26))
    middle = -0.4 + 0.8 * share
    assert red(middle, 0.3) and not red(middle, -0.3)
    assert not red(-0.4 + 0.2, 0.2)


def test_pairs_have_arrows_of_their_own():
    red = written(event((-0.4, 0, 0), (0, 0, 1), 2, 0), event((0.4, 0, 0), (0, 0, -1), 2, 1))
    assert red(-0.4, 0.3) and red(0.4, -0.3)


def test_the_beginning_of_contact_is_a_dot():
    red = written(event((0, 0, 0.2), (0, 0, 0), kind=BEGIN))
    assert red(0, 0.2) and not red(0, 0.35) and not red(0, 0.05)


def test_nothing_is_marked_without_contact_or_behind_the_camera():
    behind = CAMERA.position + [0, -1, 0]
    for red in (written(), written(event(behind, (1, 0, 0)))):
        assert not any(red(x, 0) for x in np.linspace(-0.8, 0.8, 50))
