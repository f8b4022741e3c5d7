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
The executable rigid_sim_ros2: a stand-in for the command `ros2`, where there is none.

It understands the commands of the tour in the README, with the words, the arguments and the output
they have in ROS 2 Jazzy.
"""

import argparse
import os
import sys

from rigid_sim_ros.nodes.arguments import positive
from rigid_sim_ros.nodes.signals import Interrupted, StopRequest

EXECUTABLE = 'rigid_sim_ros2'


def main(arguments=None):
    """
    Carry out a command, and return the exit code.

    0 also after Ctrl-C and SIGTERM, 1 with one line on stderr for what is not there or refused,
    2 for arguments that are not understood.
    """
    stop = StopRequest()
    stop.install()
    sys.stdout.reconfigure(line_buffering=True)
    try:
        with stop.breakable(patience=0):
            return run(sys.argv[1:] if arguments is None else arguments)
    except Interrupted:
        return 0
    except BrokenPipeError:
        # who read it has gone, as `head` does: Python would complain when it flushes at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    finally:
        stop.ignore()


def run(arguments):
    """Carry out a command given by its arguments, the program's name left out."""
    options = _parser().parse_args(arguments)
    # imported only now: importing ROS takes most of a second
    from rigid_sim_ros.nodes.ros2_verbs import parameter_verbs, service_verbs, topic_verbs
    from rigid_sim_ros.nodes.ros2_verbs.graph import Graph, VerbError
    verbs = {
        'topic': {'list': topic_verbs.list_topics, 'echo': topic_verbs.echo,
                  'hz': topic_verbs.hz, 'info': topic_verbs.info, 'pub': topic_verbs.publish},
        'service': {'list': service_verbs.list_services, 'call': service_verbs.call},
        'param': {'list': parameter_verbs.list_parameters, 'get': parameter_verbs.get,
                  'set': parameter_verbs.set_value},
        'node': {'list': service_verbs.list_nodes}}
    try:
        with Graph() as graph:
            verbs[options.command][options.verb](graph, options)
    except VerbError as error:
        print(f'{EXECUTABLE}: {error}', file=sys.stderr)
        return 1
    return 0


def _parser():
    parser = argparse.ArgumentParser(
        prog=EXECUTABLE, description='The part of the command ros2 that a first tour needs, for '
        'machines that have none.')
    commands = parser.add_subparsers(dest='command', metavar='COMMAND', required=True)
    for name, add_verbs in (('topic', _add_topic_verbs), ('service', _add_service_verbs),
                            ('param', _add_parameter_verbs), ('node', _add_node_verbs)):
        command = commands.add_parser(name, help=f'look at and use {_PLURALS[name]}')
        add_verbs(command.add_subparsers(dest='verb', metavar='VERB', required=True))
    return parser


_PLURALS = {'topic': 'topics', 'service': 'services', 'param': 'parameters', 'node': 'nodes'}


def _add_topic_verbs(verbs):
    _add_list(verbs, 'topics')
    echo = verbs.add_parser('echo', help='print the messages of a topic')
    echo.add_argument('topic')
    echo.add_argument('type', nargs='?', help='of the messages; by default that of the topic')
    echo.add_argument('--once', action='store_true', help='print one message and end')
    echo.add_argument('--field', metavar='NAME', help='print only this, such as header.frame_id')
    echo.add_argument('--no-arr', action='store_true', help='print lengths of arrays only')
    echo.add_argument('-f', '--full-length', action='store_true',
                      help='print long arrays and texts to their end')
    verbs.add_parser('hz', help='print how often messages come').add_argument('topic')
    verbs.add_parser('info', help='print type and numbers of users').add_argument('topic')
    publish = verbs.add_parser('pub', help='publish a message')
    publish.add_argument('topic')
    publish.add_argument('type', help='of the message, such as geometry_msgs/msg/TwistStamped')
    publish.add_argument('values', nargs='?', default='{}',
                         help='fields of the message as YAML; the others have their defaults')
    publish.add_argument('-r', '--rate', type=positive, default=1.0, metavar='HZ',
                         help='messages a second (default 1)')
    count = publish.add_mutually_exclusive_group()
    count.add_argument('-1', '--once', action='store_true',
                       help='publish one message, as soon as there is a subscriber, and end')
    count.add_argument('-t', '--times', type=int, default=0, metavar='N',
                       help='publish so many messages and end')


def _add_service_verbs(verbs):
    _add_list(verbs, 'services')
    call = verbs.add_parser('call', help='call a service')
    call.add_argument('service')
    call.add_argument('type', help='of the service, such as std_srvs/srv/Trigger')
    call.add_argument('values', nargs='?', default='{}',
                      help='fields of the request as YAML; the others have their defaults')


def _add_parameter_verbs(verbs):
    names = verbs.add_parser('list', help="print the names of a node's parameters")
    names.add_argument('node', nargs='?', help='by default all nodes')
    for verb, what in (('get', 'print the value of a parameter'), ('set', 'set a parameter')):
        parser = verbs.add_parser(verb, help=what)
        parser.add_argument('node')
        parser.add_argument('name')
        if verb == 'set':
            parser.add_argument('value')


def _add_node_verbs(verbs):
    verbs.add_parser('list', help='print the names of all nodes')


def _add_list(verbs, what):
    parser = verbs.add_parser('list', help=f'print the names of all {what}')
    parser.add_argument('-t', '--show-types', action='store_true', help='with their types')


if __name__ == '__main__':
    sys.exit(main())
