"""Reading a bag: `open_bag`."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.bags import finding
from labkit.bags.decoding import Decoder
from labkit.bags.metadata import BagTopic, Metadata, profiles_from
from labkit.bags.stored import StoredFile
from labkit.bags.unpacking import unpacked
from labkit.errors import LabError, did_you_mean, quoted

if TYPE_CHECKING:
    import os

    from typing_extensions import Self

__all__ = ['Bag', 'BagMessage', 'BagTopic', 'open_bag']

_FIRST_NS, _LAST_NS = -(2**63), 2**63 - 1


@dataclass(frozen=True)
class BagMessage:
    """A message of a bag.

    Attributes:
        topic: Full name of its topic.
        stamp_ns: Time of recording, ns since 1970.
        data: Its serialized data.
    """

    topic: str
    msg_type: str
    stamp_ns: int
    data: bytes = field(repr=False)
    _decoder: Decoder = field(default_factory=lambda: Decoder({}), repr=False, compare=False)

    @property
    def message(self) -> Any:
        """The deserialized message, also of a type that is not installed here.

        Raises:
            LabError: The type is unknown, or the data is not a message of it.
        """
        return self._decoder.decode(self.msg_type, self.data)


class Bag:
    """A bag, open for reading. Made by `open_bag`; a context manager.

    Attributes:
        path: Its folder, or its single file.
        storage: `'mcap'` or `'sqlite3'`.
        start_ns: Time of the first message, ns since 1970; 0 if there is none.
        end_ns: Time of the last message, ns; 0 if there is none.
        size_bytes: Size of its files, bytes.
        message_count: Number of messages.
        note: Any fault, as a sentence; '' if it is intact.
        ros_distro: Distribution that wrote the bag; `'unknown'` if not stated.
    """

    def __init__(self, found: finding.Found) -> None:
        self.path = found.path
        self.storage = found.storage
        self.note = found.note
        self.files = [file.path.name for file in found.files]
        self.ros_distro = found.metadata.ros_distro if found.metadata else 'unknown'
        self._found = found
        self._stamps: dict[str, Any] = {}
        self.size_bytes = sum(path.stat().st_size for path in found.stored_at)
        self.topics = _topics(found.files, found.metadata)
        self.message_count = sum(topic.count for topic in self.topics)
        spans = [span for span in (file.span() for file in found.files) if span is not None]
        self.start_ns = min((first for first, _ in spans), default=0)
        self.end_ns = max((last for _, last in spans), default=0)
        self._decoder = Decoder(
            {
                topic.msg_type: (topic.definition, topic.encoding)
                for file in found.files
                for topic in file.topics.values()
            }
        )

    @property
    def duration_sec(self) -> float:
        """The time from the first to the last message, s."""
        return (self.end_ns - self.start_ns) / 1e9

    def topic(self, name: str) -> BagTopic:
        """Return a topic.

        Raises:
            LabError: There is no such topic.
        """
        names = [topic.name for topic in self.topics]
        for topic in self.topics:
            if topic.name in (name, f'/{name}'):
                return topic
        known = f'It has {", ".join(names)}.' if names else 'It has none.'
        raise LabError(
            f'{quoted(self.path.name)} has no topic {quoted(name)}.',
            todo=did_you_mean(name, names, known),
        )

    def messages(
        self,
        topics: str | Iterable[str] | None = None,
        start_sec: float | None = None,
        end_sec: float | None = None,
    ) -> Iterator[BagMessage]:
        """Yield messages in order of time, reading them lazily.

        Args:
            topics: Names of topics; all if None.
            start_sec: Start, s from the beginning of the bag.
            end_sec: End, s from the beginning of the bag.

        Raises:
            LabError: The bag has no such topic, or is damaged.
        """
        names = self._names(topics)
        first = _FIRST_NS if start_sec is None else self.start_ns + round(start_sec * 1e9)
        last = _LAST_NS if end_sec is None else self.start_ns + round(end_sec * 1e9)
        return self._read(names, first, last)

    def stamps(self, topic: str) -> Any:
        """Return the times of a topic's messages in order, ns since 1970, as a numpy array.

        Raises:
            LabError: The bag has no such topic, or is damaged.
        """
        name = self.topic(topic).name
        if name not in self._stamps:
            try:
                each = [file.stamps(number) for file, number in self._topics_called(name)]
            except (ValueError, OSError) as error:
                raise self._damaged(error) from error
            found = np.concatenate([np.empty(0, dtype=np.int64), *each])
            self._stamps[name] = np.sort(found, kind='stable')
        return self._stamps[name]

    def at(self, topic: str, t_ns: int) -> BagMessage | None:
        """Return a topic's last message at or before a time, None if there is none.

        Args:
            topic: Name of the topic.
            t_ns: The time, ns since 1970.

        Raises:
            LabError: The bag has no such topic, or is damaged.
        """
        best: BagMessage | None = None
        for file, number in self._topics_called(self.topic(topic).name):
            try:
                found = file.last(number, t_ns)
            except (ValueError, OSError) as error:
                raise self._damaged(error) from error
            if found is not None and (best is None or found[0] >= best.stamp_ns):
                best = self._message(file, number, *found)
        return best

    def close(self) -> None:
        """Close the files."""
        self._found.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        topics = ', '.join(f'{topic.name} ({topic.count})' for topic in self.topics)
        text = f'{self.path}: {self.message_count} messages in {self.duration_sec:.1f} s'
        return '. '.join(filter(None, [f'{text}: {topics}' if topics else text, self.note]))

    # -- details --------------------------------------------------------------------------------

    def _names(self, topics: str | Iterable[str] | None) -> set[str]:
        if topics is None:
            return {topic.name for topic in self.topics}
        wanted = [topics] if isinstance(topics, str) else topics
        return {self.topic(name).name for name in wanted}

    def _topics_called(self, name: str) -> list[tuple[StoredFile, int]]:
        """Return the files with a topic, and the topic's number in each."""
        return [
            (file, number)
            for file in self._found.files
            for number, topic in file.topics.items()
            if topic.name == name
        ]

    def _read(self, names: set[str], first: int, last: int) -> Iterator[BagMessage]:
        def messages_of(order: int, file: StoredFile) -> Iterator[tuple[int, int, int, bytes]]:
            numbers = [key for key, topic in file.topics.items() if topic.name in names]
            for stamp, number, data in file.read(numbers, first, last):
                yield stamp, order, number, data

        files = self._found.files
        try:
            each = [messages_of(order, file) for order, file in enumerate(files)]
            for stamp, order, number, data in heapq.merge(*each, key=lambda found: found[:2]):
                yield self._message(files[order], number, stamp, data)
        except (ValueError, OSError) as error:
            raise self._damaged(error) from error

    def _message(self, file: StoredFile, number: int, stamp_ns: int, data: bytes) -> BagMessage:
        topic = file.topics[number]
        if self._found.compressed_messages:
            data = unpacked(data)
        return BagMessage(topic.name, topic.msg_type, stamp_ns, data, self._decoder)

    def _damaged(self, error: Exception) -> LabError:
        return LabError(
            f'{quoted(str(self.path))} is damaged: {error}.',
            todo='What comes before that can be read. Is there another copy of it?',
        )


