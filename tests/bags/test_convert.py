"""Bags written anew: another storage, merged, split, with fewer topics."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mcap.writer import CompressionType
from rosbags.highlevel import AnyReader

from labkit.bags.choice import TopicChoice
from labkit.bags.convert import Output, convert, read_outputs
from labkit.bags.reader import open_bag
from labkit.errors import LabError
from tests.bags import made
from tests.bags.made import START_NS, Stored

pytestmark = pytest.mark.usefixtures('home')

# What each compressed chunk begins with.
ZSTD = b'\x28\xb5\x2f\xfd'


def read(path: str) -> list[Stored]:
    """Return the messages of a bag."""
    with open_bag(path) as bag:
        return [(each.topic, each.stamp_ns - START_NS, each.data) for each in bag.messages()]


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize('maker', [made.make_mcap, made.make_sqlite])
def test_a_bag_in_another_storage(maker: made.Maker, storage: str, messages: list[Stored]) -> None:
    source = maker(Path('drive'), messages)
    done: list[float] = []
    assert convert([source], [Output(Path('copy'), storage=storage)], done.append) == [100]
    assert read('copy') == messages
    assert done == sorted(done) and 0 <= done[0] <= done[-1] <= 1
    with open_bag('copy') as bag, open_bag(source) as old:
        assert bag.storage == storage
        for topic in bag.topics:
            before = old.topic(topic.name)
            assert topic.qos_profiles == before.qos_profiles
            assert (topic.definition, topic.encoding) == (before.definition, before.encoding)
            assert topic.type_hash == before.type_hash
    with AnyReader([Path('copy')]) as reader:
        assert reader.message_count == 100


def test_bags_are_merged_and_split(messages: list[Stored]) -> None:
    even, odd = (
        made.make_mcap(Path('even'), messages[::2]),
        made.make_sqlite(Path('odd'), messages[1::2]),
    )
    outputs = [
        Output(Path('all'), split_sec=2.0),
        Output(Path('chatter'), TopicChoice(False, {'/chatter'})),
        Output(Path('rest'), TopicChoice(exclude=['chat'])),
    ]
    assert convert([even, odd], outputs) == [100, 75, 25]
    assert read('all') == messages
    assert len(list(Path('all').glob('*.mcap'))) == 5
    assert read('chatter') == [each for each in messages if each[0] == '/chatter']
    assert read('rest') == [each for each in messages if each[0] == '/count']


def test_what_can_be_read_of_a_damaged_bag_is_kept(messages: list[Stored]) -> None:
    path = made.make_mcap(
        Path('drive'), messages, compression=CompressionType.ZSTD, chunk_size=500
    )
    content = bytearray((path / 'drive_0.mcap').read_bytes())
    chunks = [place for place in range(len(content)) if content.startswith(ZSTD, place)]
    content[chunks[5] + 12 : chunks[5] + 22] = bytes(10)
    (path / 'drive_0.mcap').write_bytes(content)
    with pytest.raises(LabError, match='is damaged'):
        convert([path], [Output(Path('copy'))])
    found = read('copy')
    assert 0 < len(found) < 100 and found == messages[: len(found)]


def test_an_unfinished_bag_is_made_whole(messages: list[Stored]) -> None:
    path = made.make_mcap(Path('drive'), messages)
    (path / 'metadata.yaml').unlink()
    file = path / 'drive_0.mcap'
    file.write_bytes(file.read_bytes()[:3000])
    (count,) = convert([path], [Output(Path('copy'))])
    with open_bag('copy') as bag:
        assert (bag.note, bag.message_count) == ('', count)
        assert 0 < count < 100


def test_an_output_that_is_there_is_refused(messages: list[Stored]) -> None:
    path = made.make_mcap(Path('drive'), messages)
    with pytest.raises(LabError, match='already exists'):
        convert([path], [Output(path)])
    assert read('drive') == messages


def outputs_of(text: str) -> list[Output]:
    """Return what is read from a file with options."""
    Path('out.yaml').write_text(text)
    return read_outputs(Path('out.yaml'))


def test_options_are_read() -> None:
    text = """
output_bags:
- uri: copy
  storage_id: sqlite3
  all_topics: true
  all_services: true
  compression_mode: ""
  max_bagfile_duration: 5
- {uri: split, topics: [/a, /b], exclude_regex: b, max_bagfile_size: 100}
"""
    copy, split = outputs_of(text)
    assert (copy.path, copy.storage, copy.split_sec) == (Path('copy'), 'sqlite3', 5.0)
    assert copy.choice.everything
    assert (split.path, split.storage, split.split_bytes) == (Path('split'), 'mcap', 100)
    taken = [name for name in ('/a', '/b', '/c') if split.choice.takes(name, 'a/msg/B')]
    assert taken == ['/a']


@pytest.mark.parametrize(
    ('entry', 'words'),
    [
        ({'uri': 'copy'}, 'chooses no topics'),
        ({'all_topics': True}, 'needs a name'),
        ({'uri': 'copy', 'all_topic': True}, "Did you mean 'all_topics'"),
        ({'uri': 'copy', 'all': True, 'compression_mode': 'file'}, "no option 'compression_mode'"),
        ({'uri': 'copy', 'all': True, 'storage_id': 'mcp'}, "Did you mean 'mcap'"),
    ],
)
def test_wrong_options_are_told(entry: dict[str, Any], words: str) -> None:
    with pytest.raises(LabError, match=words):
        outputs_of(f'output_bags: [{entry}]'.replace('True', 'true'))


@pytest.mark.parametrize('text', ['', 'output_bags: 5', '{', 'output_bags: []', '[1]'])
def test_a_file_without_outputs_is_told(text: str) -> None:
    with pytest.raises(LabError, match=r'(?s)output bag.*storage_id: sqlite3'):
        outputs_of(text)
    with pytest.raises(LabError, match='can not be read'):
        read_outputs(Path('nowhere.yaml'))
