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

"""Messages from YAML, as people type them, and to YAML, as people read them."""

from importlib import import_module
import sys

from rigid_sim_ros.nodes.interfaces import interface
from rigid_sim_ros.nodes.ros2_verbs.graph import VerbError
from rosidl_parser.definition import AbstractNestedType, Array, NamespacedType
import yaml

LONGEST_SHOWN = 128
"""Elements of an array or characters of a text after which the rest is '...', as in `ros2`."""


def interface_class(kind, type_name):
    """Return the class of a type of `kind` 'msg' or 'srv'; 'std_msgs/String' is enough."""
    parts = type_name.split('/')
    try:
        package, folder, name = parts if len(parts) == 3 else (parts[0], kind, *parts[1:])
        if folder != kind:
            raise ValueError
        return interface(f'{package}/{folder}/{name}')
    except (AttributeError, ImportError, ValueError):
        word = {'msg': 'message', 'srv': 'service'}[kind]
        raise VerbError(f'there is no {word} type {type_name!r} here; types look like '
                        f'PACKAGE/{kind}/NAME') from None


def from_yaml(message_type, text):
    """Return a message with the fields that a text gives, the others at their defaults."""
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise VerbError(f'{text!r} is not YAML: {" ".join(str(error).split())}') from None
    return _message(message_type, values, '')


def _message(message_type, values, place):
    """Return a message; `place` is its name in errors, '' if it is the whole."""
    if not isinstance(values, dict):
        raise VerbError(f'{place or "the message"} is {values!r}; allowed: a mapping of fields')
    types = _field_types(message_type)
    fields = {}
    for name, value in values.items():
        inside = f'{place}.{name}' if place else str(name)
        if name not in types:
            raise VerbError(f'there is no field {inside!r}; allowed: {", ".join(types) or "none"}')
        fields[name] = _value(types[name], value, inside)
        try:
            message_type(check_fields=True, **{name: fields[name]})
        except (AssertionError, OverflowError, TypeError, ValueError):
            allowed = message_type.get_fields_and_field_types()[name]
            raise VerbError(f'{inside} is {value!r}; allowed: {allowed}') from None
    return message_type(**fields)


def _value(field_type, value, place):
    """Return what a field of a type is set to; the message itself refuses what does not fit."""
    if isinstance(field_type, NamespacedType):
        return _message(_class(field_type), value, place)
    if isinstance(field_type, AbstractNestedType):
        if not isinstance(value, list):
            raise VerbError(f'{place} is {value!r}; allowed: a list')
        return [_value(field_type.value_type, part, f'{place}[{index}]')
                for index, part in enumerate(value)]
    name = getattr(field_type, 'typename', 'string')
    if name in ('float', 'double') and not isinstance(value, bool):
        # YAML takes 1e3 for a text, and 1 for an integer
        return _number(value, place)
    if name == 'string' and isinstance(value, (int, float)):
        return str(value)
    return value


def _number(value, place):
    try:
        return float(value)
    except (TypeError, ValueError):
        raise VerbError(f'{place} is {value!r}; allowed: a number') from None


def to_yaml(message, longest=LONGEST_SHOWN, arrays=True):
    """Return a message as YAML; without `arrays` only their types and lengths."""
    return yaml.dump(_plain(message, longest, arrays), sort_keys=False, allow_unicode=True,
                     width=sys.maxsize, default_flow_style=False)


def _plain(value, longest, arrays):
    """Return a field's value in mappings, lists, texts and numbers."""
    if hasattr(value, 'SLOT_TYPES'):
        return {
            name: _array_text(part_type, getattr(value, name))
            if isinstance(part_type, AbstractNestedType) and not arrays
            else _plain(getattr(value, name), longest, arrays)
            for name, part_type in _field_types(value).items()}
    if isinstance(value, bytes):
        value = value.decode('latin-1')
    if isinstance(value, (bool, int, float)):
        return value
    cut = longest is not None and len(value) > longest
    if isinstance(value, str):
        return value[:longest] + '...' if cut else value
    parts = value[:longest] if cut else value
    # arrays of numbers are NumPy's if their length is fixed
    parts = parts.tolist() if hasattr(parts, 'tolist') else parts
    return [_plain(part, longest, arrays) for part in parts] + (['...'] if cut else [])


def _array_text(array_type, value):
    element = array_type.value_type
    name = ('/'.join(element.namespaced_name()) if isinstance(element, NamespacedType)
            else getattr(element, 'typename', 'string'))
    if isinstance(array_type, Array):
        return f'<array type: {name}[{array_type.size}]>'
    return f'<sequence type: {name}, length: {len(value)}>'


def _field_types(message):
    """Return the parsed type of each field by name, in the order of the definition."""
    return dict(zip(message.get_fields_and_field_types(), message.SLOT_TYPES))


def _class(named_type):
    return getattr(import_module('.'.join(named_type.namespaces)), named_type.name)
