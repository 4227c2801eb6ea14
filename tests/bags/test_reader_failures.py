"""What is no bag, or no whole one: one clear sentence, or what can be read of it."""

from __future__ import annotations

import json
import os
import random
import re
import shutil
import sqlite3
from pathlib import Path

import lz4.frame  # type: ignore[import-untyped]
import pytest
import yaml
import zstandard
from mcap.records import Chunk
from mcap.writer import CompressionType
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from labkit.bags import unpacking
from labkit.bags.info import describe, topic_names
from labkit.bags.reader import open_bag
from labkit.errors import LabError
from tests.bags import made
from tests.bags.made import START_NS, Stored

# What each compressed chunk begins with.
ZSTD = b'\x28\xb5\x2f\xfd'
# Whole numbers of metadata.yaml that say when and how much.
KEYS = ('nanoseconds', 'nanoseconds_since_epoch', 'message_count')


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
    os.mkfifo(tmp_path / 'pipe.mcap')
    said = complaint(tmp_path / 'pipe.mcap').message
    assert said.endswith('is no bag: it is neither a folder nor a regular file.')


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


@pytest.mark.parametrize(
    ('content', 'what', 'todo'),
    [
        (b'version https://git-lfs.github.com/spec/v1\noid sha256:0', 'Git LFS', 'git lfs pull'),
        (b'\n<!DOCTYPE html><html>', 'is a web page', 'Download the file itself'),
    ],
)
def test_what_lies_in_the_place_of_a_file_is_told(
    tmp_path: Path, messages: list[Stored], content: bytes, what: str, todo: str
) -> None:
    for maker, file in ((made.make_mcap, 'a_0.mcap'), (made.make_sqlite, 'b_0.db3')):
        path = maker(tmp_path / file[0], messages)
        (path / file).write_bytes(content)
        error = complaint(path)
        assert what in error.message and todo in error.todo


def test_a_file_that_was_renamed_is_read(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages)
    (path / 'drive_0.mcap').rename(path / 'my drive.mcap')
    with open_bag(path) as bag:
        assert 'names other files' in bag.note
        assert len(list(bag.messages())) == bag.message_count == 100


def test_an_sqlite3_file_of_something_else(tmp_path: Path) -> None:
    database = sqlite3.connect(tmp_path / 'drive_0.db3')
    database.execute('CREATE TABLE cats(name TEXT)')
    database.commit()
    database.close()
    assert 'is no sqlite3 file of rosbag2' in complaint(tmp_path).message


def test_a_file_that_is_missing(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages, files=3)
    (path / 'drive_1.mcap').unlink()
    error = complaint(path)
    assert 'lacks drive_1.mcap, which its metadata.yaml names' in error.message
    assert 'Maybe the folder was not copied whole' in error.todo


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


@pytest.mark.parametrize(
    ('key', 'number'),
    [
        ('message_count', '-5'),
        *((key, number) for key in KEYS for number in ('9' * 400, '9' * 5000, '.inf', 'x', '[]')),
    ],
)
def test_numbers_that_metadata_can_not_have(
    tmp_path: Path, messages: list[Stored], key: str, number: str
) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages)
    text = (path / 'metadata.yaml').read_text()
    changed = re.sub(rf'(\b{key}: *)\d+', rf'\g<1>{number}', text)
    assert changed != text
    (path / 'metadata.yaml').write_text(changed)
    with open_bag(path) as bag:
        assert bag.note.startswith('Its metadata.yaml can not be understood')
        assert bag.message_count == 100 and describe(bag)


def test_metadata_that_is_nested_too_deep(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages)
    (path / 'metadata.yaml').write_text('[' * 100_000 + ']' * 100_000)
    with open_bag(path) as bag:
        assert bag.note.startswith('Its metadata.yaml can not be understood')


@pytest.mark.parametrize('name', ['/a\udcff', '/a\0b', '/a\x1b[31m'])
def test_a_name_of_a_bag_can_not_move_the_cursor(tmp_path: Path, name: str) -> None:
    path = made.make_mcap(tmp_path / 'drive', [('/count', 0, made.int16(5))])
    text = (path / 'metadata.yaml').read_text()
    assert 'name: /count' in text
    (path / 'metadata.yaml').write_text(text.replace('name: /count', f'name: {json.dumps(name)}'))
    with open_bag(path) as bag:
        assert name in [topic.name for topic in bag.topics]
        shown = [*describe(bag).split('\n'), *topic_names(bag)]
        assert all(line.isprintable() for line in shown)


