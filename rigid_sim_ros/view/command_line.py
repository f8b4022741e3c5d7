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

"""The command rigid_sim_view: pictures and films of scenes and recordings."""

import argparse
from math import nan
import os
from pathlib import Path
import re
import sys

from rigid_sim_ros.recording import RecordingError
from rigid_sim_ros.scene import SceneError
from rigid_sim_ros.view.errors import ViewError

SUFFIXES = ('.png', '.gif', '.mp4')

SIDES = (64, 4096)
"""Smallest and largest side of a picture [pixels]."""

EXAMPLES = """\
examples:
  rigid_sim_view ten_cubes -o tossed.gif --duration 4
  rigid_sim_view my_scene.yaml -o start.png
  rigid_sim_view report_dynamics -o dynamics.png --time 10 --exposures 6 --view 250,40
  rigid_sim_view report_detection -o detection.png --time collision --view 300,20 --view 0,20
  rigid_sim_view report_collision -o collision.png --time collision-0.5,collision,collision+0.5
  rigid_sim_view recordings/my_run -o my_run.mp4 --time 2 --duration 10 --size 1280x720
"""


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message):
        self.exit(2, f'{self.prog}: {message} (--help shows what is allowed)\n')


def main(arguments=None):
    """Run the command; return its exit code: 0, or 2 after one line that says what is wrong."""
    options = read_arguments(sys.argv[1:] if arguments is None else arguments)
    try:
        # what draws is an extra, and --help works without it
        from rigid_sim_ros.view.show import show
    except ModuleNotFoundError as error:
        print(f"rigid_sim_view needs {error.name}: pip install 'rigid_sim_ros[view]'",
              file=sys.stderr)
        return 2
    try:
        show(options)
    except (ViewError, SceneError, RecordingError) as error:
        print(f'rigid_sim_view: {error}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def read_arguments(arguments):
    """Return the options that arguments (a list of str) stand for, or end with exit code 2."""
    return _parser().parse_args(_joined(arguments))


def _parser():
    parser = _Parser(
        prog='rigid_sim_view', epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Draw a picture or film of a scene, simulated, or of a recording.')
    parser.add_argument('source', metavar='SCENE_OR_RECORDING',
                        help='name of a shipped scene, a scene file, a recording (its folder or '
                             'an .mcap file)')
    parser.add_argument('-o', '--output', required=True, type=_output,
                        help='the file to write: .png is a picture, .gif and .mp4 are films')
    parser.add_argument('--time', type=_times, default=[('begin', 0.0)], metavar='T',
                        help='simulated time of the picture, or start of the film [s]; several, '
                             'separated by commas, give pictures side by side; collision is the '
                             'time of the first one, also collision+0.5; default: the beginning')
    parser.add_argument('--duration', type=_number(0.0, 1e6), metavar='T',
                        help='length of the film [s]; default 5, or to the '
                             'end of the recording')
    parser.add_argument('--fps', type=_number(0.1, 240), default=25.0, metavar='N',
                        help='pictures a second of a film, which shows real time; default 25')
    parser.add_argument('--exposures', type=_exposures, default=1, metavar='N',
                        help='show so many times in one picture, from the beginning to --time, '
                             'earlier ones fainter; default 1')
    parser.add_argument('--size', type=_size, default=(800, 500), metavar='WxH',
                        help='of each picture, in pixels; default 800x500')
    parser.add_argument('--view', type=_view, action='append', metavar='A,E',
                        help='azimuth and elevation of the camera in degrees: 0,0 looks from +x, '
                             '90,0 from +y, 0,90 from above; several give pictures below each '
                             'other; default 300,20')
    return parser


# -- reading arguments ---------------------------------------------------------------------------

def _joined(arguments):
    """Return the arguments with those of --view and --time attached, as they may start with -."""
    joined = []
    for argument in arguments:
        if joined and joined[-1] in ('--view', '--time'):
            joined[-1] += '=' + argument
        else:
            joined.append(argument)
    return joined


def _output(text):
    path = Path(os.path.expanduser(text))
    if path.suffix not in SUFFIXES:
        raise argparse.ArgumentTypeError(f'{text!r} must end in .png, .gif or .mp4')
    return path


def _times(text):
    times = []
    for part in text.split(','):
        match = re.fullmatch(r'\s*(collision)?\s*([-+]?[0-9.]*(?:e[-+]?[0-9]+)?)\s*', part)
        base, offset = match.groups() if match else ('', '')
        try:
            times.append((base or '', float(offset or ('0' if base else ''))))
        except ValueError:
            raise argparse.ArgumentTypeError(
                f'{part!r} must be a time in seconds, or collision, collision+0.5') from None
    return times


def _number(low, high):
    def read(text):
        try:
            value = float(text)
        except ValueError:
            value = nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f'{text!r} must be a number from {low:g} to {high:g}')
        return value
    return read


def _exposures(text):
    if not text.isdecimal() or not 1 <= int(text) <= 100:
        raise argparse.ArgumentTypeError(f'{text!r} must be an integer from 1 to 100')
    return int(text)


def _size(text):
    match = re.fullmatch(r'([0-9]{1,5})x([0-9]{1,5})', text)
    size = tuple(int(side) for side in match.groups()) if match else (0, 0)
    if not all(SIDES[0] <= side <= SIDES[1] for side in size):
        raise argparse.ArgumentTypeError(f'{text!r} must be WIDTHxHEIGHT, each from {SIDES[0]} to '
                                         f'{SIDES[1]} pixels, as in 800x500')
    return size


def _view(text):
    try:
        azimuth, elevation = (float(part) for part in text.split(','))
    except ValueError:
        azimuth = elevation = nan
    if not (abs(azimuth) <= 360 and abs(elevation) <= 90):
        raise argparse.ArgumentTypeError(f'{text!r} must be AZIMUTH,ELEVATION in degrees, within '
                                         '360 and 90, as in 300,20')
    return azimuth, elevation
