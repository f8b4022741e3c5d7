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

"""Values of command line arguments: what each may be, told in the words of argparse."""

import argparse
from math import isfinite


def positive(text):
    """Return a number above zero, or raise `ArgumentTypeError`."""
    return _number(text, lambda value: value > 0, 'a positive number')


def not_negative(text):
    """Return a number of zero or more, or raise `ArgumentTypeError`."""
    return _number(text, lambda value: value >= 0, 'a number, 0 or more')


def _number(text, is_allowed, allowed):
    try:
        value = float(text)
    except ValueError:
        value = float('nan')
    if not (isfinite(value) and is_allowed(value)):
        raise argparse.ArgumentTypeError(f'{text!r}; allowed: {allowed}')
    return value
