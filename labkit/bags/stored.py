"""What the readers of the two kinds of files have in common."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

__all__ = ['Damaged', 'StoredFile', 'StoredTopic']


class Damaged(Exception):
    """Report that a file is not what it should be. The words follow "its file ..."."""


@dataclass(frozen=True)
class StoredTopic:
    """A topic with one type, as a file knows it.

    Attributes:
        id: Its number in the file.
        name: Full name of the topic.
        msg_type: Name of the type, such as `std_msgs/msg/String`.
        serialization_format: `'cdr'`.
        qos: The offered QoS profiles, as text.
        definition: The type's definition, '' if the file has none.
        encoding: Its language: `'ros2msg'` or `'ros2idl'`.
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
    """A file of messages, open for reading.

    Attributes:
        path: Where it is.
        topics: Its topics, by number.
        note: What is wrong with it, '' if it is whole.
    """

    path: Path
    topics: dict[int, StoredTopic]
    note: str

    def counts(self) -> dict[int, int]:
        """Return how many messages each topic has."""
        ...

    def span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last message, ns; None if there is none."""
        ...

    def stamps(self, topic: int) -> Any:
        """Return the times of a topic's messages, ns, in order, as an array of numpy."""
        ...

    def read(
        self, topics: Collection[int], start_ns: int, end_ns: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield time, topic and bytes of the messages from a time to a time, in order of time."""
        ...

    def last(self, topic: int, t_ns: int) -> tuple[int, bytes] | None:
        """Return time and bytes of the last message of a topic at a time or before, or None."""
        ...

    def close(self) -> None:
        """Close it."""
        ...
