"""Read an MCAP file by its index; where it has none, one is made by looking through the file."""

from __future__ import annotations

import heapq
import os
import struct
import zlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from labkit.bags.mcap_records import MAGIC, RECORD, Channel, Fields, Op, Schema, records_in
from labkit.bags.stored import Damaged, StoredTopic

__all__ = ['McapFile']

# Footer and magic at the end of a finished file.
_FOOTER_SIZE = RECORD.size + 20 + len(MAGIC)
# Channel, sequence, time of receipt, time of publishing.
_MESSAGE = struct.Struct('<HIQQ')
_CHUNK = struct.Struct('<QQQI')
_CRC_AT = 24

_Entries = Any
"""A row each message: its time, ns, and where its record begins; of numpy."""


@dataclass
class _Chunk:
    """Messages that were written, and perhaps compressed, together.

    Attributes:
        start_ns: Time of its first message.
        end_ns: Time of its last message.
        position: Where its records begin in the file.
        stored_size: Bytes in the file.
        size: Bytes without compression.
        compression: `'zstd'`, `'lz4'` or ''.
        crc_at: Where the checksum of its records is, which is 0 if there is none.
        indexes: Channel -> where the list of its messages is in the file, or the list itself.
        count: How many messages it has, as far as the index knows.
        loose: Whether these are messages outside of any chunk, each read for itself.
    """

    start_ns: int
    end_ns: int
    position: int
    stored_size: int
    size: int
    compression: str
    crc_at: int
    indexes: dict[int, int | _Entries] = field(default_factory=dict)
    count: int = 0
    loose: bool = False


