"""The records of an MCAP file, as bytes. See https://mcap.dev/spec."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

__all__ = [
    'MAGIC',
    'RECORD',
    'Channel',
    'Fields',
    'Op',
    'Schema',
    'pack',
    'packed_map',
    'packed_text',
    'records_in',
]

MAGIC = b'\x89MCAP0\r\n'
RECORD = struct.Struct('<BQ')
"""What a record begins with: what it is, and how many bytes follow."""


class Op:
    """What a record is: its first byte."""

    HEADER = 0x01
    FOOTER = 0x02
    SCHEMA = 0x03
    CHANNEL = 0x04
    MESSAGE = 0x05
    CHUNK = 0x06
    MESSAGE_INDEX = 0x07
    CHUNK_INDEX = 0x08
    STATISTICS = 0x0B
    METADATA = 0x0C
    METADATA_INDEX = 0x0D
    SUMMARY_OFFSET = 0x0E
    DATA_END = 0x0F


def pack(op: int, *parts: bytes) -> bytes:
    """Return a record."""
    content = b''.join(parts)
    return RECORD.pack(op, len(content)) + content


def packed_text(text: str) -> bytes:
    """Return a string as it stands in a record."""
    data = text.encode()
    return struct.pack('<I', len(data)) + data


def packed_map(values: Mapping[str, str]) -> bytes:
    """Return names with their values as they stand in a record."""
    content = b''.join(packed_text(key) + packed_text(value) for key, value in values.items())
    return struct.pack('<I', len(content)) + content


class Fields:
    """Takes the content of a record apart, from its beginning on.

    Args:
        data: The content.
        position: Where to begin.

    Raises:
        ValueError: In each method: it is shorter than it says it is.
    """

    def __init__(self, data: bytes | memoryview, position: int = 0) -> None:
        self._data = data
        self.position = position

    @property
    def left(self) -> int:
        """Return how many bytes are left."""
        return len(self._data) - self.position

    def numbers(self, form: str) -> tuple[int, ...]:
        """Take numbers, in the letters of `struct`."""
        layout = struct.Struct(f'<{form}')
        return tuple(layout.unpack(self.take(layout.size)))

    def number(self, form: str) -> int:
        """Take one number."""
        return self.numbers(form)[0]

    def take(self, size: int) -> bytes:
        """Take so many bytes."""
        found = bytes(self._data[self.position : self.position + size])
        if len(found) < size:
            raise ValueError('a record is shorter than it says')
        self.position += size
        return found

    def block(self) -> bytes:
        """Take bytes that say themselves how many they are."""
        return self.take(self.number('I'))

    def text(self) -> str:
        """Take a string."""
        return self.block().decode(errors='replace')

    def map(self) -> dict[str, str]:
        """Take names with their values."""
        inner = Fields(self.block())
        found = {}
        while inner.left:
            key = inner.text()
            found[key] = inner.text()
        return found


@dataclass(frozen=True)
class Schema:
    """A type of messages: its name, in which language it is defined, and how."""

    id: int
    name: str
    encoding: str
    data: str

    @classmethod
    def read(cls, content: bytes) -> Schema:
        """Return what a record says."""
        fields = Fields(content)
        return cls(fields.number('H'), fields.text(), fields.text(), fields.text())

    def packed(self) -> bytes:
        """Return the record."""
        texts = [packed_text(text) for text in (self.name, self.encoding, self.data)]
        return pack(Op.SCHEMA, struct.pack('<H', self.id), *texts)


@dataclass(frozen=True)
class Channel:
    """A topic, with one type."""

    id: int
    schema_id: int
    topic: str
    encoding: str
    metadata: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, content: bytes) -> Channel:
        """Return what a record says."""
        fields = Fields(content)
        number, schema_id = fields.numbers('HH')
        return cls(number, schema_id, fields.text(), fields.text(), fields.map())

    def packed(self) -> bytes:
        """Return the record."""
        return pack(
            Op.CHANNEL,
            struct.pack('<HH', self.id, self.schema_id),
            packed_text(self.topic),
            packed_text(self.encoding),
            packed_map(self.metadata),
        )


def records_in(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield what each record in a chunk is, where its content begins, and where it ends.

    Raises:
        ValueError: The last one is cut off.
    """
    position = 0
    while position < len(data):
        if position + RECORD.size > len(data):
            raise ValueError('a record is cut off')
        op, size = RECORD.unpack_from(data, position)
        begin = position + RECORD.size
        position = begin + size
        if position > len(data):
            raise ValueError('a record is cut off')
        yield op, begin, position
