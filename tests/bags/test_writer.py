"""Bags that are written here open elsewhere: readers that know nothing of labkit read them."""

from __future__ import annotations

import errno
import os
import sqlite3
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from labkit.bags.metadata import profiles_from, profiles_to_text
from labkit.bags.reader import open_bag
from labkit.bags.schemas import ENCODING, full_definition
from labkit.bags.writer import BagWriter
from labkit.errors import LabError
from tests.bags.made import START_NS, Stored, string

SCAN = LaserScan(ranges=[1.0, 2.5], angle_max=3.0)
SCAN.header.frame_id = 'laser'
TYPES = {'/chatter': 'std_msgs/msg/String', '/scan': 'sensor_msgs/msg/LaserScan'}
# As rosbags computes them, which compares them with the definitions that it finds.
HASHES = {name: get_typestore(Stores.ROS2_JAZZY).hash_rihs01(TYPES[name]) for name in TYPES}
PROFILE = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
STORAGES = pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])


def write(path: Path, storage: str, messages: Sequence[Stored], **options: float) -> Path:
    """Write a bag, some messages at a time."""
    writer = BagWriter(path, storage, **options)  # type: ignore[arg-type]
    numbers = {
        name: writer.add_topic(
            *(name, kind),
            qos=profiles_to_text([PROFILE]),
            definition=full_definition(kind),
            encoding=ENCODING,
            type_hash=HASHES[name],
        )
        for name, kind in TYPES.items()
    }
    for begin in range(0, len(messages), 7):
        writer.write(
            [
                (numbers[topic], START_NS + after, 0, data)
                for topic, after, data in messages[begin : begin + 7]
            ]
        )
    writer.close()
    return path


@pytest.fixture
def drive() -> list[Stored]:
    """Give messages of two topics."""
    scan = bytes(serialize_message(SCAN))
    return [
        ('/scan', number * 10**7, scan)
        if number % 5 == 0
        else ('/chatter', number * 10**7, string(f'hello {number}'))
        for number in range(500)
    ]


def test_the_library_of_mcap_decodes_all_of_it(tmp_path: Path, drive: list[Stored]) -> None:
    path = write(tmp_path / 'drive', 'mcap', drive)
    with open(path / 'drive_0.mcap', 'rb') as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == 'ros2'
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == 500
        assert summary.statistics.message_start_time == START_NS
        found = []
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema is not None and schema.name == TYPES[channel.topic]
            assert profiles_from(channel.metadata['offered_qos_profiles'])[0].depth == 5
            assert channel.metadata['topic_type_hash'] == HASHES[channel.topic]
            found.append((channel.topic, message.log_time - START_NS, message.data))
            if channel.topic == '/scan':
                assert list(decoded.ranges) == [1.0, 2.5]
                assert decoded.header.frame_id == 'laser'
        assert found == drive
        (extra,) = reader.iter_metadata()
        assert yaml.safe_load(extra.metadata['serialized_metadata'])
        # Messages of one topic in a span of time are found by the index.
        some = reader.iter_messages(topics=['/scan'], starting_at=START_NS + 10**9)
        assert len(list(some)) == 80


@STORAGES
def test_rosbags_decodes_all_of_it(tmp_path: Path, storage: str, drive: list[Stored]) -> None:
    path = write(tmp_path / 'drive', storage, drive)
    with AnyReader([path]) as reader:
        found = []
        for connection, stamp, data in reader.messages():
            found.append((connection.topic, stamp - START_NS, bytes(data)))
            if connection.topic == '/scan':
                message = reader.deserialize(data, connection.msgtype)
                assert message.ranges.tolist() == [1.0, 2.5]  # type: ignore[attr-defined]
        assert found == drive
        assert {each.topic: each.msgcount for each in reader.connections} == {
            '/chatter': 400,
            '/scan': 100,
        }
        (qos,) = reader.connections[0].ext.offered_qos_profiles
        assert (qos.depth, qos.durability.name) == (5, 'TRANSIENT_LOCAL')
        assert {each.digest for each in reader.connections} == {*HASHES.values()}


