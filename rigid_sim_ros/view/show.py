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

"""What the command rigid_sim_view does once its arguments are read."""

from functools import partial

import numpy as np
from rigid_sim_ros.view.errors import ViewError
from rigid_sim_ros.view.files import find_ffmpeg, write_gif, write_mp4, write_picture
from rigid_sim_ros.view.motion import open_motion
from rigid_sim_ros.view.panels import Panel, side_by_side
from tqdm import tqdm

FILMS = {'.gif': write_gif, '.mp4': write_mp4}

MOST_FRAMES = 20_000

DEFAULT_DURATION = 5.0
"""Of the film of a scene [s]; that of a recording is all of it."""

ROUNDING = 1e-9
"""Of recorded times [s]."""

DEFAULT_VIEW = (300.0, 20.0)
"""Azimuth and elevation [degrees]: from the front, x to the right, and a little above."""


def show(options):
    """
    Draw what the arguments ask for and write it to their file.

    Raises `ViewError`, `SceneError` or `RecordingError`, all of one line.
    """
    suffix = options.output.suffix
    if suffix == '.mp4':
        find_ffmpeg()
    if not options.output.parent.is_dir():
        raise ViewError(f'{options.output}: the folder {options.output.parent} is not there')
    motion = open_motion(options.source)
    if not motion.bodies:
        raise ViewError(f'{options.source}: has no bodies, nothing to draw')
    times = _resolved(options.time, motion)
    if suffix in FILMS:
        _film(options, motion, times)
    else:
        _picture(options, motion, times)


def _picture(options, motion, times):
    """Write a picture: a column for each time, a row for each view."""
    moments = [np.linspace(motion.begin, time, options.exposures) if options.exposures > 1
               else np.array([time]) for time in times]
    every, indices = np.unique(np.concatenate(moments), return_inverse=True)
    states = motion.states(every, _progress('simulating'))
    columns = indices.reshape(len(times), -1)
    rows = [[panel.picture(states, column) for column in columns]
            for panel in _panels(options, motion, states)]
    write_picture(options.output, side_by_side(rows))


def _film(options, motion, times):
    """Write a film: one view below the other, all at the same time."""
    if len(times) > 1 or options.exposures > 1:
        raise ViewError('--time with several times and --exposures are for pictures, not films')
    interval = 1 / options.fps
    if options.output.suffix == '.gif':
        # a GIF counts time in hundredths of a second, and viewers slow down what is faster
        interval = max(round(100 / options.fps), 2) / 100
    duration = options.duration
    if duration is None:
        duration = DEFAULT_DURATION if np.isinf(motion.end) else max(motion.end - times[0], 0)
    count = int(duration / interval + 1e-6) + 1
    if count > MOST_FRAMES:
        raise ViewError(f'--duration {duration:g} s makes {count} pictures; must be at most '
                        f'{MOST_FRAMES}')
    moments = times[0] + interval * np.arange(count)
    states = motion.states(moments, _progress('simulating'))
    panels = _panels(options, motion, states)
    frames = (side_by_side([[panel.picture(states, [index])] for panel in panels])
              for index in _progress('drawing')(range(count)))
    FILMS[options.output.suffix](options.output, frames, 1 / interval)


def _panels(options, motion, states):
    return [Panel(motion, states, view, options.size) for view in options.view or [DEFAULT_VIEW]]


def _progress(what):
    # None shows the bar only where somebody looks on
    return partial(tqdm, desc=what, unit='picture', leave=False, disable=None)


def _resolved(times, motion):
    """Return the times [s] asked for, each a base to start from and what is added to that."""
    begin, end = motion.begin, motion.end
    bases = {'': 0.0, 'begin': begin}
    if any(base == 'collision' for base, _ in times):
        bases['collision'] = motion.first_collision()
    resolved = [bases[base] + offset for base, offset in times]
    for time in resolved:
        if not begin - ROUNDING <= time <= end + ROUNDING:
            allowed = '0 or more' if np.isinf(end) else f'from {begin:g} to {end:g} s'
            raise ViewError(f'--time {time:g} is not allowed; must be {allowed}')
    return resolved
