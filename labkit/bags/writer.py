"""Writing a bag: its files, one after the other, and `metadata.yaml` at the end."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

from labkit.bags.metadata import FILE_NAME, BagTopic, Metadata, profiles_from
from labkit.bags.stored import StoredTopic
from labkit.errors import LabError, did_you_mean, quoted
from labkit.files import replaced, write_atomically

__all__ = ['STORAGES', 'BagWriter', 'check_storage']

STORAGES = ('mcap', 'sqlite3')
_SUFFIXES = ('.mcap', '.db3', '.db3-journal', '.db3-wal', '.db3-shm')

Message = tuple[int, int, int, bytes]
"""Topic number, receive time, ns, publish time, ns, and data."""


class _File(Protocol):
    path: Path

    @property
    def size(self) -> int: ...
    def add_topic(self, topic: StoredTopic) -> None: ...
    def write(self, messages: Sequence[Message]) -> None: ...
    def flush(self) -> None: ...
    def finish(self, metadata: str) -> None: ...
    def abandon(self) -> None: ...


class BagWriter:
    """A bag, open for writing.

    Args:
        path: Its folder.
        storage: `'mcap'` or `'sqlite3'`.
        overwrite: Whether to replace an existing bag.
        split_bytes: Size after which a new file begins; 0 for never.
        split_sec: Duration after which a new file begins, s; 0 for never.

    Attributes:
        path: Its folder.

    Raises:
        LabError: The folder exists, or can't be created.
        OSError: In any method: it can't be written.
    """

    _first_ns: int
    _last_ns: int

    def __init__(
        self,
        path: Path,
        storage: str = 'mcap',
        *,
        overwrite: bool = False,
        split_bytes: int = 0,
        split_sec: float = 0.0,
    ) -> None:
        self.path = path
        self._storage = check_storage(storage)
        self._split_bytes, self._split_ns = split_bytes, round(split_sec * 1e9)
        self._topics: dict[int, StoredTopic] = {}
        self._written: list[dict[str, Any]] = []
        self._counts: dict[int, int] = {}
        self._open = True
        try:
            if os.path.lexists(path):
                _check_replaceable(path, overwrite=overwrite)
            path.parent.mkdir(parents=True, exist_ok=True)
            with replaced(path):
                path.mkdir()
                try:
                    self._begin_file()
                except OSError as error:
                    why = error.strerror or error
                    raise LabError(f'{quoted(str(path))} can not be written: {why}.') from error
        except OSError as error:
            raise LabError(
                f'{quoted(str(path))} can not be made: {error.strerror or error}.',
                todo='Choose a folder that you may write to.',
            ) from error

    def add_topic(
        self,
        name: str,
        msg_type: str,
        *,
        qos: str,
        definition: str,
        encoding: str,
        type_hash: str = '',
    ) -> int:
        """Add a topic; return its number.

        Args:
            name: Full name of the topic.
            msg_type: Name of its type.
            qos: The offered QoS profiles, as YAML.
            definition: Definition of the type.
            encoding: Language of the definition.
            type_hash: `RIHS01_...`, '' if unknown.

        """
        number = len(self._topics) + 1
        topic = StoredTopic(number, name, msg_type, 'cdr', qos, definition, encoding, type_hash)
        self._topics[number] = topic
        self._counts[number] = 0
        self._file.add_topic(topic)
        return number

    def write(self, messages: Sequence[Message]) -> None:
        """Write messages in order of arrival."""
        if self._split_bytes or self._split_ns:
            for message in messages:
                self._write([message])
        elif messages:
            self._write(messages)

    def _write(self, messages: Sequence[Message]) -> None:
        """Write messages to one file, beginning a new one if it is full."""
        if self._is_full(messages[0][1]):
            self._end_file()
            self._begin_file()
        self._file.write(messages)
        counts = self._in_file
        for topic, stamp, _, _ in messages:
            counts[topic] = counts.get(topic, 0) + 1
            if stamp < self._first_ns:
                self._first_ns = stamp
            if stamp > self._last_ns:
                self._last_ns = stamp

    def flush(self) -> None:
        """Write everything, so that it survives a crash."""
        self._file.flush()

    def close(self) -> None:
        """Complete the bag. Without effect if it is closed."""
        if self._open:
            self._open = False
            self._end_file()
            write_atomically(self.path / FILE_NAME, self._metadata(self._written).encode())

    def abandon(self) -> None:
        """Close the bag as it is: it can be read as far as it goes."""
        if self._open:
            self._open = False
            self._file.abandon()

    def _is_full(self, stamp_ns: int) -> bool:
        if not self._in_file:
            return False
        too_large = self._split_bytes and self._file.size >= self._split_bytes
        too_long = self._split_ns and stamp_ns - self._first_ns >= self._split_ns
        return bool(too_large or too_long)

    def _begin_file(self) -> None:
        from labkit.bags.mcap_writer import McapWriter
        from labkit.bags.sqlite_writer import SqliteWriter

        kind: Any = McapWriter if self._storage == 'mcap' else SqliteWriter
        name = f'{self.path.resolve().name}_{len(self._written)}{kind.suffix}'
        self._in_file: dict[int, int] = {}
        self._first_ns, self._last_ns = 2**63 - 1, 0
        self._file: _File = kind(self.path / name)
        for topic in self._topics.values():
            self._file.add_topic(topic)

    def _end_file(self) -> None:
        for topic, count in self._in_file.items():
            self._counts[topic] += count
        entry = {
            'path': self._file.path.name,
            'start_ns': self._first_ns if self._in_file else 0,
            'duration_ns': max(0, self._last_ns - self._first_ns) if self._in_file else 0,
            'count': sum(self._in_file.values()),
        }
        self._written.append(entry)
        self._file.finish(self._metadata([entry]))

    def _metadata(self, files: Sequence[dict[str, Any]]) -> str:
        filled = [file for file in files if file['count']]
        first = min((file['start_ns'] for file in filled), default=0)
        last = max((file['start_ns'] + file['duration_ns'] for file in filled), default=0)
        counts = self._counts if files is self._written else self._in_file
        topics = [
            BagTopic(
                *(topic.name, topic.msg_type, counts.get(number, 0), profiles_from(topic.qos)),
                *(topic.serialization_format, '', '', topic.type_hash),
            )
            for number, topic in self._topics.items()
        ]
        names = [file['path'] for file in files]
        return Metadata(self._storage, names, first, last - first, topics).text(files)


def check_storage(storage: str) -> str:
    """Return the name of a storage.

    Raises:
        LabError: There is no such storage.
    """
    if storage in STORAGES:
        return storage
    raise LabError(
        f'storage must be one of {", ".join(map(repr, STORAGES))}, but it is {quoted(storage)}.',
        todo=did_you_mean(str(storage), STORAGES),
    )


def _check_replaceable(path: Path, *, overwrite: bool) -> None:
    """Refuse to replace what is no bag, or a bag without being asked to.

    Raises:
        LabError: It is not to be replaced.
    """
    if not overwrite:
        raise LabError(
            f"Output folder '{path}' already exists.",
            todo='Choose another name, or replace what is there: overwrite=True.',
        )
    entries = list(path.iterdir()) if path.is_dir() and not path.is_symlink() else None
    others = [
        entry.name
        for entry in entries or ()
        if entry.is_dir() or (entry.name != FILE_NAME and not entry.name.endswith(_SUFFIXES))
    ]
    if entries is None or others:
        what = f'holds {quoted(others[0])}, too' if others else 'is no folder'
        raise LabError(
            f'{quoted(str(path))} {what}, so it is not replaced.',
            todo='Choose another name, or remove it yourself.',
        )
