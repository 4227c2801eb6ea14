"""One number out of a serialized message, without making the message.

A Python object of a large message takes tens of microseconds, a number of it two. Messages are
serialized as plain CDR: fields one after the other, each at a multiple of its own size, counted
behind a header of four bytes. Source: OMG, "DDS Interoperability Wire Protocol", 2.5, section 10,
with the encoding version 1 of "DDS-XTYPES", 1.3, section 7.4.3.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any

from labkit.rosgraph.interfaces import message_class

__all__ = ['number_reader']

_HEADER = 4
_LITTLE_ENDIAN = b'\x00\x01'
# Basic types as `struct` names them. The others (long double, wchar) have no equal there.
_FORMATS = {
    'boolean': '?',
    'octet': 'B',
    'uint8': 'B',
    'int8': 'b',
    'char': 'B',
    'uint16': 'H',
    'int16': 'h',
    'uint32': 'I',
    'int32': 'i',
    'uint64': 'Q',
    'int64': 'q',
    'float': 'f',
    'double': 'd',
}
_LENGTH = struct.Struct('<I')

# Goes past a field: from the message's bytes and where it begins to where the next one does.
_Skip = Callable[[memoryview, int], int]


class _Unknown(Exception):
    """A type whose size is not known here."""


def number_reader(
    msg_type: Any, path: Sequence[tuple[str, int | None]], otherwise: Callable[[bytes], Any]
) -> Callable[[bytes], Any]:
    """Return a function that reads one field out of serialized messages.

    Args:
        msg_type: Class of the messages.
        path: Names of the fields on the way to it, each with the index of the element if it is an
            array, else None.
        otherwise: Reads what can't be read here, by making the message: the way leads past a type
            whose size is not known, or the message has another order of bytes.

    Returns:
        The function. It raises an IndexError if an array is shorter than the index asks for.
    """
    skips: list[_Skip] = []
    try:
        slot = _lead_to(path, msg_type, skips)
        size, unpack = _basic(slot)
    except _Unknown:
        return otherwise
    mask = size - 1

    def read(data: bytes) -> Any:
        if data[:2] != _LITTLE_ENDIAN:
            return otherwise(data)
        body, at = memoryview(data)[_HEADER:], 0
        for skip in skips:
            at = skip(body, at)
        return unpack(body, at + (-at & mask))[0]

    return read


def _lead_to(path: Sequence[tuple[str, int | None]], msg_type: Any, skips: list[_Skip]) -> Any:
    """Collect what goes past all before a field; return the field's type."""
    (name, index), *rest = path
    for before, slot in _slots(msg_type):
        if before == name:
            break
        skips.append(_skip(slot))
    else:
        raise _Unknown(name)
    if index is not None:
        skips.append(_skip_to(slot, index))
        slot = slot.value_type
    return _lead_to(rest, _class_of(slot), skips) if rest else slot


def _skip(slot: Any) -> _Skip:
    """Return what goes past a field of a type."""
    if hasattr(slot, 'value_type'):
        past = _skip_elements(slot.value_type)
        size: int = getattr(slot, 'size', -1)
        if size >= 0:
            return lambda data, at: past(data, at, size)

        def skip_sequence(data: memoryview, at: int) -> int:
            at += -at & 3
            (count,) = _LENGTH.unpack_from(data, at)
            return past(data, at + 4, count)

        return skip_sequence
    if hasattr(slot, 'namespaced_name'):
        skips = [_skip(inner) for _, inner in _slots(_class_of(slot))]
        # A message without fields is a byte.
        if not skips:
            return lambda data, at: at + 1

        def skip_message(data: memoryview, at: int) -> int:
            for skip in skips:
                at = skip(data, at)
            return at

        return skip_message
    if type(slot).__name__ in ('UnboundedString', 'BoundedString'):
        return _skip_text
    size, _ = _basic(slot)
    mask = size - 1
    return lambda data, at: at + (-at & mask) + size


def _skip_to(slot: Any, index: int) -> _Skip:
    """Return what goes to the element of an array."""
    past = _skip_elements(slot.value_type)
    if hasattr(slot, 'size'):
        return lambda data, at: past(data, at, index)

    def skip(data: memoryview, at: int) -> int:
        at += -at & 3
        (count,) = _LENGTH.unpack_from(data, at)
        if index >= count:
            raise IndexError(index)
        return past(data, at + 4, index)

    return skip


def _skip_elements(slot: Any) -> Callable[[memoryview, int, int], int]:
    """Return what goes past so many elements of a type."""
    if hasattr(slot, 'typename'):
        size, _ = _basic(slot)
        mask = size - 1
        # Before no element at all, nothing is aligned.
        return lambda data, at, count: at + (-at & mask) + size * count if count else at
    skip = _skip(slot)

    def past(data: memoryview, at: int, count: int) -> int:
        for _ in range(count):
            at = skip(data, at)
        return at

    return past


def _skip_text(data: memoryview, at: int) -> int:
    at += -at & 3
    return at + 4 + int(_LENGTH.unpack_from(data, at)[0])


def _basic(slot: Any) -> tuple[int, Callable[[memoryview, int], tuple[Any, ...]]]:
    """Return size and reader of a basic type."""
    code = _FORMATS.get(getattr(slot, 'typename', ''))
    if code is None:
        raise _Unknown(slot)
    form = struct.Struct(f'<{code}')
    return form.size, form.unpack_from


def _slots(msg_type: Any) -> list[tuple[str, Any]]:
    return list(zip(msg_type.get_fields_and_field_types(), msg_type.SLOT_TYPES, strict=True))


def _class_of(slot: Any) -> Any:
    return message_class('/'.join(slot.namespaced_name()))
