"""`ros2 bag convert`: another storage, merged, split, with fewer topics."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader

from labkit.bags.reader import open_bag
from labkit.ros2 import shell
from tests.bags import made
from tests.bags.made import START_NS, Stored

pytestmark = pytest.mark.usefixtures('home')


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in an empty folder."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def messages() -> list[Stored]:
    """Return messages of two topics, in order of time."""
    return [
        ('/count', n * 10**8, made.int16(n))
        if n % 4 == 3
        else ('/chatter', n * 10**8, made.string(f'hello {n}'))
        for n in range(100)
    ]


def convert(text: str, *inputs: Path) -> int:
    """Convert bags with the options of a YAML file."""
    Path('out.yaml').write_text(text)
    words = [word for path in inputs for word in ('-i', str(path))]
    return shell.execute(['bag', 'convert', *words, '-o', 'out.yaml'])


def read(path: str) -> list[Stored]:
    """Return the messages of a bag."""
    with open_bag(path) as bag:
        return [(each.topic, each.stamp_ns - START_NS, each.data) for each in bag.messages()]


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize('maker', [made.make_mcap, made.make_sqlite])
def test_a_bag_in_another_storage(
    maker: made.Maker, storage: str, messages: list[Stored], capsys: pytest.CaptureFixture[str]
) -> None:
    source = maker(Path('drive'), messages)
    assert convert(f'output_bags: [{{uri: copy, storage_id: {storage}, all: true}}]', source) == 0
    assert capsys.readouterr().out == 'copy: 100 messages\n'
    assert read('copy') == messages
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
    even = made.make_mcap(Path('even'), messages[::2])
    odd = made.make_sqlite(Path('odd'), messages[1::2])
    text = """
output_bags:
- {uri: all, all_topics: true, max_bagfile_duration: 2, compression_mode: ""}
- {uri: chatter, topics: [/chatter]}
- {uri: rest, regex: count}
"""
    assert convert(text, even, odd) == 0
    assert read('all') == messages
    assert len(list(Path('all').glob('*.mcap'))) == 5
    assert read('chatter') == [each for each in messages if each[0] == '/chatter']
    assert read('rest') == [each for each in messages if each[0] == '/count']


def test_an_unfinished_bag_is_made_whole(messages: list[Stored]) -> None:
    path = made.make_mcap(Path('drive'), messages)
    (path / 'metadata.yaml').unlink()
    file = path / 'drive_0.mcap'
    file.write_bytes(file.read_bytes()[:3000])
    assert convert('output_bags: [{uri: copy, all: true}]', path) == 0
    with open_bag('copy') as bag:
        assert bag.note == ''
    found = read('copy')
    assert 0 < len(found) < 100 and found == messages[: len(found)]


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('output_bags: [{uri: copy}]', 'chooses no topics'),
        ('output_bags: [{uri: copy, topics: [/chater]}]', 'topics: [/chatter, /count]'),
        ('output_bags: [{uri: copy, topics: 5}]', "Did you mean 'topics' (list)?"),
        ('output_bags: [{uri: copy, all_topic: true}]', "Did you mean 'all_topics' (bool)?"),
        ('output_bags: [{uri: c, all: true, compression_mode: file}]', 'without compression'),
        ('output_bags: [{uri: copy, all: true, storage_id: mcp}]', "Did you mean 'mcap'"),
        ('output_bags: [{uri: drive, all: true}]', 'already exists'),
        ('output_bags: [{all: true}]', 'lists no output bags with a uri'),
        ('', 'lists no output bags'),
        ('output_bags: 5', 'lists no output bags'),
        ('output_bags: []', 'lists no output bags'),
        ('{', 'lists no output bags'),
        ('[1]', 'lists no output bags'),
    ],
)
def test_what_is_wrong_is_told(
    text: str, words: str, messages: list[Stored], capsys: pytest.CaptureFixture[str]
) -> None:
    path = made.make_mcap(Path('drive'), messages)
    assert convert(text, path) == 1
    assert words in capsys.readouterr().err
    assert read('drive') == messages
    assert sorted(each.name for each in Path().iterdir()) == ['drive', 'out.yaml']
