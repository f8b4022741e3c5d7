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

"""What the node could not do as told: counted by kind, and said to the user not too often."""

import difflib
import time

REPEAT_AFTER = 5.0
"""Wall time [s] between two warnings of one kind."""

LONGEST_NAME = 60
"""Characters of a name shown: names come from outside and may be of any length."""


class CountedWarnings:
    """Counts what users did wrong by kind, and warns of a kind at most every `REPEAT_AFTER`."""

    def __init__(self, warn, now=time.monotonic):
        """Warn by calling `warn(text)`; `now()` gives the wall time [s]."""
        self._warn = warn
        self._now = now
        self._warned_at = {}
        self._held_back = {}
        """What describes the last one that was not warned of, and how many there are, by kind."""
        self.counts = {}
        """How often so far, by kind."""

    @property
    def total(self):
        """How often so far, of all kinds."""
        return sum(self.counts.values())

    def add(self, kind, describe):
        """
        Count one and warn of it if one of its kind is due; else `report` does when it is.

        `describe()` makes the text; it is called only for a warning that is given, because
        finding near names among ten thousand takes longer than a simulation step.
        """
        self.counts[kind] = self.counts.get(kind, 0) + 1
        _, before = self._held_back.get(kind, (None, 0))
        self._held_back[kind] = describe, before + 1
        self._warn_if_due(kind)

    def report(self):
        """Warn of the last one held back of each kind that is due by now."""
        for kind in [*self._held_back]:
            self._warn_if_due(kind)

    def _warn_if_due(self, kind):
        now = self._now()
        if now - self._warned_at.get(kind, float('-inf')) < REPEAT_AFTER:
            return
        self._warned_at[kind] = now
        describe, count = self._held_back.pop(kind)
        more = f' ({count - 1} more like it since the last warning)' if count > 1 else ''
        self._warn(describe() + more)


def shown(name):
    """Return a name from outside as it can be printed: quoted, escaped, not too long."""
    if len(name) <= LONGEST_NAME:
        return repr(name)
    return f'{name[:LONGEST_NAME]!r}... ({len(name)} characters)'


def near_names(name, names):
    """Say which of the names a wrong one may have meant, as a phrase."""
    near = near_names_only(name, names, cutoff=0.5)
    if near:
        return near
    if not names:
        return 'this scene has no moving bodies'
    more = f', ... ({len(names)} in all)' if len(names) > 5 else ''
    return 'the names are: ' + ', '.join(names[:5]) + more


def near_names_only(name, names, cutoff=0.6):
    """Return the same where some names are near, else nothing."""
    near = difflib.get_close_matches(name[:LONGEST_NAME], names, n=3, cutoff=cutoff)
    return f'near names: {", ".join(near)}' if near else ''
