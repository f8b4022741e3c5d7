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

"""The error of a scene that cannot be loaded, and how its one line is worded."""

from difflib import get_close_matches
import reprlib

SHOWN_LENGTH = 60
"""Longest text of a given value in a message; the rest of a long value helps nobody."""


class SceneError(ValueError):
    """A scene is refused: one line with file, body, key, the value given and what is allowed."""


def shown(value):
    """Return a value as it is shown in a message: short, on one line, in YAML's words."""
    words = {None: 'nothing', True: 'true', False: 'false'}
    if value is None or isinstance(value, bool):
        return words[value]
    brief = reprlib.Repr()
    brief.maxlist = brief.maxtuple = brief.maxdict = 6
    brief.maxlevel = 3
    brief.maxstring = brief.maxother = brief.maxlong = SHOWN_LENGTH
    text = ' '.join(brief.repr(value).split())
    return text if len(text) <= SHOWN_LENGTH else text[:SHOWN_LENGTH - 3] + '...'


def listed(names):
    """Return names as 'a, b, c'."""
    return ', '.join(str(name) for name in names)


def nearest(name, names):
    """Return ' (did you mean ...?)' with the most similar names, or '' if none is similar."""
    close = get_close_matches(str(name), [str(each) for each in names], n=3)
    return f' (did you mean {" or ".join(close)}?)' if close else ''