def open_bag(path: str | os.PathLike[str]) -> Bag:
    """Open a bag for reading.

    Args:
        path: Its folder, or one data file: `.mcap` or `.db3`.

    Returns:
        The bag: `with open_bag('drive') as bag: ...`

    Raises:
        LabError: There is none, or it can't be read.
    """
    found = finding.find(Path(path))
    try:
        return Bag(found)
    except (ValueError, OSError) as error:
        found.close()
        raise LabError(
            f'{quoted(str(path))} is damaged: {error}.', todo='Is there another copy of it?'
        ) from error


def _topics(files: Sequence[StoredFile], metadata: Metadata | None) -> list[BagTopic]:
    """Return the topics of files, with counts from `metadata.yaml` if there is one."""
    found: dict[tuple[str, str], BagTopic] = {}
    for file in files:
        counts = file.counts() if metadata is None else {}
        for number, stored in file.topics.items():
            key = (stored.name, stored.msg_type)
            if key not in found:
                found[key] = BagTopic(
                    *(*key, 0, profiles_from(stored.qos), stored.serialization_format),
                    *(stored.definition, stored.encoding, stored.type_hash),
                )
            count = found[key].count + counts.get(number, 0)
            found[key] = replace(found[key], count=count)
    for told in metadata.topics if metadata is not None else ():
        key = (told.name, told.msg_type)
        known = found.get(key, told)
        found[key] = replace(told, definition=known.definition, encoding=known.encoding)
    return [found[key] for key in sorted(found)]
