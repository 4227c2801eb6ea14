"""Bags that others have written open here: each storage, each way to store it."""

from __future__ import annotations

import sqlite3
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import CompressionType, IndexType, Writer
from rclpy.qos import DurabilityPolicy, HistoryPolicy, ReliabilityPolicy
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from std_msgs.msg import Int16, String

from labkit.bags.reader import Bag, open_bag
from labkit.errors import LabError
from tests.bags import made
from tests.bags.made import START_NS, Stored

NO_INDEX: dict[str, Any] = {
    'index_types': IndexType.NONE,
    'use_statistics': False,
    'use_summary_offsets': False,
}
MAKERS: dict[str, Callable[[Path, list[Stored]], Path]] = {
    'sqlite3 of Jazzy': made.make_sqlite,
    'sqlite3 of Humble': lambda path, found: made.make_sqlite(path, found, schema=3, version=5),
    'mcap': made.make_mcap,
    'mcap in one chunk': lambda path, found: made.make_mcap(path, found, chunk_size=1 << 20),
    'mcap without chunks': lambda path, found: made.make_mcap(path, found, use_chunking=False),
    'mcap, zstd': lambda path, found: made.make_mcap(
        path, found, compression=CompressionType.ZSTD
    ),
    'mcap, lz4': lambda path, found: made.make_mcap(path, found, compression=CompressionType.LZ4),
    'mcap in three files': lambda path, found: made.make_mcap(path, found, files=3),
    'mcap without an index': lambda path, found: made.make_mcap(path, found, **NO_INDEX),
    'mcap without an index of messages': lambda path, found: made.make_mcap(
        path, found, index_types=IndexType.ALL & ~IndexType.MESSAGE
    ),
}


@pytest.fixture(params=MAKERS)
def path(request: pytest.FixtureRequest, tmp_path: Path, messages: list[Stored]) -> Path:
    """Give a bag of each kind."""
    return MAKERS[request.param](tmp_path / 'drive', messages)


def read(bag: Bag, *args: object, **limits: float) -> list[tuple[str, int, bytes]]:
    """Return what the bag yields, with the time after its start."""
    found = bag.messages(*args, **limits)  # type: ignore[arg-type]
    return [(each.topic, each.stamp_ns - START_NS, each.data) for each in found]


def test_all_of_a_bag_is_read(path: Path, messages: list[Stored]) -> None:
    with open_bag(path) as bag:
        assert read(bag) == messages
        assert (bag.start_ns, bag.end_ns) == (START_NS, START_NS + 99 * 10**8)
        assert (bag.duration_sec, bag.message_count, bag.note) == (9.9, 100, '')
        assert bag.storage == ('sqlite3' if list(path.glob('*.db3')) else 'mcap')
        assert bag.size_bytes == sum(
            file.stat().st_size for file in path.iterdir() if file.suffix != '.yaml'
        )
        assert [(each.name, each.msg_type, each.count) for each in bag.topics] == [
            ('/chatter', 'std_msgs/msg/String', 75),
            ('/count', 'std_msgs/msg/Int16', 25),
        ]


def test_the_profiles_that_were_offered_are_told(path: Path) -> None:
    with open_bag(path) as bag:
        (profile,) = bag.topic('/chatter').qos_profiles
    assert (profile.history, profile.depth) == (HistoryPolicy.KEEP_LAST, 7)
    assert profile.reliability == ReliabilityPolicy.BEST_EFFORT
    assert profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert profile.deadline.nanoseconds == profile.lifespan.nanoseconds == 2**63 - 1


def test_messages_are_decoded(path: Path) -> None:
    with open_bag(path) as bag:
        first = next(iter(bag.messages('/chatter')))
        third = bag.at('/count', START_NS + 12 * 10**8)
    assert isinstance(first.message, String) and first.message.data == 'hello 0'
    assert third is not None and isinstance(third.message, Int16) and third.message.data == 11


