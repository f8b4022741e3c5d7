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

"""What we claim about compatibility, by readers that are not ours."""

import io

import numpy as np
import pytest

rosbag2 = pytest.importorskip('rosbags.rosbag2')
typesys = pytest.importorskip('rosbags.typesys')
reader = pytest.importorskip('mcap.reader')
decoder = pytest.importorskip('mcap_ros2.decoder')

COUNTS = {'/rigid_sim/poses': 100, '/rigid_sim/states': 100, '/rigid_sim/collisions': 10,
          '/rigid_sim/scene': 1}


@pytest.fixture(scope='module')
def store():
    return typesys.get_typestore(typesys.Stores.ROS2_JAZZY)


def test_rosbags_opens_the_folder_and_sees_topics_counts_and_times(bag):
    with rosbag2.Reader(bag) as opened:
        counts = {connection.topic: connection.msgcount for connection in opened.connections}
        assert {topic: count for topic, count in counts.items() if count} == COUNTS
        assert len(counts) == 14
        assert (opened.message_count, opened.start_time) == (211, 0)
        assert opened.end_time - 1 == 990_000_000
        assert opened.ros_distro == 'jazzy'


def test_rosbags_sees_quality_of_service_and_its_own_type_hashes(bag, store):
    with rosbag2.Reader(bag) as opened:
        qualities = {connection.topic: connection.ext.offered_qos_profiles[0]
                     for connection in opened.connections}
        assert qualities['/rigid_sim/scene'].durability.name == 'TRANSIENT_LOCAL'
        assert qualities['/rigid_sim/scene'].depth == 1
        assert qualities['/clock'].reliability.name == 'BEST_EFFORT'
        assert qualities['/rigid_sim/poses'].history.name == 'KEEP_LAST'
        for connection in opened.connections:
            assert connection.digest == store.hash_rihs01(connection.msgtype)


def test_rosbags_reads_every_message_in_order(bag, run, store):
    steps = 0
    with rosbag2.Reader(bag) as opened:
        last = 0
        for connection, time_ns, raw in opened.messages():
            assert time_ns >= last
            last = time_ns
            message = store.deserialize_cdr(raw, connection.msgtype)
            if connection.topic == '/rigid_sim/poses':
                assert raw == run.poses(steps, steps * 10_000_000)
                assert message.header.stamp.nanosec == time_ns
                assert [message.poses[2].position.x, message.poses[1].orientation.w] == [
                    run.values(steps, 3, 0)[2, 0], run.values(steps, 4, 1)[1, 3]]
                steps += 1
    assert steps == 100


def test_mcap_and_its_ros_2_support_decode_by_the_schemas_in_the_file(bag, run):
    with open(bag / 'sound_0.mcap', 'rb') as stream:
        opened = reader.make_reader(stream, validate_crcs=True,
                                    decoder_factories=[decoder.DecoderFactory()])
        assert opened.get_header().profile == 'ros2'
        assert [(item.name, item.data.decode()) for item in opened.iter_attachments()][0] == (
            'scene.yaml', run.scene)
        assert [item.name for item in opened.iter_metadata()] == ['rosbag2', 'rosbag2']
        seen = {}
        for schema, channel, message, decoded in opened.iter_decoded_messages():
            assert (schema.encoding, channel.message_encoding) == ('ros2msg', 'cdr')
            assert message.log_time == message.publish_time
            assert message.sequence == seen.get(channel.topic, 0)
            seen[channel.topic] = seen.get(channel.topic, 0) + 1
            if channel.topic == '/rigid_sim/states':
                step = seen[channel.topic] - 1
                assert decoded.joint_names == list(run.names)
                assert decoded.wrench[1].torque.y == run.values(step, 3, 5)[1, 1]
            if channel.topic == '/rigid_sim/collisions':
                assert [field.name for field in decoded.fields][:4] == ['x', 'y', 'z', 'normal_x']
        assert seen == COUNTS


def test_mcap_s_strict_stream_reader_finds_sound_chunks_statistics_and_index(bag):
    stream_reader = pytest.importorskip('mcap.stream_reader')
    data = (bag / 'sound_0.mcap').read_bytes()
    records = list(stream_reader.StreamReader(
        io.BytesIO(data), emit_chunks=True, validate_crcs=True).records)
    kinds = [type(record).__name__ for record in records]
    assert kinds.count('Chunk') == kinds.count('ChunkIndex') > 2
    with open(bag / 'sound_0.mcap', 'rb') as stream:
        summary = reader.make_reader(stream, validate_crcs=True).get_summary()
    assert summary.statistics.message_count == 211
    assert summary.statistics.chunk_count == kinds.count('Chunk')
    for index in summary.chunk_indexes:
        assert data[index.chunk_start_offset] == 6
        for channel, offset in index.message_index_offsets.items():
            assert data[offset] == 7
            assert int.from_bytes(data[offset + 9:offset + 11], 'little') == channel


@pytest.mark.parametrize('compression', ['none', 'lz4', 'zstd'])
def test_mcap_reads_every_compression(tmp_path, run, compression):
    with run.recorder(tmp_path / 'bag', compression=compression) as recorder:
        run.write(recorder, 0, 20)
    with rosbag2.Reader(tmp_path / 'bag') as opened:
        raw = [data for connection, _, data in opened.messages()
               if connection.topic == '/rigid_sim/poses']
    assert raw == [run.poses(step, step * 10_000_000) for step in range(20)]


def test_a_bag_without_messages_opens(tmp_path, run):
    run.recorder(tmp_path / 'bag').close()
    with rosbag2.Reader(tmp_path / 'bag') as opened:
        assert opened.message_count == 0
        assert len(opened.connections) == 14


def test_collisions_are_points_to_others(bag, run, store):
    with rosbag2.Reader(bag) as opened:
        connections = [item for item in opened.connections
                       if item.topic == '/rigid_sim/collisions']
        _, time_ns, raw = next(opened.messages(connections))
    cloud = store.deserialize_cdr(raw, 'sensor_msgs/msg/PointCloud2')
    point = cloud.data.tobytes()
    offsets = {field.name: field.offset for field in cloud.fields}
    assert np.frombuffer(point, '<f4', 3, offsets['x']).tolist() == [1, 2, 3]
    assert np.frombuffer(point, '<f8', 1, offsets['speed']).tolist() == [2.5]
    offset, = np.frombuffer(point, '<f8', 1, offsets['time_offset'])
    assert time_ns / 1e9 + offset == run.events(time_ns)['time'][0]
