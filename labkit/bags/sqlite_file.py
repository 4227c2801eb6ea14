"""Read an sqlite3 file of rosbag2."""

from __future__ import annotations

import contextlib
import sqlite3
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from labkit.bags.stored import Damaged, StoredTopic

__all__ = ['SqliteFile']


class SqliteFile:
    """An sqlite3 file, open for reading. See `StoredFile`.

    Raises:
        Damaged: It is not an sqlite3 file of rosbag2.
        OSError: It can't be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.note = ''
        with path.open('rb') as file:
            if not file.read(1):
                raise Damaged('is empty')
        self._database = _connect(path)
        try:
            self.topics = self._read_topics()
        except sqlite3.DatabaseError as error:
            self._database.close()
            raise Damaged(f'is no sqlite3 file of rosbag2 ({error})') from error

    def counts(self) -> dict[int, int]:
        """Return the number of messages of each topic."""
        rows = self._query('SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id')
        return dict.fromkeys(self.topics, 0) | {
            topic: count for topic, count in rows if topic in self.topics
        }

    def span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last message, ns; None without messages."""
        # Two queries, so that each uses the index.
        first, last = next(
            self._query(
                'SELECT (SELECT MIN(timestamp) FROM messages), '
                '(SELECT MAX(timestamp) FROM messages)'
            )
        )
        return None if first is None else (first, last)

    def stamps(self, topic: int) -> Any:
        """Return the times of a topic's messages in order, ns."""
        rows = self._query('SELECT timestamp FROM messages WHERE topic_id = ?', topic)
        return np.sort(np.fromiter((stamp for (stamp,) in rows), dtype=np.int64))

    def read(
        self, topics: Collection[int], start_ns: int, end_ns: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield time, topic and data of the messages between two times, in order of time."""
        marks = ','.join('?' * len(topics))
        yield from self._query(
            'SELECT timestamp, topic_id, data FROM messages WHERE timestamp BETWEEN ? AND ? '
            f'AND topic_id IN ({marks}) ORDER BY timestamp, id',
            *(max(start_ns, -(2**63)), min(end_ns, 2**63 - 1), *topics),
        )

    def last(self, topic: int, t_ns: int) -> tuple[int, bytes] | None:
        """Return time and data of a topic's last message at or before a time, or None."""
        rows = self._query(
            'SELECT timestamp, data FROM messages WHERE topic_id = ? AND timestamp <= ? '
            'ORDER BY timestamp DESC, id DESC LIMIT 1',
            *(topic, t_ns),
        )
        return next(rows, None)

    def close(self) -> None:
        """Close the file."""
        self._database.close()

    def _query(self, query: str, *values: int) -> Iterator[Any]:
        """Yield the rows of a query.

        Raises:
            ValueError: The file is damaged.
        """
        try:
            yield from self._database.execute(query, values)
        except sqlite3.DatabaseError as error:
            raise ValueError(str(error)) from error

    def _read_topics(self) -> dict[int, StoredTopic]:
        # Older versions of rosbag2 have fewer columns, and no definitions.
        known = {row[1] for row in self._database.execute('PRAGMA table_info(topics)')}
        wanted = ['offered_qos_profiles', 'type_description_hash']
        columns = [name if name in known else "''" for name in wanted]
        definitions: dict[str, tuple[str, str]] = {}
        if list(self._database.execute('PRAGMA table_info(message_definitions)')):
            definitions = {
                name: (text, encoding)
                for name, encoding, text in self._database.execute(
                    'SELECT topic_type, encoding, encoded_message_definition '
                    'FROM message_definitions'
                )
            }
        rows = self._database.execute(
            f'SELECT id, name, type, serialization_format, {", ".join(columns)} FROM topics'
        ).fetchall()
        self._database.execute('SELECT topic_id, timestamp, data FROM messages LIMIT 1')
        return {
            number: StoredTopic(
                *(number, name, msg_type, form, qos),
                *definitions.get(msg_type, ('', '')),
                type_hash,
            )
            for number, name, msg_type, form, qos, type_hash in rows
        }


def _connect(path: Path) -> sqlite3.Connection:
    """Open a file; sqlite first recovers what a killed program has left beside it."""
    uri = path.resolve().as_uri()
    for mode in ('mode=ro', 'mode=rw', 'immutable=1'):
        with contextlib.suppress(sqlite3.OperationalError):
            database = sqlite3.connect(f'{uri}?{mode}', uri=True, check_same_thread=False)
            database.text_factory = lambda text: text.decode(errors='replace')
            try:
                database.execute('PRAGMA schema_version').fetchall()
            except sqlite3.OperationalError:
                database.close()
                raise
            except sqlite3.DatabaseError as error:
                database.close()
                raise Damaged(f'is no sqlite3 file ({error})') from error
            return database
    raise Damaged('can not be opened by sqlite3')