class McapFile:
    """An MCAP file, open for reading. See `StoredFile`.

    Args:
        path: The file.

    Raises:
        Damaged: It is no MCAP file.
        OSError: It can't be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.note = ''
        self._file: BinaryIO = path.open('rb')
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._chunks: list[_Chunk] = []
        self._counts: dict[int, int] = {}
        self._places: dict[int, tuple[Any, Any, Any]] = {}
        self._last_read: tuple[int, bytes] = (-1, b'')
        try:
            self._size = path.stat().st_size
            if self._at(0, len(MAGIC)) != MAGIC:
                raise Damaged('is empty' if not self._size else 'is no MCAP file')
            if not self._read_summary():
                self._look_through()
        except BaseException:
            self._file.close()
            raise
        self._chunks.sort(key=lambda chunk: chunk.start_ns)
        self.topics = {number: self._topic(channel) for number, channel in self._channels.items()}

    # -- what StoredFile asks for ---------------------------------------------------------------

    def counts(self) -> dict[int, int]:
        """Return how many messages each topic has."""
        return {number: self._counts.get(number, 0) for number in self.topics}

    def span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last message, ns; None if there is none."""
        if not self._chunks:
            return None
        return self._chunks[0].start_ns, max(chunk.end_ns for chunk in self._chunks)

    def stamps(self, topic: int) -> Any:
        """Return the times of a topic's messages, ns, in order."""
        return self._places_of(topic)[0]

    def read(
        self, topics: Collection[int], start_ns: int, end_ns: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield time, topic and bytes of the messages from a time to a time, in order of time."""
        wanted = [
            self._messages(number, set(topics), start_ns, end_ns)
            for number, chunk in enumerate(self._chunks)
            if chunk.start_ns <= end_ns and chunk.end_ns >= start_ns
        ]
        # Each begins with a mark of when its first message may come, so that no chunk is read
        # before its time.
        for stamp, place, _, topic, data in heapq.merge(*wanted):
            if place >= 0:
                yield stamp, topic, data

    def last(self, topic: int, t_ns: int) -> tuple[int, bytes] | None:
        """Return time and bytes of the last message of a topic at a time or before, or None."""
        stamps, chunks, offsets = self._places_of(topic)
        index = int(np.searchsorted(stamps, t_ns, side='right')) - 1
        if index < 0:
            return None
        number = int(chunks[index])
        return int(stamps[index]), self._message(number, int(offsets[index]))

    def close(self) -> None:
        """Close it."""
        self._file.close()

    # -- the index ------------------------------------------------------------------------------

    def _read_summary(self) -> bool:
        """Read the index at the end; return False if there is none."""
        end = self._size - _FOOTER_SIZE
        footer = self._at(end, _FOOTER_SIZE) if end > 0 else b''
        if footer[-len(MAGIC) :] != MAGIC or footer[0] != Op.FOOTER:
            return False
        begin = Fields(footer, RECORD.size).number('Q')
        if not 0 < begin <= end:
            return False
        counted = False
        try:
            for op, content in self._records_of_summary(begin, end):
                counted = op == Op.STATISTICS or counted
                self._take(op, content)
        except (ValueError, struct.error):
            counted = False
        indexed = sum(chunk.count for chunk in self._chunks)
        complete = counted and indexed == sum(self._counts.values())
        if not complete or not set(self._counts) <= set(self._channels):
            complete = False
            self._channels, self._schemas, self._chunks, self._counts = {}, {}, [], {}
        return complete

    def _records_of_summary(self, begin: int, end: int) -> Iterator[tuple[int, bytes]]:
        data = self._at(begin, end - begin)
        for op, first, last in records_in(data):
            yield op, data[first:last]

    def _take(self, op: int, content: bytes) -> None:
        """Take note of what a record of the summary, or of a chunk, says."""
        if op == Op.SCHEMA:
            schema = Schema.read(content)
            self._schemas[schema.id] = schema
        elif op == Op.CHANNEL:
            channel = Channel.read(content)
            self._channels[channel.id] = channel
        elif op == Op.STATISTICS:
            fields = Fields(content, 42)
            self._counts = dict(struct.iter_unpack('<HQ', fields.block()))
        elif op == Op.CHUNK_INDEX:
            self._chunks.append(_indexed(content))

    def _look_through(self) -> None:
        """Make the index: look at all records from the beginning on, as far as they are whole."""
        loose: dict[int, list[tuple[int, int]]] = {}
        position = len(MAGIC)
        finished = False
        try:
            while position < self._size:
                op, size = RECORD.unpack(self._exactly(position, RECORD.size))
                begin, position = position + RECORD.size, position + RECORD.size + size
                if position > self._size:
                    raise ValueError('a record is cut off')
                if op == Op.CHUNK:
                    self._add_chunk(begin)
                elif op == Op.MESSAGE:
                    channel, _, stamp, _ = _MESSAGE.unpack(self._exactly(begin, _MESSAGE.size))
                    loose.setdefault(channel, []).append((stamp, begin - RECORD.size))
                elif op in (Op.SCHEMA, Op.CHANNEL):
                    self._take(op, self._exactly(begin, size))
                elif op in (Op.DATA_END, Op.FOOTER):
                    finished = True
                    break
                elif not op:
                    raise ValueError('there is no record')
        except (ValueError, struct.error):
            pass
        if loose:
            self._chunks.append(_loose_chunk(loose))
        for chunk in self._chunks:
            for channel in chunk.indexes:
                more = len(self._entries(chunk, channel))
                self._counts[channel] = self._counts.get(channel, 0) + more
        if not finished:
            self.note = 'was not finished; it is read as far as it goes'

    def _add_chunk(self, begin: int) -> None:
        """Make the index of a chunk by looking through it.

        Raises:
            ValueError: It is damaged.
        """
        chunk = _chunk_at(begin, self._exactly(begin, _CHUNK.size + 40))
        data = self._content(chunk)
        found: dict[int, list[tuple[int, int]]] = {}
        for op, first, last in records_in(data):
            if op == Op.MESSAGE:
                channel, _, stamp, _ = _MESSAGE.unpack_from(data, first)
                found.setdefault(channel, []).append((stamp, first - RECORD.size))
            else:
                self._take(op, data[first:last])
        if found:
            chunk.indexes = {channel: _entries(rows) for channel, rows in found.items()}
            chunk.start_ns = min(min(rows)[0] for rows in found.values())
            chunk.end_ns = max(max(rows)[0] for rows in found.values())
            self._chunks.append(chunk)

    def _entries(self, chunk: _Chunk, channel: int) -> _Entries:
        """Return the times and places of a channel's messages in a chunk, in order of time."""
        index = chunk.indexes.get(channel)
        if index is None:
            return _entries([])
        if not isinstance(index, int):
            return index
        op, size = RECORD.unpack(self._exactly(index, RECORD.size))
        if op != Op.MESSAGE_INDEX or size < 6:
            return _entries([])
        content = self._exactly(index + RECORD.size + 6, size - 6)
        return _entries(np.frombuffer(content[: len(content) // 16 * 16], '<u8').reshape(-1, 2))

    def _places_of(self, channel: int) -> tuple[Any, Any, Any]:
        """Return time, number of the chunk and place of a channel's messages, in order of time."""
        if channel not in self._places:
            found = [self._entries(chunk, channel) for chunk in self._chunks]
            numbers = np.repeat(np.arange(len(found), dtype=np.int32), [len(e) for e in found])
            rows = np.concatenate([_entries([]), *found])
            order = np.argsort(rows[:, 0], kind='stable')
            self._places[channel] = (rows[order, 0], numbers[order], rows[order, 1])
        return self._places[channel]

    def _topic(self, channel: Channel) -> StoredTopic:
        schema = self._schemas.get(channel.schema_id, Schema(0, '', '', ''))
        return StoredTopic(
            channel.id,
            channel.topic,
            schema.name,
            channel.encoding,
            channel.metadata.get('offered_qos_profiles', ''),
            schema.data,
            schema.encoding,
            channel.metadata.get('topic_type_hash', ''),
        )

    # -- messages -------------------------------------------------------------------------------

    def _messages(
        self, number: int, topics: set[int], start_ns: int, end_ns: int
    ) -> Iterator[tuple[int, int, int, int, bytes]]:
        """Yield time, number of the chunk, place, channel and bytes, after a mark of the first."""
        chunk = self._chunks[number]
        yield chunk.start_ns, -1, number, 0, b''
        places: list[tuple[int, int, int]] = []
        for topic in topics & {*chunk.indexes}:
            rows = self._entries(chunk, topic)
            first = np.searchsorted(rows[:, 0], start_ns, side='left')
            last = np.searchsorted(rows[:, 0], end_ns, side='right')
            places += [(stamp, place, topic) for stamp, place in rows[first:last].tolist()]
        data = self._content(chunk) if places and not chunk.loose else b''
        for stamp, place, topic in sorted(places):
            found = self._message(number, place) if chunk.loose else _message_in(data, place)
            yield stamp, number, place, topic, found

    def _message(self, number: int, place: int) -> bytes:
        """Return the bytes of one message."""
        chunk = self._chunks[number]
        if chunk.compression:
            if self._last_read[0] != number:
                self._last_read = (number, self._content(chunk))
            return _message_in(self._last_read[1], place)
        begin = chunk.position + place
        _, size = RECORD.unpack(self._exactly(begin, RECORD.size))
        return self._exactly(begin + RECORD.size + _MESSAGE.size, size - _MESSAGE.size)

    def _content(self, chunk: _Chunk) -> bytes:
        """Return the records of a chunk.

        Raises:
            ValueError: They are damaged.
        """
        data = self._exactly(chunk.position, chunk.stored_size)
        (crc,) = struct.unpack('<I', self._exactly(chunk.crc_at, 4))
        if not chunk.compression:
            if crc and zlib.crc32(data) != crc:
                raise ValueError('a checksum does not fit')
            return data
        from rosbags.rosbag2.storage_mcap import decompress

        try:
            return decompress(data, chunk.compression, chunk.size, crc)
        except Exception as error:  # of three libraries, about bytes that may be anything
            raise ValueError(str(error)) from error

    def _exactly(self, position: int, size: int) -> bytes:
        data = self._at(position, size)
        if len(data) < size:
            raise ValueError('the file is cut off')
        return data

    def _at(self, position: int, size: int) -> bytes:
        return os.pread(self._file.fileno(), size, position)


def _entries(rows: Any) -> _Entries:
    """Return the times and places of messages as an array, in order of time."""
    table = np.asarray(rows, dtype=np.int64).reshape(-1, 2)
    if np.all(table[:-1, 0] <= table[1:, 0]):
        return table
    return table[np.lexsort((table[:, 1], table[:, 0]))]


def _indexed(content: bytes) -> _Chunk:
    """Return a chunk as the index at the end of the file describes it."""
    fields = Fields(content)
    start, end, begin, _ = fields.numbers('QQQQ')
    indexes: dict[int, int | _Entries] = dict(struct.iter_unpack('<HQ', fields.block()))
    in_indexes = fields.number('Q')
    compression = fields.text()
    stored, size = fields.numbers('QQ')
    begin += RECORD.size
    header = _CHUNK.size + 4 + len(compression) + 8
    # Each index says, besides sixteen bytes a message, what it is, and of which channel.
    messages = (in_indexes - len(indexes) * (RECORD.size + 6)) // 16
    crc_at = begin + _CRC_AT
    return _Chunk(start, end, begin + header, stored, size, compression, crc_at, indexes, messages)


def _chunk_at(begin: int, header: bytes) -> _Chunk:
    """Return a chunk as the record itself describes it, without the index of its messages."""
    start, end, size, _ = _CHUNK.unpack_from(header)
    fields = Fields(header, _CHUNK.size)
    compression = fields.text()
    stored = fields.number('Q')
    return _Chunk(start, end, begin + fields.position, stored, size, compression, begin + _CRC_AT)


def _loose_chunk(found: dict[int, list[tuple[int, int]]]) -> _Chunk:
    """Return messages that are in no chunk as one."""
    indexes: dict[int, int | _Entries] = {key: _entries(rows) for key, rows in found.items()}
    stamps = [stamp for rows in found.values() for stamp, _ in rows]
    return _Chunk(min(stamps), max(stamps), 0, 0, 0, '', 0, indexes, len(stamps), loose=True)


def _message_in(data: bytes, place: int) -> bytes:
    """Return the bytes of the message whose record begins at a place."""
    _, size = RECORD.unpack_from(data, place)
    begin = place + RECORD.size
    return data[begin + _MESSAGE.size : begin + size]
