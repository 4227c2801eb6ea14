"""Messages as text and back: YAML, comma-separated values, and filling one from YAML.

The text is that of the real `ros2` (`rosidl_runtime_py`). Filling is stricter: what would be
bent silently there, such as 1.5 into an integer, is refused here.
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

from labkit.errors import nearest
from labkit.rosgraph.interfaces import message_class, type_name
from labkit.rosgraph.refusals import Refusal, Refused

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
        truncate_length: How much to show of arrays and strings; all of it if None.
        no_arr: Whether to show type and length of arrays only.
        no_str: Whether to show the length of strings only.
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
    """Writes each field on a line of its own, also in flow style."""

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
    """Return the values of a message, separated by commas. Arguments as for `to_yaml`."""
    return _cells(_plain(message, None, truncate_length, no_arr, no_str))


def read_yaml(text: str) -> Any:
    """Return what a text in YAML says: for a message, a dictionary of fields and their values.

    Raises:
        Refused: It is not YAML.
    """
    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        problem = getattr(error, 'problem', None) or str(error).splitlines()[0]
        raise Refused(
            f'The values can not be read as YAML: {problem}: {text!r}',
            todo='Write the name of the field, a colon, a space and the value: "{data: 1}"',
            reason=Refusal.NOT_YAML,
        ) from error


def no_dictionary(values: Any, complaint: str) -> Refused:
    """Return what to raise when values are not fields and what they hold.

    Args:
        values: What was given, as `read_yaml` has read it.
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
        values: Field -> value, as `read_yaml` gives it; anything else is refused in the words of
            the real one. A header may be `auto`, a time `now`.

    Returns:
        Functions that set the time fields that are to hold the present time, given that time.

    Raises:
        Refused: A field does not exist, or can't hold its value.
    """
    setters: list[Setter] = []
    try:
        if not isinstance(values, dict):
            kind = type(values).__name__
            raise no_dictionary(
                values, f"Value '{values}' is expected to be a dictionary but is a {kind}"
            )
        _fill(message, values, setters, '')
    except Refused as error:
        raise Refused(
            f'Failed to populate field: {error.message}', todo=error.todo, reason=error.reason
        ) from None
    return setters


def prototype(msg_type: Any) -> str:
    """Return the values of a new message as YAML on one line, to be edited."""
    plain = _plain(msg_type(), None, None, False, False)
    return _dump(plain, yaml.SafeDumper, flow_style=True).strip()


def field_paths(msg_type: Any, start: str = '') -> Iterator[str]:
    """Yield the fields of a message class by their paths, such as `pose.pose.position.x`."""
    for (name, _), slot in zip(
        msg_type.get_fields_and_field_types().items(), msg_type.SLOT_TYPES, strict=True
    ):
        yield f'{start}{name}'
        if isinstance(slot, NamespacedType):
            yield from field_paths(_class_of(slot), f'{start}{name}.')


def _class_of(slot: NamespacedType) -> Any:
    return message_class('/'.join(slot.namespaced_name()))


# -- showing ------------------------------------------------------------------------------------


def _plain(value: Any, slot: Any, limit: int | None, no_arr: bool, no_str: bool) -> Any:
    """Return a message, or a value of a field, as what YAML can show."""
    if isinstance(value, bytes):
        text = ''.join(map(chr, value))
        return text if limit is None or len(text) <= limit else text[:limit] + '...'
    if isinstance(value, str):
        if no_str:
            return f'<string length: <{len(value)}>>'
        return value if limit is None or len(value) <= limit else value[:limit] + '...'
    if isinstance(value, (list, tuple, array.array, numpy.ndarray)):
        if no_arr and slot is not None:
            return _array_in_words(value, slot)
        shown = value if limit is None or len(value) <= limit else value[:limit]
        items = [_plain(item, None, limit, no_arr, no_str) for item in shown]
        return items if len(shown) == len(value) else [*items, '...']
    if isinstance(value, (numpy.number, numpy.bool_)):
        return value.item()
    if isinstance(value, (bool, int, float)):
        return value
    return {
        name: _plain(getattr(value, name), slot, limit, no_arr, no_str)
        for name, slot in zip(value.get_fields_and_field_types(), value.SLOT_TYPES, strict=True)
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
    fields = dict(zip(message.get_fields_and_field_types(), message.SLOT_TYPES, strict=True))
    msg_type = type_name(type(message))
    if not isinstance(values, dict):
        raise Refused(
            f'{_field(start)}a {msg_type} needs a value for each field, but got {values!r}.',
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
    message, reason = f'{owner} has no field {name!r}.', Refusal.NO_SUCH_FIELD
    if name.partition(':')[0] in fields:
        spaced = name.replace(':', ': ')
        hint = f'A space is missing after the colon. Write {spaced!r}.'
        reason = Refusal.SPACE_AFTER_COLON
    else:
        near = nearest(name, fields)
        hint = f'Did you mean {near!r}?' if near else f'Its fields: {", ".join(fields)}.'
    return Refused(message, todo=hint, reason=reason)


def _fill_time(message: Any, name: str, value: Any, setters: list[Setter]) -> bool:
    """Arrange for the present time, where `auto` or `now` asks for it."""
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
    """Return a value as a field of a type takes it."""
    if isinstance(slot, AbstractNestedType):
        return _sequence(slot, value, setters, path)
    if isinstance(slot, NamespacedType):
        message = _class_of(slot)()
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
    # YAML reads 5 as a number and yes as a truth value; in a text field they are what was typed.
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
    """Return a value as a number, None if it is none. Quotation marks around it are allowed."""
    if isinstance(value, bool):
        return None
    if isinstance(value, str):
        # 1e3 is a text for YAML, which wants 1.0e+3.
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
    return Refused(f'The {path!r} field must be {wanted}, but got {value!r}.', reason=reason)


def _field(start: str) -> str:
    return f'{start.rstrip(".")}: ' if start else ''
