"""Write an sqlite3 file of rosbag2, in version 4 of its tables."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from labkit.bags.metadata import ROS_DISTRO, VERSION
from labkit.bags.stored import StoredTopic

__all__ = ['SqliteWriter']

_TABLES = """
    CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
    CREATE TABLE metadata(
        id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
    CREATE TABLE topics(
        id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
        serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL,
        type_description_hash TEXT NOT NULL);
    CREATE TABLE message_definitions(
        id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
        encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
    CREATE TABLE messages(
        id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
        data BLOB NOT NULL);
    CREATE INDEX timestamp_idx ON messages (timestamp ASC);
"""
# Each statement releases and takes Python's lock, so one inserts many rows; some versions of
# sqlite refuse more than 999 values.
_ROWS = 100
_INSERT = 'INSERT INTO messages(topic_id, timestamp, data) VALUES'
_INSERT_ROWS = _INSERT + ','.join(['(?,?,?)'] * _ROWS)
# Most bytes in one transaction.
_TRANSACTION_BYTES = 8 << 20


class SqliteWriter:
    """An sqlite3 file, open for writing.

    Args:
        path: The file, which must not exist.

    Raises:
        OSError: In any method: it can't be written.
    """

    suffix = '.db3'

    def __init__(self, path: Path) -> None:
        self.path = path
        self.size = 0
        self._waiting = 0
        self._types: set[str] = set()
        path.touch(exist_ok=False)
        # Made in one thread and used in another, never in two at once.
        self._database = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        # Committed data survives the process; only the computer itself must not stop.
        self._do('PRAGMA synchronous = OFF')
        for statement in _TABLES.strip().split(';'):
            self._do(statement)
        self._do('INSERT INTO schema VALUES(4, ?)', ROS_DISTRO)
        self._do('BEGIN')

    def add_topic(self, topic: StoredTopic) -> None:
        """Add a topic. Its number must be new."""
        self._do(
            'INSERT INTO topics VALUES(?, ?, ?, ?, ?, ?)',
            *(topic.id, topic.name, topic.msg_type, topic.serialization_format),
            *(topic.qos, topic.type_hash),
        )
        if topic.msg_type not in self._types:
            self._types.add(topic.msg_type)
            self._do(
                'INSERT INTO message_definitions(topic_type, encoding, '
                'encoded_message_definition, type_description_hash) VALUES(?, ?, ?, ?)',
                *(topic.msg_type, topic.encoding, topic.definition, topic.type_hash),
            )
        self.flush()

    def write(self, messages: Sequence[tuple[int, int, int, bytes]]) -> None:
        """Write messages, see `Message`."""
        rows = [(topic, stamp, data) for topic, stamp, _, data in messages]
        whole = len(rows) - len(rows) % _ROWS
        try:
            for start in range(0, whole, _ROWS):
                values = [value for row in rows[start : start + _ROWS] for value in row]
                self._database.execute(_INSERT_ROWS, values)
            self._database.executemany(f'{_INSERT}(?,?,?)', rows[whole:])
        except sqlite3.Error as error:
            raise OSError(str(error)) from error
        written = sum(len(message[3]) for message in messages)
        self.size += written
        self._waiting += written
        if self._waiting >= _TRANSACTION_BYTES:
            self.flush()

    def flush(self) -> None:
        """Commit everything, so that it survives a crash."""
        self._do('COMMIT')
        self._do('BEGIN')
        self._waiting = 0

    def finish(self, metadata: str) -> None:
        """Commit everything, and close the file.

        Args:
            metadata: The part of metadata.yaml about this file.
        """
        self._do(
            'INSERT INTO metadata(metadata_version, metadata) VALUES(?, ?)', VERSION, metadata
        )
        self._do('COMMIT')
        self._database.close()

    def abandon(self) -> None:
        """Close the file as it is, without what could not be written."""
        with suppress(sqlite3.Error):
            self._database.execute('ROLLBACK')
        self._database.close()

    def _do(self, statement: str, *values: int | str) -> None:
        try:
            self._database.execute(statement, values)
        except sqlite3.Error as error:
            raise OSError(str(error)) from error
