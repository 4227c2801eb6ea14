"""The interface of the readers of both kinds of files."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

__all__ = ['Damaged', 'StoredFile', 'StoredTopic']


class Damaged(Exception):
    """Report that a file is invalid. The message follows "its file ..."."""


@dataclass(frozen=True)
class StoredTopic:
    """A topic with one type, as stored in a file.

    Attributes:
        id: Its number in the file.
        name: Full name of the topic.
        msg_type: Name of the type, such as `std_msgs/msg/String`.
        serialization_format: `'cdr'`.
        qos: The offered QoS profiles, as YAML.
        definition: Definition of the type, '' if the file has none.
        encoding: Language of the definition: `'ros2msg'` or `'ros2idl'`.
        type_hash: `RIHS01_...`, '' if the file has none.
    """

    id: int
    name: str
    msg_type: str
    serialization_format: str
    qos: str
    definition: str
    encoding: str
    type_hash: str


class StoredFile(Protocol):
    """A data file, open for reading.

    Attributes:
        topics: Its topics, by number.
        note: Any fault, '' if it is intact.
    """

    path: Path
    topics: dict[int, StoredTopic]
    note: str

    def counts(self) -> dict[int, int]:
        """Return the number of messages of each topic."""
        ...

    def span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last message, ns; None without messages."""
        ...

    def stamps(self, topic: int) -> Any:
        """Return the times of a topic's messages in order, ns, as a numpy array."""
        ...

    def read(
        self, topics: Collection[int], start_ns: int, end_ns: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield time, topic and data of the messages between two times, in order of time."""
        ...

    def last(self, topic: int, t_ns: int) -> tuple[int, bytes] | None:
        """Return time and data of a topic's last message at or before a time, or None."""
        ...

    def close(self) -> None:
        """Close the file."""
        ...
