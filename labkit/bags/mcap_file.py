"""Read an MCAP file by its index; if it has none, build it by scanning the file."""

from __future__ import annotations

import heapq
import os
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.reader import SeekingReader
from mcap.records import Channel, Chunk, DataEnd, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from labkit.bags.stored import Damaged, StoredTopic
from labkit.bags.unpacking import unpacked_chunk

__all__ = ['McapFile']

# Start of a record: its opcode, and the number of bytes that follow.
_RECORD_SIZE = 9
# Sizes of records without their variable parts: the data of a Message, the data and the
# compression of a Chunk, the entries of a MessageIndex.
_MESSAGE_SIZE, _CHUNK_SIZE = _RECORD_SIZE + 22, _RECORD_SIZE + 40
_INDEX_SIZE, _ENTRY_SIZE = _RECORD_SIZE + 6, 16
# Messages outside chunks are read in groups of about this many bytes.
_CHUNK_BYTES = 1 << 20


@dataclass
class _Chunk:
    """Messages that are read together: a chunk, or a group of consecutive ones outside chunks.

    Attributes:
        offset: Start of its record, or of the first message, in the file.
        length: Its length in the file, bytes.
        start_ns: Time of its first message.
        end_ns: Time of its last message.
        is_chunk: Whether it is a chunk of the file.
        times: Channel -> offset of its MessageIndex, or the times of its messages.
    """

    offset: int
    length: int
    start_ns: int = 2**64
    end_ns: int = 0
    is_chunk: bool = True
    times: dict[int, Any] = field(default_factory=dict)

    def add(self, message: Message) -> None:
        """Add a message to the index."""
        self.start_ns = min(self.start_ns, message.log_time)
        self.end_ns = max(self.end_ns, message.log_time)
        self.times.setdefault(message.channel_id, []).append(message.log_time)