def test_a_part_of_a_bag_is_read(path: Path, messages: list[Stored]) -> None:
    with open_bag(path) as bag:
        assert read(bag, '/count') == [each for each in messages if each[0] == '/count']
        assert read(bag, ['chatter', '/count']) == messages
        assert read(bag, start_sec=1.0, end_sec=2.0) == messages[10:21]
        assert read(bag, '/count', start_sec=9.85) == [messages[99]]
        assert read(bag, start_sec=10) == read(bag, end_sec=-1) == []


def test_the_times_of_a_topic_are_told(path: Path, messages: list[Stored]) -> None:
    with open_bag(path) as bag:
        stamps = bag.stamps('/count')
    assert stamps.dtype == 'int64'
    assert stamps.tolist() == [START_NS + after for name, after, _ in messages if name == '/count']


def test_the_last_message_at_a_time_is_found(path: Path, messages: list[Stored]) -> None:
    with open_bag(path) as bag:

        def at(topic: str, after: int) -> bytes | None:
            found = bag.at(topic, START_NS + after)
            return found.data if found is not None else None

        for number, (topic, after, data) in enumerate(messages):
            assert at(topic, after) == at(topic, after + 1) == data, number
        assert at('/count', 3 * 10**8 - 1) is None
        assert at('/chatter', -1) is None
        assert at('/chatter', 10**15) == messages[98][2]


def test_one_file_of_a_bag_is_read(path: Path, messages: list[Stored]) -> None:
    (first, *_) = sorted(path.glob('*_0.*'))
    with open_bag(first) as bag:
        assert read(bag) == messages[: bag.message_count]
        assert bag.message_count == sum(topic.count for topic in bag.topics) >= 34


def test_a_bag_says_what_is_in_it(path: Path) -> None:
    with open_bag(str(path)) as bag:
        assert repr(bag) == f'{path}: 100 messages in 9.9 s: /chatter (75), /count (25)'
        with pytest.raises(LabError, match="Did you mean '/count'"):
            bag.messages('/counter')


