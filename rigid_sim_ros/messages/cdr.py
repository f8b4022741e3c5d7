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
Common Data Representation (CDR), as ROS 2 middleware puts messages on the wire.

Little endian, plain CDR (XCDR version 1): four bytes of encapsulation header, then the fields in
the order of the message definition, each aligned to its own size counted from after the header.
Padding is zero here, so that equal messages are equal bytes; Fast CDR leaves it uninitialised.
"""

import struct

import numpy as np

ENCAPSULATION = b'\x00\x01\x00\x00'
"""Plain CDR, little endian, no options."""

NANOSECONDS = 1_000_000_000

_TIME = struct.Struct('<iI')

_TRAILING = 3
"""Bytes that a sender may leave after the last field: the payload is padded to four."""


class MessageError(ValueError):
    """Bytes that are not the message they should be."""


def align(offset, size):
    """Return the next multiple of `size`, a power of two, at or after an offset."""
    return (offset + size - 1) & -size


def seconds_and_nanoseconds(time_ns):
    """Split a time [ns] as builtin_interfaces/Time does."""
    return divmod(int(time_ns), NANOSECONDS)


class Writer:
    """
    Appends fields to a message, small ones or those of a template that is filled in later.

    Offsets count from after the encapsulation header, as alignment does.
    """

    def __init__(self, data=b''):
        self._data = bytearray(data)

    @property
    def offset(self):
        """Where the next byte goes."""
        return len(self._data)

    def align(self, size):
        """Pad with zeros to a multiple of `size`."""
        self._data.extend(bytes(align(len(self._data), size) - len(self._data)))

    def pack(self, code, *values):
        """Append numbers that share one `struct` code, aligned to their size; give the offset."""
        self.align(struct.calcsize(code))
        offset = len(self._data)
        self._data += struct.pack(f'<{len(values)}{code}', *values)
        return offset

    def string(self, text):
        """Append a string, NUL included in its length."""
        data = text.encode()
        self.pack('I', len(data) + 1)
        self._data += data + b'\0'

    def strings(self, texts):
        """Append a sequence of strings."""
        self.pack('I', len(texts))
        for text in texts:
            self.string(text)

    def header(self, time_ns, frame_id):
        """Append a std_msgs/Header."""
        self.time(time_ns)
        self.string(frame_id)

    def time(self, time_ns):
        """Append a builtin_interfaces/Time; give its offset."""
        seconds, nanoseconds = seconds_and_nanoseconds(time_ns)
        offset = self.pack('i', seconds)
        self.pack('I', nanoseconds)
        return offset

    def array(self, count, width):
        """
        Append a sequence of `count` elements of `width` doubles each, zeros to be filled in.

        Gives the offset of the first double. An empty sequence has no padding after its length.
        """
        self.pack('I', count)
        if count:
            self.align(8)
        offset = len(self._data)
        self._data += bytes(8 * count * width)
        return offset

    def raw(self, data):
        """Append bytes as they are."""
        self._data += data

    def set_count(self, offset, count):
        """Write the length of a sequence that was appended before."""
        struct.pack_into('<I', self._data, offset, count)

    def message(self):
        """Return the finished message."""
        return ENCAPSULATION + bytes(self._data)


class Template:
    """
    A message of fixed layout that is filled in place again and again.

    Cut off the front of a bytearray, bytes are not moved, so the message begins four bytes after
    a multiple of eight: doubles aligned in it are then aligned in memory too, which is faster.
    """

    def __init__(self, writer):
        self._message = bytearray(4) + writer.message()
        del self._message[:4]

    def doubles(self, offset, count, width):
        """Return a (count, width) view of the doubles at an offset of the payload."""
        values = np.frombuffer(self._message, np.float64, count * width, 4 + offset)
        return values.reshape(count, width)

    def set_time(self, time_ns):
        """Write the builtin_interfaces/Time that the payload begins with."""
        _TIME.pack_into(self._message, 4, *divmod(time_ns, NANOSECONDS))

    def continued(self):
        """Return a `Writer` that goes on after a copy of the message as it is filled in now."""
        return Writer(memoryview(self._message)[4:])

    def message(self):
        """Return the message as it is filled in now."""
        return bytes(self._message)

    def view(self):
        """
        Return the message itself, to be read only: it changes as the template is filled in anew.

        A bytearray, which rclpy takes as it is; of a memoryview it would need a copy.
        """
        return self._message


class Reader:
    """
    Takes fields out of a message, trusting nothing in it.

    Whatever is wrong is a `MessageError`: no length is believed before the bytes it promises are
    known to be there, so no input makes it allocate more than its own size.
    """

    def __init__(self, data, what='message'):
        self._data = memoryview(data).cast('B')
        self._what = what
        self._offset = 4
        if len(self._data) < 4:
            raise MessageError(f'{what}: {len(self._data)} bytes, no encapsulation header')
        if bytes(self._data[:2]) != ENCAPSULATION[:2]:
            raise MessageError(
                f'{what}: encapsulation {bytes(self._data[:2]).hex()}, only 0001 (plain CDR, '
                'little endian) is read')

    @property
    def offset(self):
        """Where the next byte comes from, counted from after the encapsulation header."""
        return self._offset - 4

    @property
    def remaining(self):
        """Return the number of bytes not read yet."""
        return len(self._data) - self._offset

    def fail(self, reason):
        """Raise a `MessageError` that says which message and where."""
        raise MessageError(f'{self._what}: {reason} at byte {self._offset} of {len(self._data)}')

    def align(self, size):
        """Skip padding."""
        self._offset = align(self._offset - 4, size) + 4

    def raw(self, length):
        """Return the next bytes, as a view."""
        if length > self.remaining:
            self.fail(f'{length} bytes expected, {max(self.remaining, 0)} left')
        start = self._offset
        self._offset = start + length
        return self._data[start:self._offset]

    def rest(self):
        """Return all that is left, as a view, without taking it."""
        return self._data[self._offset:]

    def skip(self, expected):
        """Take these bytes if they are the next ones; say whether they were."""
        end = self._offset + len(expected)
        if self._data[self._offset:end] != expected:
            return False
        self._offset = end
        return True

    def unpack(self, codes):
        """Return one number for each `struct` code, each aligned to its own size."""
        values = []
        for code in codes:
            size = struct.calcsize(code)
            self.align(size)
            values += struct.unpack('<' + code, self.raw(size))
        return values

    def number(self, code):
        """Return one number."""
        return self.unpack(code)[0]

    def count(self, smallest):
        """Return the length of a sequence whose elements take at least `smallest` bytes each."""
        count = self.number('I')
        if count * smallest > self.remaining:
            self.fail(f'a sequence of {count} elements does not fit')
        return count

    def string(self):
        """Return a string."""
        length = self.number('I')
        data = bytes(self.raw(length))
        if length and data[-1]:
            self.fail('a string does not end in NUL')
        try:
            return data[:-1].decode()
        except UnicodeDecodeError as error:
            raise MessageError(f'{self._what}: a string is not UTF-8: {error}') from error

    def strings(self):
        """Return a sequence of strings, as a tuple."""
        return tuple(self.string() for _ in range(self.count(4)))

    def time(self):
        """Return a builtin_interfaces/Time [ns]."""
        seconds, nanoseconds = self.unpack('iI')
        return seconds * NANOSECONDS + nanoseconds

    def header(self):
        """Return a std_msgs/Header: time [ns] and frame."""
        return self.time(), self.string()

    def doubles(self, count):
        """Return doubles, a view that cannot be written."""
        if count:
            self.align(8)
        return np.frombuffer(self.raw(8 * count), '<f8')

    def array(self, width):
        """Return a sequence of elements of `width` doubles, a (count, width) view."""
        count = self.count(8 * width)
        return self.doubles(count * width).reshape(count, width)

    def end(self):
        """Refuse a message that goes on after its last field."""
        if self.remaining > _TRAILING:
            self.fail(f'{self.remaining} bytes after the last field')