def test_a_name_with_a_bad_byte_in_sqlite(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_sqlite(tmp_path / 'drive', messages)
    (path / 'metadata.yaml').unlink()
    with sqlite3.connect(path / 'drive_0.db3') as database:
        database.execute("UPDATE topics SET name = CAST(X'2F61FF' AS TEXT) WHERE name = '/count'")
    database.close()
    with open_bag(path) as bag:
        assert '/a\ufffd' in [topic.name for topic in bag.topics]
        assert len(list(bag.messages())) == 100


def test_a_name_with_a_bad_byte_in_mcap(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages, enable_crcs=False) / 'drive_0.mcap'
    path.write_bytes(path.read_bytes().replace(b'/count', b'/co\xffnt'))
    with open_bag(path) as bag:
        assert bag.note == ('drive_0.mcap has a name that is no UTF-8; it is read up to there.')


@pytest.mark.parametrize('maker', [made.make_mcap, made.make_sqlite])
def test_a_bag_without_metadata(tmp_path: Path, messages: list[Stored], maker: made.Maker) -> None:
    path = maker(tmp_path / 'drive', messages)
    (path / 'metadata.yaml').unlink()
    with open_bag(path) as bag:
        assert bag.note.startswith('It is not complete (metadata.yaml is missing)')
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
                assert 'is not complete; it is read as far as it goes' in bag.note
        before = len(found)
    assert before == 100


def test_a_finished_bag_whose_file_was_cut_off(tmp_path: Path, messages: list[Stored]) -> None:
    path = made.make_mcap(tmp_path / 'drive', messages)
    file = path / 'drive_0.mcap'
    file.write_bytes(file.read_bytes()[:4000])
    with open_bag(path) as bag:
        count = len(list(bag.messages()))
        assert 0 < count == bag.message_count < 100
        assert bag.note == 'drive_0.mcap is not complete; it is read as far as it goes.'


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


@pytest.mark.parametrize('compression', [CompressionType.ZSTD, CompressionType.LZ4])
@pytest.mark.parametrize('whole', [True, False])
def test_a_chunk_that_unpacks_to_very_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compression: CompressionType, whole: bool
) -> None:
    path = made.make_mcap(
        tmp_path / 'a', [('/chatter', 0, bytes(1 << 20))], compression=compression
    )
    file = path / 'a_0.mcap'
    assert file.stat().st_size < 10_000
    monkeypatch.setattr(unpacking, 'MOST_BYTES', 1 << 19)
    if whole:
        assert 'is larger than 0 MB when it is unpacked' in complaint(path).message
        return
    file.write_bytes(file.read_bytes()[:-100])
    with open_bag(path) as bag:  # to find out what it holds, it is unpacked
        assert 'read as far as it goes' in bag.note
        assert not bag.message_count


@pytest.mark.parametrize('mode', [CompressionMode.MESSAGE, CompressionMode.FILE])
def test_a_bag_that_unpacks_to_very_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mode: CompressionMode
) -> None:
    writer = Writer(tmp_path / 'a', version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        kind = made.TYPES['/chatter']
        topic = writer.add_connection('/a', kind, msgdef=made.DEFINITIONS[kind], rihs01='RIHS01_0')
        writer.write(topic, 0, bytes(1 << 20))
    if mode is CompressionMode.MESSAGE:
        monkeypatch.setattr(unpacking, 'MOST_BYTES', 1 << 19)
        reason = 'is larger than 0 MB when it is unpacked'
    else:
        usage = shutil.disk_usage(tmp_path)._replace(free=1 << 19)
        monkeypatch.setattr(shutil, 'disk_usage', lambda _: usage)
        reason = 'there is no room for it in'
    assert reason in complaint(tmp_path / 'a').message


@pytest.mark.parametrize('end', [0, 1, 5, 3000])
def test_a_message_that_was_cut_off_is_damaged(end: int) -> None:
    packed = zstandard.compress(random.Random(1).randbytes(5000))
    assert len(unpacking.unpacked(packed)) == 5000
    with pytest.raises(ValueError, match=r'cut off|not enough data'):
        unpacking.unpacked(packed[:end])


def test_an_lz4_chunk_that_was_cut_off_is_damaged() -> None:
    packed = lz4.frame.compress(random.Random(1).randbytes(5000))
    assert len(unpacking.unpacked_chunk(Chunk('lz4', packed, 0, 0, 0, 5000)).data) == 5000
    with pytest.raises(ValueError, match='cut off'):
        unpacking.unpacked_chunk(Chunk('lz4', packed[:3000], 0, 0, 0, 5000))


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
