"""Messages as YAML and comma-separated values, and filling a message from YAML.

The text is that of the real `ros2` (`rosidl_runtime_py`). Filling is stricter: values that it
would silently convert, such as 1.5 for an integer, are refused here.
"""

from __future__ import annotations

import array
import math
import sys
from collections.abc import Callable, Collection, Iterator
from typing import Any

import numpy
import yaml
from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractNestedType,
    Array,
    BasicType,
    BoundedSequence,
    NamespacedType,
)

from labkit.errors import did_you_mean, quoted
from labkit.rosgraph.interfaces import slot_class, slots, type_name
from labkit.rosgraph.refusals import Refusal, Refused
from labkit.rosgraph.yaml_loading import load_yaml

__all__ = ['field_paths', 'fill', 'no_dictionary', 'prototype', 'read_yaml', 'to_csv', 'to_yaml']

Setter = Callable[[Any], None]


def to_yaml(
    message: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML.

    Args:
        message: The message.
        truncate_length: Length limit of arrays and strings; None for no limit.
        no_arr: Whether to show only type and length of arrays.
        no_str: Whether to show only the length of strings.
        flow_style: Whether to show each list on one line.
    """
    plain = _plain(message, None, truncate_length, no_arr, no_str)
    return _dump(plain, _InLines, flow_style)


def _dump(plain: Any, dumper: type[yaml.SafeDumper], flow_style: bool) -> str:
    text: str = yaml.dump(
        plain,
        Dumper=dumper,
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=flow_style,
        sort_keys=False,
    )
    return text


class _InLines(yaml.SafeDumper):
    """Writes each field on its own line, even in flow style."""

    def represent_mapping(self, *args: Any, **options: Any) -> yaml.MappingNode:
        node: yaml.MappingNode = super().represent_mapping(*args, **options)
        node.flow_style = False
        return node


def to_csv(
    message: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
) -> str:
    """Return the values of a message separated by commas. Arguments as for `to_yaml`."""
    return _cells(_plain(message, None, truncate_length, no_arr, no_str, octets=str))


def read_yaml(text: str) -> Any:
    """Parse YAML: for a message, a dictionary of fields and values.

    Raises:
        Refused: It is not YAML.
    """
    try:
        return load_yaml(text)
    except ValueError as error:
        raise Refused(
            f'The values can not be read as YAML: {error}: {quoted(text)}',
            todo='Write the name of the field, a colon, a space and the value: "{data: 1}"',
            reason=Refusal.NOT_YAML,
        ) from error


def no_dictionary(values: Any, complaint: str) -> Refused:
    """Return the error for values that are not a dictionary of fields.

    Args:
        values: The values, as `read_yaml` returned them.
        complaint: The first sentence.
    """
    spaceless = isinstance(values, str) and ':' in values
    return Refused(
        f'{complaint} A space is missing after the colon.' if spaceless else complaint,
        todo='Write the name of the field, a colon, a space and the value: "{data: 1}"',
        reason=Refusal.SPACE_AFTER_COLON if spaceless else Refusal.NO_FIELDS,
    )


def fill(message: Any, values: Any) -> list[Setter]:
    """Set fields of a message.

    Args:
        message: The message.
        values: Field -> value, from `read_yaml`; anything else is refused in the words of the real
            command. A header may be `auto`, a time `now`.

    Returns:
        Functions that set the time fields to a given present time.

    Raises:
        Refused: A field does not exist, or can't hold its value.
    """
    setters: list[Setter] = []
    try:
        if not isinstance(values, dict):
            kind = type(values).__name__
            raise no_dictionary(
                values,
                f'Value {quoted(str(values))} is expected to be a dictionary but is a {kind}',
            )
        _fill(message, values, setters, '')
    except Refused as error:
        raise Refused(
            f'Failed to populate field: {error.message}', todo=error.todo, reason=error.reason
        ) from None
    return setters


def prototype(msg_type: Any) -> str:
    """Return the default values of a message as editable YAML on one line."""
    plain = _plain(msg_type(), None, None, False, False)
    return _dump(plain, yaml.SafeDumper, flow_style=True).strip()


def field_paths(msg_type: Any, start: str = '') -> Iterator[str]:
    """Yield the paths of a message class's fields, such as `pose.pose.position.x`."""
    for name, slot in slots(msg_type).items():
        yield f'{start}{name}'
        if isinstance(slot, NamespacedType):
            yield from field_paths(slot_class(slot), f'{start}{name}.')


# -- showing ------------------------------------------------------------------------------------


def _plain(
    value: Any,
    slot: Any,
    limit: int | None,
    no_arr: bool,
    no_str: bool,
    octets: Callable[[bytes], str] = lambda value: ''.join(map(chr, value)),
) -> Any:
    """Return a message, or a field value, as plain data for YAML."""
    if isinstance(value, bytes):
        text = octets(value)
        return text if limit is None or len(text) <= limit else text[:limit] + '...'
    if isinstance(value, str):
        if no_str:
            return f'<string length: <{len(value)}>>'
        return value if limit is None or len(value) <= limit else value[:limit] + '...'
    if isinstance(value, (list, tuple, array.array, numpy.ndarray)):
        if no_arr and slot is not None:
            return _array_in_words(value, slot)
        shown = value if limit is None or len(value) <= limit else value[:limit]
        items = [_plain(item, None, limit, no_arr, no_str, octets) for item in shown]
        return items if len(shown) == len(value) else [*items, '...']
    if isinstance(value, (numpy.number, numpy.bool_)):
        return value.item()
    if isinstance(value, (bool, int, float)):
        return value
    return {
        name: _plain(getattr(value, name), slot, limit, no_arr, no_str, octets)
        for name, slot in slots(type(value)).items()
    }


def _array_in_words(value: Any, slot: AbstractNestedType) -> str:
    name = _type_in_words(slot.value_type)
    if isinstance(slot, Array):
        return f'<array type: {name}[{slot.size}]>'
    if isinstance(slot, BoundedSequence):
        return f'<sequence type: {name}[{slot.maximum_size}], length: {len(value)}>'
    return f'<sequence type: {name}, length: {len(value)}>'


def _type_in_words(slot: Any) -> str:
    if isinstance(slot, BasicType):
        return str(slot.typename)
    if isinstance(slot, NamespacedType):
        return '/'.join(slot.namespaced_name())
    return 'wstring' if 'WString' in type(slot).__name__ else 'string'


def _cells(plain: Any) -> str:
    if isinstance(plain, dict):
        return ','.join(_cells(value) for value in plain.values())
    if isinstance(plain, list):
        return ','.join(_cells(value) for value in plain)
    return str(plain)


# -- filling ------------------------------------------------------------------------------------


def _fill(message: Any, values: Any, setters: list[Setter], start: str) -> None:
    fields, msg_type = slots(type(message)), type_name(type(message))
    if not isinstance(values, dict):
        raise Refused(
            f'{_field(start)}a {msg_type} needs a value for each field, but got {quoted(values)}.',
            todo=f'Its fields: {", ".join(fields)}. Write {{{next(iter(fields), "data")}: ...}}',
            reason=Refusal.FIELDS_WANTED,
        )
    for name, value in values.items():
        if name not in fields:
            raise _no_field(f'{_field(start)}{msg_type}', str(name), fields)
        path = f'{start}{name}'
        if not _fill_time(message, name, value, setters):
            setattr(message, name, _value(fields[name], value, setters, path))


def _no_field(owner: str, name: str, fields: Collection[str]) -> Refused:
    message, reason = f'{owner} has no field {quoted(name)}.', Refusal.NO_SUCH_FIELD
    if name.partition(':')[0] in fields:
        spaced = name.replace(':', ': ')
        hint = f'A space is missing after the colon. Write {quoted(spaced)}.'
        reason = Refusal.SPACE_AFTER_COLON
    else:
        hint = did_you_mean(name, fields, f'Its fields: {", ".join(fields)}.')
    return Refused(message, todo=hint, reason=reason)


def _fill_time(message: Any, name: str, value: Any, setters: list[Setter]) -> bool:
    """Arrange for the present time if the value is `auto` or `now`."""
    field = getattr(message, name)
    kind = f'{type(field).__module__}.{type(field).__name__}'
    if kind == 'std_msgs.msg._header.Header' and value == 'auto':
        setters.append(lambda now: setattr(field, 'stamp', now))
    elif kind == 'builtin_interfaces.msg._time.Time' and value == 'now':
        setters.append(lambda now: setattr(message, name, now))
    else:
        return False
    return True


def _value(slot: Any, value: Any, setters: list[Setter], path: str) -> Any:
    """Return a value converted for a field of a type."""
    if isinstance(slot, AbstractNestedType):
        return _sequence(slot, value, setters, path)
    if isinstance(slot, NamespacedType):
        message = slot_class(slot)()
        _fill(message, value, setters, f'{path}.')
        return message
    if isinstance(slot, AbstractGenericString):
        return _string(slot, value, path)
    return _basic(slot.typename, value, path)


def _sequence(slot: AbstractNestedType, value: Any, setters: list[Setter], path: str) -> Any:
    if not isinstance(value, list):
        raise _refused(path, 'a list in square brackets', value, Refusal.LIST_WANTED)
    size = getattr(slot, 'size', None)
    if size is not None and len(value) != size:
        raise _refused(path, f'a list of {size} values', value, Refusal.LIST_WANTED)
    most = getattr(slot, 'maximum_size', None)
    if most is not None and len(value) > most:
        raise _refused(path, f'a list of at most {most} values', value, Refusal.LIST_WANTED)
    return [
        _value(slot.value_type, item, setters, f'{path}[{index}]')
        for index, item in enumerate(value)
    ]


def _string(slot: AbstractGenericString, value: Any, path: str) -> str:
    if isinstance(value, (dict, list)) or value is None:
        raise _refused(path, 'a text', value, Refusal.NOT_A_TEXT)
    # YAML reads 5 as a number and yes as a boolean; a text field gets what was typed.
    text = str(value)
    most = getattr(slot, 'maximum_size', None)
    if most is not None and len(text) > most:
        raise _refused(path, f'a text of at most {most} characters', value, Refusal.NOT_A_TEXT)
    return text


def _basic(typename: str, value: Any, path: str) -> Any:
    if typename == 'boolean':
        if not isinstance(value, bool):
            raise _refused(path, 'true or false', value, Refusal.NOT_TRUE_OR_FALSE)
        return value
    if typename in ('float', 'double'):
        return _real(typename, value, path)
    if typename == 'octet' and isinstance(value, str) and len(value) == 1:
        value = ord(value)  # as `to_yaml` shows it
    least, most = _range(typename)
    number = _number(value, int)
    if number is None or not least <= number <= most:
        reason = Refusal.NOT_A_WHOLE_NUMBER if number is None else Refusal.OUT_OF_RANGE
        raise _refused(path, f'a whole number from {least} to {most}', value, reason)
    return bytes([number]) if typename == 'octet' else number


def _real(typename: str, value: Any, path: str) -> float:
    number = _number(value, float)
    if number is None:
        raise _refused(path, 'a number', value, Refusal.NOT_A_NUMBER)
    if typename == 'float' and math.isfinite(number) and abs(number) > _MAX_FLOAT:
        wanted = f'a number of at most {_MAX_FLOAT:.3g} in size'
        raise _refused(path, wanted, value, Refusal.OUT_OF_RANGE)
    return float(number)


_MAX_FLOAT = float(numpy.finfo(numpy.float32).max)


def _number(value: Any, kind: type) -> Any:
    """Return a value as a number, None if it is not one. Quotes around it are allowed."""
    if isinstance(value, bool):
        return None
    if isinstance(value, str):
        # YAML reads 1e3 as text: it wants 1.0e+3.
        try:
            return kind(value)
        except ValueError:
            return None
    if isinstance(value, int) or (isinstance(value, float) and kind is float):
        try:
            return kind(value)
        except OverflowError:
            return None
    return None


def _range(typename: str) -> tuple[int, int]:
    if typename in ('octet', 'char', 'uint8'):
        return 0, 255
    bits = int(typename.removeprefix('u').removeprefix('int'))
    if typename.startswith('u'):
        return 0, 2**bits - 1
    return -(2 ** (bits - 1)), 2 ** (bits - 1) - 1


def _refused(path: str, wanted: str, value: Any, reason: Refusal) -> Refused:
    if isinstance(value, list) and reason in (Refusal.NOT_A_NUMBER, Refusal.NOT_A_WHOLE_NUMBER):
        reason = Refusal.LIST_FOR_NUMBER
    return Refused(f'The {path!r} field must be {wanted}, but got {quoted(value)}.', reason=reason)


def _field(start: str) -> str:
    return f'{start.rstrip(".")}: ' if start else ''
