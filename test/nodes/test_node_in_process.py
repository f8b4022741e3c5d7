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

"""Nodes made in the test's own process: what is built, who publishes the clock, both executors."""

from contextlib import contextmanager
from importlib.util import find_spec
import sys
import time
from types import ModuleType

import pytest

rclpy = pytest.importorskip('rclpy')

from geometry_msgs.msg import PoseArray, TwistStamped  # noqa: E402, I100
from node_harness import Client, PATIENCE  # noqa: E402
from rclpy.context import Context  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from rigid_sim_ros.nodes.clock_source import ROW as CLOCK  # noqa: E402
from rigid_sim_ros.nodes.executors import EVENTS, make_executor, SINGLE_THREADED  # noqa: E402
from rigid_sim_ros.nodes.interfaces import interface  # noqa: E402
from rigid_sim_ros.nodes.node import SimulationNode  # noqa: E402
from rigid_sim_ros.nodes.parameters import ParameterError  # noqa: E402
from rigid_sim_ros.nodes.running import drive  # noqa: E402
from rigid_sim_ros.nodes.signals import StopRequest  # noqa: E402
from std_msgs.msg import Header  # noqa: E402
from visualization_msgs.msg import Marker  # noqa: E402


class Stop(StopRequest):
    """Ends `drive` when a condition holds, or fails the test after a while."""

    def __init__(self, condition):
        super().__init__()
        self._condition = condition
        self._deadline = time.monotonic() + PATIENCE

    @property
    def requested(self):
        assert time.monotonic() < self._deadline, 'waited in vain'
        return self._condition()

    @requested.setter
    def requested(self, value):
        pass


@contextmanager
def hosted(*namespaces, executor=EVENTS, **parameters):
    """Give nodes, and a function that runs them until a condition holds."""
    context = Context()
    rclpy.init(context=context)
    parameters.setdefault('scene', 'report_dynamics')
    overrides = [Parameter(name, value=value) for name, value in parameters.items()]
    nodes = [SimulationNode(StopRequest(), context=context, namespace=namespace,
                            parameter_overrides=overrides) for namespace in namespaces]
    runner, _ = make_executor(executor, context)
    for node in nodes:
        runner.add_node(node.ros)
        node.start()
    try:
        yield nodes, lambda condition: drive(nodes, runner, Stop(condition))
    finally:
        for node in nodes:
            node.close()
        rclpy.shutdown(context=context)


def encoded(node):
    return {publication.row.name: publication.encoded for publication in node.publications
            if publication.encoded}


def test_nothing_is_built_that_nobody_reads():
    with hosted('') as ([node], run):
        run(lambda: node.session.time >= 300_000_000)
        # the latched scene is for subscribers yet to come
        assert encoded(node) == {'~/scene': 1}


def test_only_what_is_read_is_built():
    with hosted('') as ([node], run), Client() as client:
        poses = client.listen('~/poses')
        run(lambda: len(client.poll(poses)) >= 10)
        counts = encoded(node)
        assert set(counts) == {'~/scene', '~/poses'}
        assert counts['~/poses'] >= 10


def test_only_what_is_recorded_is_built(tmp_path):
    with hosted('', record=True, record_path=str(tmp_path / 'bag')) as ([node], run):
        run(lambda: node.session.time >= 300_000_000)
        counts = encoded(node)
        assert {'~/scene', '~/poses', '~/states', '/clock'} <= set(counts)
        assert not set(counts) & {'~/markers', '/diagnostics'}
        # the first state, and one more for each period
        assert counts['~/poses'] == 1 + node.session.time // 10_000_000


def test_markers_come_as_fast_as_eyes_see_and_are_removed_on_reset():
    with hosted('', publish_rate=500.0) as ([node], run), Client() as client:
        markers = client.listen('~/markers')
        run(lambda: client.poll(markers))
        start, count = time.monotonic(), len(markers)
        run(lambda: time.monotonic() > start + 0.5 and client.poll(markers) is markers)
        client.spin(0.1)
        # thirty a second, and one for the edges
        assert 2 <= len(markers) - count <= 17
        bodies = len(node.session.simulation.names)
        assert [marker.action for marker in markers[-1].markers] == [Marker.ADD] * bodies
        count = len(markers)
        node.reset()
        run(lambda: len(client.poll(markers)) >= count + 2)
        assert [marker.action for marker in markers[count].markers] == [Marker.DELETEALL]
        assert [marker.action for marker in markers[count + 1].markers] == [Marker.ADD] * bodies


def test_first_diagnostics_tell_the_pace_also_after_time_went_back():
    with hosted('', reset_time=True) as ([node], run), Client() as client:
        diagnostics = client.listen('/diagnostics')
        run(lambda: node.session.time > 800_000_000)
        node.reset()
        run(lambda: client.poll(diagnostics))
        values = {value.key: value.value for value in diagnostics[0].status[0].values}
        # a second of wall time at the pace of the wall, though the clock shows little of it
        assert 0.5 < float(values['real-time factor, last period']) < 1.1


