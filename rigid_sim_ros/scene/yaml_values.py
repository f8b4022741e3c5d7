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
YAML text to plain values, stricter and faster than PyYAML's own constructors.

PyYAML's parser is used; what is built from its events follows the core schema of YAML 1.2, as
people expect: 1e-3 is a number, `yes`, 012 and 12:30 are not a truth value, an octal and a
sexagesimal number. A key given twice is refused (PyYAML keeps the last), and so are tags.
Building from events takes a third of the time of CSafeLoader, and deep nesting gives an error,
where the recursion of CSafeLoader ends the process.
"""

import re

from rigid_sim_ros.scene.errors import SceneError, shown
import yaml

MAX_DEPTH = 20
"""Deepest nesting; a scene needs 4."""

LONGEST_INTEGER = 300
"""Digits; a longer integer is read as floating point, as float() can hold no larger one."""

_Loader = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)

_NUMBER = re.compile(r'[-+]?(?:\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?')
_INTEGER = re.compile(r'[-+]?[0-9]+')
_NUMBER_STARTS = frozenset('-+.0123456789')
_WORDS = {
    '': None, '~': None, 'null': None, 'Null': None, 'NULL': None,
    'true': True, 'True': True, 'TRUE': True, 'false': False, 'False': False, 'FALSE': False,
    **{sign + word: float(sign + 'inf')
       for sign in ('', '+', '-') for word in ('.inf', '.Inf', '.INF')},
    '.nan': float('nan'), '.NaN': float('nan'), '.NAN': float('nan')}

_NO_KEY = object()
_MERGE = object()


def parse_yaml(text, label):
    """
    Return the value of one YAML document: dict, list, str, float, int, bool or None.

    Raises
    ------
    SceneError
        `label`, line, column and problem, for text that is not one YAML document without tags.

    """
    try:
        return _build(yaml.parse(text, Loader=_Loader))
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f'line {mark.line + 1}, column {mark.column + 1}: ' if mark else ''
        problem = ' '.join(str(error.problem or error.context).split())
        raise SceneError(f'{label}: {place}not valid YAML: {problem}') from None
    except (yaml.YAMLError, UnicodeEncodeError) as error:
        problem = ' '.join(str(error).split())
        raise SceneError(f'{label}: not valid YAML: {problem}') from None


def _refused(event, problem):
    return yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)


class _List(list):
    """A sequence under construction."""

    anchor = None

    def take(self, value, event):
        self.append(value)

    def finish(self):
        return self


class _Mapping(dict):
    """A mapping under construction: takes key, value, key, value, ..."""

    anchor = None

    def __init__(self):
        super().__init__()
        self.key = _NO_KEY
        self.merged = []

    def take(self, value, event):
        if self.key is not _NO_KEY:
            if self.key is _MERGE:
                self.merged += self._mappings(value, event)
            else:
                self[self.key] = value
            self.key = _NO_KEY
        elif value == '<<' and isinstance(event, yaml.ScalarEvent) and event.implicit[0]:
            self.key = _MERGE
        elif isinstance(value, (dict, list)):
            raise _refused(event, 'a key must be a word')
        elif value in self:
            raise _refused(event, f'the key {shown(value)} is given twice')
        else:
            self.key = value

    @staticmethod
    def _mappings(value, event):
        values = value if isinstance(value, list) else [value]
        if not all(isinstance(each, dict) for each in values):
            raise _refused(event, '<< takes a mapping or a list of mappings')
        return values

    def finish(self):
        for merged in self.merged:
            for key, value in merged.items():
                self.setdefault(key, value)
        return self


def _build(events):
    """Return the value of the one document in a stream of parser events."""
    root, document_count = None, 0
    anchors = {}
    unfinished = []
    for event in events:
        kind = type(event)
        if kind is yaml.ScalarEvent:
            value, anchor = _scalar(event), event.anchor
        elif kind is yaml.SequenceStartEvent or kind is yaml.MappingStartEvent:
            _check_collection(event, len(unfinished))
            unfinished.append(_List() if kind is yaml.SequenceStartEvent else _Mapping())
            unfinished[-1].anchor = event.anchor
            continue
        elif kind is yaml.SequenceEndEvent or kind is yaml.MappingEndEvent:
            finished = unfinished.pop()
            value, anchor = finished.finish(), finished.anchor
        elif kind is yaml.AliasEvent:
            # anchors are known once complete, so that no value can contain itself
            if event.anchor not in anchors:
                raise _refused(event, f'the alias *{event.anchor} has no anchor before it')
            value, anchor = anchors[event.anchor], None
        else:
            document_count += kind is yaml.DocumentStartEvent
            if document_count > 1:
                raise _refused(event, 'a second document; a scene is one document')
            continue
        if anchor:
            anchors[anchor] = value
        if unfinished:
            unfinished[-1].take(value, event)
        else:
            root = value
    return root


def _check_collection(event, depth):
    if not event.implicit:
        raise _refused(event, f'the tag {event.tag}; a scene has no tags')
    if depth >= MAX_DEPTH:
        raise _refused(event, f'nested deeper than {MAX_DEPTH} levels')


def _scalar(event):
    """Return the value of a scalar: text if quoted, else by the core schema of YAML 1.2."""
    text = event.value
    plain, quoted = event.implicit
    if not plain:
        if not quoted:
            raise _refused(event, f'the tag {event.tag}; a scene has no tags')
        return text
    if text in _WORDS:
        return _WORDS[text]
    if text[0] in _NUMBER_STARTS and _NUMBER.fullmatch(text):
        if _INTEGER.fullmatch(text) and len(text) <= LONGEST_INTEGER:
            return int(text)
        return float(text)
    return text