def test_plain_sqlite3_reads_it(tmp_path: Path, drive: list[Stored]) -> None:
    path = write(tmp_path / 'drive', 'sqlite3', drive)
    assert sorted(file.name for file in path.iterdir()) == ['drive_0.db3', 'metadata.yaml']
    with closing(sqlite3.connect(path / 'drive_0.db3')) as database:
        rows = database.execute(
            'SELECT topics.name, timestamp, data FROM messages JOIN topics '
            'ON topics.id = topic_id ORDER BY timestamp'
        ).fetchall()
        assert [(name, stamp - START_NS, data) for name, stamp, data in rows] == drive
        assert database.execute('SELECT schema_version FROM schema').fetchone() == (4,)
        definitions = dict(
            database.execute(
                'SELECT topic_type, encoded_message_definition FROM message_definitions'
            )
        )
        assert definitions.keys() == set(TYPES.values())
        assert 'MSG: builtin_interfaces/Time' in definitions['sensor_msgs/msg/LaserScan']


@STORAGES
def test_metadata_says_what_version_9_says(
    tmp_path: Path, storage: str, drive: list[Stored]
) -> None:
    path = write(tmp_path / 'drive', storage, drive)
    content = yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert content['version'] == 9
    assert content['storage_identifier'] == storage
    assert content['duration'] == {'nanoseconds': 499 * 10**7}
    assert content['starting_time'] == {'nanoseconds_since_epoch': START_NS}
    assert content['message_count'] == 500
    assert content['ros_distro'] == 'jazzy'
    (file,) = content['files']
    assert (
        content['relative_file_paths']
        == [file['path']]
        == ['drive_0.mcap' if storage == 'mcap' else 'drive_0.db3']
    )
    assert file['message_count'] == 500
    first = content['topics_with_message_count'][0]
    assert first['message_count'] == 400
    (qos,) = first['topic_metadata'].pop('offered_qos_profiles')
    assert (qos['history'], qos['depth'], qos['durability']) == (
        *('keep_last', 5, 'transient_local'),
    )
    assert first['topic_metadata'] == {
        'name': '/chatter',
        'type': 'std_msgs/msg/String',
        'serialization_format': 'cdr',
        'type_description_hash': HASHES['/chatter'],
    }


@STORAGES
@pytest.mark.parametrize('limit', [{'split_sec': 1.0}, {'split_bytes': 5000}])
def test_a_bag_is_split(
    tmp_path: Path, storage: str, drive: list[Stored], limit: dict[str, float]
) -> None:
    path = write(tmp_path / 'drive', storage, drive, **limit)
    with open_bag(path) as bag:
        found = [(each.topic, each.stamp_ns - START_NS, each.data) for each in bag.messages()]
        assert found == drive
        assert len(bag.files) >= 3
        each = yaml.safe_load((path / 'metadata.yaml').read_text())
    files = each['rosbag2_bagfile_information']['files']
    assert sum(file['message_count'] for file in files) == 500
    with AnyReader([path]) as reader:
        assert len(list(reader.messages())) == 500


@STORAGES
@settings(max_examples=15, deadline=None)
@given(
    found=st.lists(
        st.tuples(
            st.sampled_from(list(TYPES)), st.integers(0, 2**40), st.binary(min_size=4, max_size=40)
        ),
        max_size=40,
    ),
    split=st.sampled_from([0, 100]),
)
def test_what_is_written_is_read(
    tmp_path_factory: pytest.TempPathFactory, storage: str, found: list[Stored], split: int
) -> None:
    path = tmp_path_factory.mktemp('bags') / 'drive'
    write(path, storage, found, split_bytes=split)
    with open_bag(path) as bag:
        read = [(each.topic, each.stamp_ns - START_NS, each.data) for each in bag.messages()]
        assert bag.message_count == len(found)
        assert sorted(read) == sorted(found)
        assert [each[1] for each in read] == sorted(each[1] for each in found)


