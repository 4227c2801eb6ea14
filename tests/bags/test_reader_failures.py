"""What is no bag, or no whole one: one clear sentence, or what can be read of it."""

from __future__ import annotations

import random
import sqlite3
from pathlib import Path

import pytest
import yaml
from mcap.writer import CompressionType

from labkit.bags.reader import open_bag
from labkit.errors import LabError
from tests.bags import made
from tests.bags.made import START_NS, Stored

# What each compressed chunk begins with.
ZSTD = b'\x28\xb5\x2f\xfd'


def complaint(path: Path) -> LabError:
    """Return what is said of a path, which must not be a traceback of something else."""
    with pytest.raises(LabError) as caught, open_bag(path) as bag:
        for _ in bag.messages():
            pass
    assert '\n' not in caught.value.message
    return caught.value


def test_a_bag_that_is_not_there(tmp_path: Path, messages: list[Stored]) -> None:
    made.make_mcap(tmp_path / 'drive', messages)
    error = complaint(tmp_path / 'drvie')
    assert error.message == f"There is no bag '{tmp_path / 'drvie'}'."
    assert error.todo == f"Did you mean '{tmp_path / 'drive'}'?"
    assert 'There are these bags: drive.' in complaint(tmp_path / 'walk').todo
    assert 'lab.record(' in complaint(tmp_path / 'nowhere' / 'walk').todo


def test_a_folder_that_is_no_bag(tmp_path: Path, messages: list[Stored]) -> None:
    assert 'the folder is empty' in complaint(tmp_path).message
    made.make_mcap(tmp_path / 'all' / 'drive', messages)
    assert str(tmp_path / 'all' / 'drive') in complaint(tmp_path / 'all').todo
    (tmp_path / 'other').mkdir()
    (tmp_path / 'other' / 'notes.txt').write_text('hello')
    assert 'holds no metadata.yaml' in complaint(tmp_path / 'other').message
    assert 'is no bag' in complaint(tmp_path / 'other' / 'notes.txt').message


@pytest.mark.parametrize('inside', [False, True])
def test_a_bag_of_ros_1(tmp_path: Path, inside: bool) -> None:
    file = tmp_path / 'old.bag'
    file.write_bytes(b'#ROSBAG V2.0\n' + bytes(100))
    error = complaint(tmp_path if inside else file)
    assert 'is a bag of ROS 1' in error.message
    assert f'rosbags-convert --src {file}' in error.todo


@pytest.mark.parametrize('name', ['drive_0.mcap', 'drive_0.db3'])
@pytest.mark.parametrize(
    ('content', 'words'), [(b'', 'is empty'), (b'nonsense' * 100, 'is no '), (b'x', 'is no ')]
)
def test_a_file_that_is_none(tmp_path: Path, name: str, content: bytes, words: str) -> None:
    (tmp_path / name).write_bytes(content)
    for path in (tmp_path, tmp_path / name):
        error = complaint(path)
        assert words in error.message and name in error.message
        assert error.todo


def test_an_sqlite3_file_of_something_else(tmp_path: Path) -> None:
    database = sqlite3.connect(tmp_path / 'drive_0.db3')
    database.execute('CREATE TABLE cats(name TEXT)')
    database.commit()
    database.close()
    assert 'is no sqlite3 file of rosbag2' in complaint(tmp_path).message


def test_a_file_that_is_missing(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages, files=3)
    (path / 'drive_1.mcap').unlink()
    assert 'lacks drive_1.mcap' in complaint(path).message


@pytest.mark.parametrize(
    ('key', 'value', 'words'),
    [
        ('storage_identifier', 'my_storage', "is stored as 'my_storage'"),
        ('version', 99, 'is of version 99'),
    ],
)
def test_a_bag_of_tomorrow(
    tmp_path: Path, messages: list[Stored], key: str, value: object, words: str
) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages)
    content = yaml.safe_load((path / 'metadata.yaml').read_text())
    content['rosbag2_bagfile_information'][key] = value
    (path / 'metadata.yaml').write_text(yaml.safe_dump(content))
    assert words in complaint(path).message


@pytest.mark.parametrize('text', ['', 'a: [', 'hello', 'rosbag2_bagfile_information: 1'])
@pytest.mark.parametrize('maker', [made.make_mcap, made.make_sqlite])
def test_metadata_that_can_not_be_understood(
    tmp_path: Path, messages: list[Stored], maker: made.Maker, text: str
) -> None:
    path = maker(tmp_path / 'drive', messages)
    (path / 'metadata.yaml').write_text(text)
    with open_bag(path) as bag:
        assert bag.note == (
            'Its metadata.yaml can not be understood; its files are read without it.'
        )
        assert len(list(bag.messages())) == bag.message_count == 100


