"""A message as rows of a tree, one per field; long arrays and texts are shortened."""

from __future__ import annotations

import array
import dataclasses
from typing import Any, NamedTuple

import numpy as np

__all__ = ['Row', 'as_text', 'fields_of', 'is_message', 'rows', 'value_text']

# Elements shown of arrays of numbers, and of arrays of messages.
NUMBERS = 5
MESSAGES = 3
TEXT = 120
MOST_ROWS = 200
TIME = 'builtin_interfaces/Time'


class Row(NamedTuple):
    """One field.

    Attributes:
        depth: Nesting depth, from 0.
        name: Its name, or its index in an array.
        field_type: Its type as interface files write it.
        has_parts: Whether rows of nested fields follow.
        value: Its value as text; the number of elements for an array of messages.
    """

    depth: int
    name: str
    field_type: str
    has_parts: bool
    value: str


def rows(message: Any, *, no_time: bool = False) -> list[Row]:
    """Return a message as rows; with `no_time`, without time stamps, which differ each time."""
    found: list[Row] = []
    _add_fields(found, message, 0, no_time)
    if len(found) > MOST_ROWS:
        found[MOST_ROWS:] = [Row(0, '...', '', False, f'{len(found) - MOST_ROWS} more rows')]
    return found


def as_text(found: list[Row]) -> str:
    """Return rows as indented lines."""
    return '\n'.join(
        f'{"  " * row.depth}{row.name}:{" " * bool(row.value)}{row.value}' for row in found
    )


def is_message(value: Any) -> bool:
    """Return whether a value is a message: of rclpy, or of `rosbags` for types not installed."""
    return hasattr(value, 'get_fields_and_field_types') or hasattr(value, '__msgtype__')


def fields_of(message: Any) -> dict[str, str]:
    """Return names and types of a message's fields; types are unknown if not installed."""
    if hasattr(message, 'get_fields_and_field_types'):
        found: dict[str, str] = message.get_fields_and_field_types()
        return found
    return {field.name: '' for field in dataclasses.fields(message)}


def value_text(value: Any) -> str:
    """Return a field value as text."""
    if isinstance(value, (bool, np.bool_)):
        return 'true' if value else 'false'
    if isinstance(value, (float, np.floating)):
        text = f'{value:.6g}'
        return text if set(text) & set('.en') else f'{text}.0'
    if isinstance(value, (int, np.integer)):
        return str(value)
    if isinstance(value, bytes):
        return value.hex()
    text = str(value)
    return repr(text if len(text) <= TEXT else f'{text[:TEXT]}...')


def _add_fields(found: list[Row], message: Any, depth: int, no_time: bool) -> None:
    for name, field_type in fields_of(message).items():
        if len(found) > 2 * MOST_ROWS:
            return
        value = getattr(message, name)
        if no_time and field_type == TIME:
            found.append(Row(depth, name, field_type, False, f'<{TIME}>'))
        else:
            _add(found, value, Row(depth, name, field_type, False, ''), no_time)


def _add(found: list[Row], value: Any, row: Row, no_time: bool) -> None:
    if is_message(value):
        found.append(row._replace(has_parts=True))
        _add_fields(found, value, row.depth + 1, no_time)
    elif not isinstance(value, (list, tuple, array.array, np.ndarray)):
        found.append(row._replace(value=value_text(value)))
    elif len(value) and is_message(value[0]):
        found.append(row._replace(has_parts=True, value=_counted(value, MESSAGES)))
        for number, part in enumerate(value[:MESSAGES]):
            _add(found, part, Row(row.depth + 1, f'[{number}]', '', True, ''), no_time)
    else:
        shown = ', '.join(map(value_text, value[:NUMBERS]))
        if len(value) > NUMBERS:
            shown = f'{shown}, ...] {len(value)} values'
        else:
            shown += ']'
        found.append(row._replace(value=f'[{shown}'))


def _counted(value: Any, shown: int) -> str:
    first = f', the first {shown}' if len(value) > shown else ''
    return f'{len(value)} elements{first}'
