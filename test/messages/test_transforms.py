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

"""Transforms for tf2, read by rosbags, which knows tf2_msgs where ROS is installed without it."""

import numpy as np
from numpy.testing import assert_array_equal
import pytest
from rigid_sim_ros.messages import TransformsEncoder

typesys = pytest.importorskip('rosbags.typesys')


@pytest.mark.parametrize('names', [
    (), ('a',), ('a', 'bc', 'def', 'ghij', 'klmno'), tuple(f'cube_{n}' for n in range(1000))])
def test_rosbags_reads_what_was_written(names):
    store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    generator = np.random.default_rng(3)
    encoder = TransformsEncoder('world', names)
    for time_ns in (0, 12_000_000_345):
        position = generator.normal(size=(len(names), 3))
        orientation = generator.normal(size=(len(names), 4))
        data = encoder.encode(time_ns, position, orientation)
        transforms = store.deserialize_cdr(data, 'tf2_msgs/msg/TFMessage').transforms
        assert tuple(row.child_frame_id for row in transforms) == names
        assert {row.header.frame_id for row in transforms} <= {'world'}
        assert {row.header.stamp.sec * 10 ** 9 + row.header.stamp.nanosec
                for row in transforms} <= {time_ns}
        numbers = [[part.x, part.y, part.z] for row in transforms
                   for part in (row.transform.translation, row.transform.rotation)]
        assert_array_equal(np.reshape(numbers[::2], (-1, 3)), position)
        assert_array_equal(np.reshape(numbers[1::2], (-1, 3)), orientation[:, :3])
        assert [row.transform.rotation.w for row in transforms] == orientation[:, 3].tolist()
        # byte for byte what a plain writer makes of the same values
        assert bytes(store.serialize_cdr(store.deserialize_cdr(data, 'tf2_msgs/msg/TFMessage'),
                                         'tf2_msgs/msg/TFMessage')) == data
