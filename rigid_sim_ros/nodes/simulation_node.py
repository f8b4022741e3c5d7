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

"""The executable rigid_sim_node."""

import os
import sys

from rigid_sim_ros.nodes.signals import Interrupted, StopRequest


def main(arguments=None):
    """
    Run the node until it is told to stop, and return the exit code.

    0 after Ctrl-C or SIGTERM, 2 for what the user got wrong, with one line on stderr.
    """
    # systems of equations are so small that a second thread takes time and gives none; results
    # are the same
    os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
    stop = StopRequest()
    stop.install()
    try:
        # imported only now: importing ROS and NumPy takes most of a second, in which Ctrl-C shall
        # end the process as quietly as it does later
        with stop.breakable(patience=0):
            from rigid_sim_ros.nodes.running import run
        return run(sys.argv if arguments is None else arguments, stop)
    except Interrupted:
        return 0
    finally:
        stop.ignore()


if __name__ == '__main__':
    sys.exit(main())
