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

"""`rigid_sim_recover`: finish a bag whose recorder was killed."""

import argparse
import os
import sys

from rigid_sim_ros.recording import RecordingError, recover


def main(arguments=None):
    """Run the program; return its exit code."""
    parser = argparse.ArgumentParser(
        prog='rigid_sim_recover',
        description='Finish a bag whose recorder was killed, or whose files were damaged: '
                    'everything readable is kept, and a damaged file stays beside the new one.')
    parser.add_argument('bag', type=os.path.expanduser, help='folder of the bag')
    options = parser.parse_args(arguments)
    try:
        for line in recover(options.bag):
            print(line)
    except RecordingError as error:
        print(f'rigid_sim_recover: {error}', file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