@pytest.mark.parametrize('maker', [made.make_mcap, made.make_sqlite])
def test_a_bag_without_metadata(tmp_path: Path, messages: list[Stored], maker: made.Maker) -> None:
    path = maker(tmp_path / 'drive', messages)
    (path / 'metadata.yaml').unlink()
    with open_bag(path) as bag:
        assert bag.note.startswith('It was not finished (metadata.yaml is missing)')
        assert [topic.count for topic in bag.topics] == [75, 25]
        assert len(list(bag.messages())) == 100
        assert bag.topic('/count').qos_profiles[0].depth == 7
        assert bag.note in repr(bag)


@pytest.mark.parametrize('compression', [CompressionType.NONE, CompressionType.ZSTD])
@pytest.mark.parametrize('use_chunking', [True, False])
def test_a_file_that_was_cut_off_anywhere_is_read_as_far_as_it_goes(
    tmp_path: Path,
    messages: list[Stored],
    compression: CompressionType,
    use_chunking: bool,
) -> None:
    whole = made.make_mcap(
        tmp_path / 'whole', messages, compression=compression, use_chunking=use_chunking
    )
    content = (whole / 'whole_0.mcap').read_bytes()
    path = tmp_path / 'cut.mcap'
    before = 0
    for end in sorted({*random.Random(1).sample(range(40, len(content)), 60), len(content) - 1}):
        path.write_bytes(content[:end])
        with open_bag(path) as bag:
            found = [(m.topic, m.stamp_ns - START_NS, m.data) for m in bag.messages()]
            assert found == messages[: len(found)]
            assert len(found) == bag.message_count >= before
            if len(found) < 100:
                assert 'was not finished; it is read as far as it goes' in bag.note
        before = len(found)
    assert before == 100


def test_a_finished_bag_whose_file_was_cut_off(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages)
    file = path / 'drive_0.mcap'
    file.write_bytes(file.read_bytes()[:4000])
    with open_bag(path) as bag:
        count = len(list(bag.messages()))
        assert 0 < count == bag.message_count < 100
        assert bag.note == 'drive_0.mcap was not finished; it is read as far as it goes.'


@pytest.mark.parametrize('compression', [CompressionType.NONE, CompressionType.ZSTD])
def test_damage_is_told_where_it_is(
    tmp_path: Path, messages: list[Stored], compression: CompressionType
) -> None:
    path = made.make_mcap(
        tmp_path / 'drive', messages, compression=compression, chunk_size=500, enable_crcs=True
    )
    file = path / 'drive_0.mcap'
    content = bytearray(file.read_bytes())
    with open_bag(path) as bag:
        assert bag.message_count == 100
    mark = ZSTD if compression is CompressionType.ZSTD else b'hello'
    chunks = [place for place in range(len(content)) if content.startswith(mark, place)]
    place = chunks[len(chunks) // 2] + len(mark)
    content[place : place + 10] = bytes(10)
    file.write_bytes(content)
    error = complaint(path)
    assert f"'{path}' is damaged" in error.message
    with open_bag(path) as bag:
        seen = []
        with pytest.raises(LabError):
            for message in bag.messages():
                seen.append(message)
        assert 0 < len(seen) < 100


def test_a_damaged_sqlite3_file_is_told(tmp_path: Path) -> None:
    large = [('/chatter', number, bytes(3000)) for number in range(100)]
    path = made.make_sqlite(tmp_path / 'drive', large)
    file = path / 'drive_0.db3'
    content = bytearray(file.read_bytes())
    content[50_000:200_000] = b'\xff' * 150_000
    file.write_bytes(content)
    assert 'is damaged' in complaint(path).message


def test_two_kinds_of_files_without_metadata(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages)
    (path / 'metadata.yaml').unlink()
    (path / 'drive_0.db3').write_bytes(b'x')
    assert 'files of two kinds' in complaint(path).message


def test_an_empty_bag(tmp_path: Path) -> None:
    path = made.make_mcap(tmp_path / 'drive', [('/count', 0, made.int16(0))])
    empty = made.make_mcap(tmp_path / 'empty', [('/count', 0, made.int16(0))])
    (empty / 'empty_0.mcap').write_bytes((path / 'drive_0.mcap').read_bytes()[:40])
    (empty / 'metadata.yaml').unlink()
    with open_bag(empty) as bag:
        assert (bag.message_count, bag.start_ns, bag.end_ns, bag.topics) == (0, 0, 0, [])
        assert list(bag.messages()) == []
