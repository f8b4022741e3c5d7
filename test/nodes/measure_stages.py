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
What each stage of recording a thousand cubes costs, in microseconds of processor time a state.

    python test/nodes/measure_stages.py [STATES]

Cubes drift, each with a motion of its own. A stage is done for so many states (1000) in a row, so
that its data is in the caches: in a node that sleeps between two states it takes up to twice as
long. Beside them are floors, what only moving or writing as many bytes takes.
"""

import os
import sys
import tempfile
import time

import numpy as np
from rigid_sim_ros import topics
from rigid_sim_ros.engine import Simulation
from rigid_sim_ros.recording.checksum import crc32
from rigid_sim_ros.recording.chunk import Chunk, CHUNK_BYTES
from rigid_sim_ros.recording.mcap_file import COMPRESSIONS
from rigid_sim_ros.scene import load_scene

REPETITIONS = 5
"""Of which the median is told."""


def drifting(counts):
    """Return a scene (YAML) of cubes along x, y and z that fly apart, so that none ever meet."""
    random = np.random.default_rng(1)
    lines = ['gravity: [0, 0, 0]', 'bodies:']
    for number, place in enumerate(np.ndindex(*counts), 1):
        position = 1.0 * np.array(place)
        velocity = 0.05 * position + 0.001 * random.normal(size=3)
        turn, rate = 180 * random.normal(size=3), random.normal(size=3)
        lines.append(
            f'  - {{name: cube_{number}, cube: {{edge: 0.2}}, mass: 1.0, '
            f'position: {position.tolist()}, rpy: {turn.tolist()}, '
            f'velocity: {velocity.tolist()}, angular_velocity: {rate.tolist()}}}')
    return '\n'.join(lines) + '\n'


def processor_time(work, count):
    """Return the processor time [us] of one call of `work`."""
    times = []
    for _ in range(REPETITIONS):
        start = time.process_time()
        for _ in range(count):
            work()
        times.append((time.process_time() - start) / count * 1e6)
    return float(np.median(times))


def write_over(number, data):
    """Return a function that writes data to a file, over what it wrote before after 16 MB."""
    def work():
        os.write(number, data)
        if os.lseek(number, 0, os.SEEK_CUR) > 2**24:
            os.ftruncate(number, 0)
            os.lseek(number, 0, os.SEEK_SET)
    return work


def main(count):
    """Print a line for each stage."""
    simulation = Simulation(load_scene(drifting((10, 10, 10))))
    source = topics.Source(simulation, 'world', '')
    encoders = [row.encoder(source) for row in topics.PUBLISHED[:2]]

    def advance(read):
        simulation.advance(0.001)
        if read:
            simulation.position, simulation.linear_velocity, simulation.force

    def encode():
        source.shared = {}
        return [encoder(0) for encoder in encoders]

    chunk, messages = Chunk(), encode()

    def copy():
        if chunk.size >= CHUNK_BYTES:
            chunk.clear()
        for channel, data in enumerate(messages, 1):
            chunk.add(channel, 0, 0, data)

    plain = b''.join(messages)
    room = memoryview(bytearray(CHUNK_BYTES))
    places = [0]

    def move():
        places[0] = (places[0] + len(plain)) % (len(room) - len(plain))
        room[places[0]:places[0] + len(plain)] = plain

    print(f'a state: {len(plain)} bytes')
    for name, work in (('simulate', lambda: advance(False)),
                       ('simulate and evaluate', lambda: advance(True)),
                       ('make both messages', encode), ('copy them into a chunk', copy),
                       ('  floor: copy as many bytes', move)):
        print(f'{name:32}{processor_time(work, count):8.1f} us')
    chunk.clear()
    states = 0
    while chunk.size < CHUNK_BYTES:
        advance(False)
        encode()
        states += 1
        for channel, data in enumerate(messages, 1):
            chunk.add(channel, 0, 0, data)
    packed(chunk.data(), chunk.message_count, states)


def packed(data, message_count, states):
    """Print what is done with a whole chunk of so many states."""
    def show(name, work):
        print(f'{name:32}{processor_time(work, 20) / states:8.1f} us')

    with tempfile.NamedTemporaryFile() as file:
        show('checksum', lambda: crc32(data))
        for name, (_, compress) in COMPRESSIONS.items():
            size = len(data) // message_count
            compressed = compress(data, size)
            print(f'{name}: {len(compressed) / states:.0f} bytes a state')
            show('  compress', lambda: compress(data, size))
            show('  floor: write to the page cache', write_over(file.fileno(), compressed))


if __name__ == '__main__':
    main(int(sys.argv[1]) if sys.argv[1:] else 1000)