@STORAGES
def test_a_message_larger_than_a_chunk_is_written(tmp_path: Path, storage: str) -> None:
    large: list[Stored] = [('/chatter', number, bytes(2 << 20)) for number in range(3)]
    path = write(tmp_path / 'drive', storage, large)
    with open_bag(path) as bag:
        assert [len(each.data) for each in bag.messages()] == [2 << 20] * 3


@STORAGES
def test_what_was_flushed_is_read_before_the_end(tmp_path: Path, storage: str) -> None:
    writer = BagWriter(tmp_path / 'drive', storage)
    number = writer.add_topic(
        *('/chatter', 'std_msgs/msg/String'), qos='', definition='string data', encoding=ENCODING
    )
    writer.write([(number, START_NS, 0, string('one'))])
    writer.flush()
    with open_bag(tmp_path / 'drive') as bag:
        assert [each.message for each in bag.messages()] == [String(data='one')]
        assert 'It is not complete' in bag.note
    writer.close()
    with open_bag(tmp_path / 'drive') as bag:
        assert (bag.note, bag.message_count) == ('', 1)


def test_a_folder_that_is_there_is_refused(tmp_path: Path, drive: list[Stored]) -> None:
    path = write(tmp_path / 'drive', 'mcap', drive)
    before = (path / 'drive_0.mcap').read_bytes()
    with pytest.raises(LabError, match=r"(?s)Output folder '.*drive' already exists.*overwrite"):
        BagWriter(path)
    assert (path / 'drive_0.mcap').read_bytes() == before
    write(path, 'sqlite3', drive[:10], overwrite=True)
    assert sorted(file.name for file in path.iterdir()) == ['drive_0.db3', 'metadata.yaml']


def test_only_a_bag_is_replaced(tmp_path: Path) -> None:
    (tmp_path / 'work').mkdir()
    (tmp_path / 'work' / 'thesis.txt').write_text('all of it')
    with pytest.raises(LabError, match=r"holds 'thesis\.txt', too"):
        BagWriter(tmp_path / 'work', overwrite=True)
    (tmp_path / 'link').symlink_to(tmp_path / 'work')
    (tmp_path / 'file').write_text('hello')
    for name in ('link', 'file'):
        with pytest.raises(LabError, match='is no folder'):
            BagWriter(tmp_path / name, overwrite=True)
    assert (tmp_path / 'work' / 'thesis.txt').read_text() == 'all of it'


def test_folders_in_a_bag_are_not_removed_with_it(tmp_path: Path, drive: list[Stored]) -> None:
    path = write(tmp_path / 'drive', 'mcap', drive)
    (path / 'raw.mcap').mkdir()
    (path / 'raw.mcap' / 'thesis.txt').write_text('all of it')
    with pytest.raises(LabError, match=r"holds 'raw\.mcap', too"):
        BagWriter(path, overwrite=True)
    assert (path / 'raw.mcap' / 'thesis.txt').read_text() == 'all of it'


def test_a_bag_is_replaced_by_one_that_can_be_made(
    tmp_path: Path, drive: list[Stored], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(tmp_path / 'drive', 'mcap', drive)
    before = (path / 'drive_0.mcap').read_bytes()

    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(BagWriter, '_begin_file', refuse)
    with pytest.raises(LabError, match='can not be written: No space left'):
        BagWriter(path, overwrite=True)
    assert (path / 'drive_0.mcap').read_bytes() == before
    with pytest.raises(LabError, match='can not be written: No space left'):
        BagWriter(tmp_path / 'other')
    assert [folder.name for folder in tmp_path.iterdir()] == ['drive']


def test_a_folder_that_can_not_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / 'file').write_text('hello')
    with pytest.raises(LabError, match='can not be made'):
        BagWriter(tmp_path / 'file' / 'drive')


def test_a_storage_that_is_not_known_is_told(tmp_path: Path) -> None:
    with pytest.raises(LabError, match="Did you mean 'sqlite3'"):
        BagWriter(tmp_path / 'drive', 'sqlite')
    assert not (tmp_path / 'drive').exists()
