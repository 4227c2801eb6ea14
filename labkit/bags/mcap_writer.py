"""Write an MCAP file that can be read up to the last `flush`, however the program ends."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from mcap.writer import CompressionType, Writer

from labkit.bags.stored import StoredTopic

__all__ = ['McapWriter']


class McapWriter:
    """An MCAP file, open for writing.

    Args:
        path: The file, which must not exist.

    Attributes:
        size: Size of the written messages, bytes.

    Raises:
        OSError: In any method: it can't be written.
    """

    suffix = '.mcap'

    def __init__(self, path: Path) -> None:
        self.path = path
        self.size = 0
        self._file = path.open('xb')
        self._writer = Writer(self._file, compression=CompressionType.NONE)
        self._schemas: dict[str, int] = {}
        self._channels: dict[int, int] = {}
        self._writer.start('ros2', 'labkit')
        self.flush()

    def add_topic(self, topic: StoredTopic) -> None:
        """Add a topic. Its number must be new."""
        if topic.msg_type not in self._schemas:
            self._schemas[topic.msg_type] = self._writer.register_schema(
                topic.msg_type, topic.encoding, topic.definition.encode()
            )
        self._channels[topic.id] = self._writer.register_channel(
            topic.name,
            topic.serialization_format,
            self._schemas[topic.msg_type],
            {'offered_qos_profiles': topic.qos, 'topic_type_hash': topic.type_hash},
        )

    def write(self, messages: Sequence[tuple[int, int, int, bytes]]) -> None:
        """Write messages, see `Message`."""
        for topic, stamp, published, data in messages:
            self._writer.add_message(self._channels[topic], stamp, data, published or stamp)
            self.size += len(data)

    def flush(self) -> None:
        """Write everything, so that it survives a crash."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def finish(self, metadata: str) -> None:
        """Write the index, and close the file.

        Args:
            metadata: The part of metadata.yaml about this file.
        """
        self.flush()
        self._writer.add_metadata('rosbag2', {'serialized_metadata': metadata})
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.close()

    def abandon(self) -> None:
        """Close the file as it is, without an index or what could not be written."""
        with suppress(OSError):
            self._file.close()
