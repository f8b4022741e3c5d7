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

"""What the benchmark refuses."""

from difflib import get_close_matches


class BenchmarkError(Exception):
    """Something that cannot be run; the text is one line that says what was given and allowed."""


def chosen(kind, names, allowed):
    """
    Return names that are all allowed, each once; all that are allowed if none are given.

    Raises `BenchmarkError` with the unknown name and those near it; `kind` says of what.
    """
    for name in names:
        if name not in allowed:
            near = get_close_matches(name, allowed, cutoff=0.5) or allowed
            raise BenchmarkError(f'no {kind} is named {name!r}; '
                                 f'{"near names" if near is not allowed else "allowed"}: '
                                 f'{", ".join(near)}')
    return list(dict.fromkeys(names)) or list(allowed)
