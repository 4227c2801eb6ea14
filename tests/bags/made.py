"""Bags made by hand, by what rosbag2 documents of its format, with nothing of labkit."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import yaml
from mcap.writer import CompressionType, Writer
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore
from std_msgs.msg import Int16, String

__all__ = [
    'START_NS',
    'Maker',
    'Stored',
    'int16',
    'make_mcap',
    'make_sqlite',
    'metadata',
    'string',
]

START_NS = 1_700_000_000_000_000_000

Stored = tuple[str, int, bytes]
"""Topic, time after the start, ns, and bytes."""


class Maker(Protocol):
    """Makes a bag."""

    def __call__(self, folder: Path, messages: Sequence[Stored], /) -> Path: ...


TYPES = {'/chatter': 'std_msgs/msg/String', '/count': 'std_msgs/msg/Int16'}
DEFINITIONS = {'std_msgs/msg/String': 'string data\n', 'std_msgs/msg/Int16': 'int16 data\n'}
HASHES = {kind: get_typestore(Stores.ROS2_JAZZY).hash_rihs01(kind) for kind in DEFINITIONS}
# As version 9 of metadata.yaml writes it, and as the versions before did.
QOS_9 = """
- history: keep_last
  depth: 7
  reliability: best_effort
  durability: transient_local
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: automatic
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
"""
QOS_5 = (
    '- history: 1\n  depth: 7\n  reliability: 2\n  durability: 1\n'
    '  deadline:\n    sec: 2147483647\n    nsec: 4294967295\n'
    '  lifespan:\n    sec: 2147483647\n    nsec: 4294967295\n  liveliness: 1\n'
    '  liveliness_lease_duration:\n    sec: 2147483647\n    nsec: 4294967295\n'
    '  avoid_ros_namespace_conventions: false'
)


def string(text: str) -> bytes:
    """Return a String as bytes."""
    return bytes(serialize_message(String(data=text)))


def int16(number: int) -> bytes:
    """Return an Int16 as bytes."""
    return bytes(serialize_message(Int16(data=number)))


def metadata(
    folder: Path, storage: str, files: Sequence[str], messages: Sequence[Stored], version: int = 9
) -> None:
    """Write metadata.yaml."""
    stamps = [START_NS + after for _, after, _ in messages]
    count: Any = {name: sum(topic == name for topic, _, _ in messages) for name in TYPES}
    information: dict[str, Any] = {
        'version': version,
        'storage_identifier': storage,
        'duration': {'nanoseconds': max(stamps) - min(stamps)},
        'starting_time': {'nanoseconds_since_epoch': min(stamps)},
        'message_count': len(messages),
        'topics_with_message_count': [
            {
                'topic_metadata': {
                    'name': name,
                    'type': TYPES[name],
                    'serialization_format': 'cdr',
                    'offered_qos_profiles': yaml.safe_load(QOS_9) if version >= 9 else QOS_5,
                    'type_description_hash': HASHES[TYPES[name]],
                },
                'message_count': count[name],
            }
            for name in TYPES
        ],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': list(files),
        'files': [],
        'custom_data': None,
        'ros_distro': 'jazzy',
    }
    text = yaml.safe_dump({'rosbag2_bagfile_information': information})
    (folder / 'metadata.yaml').write_text(text)


def make_sqlite(
    folder: Path, messages: Sequence[Stored], *, schema: int = 4, version: int = 9
) -> Path:
    """Make a bag in sqlite3, in version 4 of the tables, or as older ones were."""
    folder.mkdir(parents=True)
    name = f'{folder.name}_0.db3'
    database = sqlite3.connect(folder / name)
    new = schema >= 4
    database.executescript(
        'CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, '
        'serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL'
        + (', type_description_hash TEXT NOT NULL' if new else '')
        + ');CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, '
        'timestamp INTEGER NOT NULL, data BLOB NOT NULL);'
        'CREATE INDEX timestamp_idx ON messages (timestamp ASC);'
    )
    if new:
        database.executescript(
            'CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);'
            "INSERT INTO schema VALUES(4, 'jazzy');"
            'CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, '
            'encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, '
            'type_description_hash TEXT NOT NULL);'
        )
        for kind, text in DEFINITIONS.items():
            row = (kind, 'ros2msg', text, HASHES[kind])
            database.execute(
                'INSERT INTO message_definitions(topic_type, encoding, '
                'encoded_message_definition, type_description_hash) VALUES(?, ?, ?, ?)',
                row,
            )
    numbers = {topic: number for number, topic in enumerate(TYPES, 1)}
    for topic, number in numbers.items():
        qos = QOS_9 if version >= 9 else QOS_5
        values = [
            number,
            topic,
            TYPES[topic],
            'cdr',
            qos,
            *([HASHES[TYPES[topic]]] if new else []),
        ]
        database.execute(f'INSERT INTO topics VALUES({",".join("?" * len(values))})', values)
    for topic, after, data in messages:
        database.execute(
            'INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)',
            (numbers[topic], START_NS + after, data),
        )
    database.commit()
    database.close()
    metadata(folder, 'sqlite3', [name], messages, version)
    return folder


def make_mcap(
    folder: Path,
    messages: Sequence[Stored],
    *,
    compression: CompressionType = CompressionType.NONE,
    chunk_size: int = 200,
    use_chunking: bool = True,
    files: int = 1,
    **options: Any,
) -> Path:
    """Make a bag in MCAP, with the library that knows nothing of ROS."""
    folder.mkdir(parents=True)
    names = [f'{folder.name}_{number}.mcap' for number in range(files)]
    share = -(-len(messages) // files)
    for number, name in enumerate(names):
        with open(folder / name, 'wb') as file:
            writer = Writer(
                file,
                chunk_size=chunk_size,
                compression=compression,
                use_chunking=use_chunking,
                **options,
            )
            writer.start('ros2', 'made by hand')
            channels = {}
            for topic, kind in TYPES.items():
                schema = writer.register_schema(kind, 'ros2msg', DEFINITIONS[kind].encode())
                channels[topic] = writer.register_channel(
                    topic, 'cdr', schema, {'offered_qos_profiles': QOS_9}
                )
            for topic, after, data in messages[number * share : (number + 1) * share]:
                stamp = START_NS + after
                writer.add_message(channels[topic], stamp, data, stamp)
            writer.finish()
    metadata(folder, 'mcap', names, messages)
    return folder