class McapFile:
    """An MCAP file, open for reading. See `StoredFile`.

    Raises:
        Damaged: It is not an MCAP file.
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
        self._last_read: tuple[int, list[Message]] = (-1, [])
        try:
            self._size = path.stat().st_size
            try:
                reader = SeekingReader(self._file, record_size_limit=self._size)
            except Exception as error:  # a library, and data from anywhere
                raise Damaged('is no MCAP file' if self._size else 'is empty') from error
            if not self._read_summary(reader):
                self._scan()
        except BaseException:
            self._file.close()
            raise
        self._chunks.sort(key=lambda chunk: chunk.start_ns)
        self.topics = {number: self._topic(channel) for number, channel in self._channels.items()}

    def counts(self) -> dict[int, int]:
        """Return the number of messages of each topic."""
        return {number: self._counts.get(number, 0) for number in self.topics}

    def span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last message, ns; None without messages."""
        if not self._chunks:
            return None
        return self._chunks[0].start_ns, max(chunk.end_ns for chunk in self._chunks)

    def stamps(self, topic: int) -> Any:
        """Return the times of a topic's messages in order, ns."""
        found = [self._times(chunk.times[topic]) for chunk in self._chunks if topic in chunk.times]
        return np.sort(np.concatenate([np.empty(0, dtype=np.int64), *found]))

    def read(
        self, topics: Collection[int], start_ns: int, end_ns: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield time, topic and data of the messages between two times, in order of time."""
        # Chunks may overlap: hold a message back until no later chunk can begin before it.
        waiting: list[tuple[int, int, int, int, bytes]] = []
        ends = [*(chunk.start_ns for chunk in self._chunks[1:]), 2**64]
        for chunk, end in zip(self._chunks, ends, strict=False):
            overlaps = chunk.start_ns <= end_ns and chunk.end_ns >= start_ns
            if overlaps and not chunk.times.keys().isdisjoint(topics):
                for index, message in enumerate(self._messages(chunk)):
                    stamp, topic = message.log_time, message.channel_id
                    if topic in topics and start_ns <= stamp <= end_ns:
                        heapq.heappush(waiting, (stamp, chunk.offset, index, topic, message.data))
            while waiting and waiting[0][0] < end:
                stamp, _, _, topic, data = heapq.heappop(waiting)
                yield stamp, topic, data

    def last(self, topic: int, t_ns: int) -> tuple[int, bytes] | None:
        """Return time and data of a topic's last message at or before a time, or None."""
        best = (-(2**63), -1, -1, b'')
        for chunk in reversed(self._chunks):
            if topic in chunk.times and chunk.start_ns <= t_ns and chunk.end_ns >= best[0]:
                for index, message in enumerate(self._messages(chunk)):
                    if message.channel_id == topic and message.log_time <= t_ns:
                        best = max(best, (message.log_time, chunk.offset, index, message.data))
        return (best[0], best[3]) if best[2] >= 0 else None

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    # -- the index ------------------------------------------------------------------------------

    def _read_summary(self, reader: SeekingReader) -> bool:
        """Use the index at the end; return False if it is missing or incomplete."""
        try:
            summary = reader.get_summary()
        except Exception:  # as above: then it is built
            return False
        if summary is None or summary.statistics is None:
            return False
        counts = summary.statistics.channel_message_counts
        indexed = sum(
            each.message_index_length - len(each.message_index_offsets) * _INDEX_SIZE
            for each in summary.chunk_indexes
        )
        complete = indexed == sum(counts.values()) * _ENTRY_SIZE
        if not complete or not counts.keys() <= summary.channels.keys():
            return False
        self._schemas, self._channels, self._counts = summary.schemas, summary.channels, counts
        self._chunks = [
            _Chunk(
                each.chunk_start_offset,
                each.chunk_length,
                each.message_start_time,
                each.message_end_time,
                times={**each.message_index_offsets},
            )
            for each in summary.chunk_indexes
        ]
        return True

    def _scan(self) -> None:
        """Build the index from all records, as far as they are complete."""
        self.note = 'is not complete; it is read as far as it goes'
        self._file.seek(0)
        outside: _Chunk | None = None
        stream = StreamReader(self._file, emit_chunks=True, record_size_limit=self._size)
        try:
            for record in stream.records:
                end = self._file.tell()
                if isinstance(record, Chunk):
                    length = _CHUNK_SIZE + len(record.compression) + len(record.data)
                    found = _Chunk(end - length, length)
                    for each in breakup_chunk(unpacked_chunk(record), validate_crc=True):
                        self._note(each, found)
                    if found.times:
                        self._chunks.append(found)
                elif isinstance(record, Message):
                    if outside is None or outside.length >= _CHUNK_BYTES:
                        begin = end - _MESSAGE_SIZE - len(record.data)
                        outside = _Chunk(begin, 0, is_chunk=False)
                        self._chunks.append(outside)
                    self._note(record, outside)
                    outside.length = end - outside.offset
                elif isinstance(record, DataEnd):
                    self.note = ''
                    break
                else:
                    self._note(record)
        except UnicodeDecodeError:
            self.note = 'has a name that is no UTF-8; it is read up to there'
        except Exception:  # as above: the rest is incomplete
            pass

    def _note(self, record: object, chunk: _Chunk | None = None) -> None:
        """Process a record outside the index."""
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
        elif isinstance(record, Message) and chunk is not None:
            chunk.add(record)
            self._counts[record.channel_id] = self._counts.get(record.channel_id, 0) + 1

    def _topic(self, channel: Channel) -> StoredTopic:
        schema = self._schemas.get(channel.schema_id, Schema(0, b'', '', ''))
        return StoredTopic(
            channel.id,
            channel.topic,
            schema.name,
            channel.message_encoding,
            channel.metadata.get('offered_qos_profiles', ''),
            schema.data.decode(errors='replace'),
            schema.encoding,
            channel.metadata.get('topic_type_hash', ''),
        )

    # -- messages -------------------------------------------------------------------------------

    def _messages(self, chunk: _Chunk) -> list[Message]:
        """Return the messages of a chunk, in the order of the file.

        Raises:
            ValueError: They are damaged.
        """
        if self._last_read[0] != chunk.offset:
            data = self._read_at(chunk.offset, chunk.length)
            try:
                if chunk.is_chunk:
                    record = Chunk.read(ReadDataStream(BytesIO(data[_RECORD_SIZE:])))
                else:
                    record = Chunk('', data, chunk.end_ns, chunk.start_ns, 0, len(data))
                records = breakup_chunk(unpacked_chunk(record), validate_crc=True)
            except Exception as error:  # three libraries, and data from anywhere
                raise ValueError(str(error) or 'a record is cut off') from error
            found = [each for each in records if isinstance(each, Message)]
            self._last_read = (chunk.offset, found)
        return self._last_read[1]

    def _times(self, known: int | list[int]) -> Any:
        """Return the times of a channel's messages in a chunk."""
        if isinstance(known, list):
            return np.array(known, dtype=np.int64)
        head = self._read_at(known, _INDEX_SIZE)
        size = int.from_bytes(head[-4:], 'little') // _ENTRY_SIZE * _ENTRY_SIZE
        entries = np.frombuffer(self._read_at(known + _INDEX_SIZE, size), '<u8')
        return entries[::2].astype(np.int64)

    def _read_at(self, offset: int, size: int) -> bytes:
        data = os.pread(self._file.fileno(), size, offset)
        if len(data) < size:
            raise ValueError('the file is cut off')
        return data