@pytest.mark.parametrize('executor', [EVENTS, SINGLE_THREADED])
def test_both_executors_serve(executor):
    with hosted('', executor=executor) as ([node], run), Client() as client:
        poses = client.listen('~/poses')
        publisher = client.node.create_publisher(TwistStamped, '/rigid_sim/cmd_vel', 10)
        run(publisher.get_subscription_count)
        publisher.publish(TwistStamped(header=Header(frame_id=node.session.simulation.names[0])))
        run(lambda: node.session.commands.taken == 1)
        start = time.monotonic()
        count = len(client.poll(poses))
        run(lambda: len(client.poll(poses)) >= count + 50)
        # fifty states at 100 Hz: half a second, with some room for a busy machine
        assert 0.3 < time.monotonic() - start < 3.0


def test_two_nodes_in_one_process_and_one_clock():
    with hosted('left', 'right') as (nodes, run), \
            Client() as client:
        received = {name: [] for name in ('left', 'right')}
        for name, messages in received.items():
            client.node.create_subscription(
                PoseArray, f'/{name}/rigid_sim/poses', messages.append, 100)
        run(lambda: all(len(client.poll(messages)) > 5 for messages in received.values()))
        info = nodes[0].ros.get_publishers_info_by_topic('/clock')
        assert [row.node_namespace for row in info] == ['/left']


def settled(nodes, condition):
    """Let nodes of different contexts work until a condition holds."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, 'waited in vain'
        for node in nodes:
            node.work()
        time.sleep(1e-3)


def clock_count(node):
    return len(node.ros.get_publishers_info_by_topic('/clock'))


@pytest.mark.parametrize('other', ['left', 'right'])
def test_nodes_that_start_together_settle_on_one_clock(other, capfd):
    with hosted('left') as ([left], _), hosted(other) as ([right], _):
        # the first second is over when both have looked around
        settled([left, right], lambda: (
            clock_count(left) == clock_count(right) == 1
            and min(left.session.time, right.session.time) > 1_200_000_000))
    assert ('2 nodes are named /left/rigid_sim' in capfd.readouterr().err) == (other == 'left')


def test_node_takes_over_the_clock_of_one_that_ended():
    with hosted('right') as ([right], _):
        with hosted('left') as ([left], _):
            settled([left, right], lambda: clock_count(left) == 1 == clock_count(right)
                    and right.session.time > 1_200_000_000)
            publishing = right if right.publications.is_open(CLOCK) else left
            waiting = left if publishing is right else right
            publishing.publications.end(CLOCK)
            settled([waiting], lambda: waiting.publications.is_open(CLOCK))


def test_both_publish_the_clock_if_told_to():
    with hosted('left', 'right', publish_clock=True) as (nodes, run):
        run(lambda: nodes[0].session.time > 1_200_000_000)
        assert len(nodes[0].ros.get_publishers_info_by_topic('/clock')) == 2


def test_recording_that_failed_just_before_the_end_is_told(tmp_path, capfd):
    with hosted('', record=True, record_path=str(tmp_path / 'bag')) as ([node], _):
        node.recording._recorder._fail('no room left')
    assert 'no room left' in capfd.readouterr().err


def test_scene_that_the_method_does_not_know_is_refused(tmp_path):
    path = tmp_path / 'ball.yaml'
    path.write_text('bodies: [{name: ball, sphere: {radius: 1}, mass: 1}]')
    with pytest.raises(ParameterError, match="'report'.*'sphere'") as error:
        with hosted('', scene=str(path), method='report'):
            pass
    assert '\n' not in str(error.value)


def test_transforms_need_tf2_msgs():
    if find_spec('tf2_msgs'):
        pytest.skip('tf2_msgs is installed')
    with pytest.raises(ParameterError, match='publish_tf is true, but there is no tf2_msgs'):
        with hosted('', publish_tf=True):
            pass


def test_transforms_are_published_if_asked_for(monkeypatch):
    typesys = pytest.importorskip('rosbags.typesys')
    if not find_spec('tf2_msgs'):
        # bytes go through a topic of any type; rosbags knows the one they are meant for
        module = ModuleType('tf2_msgs.msg')
        module.TFMessage = PoseArray
        monkeypatch.setitem(sys.modules, 'tf2_msgs', ModuleType('tf2_msgs'))
        monkeypatch.setitem(sys.modules, 'tf2_msgs.msg', module)
    with hosted('', publish_tf=True) as ([node], run), Client() as client:
        received = []
        client.node.create_subscription(
            interface('tf2_msgs/msg/TFMessage'), '/tf', received.append, 10, raw=True)
        run(lambda: client.poll(received))
        store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
        transforms = store.deserialize_cdr(received[-1], 'tf2_msgs/msg/TFMessage').transforms
        assert tuple(row.child_frame_id for row in transforms) == node.session.simulation.names
