"""Write an MCAP file so that it can be read up to the last moment, whatever ends its program.

Writers of libraries keep a chunk in memory until it is full, which takes minutes for a slow topic.
Here a chunk is written, with its index, whenever `flush` is called: what follows the last whole
one after a crash is at most as much as was published meanwhile.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

from labkit.bags.mcap_records import (
    MAGIC,
    RECORD,
    Channel,
    Op,
    Schema,
    pack,
    packed_map,
    packed_text,
)
from labkit.bags.stored import StoredTopic

__all__ = ['McapWriter']

CHUNK_BYTES = 1 << 20
_FEW = 32
_PROFILE, _LIBRARY = 'ros2', 'labkit'
_MESSAGE = struct.Struct('<BQHIQQ')
_PLACE = struct.Struct('<QQ')


class McapWriter:
    """An MCAP file, open for writing.

    Args:
        path: The file, which must not be there.

    Raises:
        OSError: In each method: it can't be written.
    """

    suffix = '.mcap'
    _first_ns: int
    _last_ns: int

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = path.open('xb', buffering=0)
        self._end = 0
        self._schemas: dict[str, Schema] = {}
        self._channels: list[Channel] = []
        self._chunk_indexes: list[bytes] = []
        self._counts: dict[int, int] = {}
        self._start_ns, self._end_ns = 2**64 - 1, 0
        self._begin_chunk()
        self._put(MAGIC + pack(Op.HEADER, packed_text(_PROFILE), packed_text(_LIBRARY)))

    @property
    def size(self) -> int:
        """Return how many bytes the file has, or will have with what waits."""
        return self._end + self._filled

    def add_topic(self, topic: StoredTopic) -> None:
        """Add a topic. Its number must be new."""
        schema = self._schemas.get(topic.msg_type)
        if schema is None:
            number = len(self._schemas) + 1
            schema = Schema(number, topic.msg_type, topic.encoding, topic.definition)
            self._schemas[topic.msg_type] = schema
            self._add(schema.packed())
        metadata = {'offered_qos_profiles': topic.qos, 'topic_type_hash': topic.type_hash}
        form = topic.serialization_format
        channel = Channel(topic.id, schema.id, topic.name, form, metadata)
        self._channels.append(channel)
        self._add(channel.packed())

    def write(self, messages: Sequence[tuple[int, int, int, bytes]]) -> None:
        """Write messages: number of the topic, times of receipt and of publishing, ns, bytes."""
        for topic, stamp, published, data in messages:
            size = len(data)
            self._parts.append(
                _MESSAGE.pack(Op.MESSAGE, size + 22, topic, 0, stamp, published or stamp)
            )
            self._parts.append(data)
            place = _PLACE.pack(stamp, self._filled)
            if topic in self._indexes:
                self._indexes[topic] += place
            else:
                self._indexes[topic] = bytearray(place)
            if stamp < self._first_ns:
                self._first_ns = stamp
            if stamp > self._last_ns:
                self._last_ns = stamp
            self._filled += _MESSAGE.size + size
            if self._filled >= CHUNK_BYTES:
                self.flush()

    def flush(self) -> None:
        """Write what waits, so that it can be read whatever happens from now on."""
        if not self._parts:
            return
        has_messages = bool(self._indexes)
        first = self._first_ns if has_messages else 0
        # Many small pieces are faster as one; large ones are not copied.
        body = [b''.join(self._parts)] if len(self._parts) > _FEW else self._parts
        crc = 0
        for part in body:
            crc = zlib.crc32(part, crc)
        head = struct.pack('<QQQI', first, self._last_ns, self._filled, crc) + packed_text('')
        head += struct.pack('<Q', self._filled)
        record = RECORD.pack(Op.CHUNK, len(head) + self._filled) + head
        begin, size = self._end, len(record) + self._filled
        indexes, places = [], []
        at = begin + size
        for topic, entries in self._indexes.items():
            places.append(struct.pack('<HQ', topic, at))
            content = struct.pack('<HI', topic, len(entries))
            indexes.append(pack(Op.MESSAGE_INDEX, content, bytes(entries)))
            at += len(indexes[-1])
        self._put(record, *body, *indexes)
        if has_messages:
            of_indexes = b''.join(places)
            self._chunk_indexes.append(
                struct.pack('<QQQQI', first, self._last_ns, begin, size, len(of_indexes))
                + of_indexes
                + struct.pack('<Q', at - begin - size)
                + packed_text('')
                + struct.pack('<QQ', self._filled, self._filled)
            )
            for topic, entries in self._indexes.items():
                self._counts[topic] = self._counts.get(topic, 0) + len(entries) // _PLACE.size
            self._start_ns = min(self._start_ns, first)
            self._end_ns = max(self._end_ns, self._last_ns)
        self._begin_chunk()

    def finish(self, metadata: str) -> None:
        """Write the index, and close the file.

        Args:
            metadata: The text of metadata.yaml, as far as it is about this file.
        """
        self.flush()
        at = self._end
        said = pack(
            Op.METADATA, packed_text('rosbag2'), packed_map({'serialized_metadata': metadata})
        )
        index = struct.pack('<QQ', at, len(said)) + packed_text('rosbag2')
        end = pack(Op.DATA_END, struct.pack('<I', 0))
        groups = [
            (Op.SCHEMA, b''.join(schema.packed() for schema in self._schemas.values())),
            (Op.CHANNEL, b''.join(channel.packed() for channel in self._channels)),
            (Op.CHUNK_INDEX, b''.join(pack(Op.CHUNK_INDEX, each) for each in self._chunk_indexes)),
            (Op.METADATA_INDEX, pack(Op.METADATA_INDEX, index)),
            (Op.STATISTICS, pack(Op.STATISTICS, self._statistics())),
        ]
        begin = at = at + len(said) + len(end)
        offsets = []
        for op, content in groups:
            if content:
                offsets.append(pack(Op.SUMMARY_OFFSET, struct.pack('<BQQ', op, at, len(content))))
            at += len(content)
        footer = pack(Op.FOOTER, struct.pack('<QQI', begin, at, 0))
        self._put(said, end, *(text for _, text in groups), *offsets, footer, MAGIC)
        self._file.close()

    def abandon(self) -> None:
        """Close the file as it is: without what could not be written, and without an index."""
        self._file.close()

    def _statistics(self) -> bytes:
        first = self._start_ns if self._counts else 0
        counts = b''.join(struct.pack('<HQ', *each) for each in sorted(self._counts.items()))
        numbers = (
            *(sum(self._counts.values()), len(self._schemas), len(self._channels)),
            *(0, 1, len(self._chunk_indexes), first, self._end_ns, len(counts)),
        )
        return struct.pack('<QHIIIIQQI', *numbers) + counts

    def _begin_chunk(self) -> None:
        self._parts: list[bytes] = []
        self._indexes: dict[int, bytearray] = {}
        self._filled = 0
        self._first_ns, self._last_ns = 2**64 - 1, 0

    def _add(self, record: bytes) -> None:
        """Let a record be a part of the chunk."""
        self._parts.append(record)
        self._filled += len(record)

    def _put(self, *parts: bytes) -> None:
        """Write all of it, or nothing."""
        try:
            for part in parts:
                view = memoryview(part)
                while view:
                    view = view[self._file.write(view) or 0 :]
        except OSError:
            os.ftruncate(self._file.fileno(), self._end)
            raise
        self._end += sum(map(len, parts))
