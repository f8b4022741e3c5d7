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

"""Writing pictures and films; a file is complete or not there."""

from contextlib import contextmanager
from itertools import chain
import os
from pathlib import Path
import shutil
import subprocess

from PIL import Image
from rigid_sim_ros.view.errors import ViewError
from rigid_sim_ros.view.labels import CONTACT_COLOR

PALETTE_SIZE = 256
"""Colours of a GIF."""


@contextmanager
def written(path):
    """Give the name of a file to write that takes the place of `path` once it is complete."""
    path = Path(path)
    partial = path.with_name(f'.{path.stem}_{os.getpid()}{path.suffix}')
    try:
        yield partial
        os.replace(partial, path)
    except OSError as error:
        reason = error.strerror or error
        raise ViewError(f'{path}: cannot be written: {reason}') from None
    finally:
        partial.unlink(missing_ok=True)


def write_picture(path, image):
    """Write a PNG."""
    with written(path) as partial:
        image.save(partial, optimize=True)


def write_gif(path, frames, frame_rate):
    """Write PIL images, one after the other as they come, as a GIF that repeats for ever."""
    frames = iter(frames)
    first = next(frames)
    palette = _palette(first)

    def reduced(image):
        return image.quantize(palette=palette, dither=Image.Dither.NONE)

    with written(path) as partial:
        reduced(first).save(partial, save_all=True, append_images=map(reduced, frames),
                            duration=round(1000 / frame_rate), loop=0)


def _palette(image):
    """
    Return an image with the colours for all frames: those of one of them, and of contacts.

    Frames with colours of their own would flicker.
    """
    colors = image.quantize(PALETTE_SIZE - 1).getpalette()[:3 * (PALETTE_SIZE - 1)]
    palette = Image.new('P', (1, 1))
    palette.putpalette([*colors, *CONTACT_COLOR])
    return palette


def write_mp4(path, frames, frame_rate):
    """Write PIL images, one after the other as they come, as an H.264 film by ffmpeg."""
    program = find_ffmpeg()
    frames = iter(frames)
    first = next(frames)
    width, height = first.size
    with written(path) as partial:
        command = [
            program, '-loglevel', 'error', '-y', '-f', 'rawvideo', '-pix_fmt', 'rgb24',
            '-s', f'{width}x{height}', '-r', str(frame_rate), '-i', '-', '-an',
            '-c:v', 'libx264', '-pix_fmt', 'yuv420p', '-movflags', '+faststart',
            # this pixel format wants even sides
            '-vf', 'pad=ceil(iw/2)*2:ceil(ih/2)*2', str(partial)]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
            try:
                for image in chain([first], frames):
                    ffmpeg.stdin.write(image.tobytes())
                ffmpeg.stdin.close()
            except BrokenPipeError:
                pass  # its message says why
            message = ffmpeg.stderr.read().decode(errors='replace').split('\n')[0].strip()
        if ffmpeg.returncode:
            raise ViewError(f'{path}: ffmpeg failed: {message}')


def find_ffmpeg():
    """Return the path of ffmpeg; refuse if there is none."""
    program = shutil.which('ffmpeg')
    if program is None:
        raise ViewError('.mp4 needs ffmpeg, which is not installed (apt install ffmpeg); '
                        'a .gif does not')
    return program