@pytest.mark.parametrize('storage', list(StoragePlugin))
@pytest.mark.parametrize('mode', [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_a_compressed_bag_is_read(
    tmp_path: Path, storage: StoragePlugin, mode: CompressionMode, messages: list[Stored]
) -> None:
    writer = RosbagsWriter(tmp_path / 'drive', version=9, storage_plugin=storage)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {
            topic: writer.add_connection(
                topic, kind, msgdef=made.DEFINITIONS[kind], rihs01='RIHS01_00'
            )
            for topic, kind in made.TYPES.items()
        }
        for topic, after, data in messages:
            writer.write(connections[topic], START_NS + after, data)
    with open_bag(tmp_path / 'drive') as bag:
        assert read(bag) == messages
        found = bag.at('/count', bag.end_ns)
        assert found is not None and found.data == messages[-1][2]


def test_chunks_whose_times_overlap_are_read_in_order(tmp_path: Path) -> None:
    # A message may come late: then its chunk begins before the one before has ended.
    mixed = [('/count', after * 10**6, made.int16(after)) for after in (5, 1, 9, 3, 8, 2, 7, 0)]
    path = made.make_mcap(tmp_path / 'drive', mixed, chunk_size=60)
    with open_bag(path) as bag:
        assert read(bag) == sorted(mixed, key=lambda each: each[1])
        assert (bag.stamps('/count') - START_NS).tolist() == sorted(each[1] for each in mixed)


PLAIN = 'demo_msgs/Leg left\nuint8[<=3] toes\n'
NESTED = '=' * 80 + '\nMSG: demo_msgs/Leg\nfloat64 length\nstring name\n'


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_type_that_is_not_installed_is_decoded_by_its_definition(
    tmp_path: Path, storage: str
) -> None:
    data = b'\x00\x01\x00\x00' + b'\0\0\0\0\0\0\xe0\x3f' + b'\3\0\0\0ab\0' + b'\0'
    data += b'\2\0\0\0\7\x08'
    path = _bag_of_robot(tmp_path, storage, data)
    with open_bag(path) as bag:
        (message,) = bag.messages()
        assert message.message.left.length == 0.5
        assert message.message.left.name == 'ab'
        assert message.message.toes.tolist() == [7, 8]


def test_a_type_that_nobody_knows_is_told(tmp_path: Path) -> None:
    path = _bag_of_robot(tmp_path, 'sqlite3', b'\0\1\0\0')
    with sqlite3.connect(path) as database:
        database.execute('DELETE FROM message_definitions')
    with open_bag(path) as bag:
        (message,) = bag.messages()
        with pytest.raises(LabError, match='demo_msgs/msg/Robot is not installed here'):
            assert message.message


def test_bytes_that_are_no_message_are_told(tmp_path: Path) -> None:
    broken = ('/chatter', 0, b'\0\1\0\0\xff\xff\xff\x00abc')
    path = made.make_mcap(tmp_path / 'drive', [broken])
    with open_bag(path) as bag:
        (message,) = bag.messages()
        with pytest.raises(LabError, match='are no message of std_msgs/msg/String'):
            assert message.message


# A type without a size, in pairs of pairs of pairs.
LEVELS = [f'Level{n}[2] pair\n' for n in range(1, 61)]
DOUBLED = LEVELS[0] + ''.join(
    f'{"=" * 80}\nMSG: demo_msgs/Level{n}\n{text}'
    for n, text in enumerate([*LEVELS[1:], 'uint8[0] nothing\n'], start=1)
)


@pytest.mark.parametrize('definition', ['string[400000000000] many\n', DOUBLED])
def test_a_definition_of_more_than_there_is_takes_no_time(tmp_path: Path, definition: str) -> None:
    path = _bag_of_robot(tmp_path, 'mcap', b'\0\1\0\0' + bytes(64), definition)
    with open_bag(path) as bag:
        (message,) = bag.messages()
        with pytest.raises(LabError, match='a message has at least'):
            assert message.message


def _bag_of_robot(folder: Path, storage: str, data: bytes, text: str = PLAIN + NESTED) -> Path:
    """Return a file with one message of a type that is not installed."""
    kind = 'demo_msgs/msg/Robot'
    if storage == 'mcap':
        path = folder / 'robot.mcap'
        with open(path, 'wb') as file:
            writer = Writer(file)
            writer.start('ros2', 'made by hand')
            schema = writer.register_schema(kind, 'ros2msg', text.encode())
            channel = writer.register_channel('/robot', 'cdr', schema)
            writer.add_message(channel, START_NS, data, START_NS)
            writer.finish()
        return path
    made.make_sqlite(folder / 'robot', [('/count', 0, data)])
    path = folder / 'robot' / 'robot_0.db3'
    with sqlite3.connect(path) as database:
        database.execute('UPDATE topics SET type = ? WHERE name = "/count"', [kind])
        database.execute(
            'UPDATE message_definitions SET topic_type = ?, encoded_message_definition = ? '
            'WHERE topic_type = "std_msgs/msg/Int16"',
            (kind, text),
        )
    return path


@pytest.mark.parametrize('maker', ['mcap', 'mcap, zstd', 'mcap without chunks', 'sqlite3'])
def test_a_large_bag_is_not_read_into_memory(tmp_path: Path, maker: str) -> None:
    size, count = 100_000, 400
    large = [('/chatter', number * 10**6, bytes(size)) for number in range(count)]
    if maker == 'sqlite3':
        path = made.make_sqlite(tmp_path / 'drive', large)
    else:
        path = made.make_mcap(
            tmp_path / 'drive',
            large,
            chunk_size=1 << 20,
            use_chunking='without' not in maker,
            compression=CompressionType.ZSTD if 'zstd' in maker else CompressionType.NONE,
        )
    del large
    tracemalloc.start()
    try:
        with open_bag(path) as bag:
            assert sum(len(each.data) for each in bag.messages()) == size * count
            assert len(bag.stamps('/chatter')) == count
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < size * count / 4
