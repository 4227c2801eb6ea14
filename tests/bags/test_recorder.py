"""A recording: what it takes, when it ends, what it says."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int16, String

import labkit as lab
from labkit.background.runtime import runtime
from labkit.bags import recorder
from labkit.bags.reader import open_bag
from labkit.bags.writer import BagWriter
from labkit.errors import LabError, LabTimeout

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
HASTY = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)

pytestmark = pytest.mark.usefixtures('home')


@pytest.fixture
def talker() -> Iterator[Node]:
    """Give a node."""
    lab.start()
    yield lab.spin(Node('talker'))


def contents(path: str = 'drive') -> dict[str, list[Any]]:
    """Return what a bag holds, by topic."""
    with open_bag(path) as bag:
        found: dict[str, list[Any]] = {topic.name: [] for topic in bag.topics}
        for message in bag.messages():
            found[message.topic].append(message.message.data)
        assert bag.note == ''
    return found


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_what_is_published_is_recorded(talker: Node, storage: str) -> None:
    publisher = talker.create_publisher(String, '/chatter', 10)
    with lab.record('drive', '/chatter', storage=storage) as recording:
        for number in range(8):
            publisher.publish(String(data=str(number)))
        recording.wait_for(8, '/chatter', timeout_sec=30)
        assert recording.counts == {'/chatter': 8}
        assert repr(recording) == 'Recording drive: 8 messages: /chatter (8)'
    assert (recording.done, recording.lost, recording.error) == (True, 0, None)
    assert repr(recording) == 'Recorded drive: 8 messages: /chatter (8)'
    assert contents() == {'/chatter': [str(number) for number in range(8)]}
    with open_bag('drive') as bag:
        assert bag.storage == storage
        assert bag.topics[0].type_hash.startswith('RIHS01_df66')
        assert 'string data' in bag.topics[0].definition
        stamps = [each.stamp_ns for each in bag.messages()]
    assert stamps == sorted(stamps) and stamps[0] > 1.7e18


def test_all_topics_are_recorded_but_hidden_ones(talker: Node) -> None:
    for name in ('/chatter', '/_secret', '/part/_hidden'):
        talker.create_publisher(String, name, 10)
    talker.create_subscription(String, '/nobody_publishes', print, 10)
    with lab.record('drive') as recording:
        assert set(recording.counts) == {'/chatter', '/parameter_events', '/rosout'}
    with lab.record('named', ['_secret', 'chatter']) as recording:
        assert set(recording.counts) == {'/chatter', '/_secret'}


@pytest.mark.parametrize(
    ('choice', 'names'),
    [
        ({'regex': '^/robot/.*'}, {'/robot/odom', '/robot/scan'}),
        ({'regex': 'odom'}, {'/odom', '/robot/odom'}),
        ({'topics': ['/scan'], 'regex': '/odom$'}, {'/odom', '/robot/odom', '/scan'}),
        ({'exclude': ['rosout', 'events', 'robot']}, {'/odom', '/scan'}),
        ({'topics': {'/odom', '/scan'}, 'exclude': 'sc.n'}, {'/odom'}),
    ],
)
def test_topics_are_chosen(talker: Node, choice: dict[str, Any], names: set[str]) -> None:
    for name in ('/odom', '/scan', '/robot/odom', '/robot/scan'):
        talker.create_publisher(String, name, 10)
    with lab.record('drive', **choice) as recording:
        assert set(recording.counts) == names


def test_a_topic_that_appears_later_is_recorded(talker: Node) -> None:
    with lab.record('drive', ['/chatter', '/count']) as recording:
        assert recording.counts == {}
        publisher = talker.create_publisher(Int16, '/count', LATCHED)
        publisher.publish(Int16(data=7))
        recording.wait_for(1, 'count', timeout_sec=30)
    assert contents() == {'/count': [7]}


def test_profiles_are_adapted_and_kept(talker: Node) -> None:
    latched = talker.create_publisher(String, '/map', LATCHED)
    latched.publish(String(data='before'))
    talker.create_publisher(String, '/scan', HASTY)
    talker.create_publisher(String, '/mixed', HASTY)
    talker.create_publisher(String, '/mixed', LATCHED)
    with lab.record('drive', ['/map', '/scan', '/mixed']) as recording:
        # A late joiner hears what was published before.
        recording.wait_for(1, '/map', timeout_sec=30)
        assert [text for text in recording.warnings if 'RELIABILITY' in text.upper()]
    with open_bag('drive') as bag:
        (of_map,) = bag.topic('/map').qos_profiles
        (of_scan,) = bag.topic('/scan').qos_profiles
        assert len(bag.topic('/mixed').qos_profiles) == 2
    assert of_map.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert of_scan.reliability == ReliabilityPolicy.BEST_EFFORT


def test_a_publisher_that_offers_less_and_comes_later_is_heard(talker: Node) -> None:
    talker.create_publisher(String, '/scan', 10)
    with lab.record('drive', '/scan') as recording:
        hasty = talker.create_publisher(String, '/scan', HASTY)
        lab.wait_until(lambda: hasty.get_subscription_count() == 1, timeout_sec=30)
        hasty.publish(String(data='hasty'))
        recording.wait_for(1, timeout_sec=30)
    assert contents() == {'/scan': ['hasty']}


def test_it_ends_after_a_count(talker: Node) -> None:
    publisher = talker.create_publisher(String, '/chatter', 10)
    talker.create_timer(0.002, lambda: publisher.publish(String(data='hi')))
    recording = lab.record('drive', '/chatter', count=5)
    lab.wait_until(lambda: recording.done, timeout_sec=30)
    assert recording.counts == {'/chatter': 5}
    assert contents() == {'/chatter': ['hi'] * 5}
    assert '/rosbag2_recorder' not in [entry.name for entry in runtime.nodes()]


def test_it_ends_after_a_time(talker: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    passed = 0.0
    clock = SimpleNamespace(monotonic=lambda: passed, time_ns=time.time_ns)
    monkeypatch.setattr(recorder, 'time', clock)
    publisher = talker.create_publisher(String, '/chatter', 10)
    recording = lab.record('drive', '/chatter', max_duration_sec=0.3)
    for count, passed_then in enumerate((0.0, 0.29), start=1):
        passed = passed_then
        publisher.publish(String(data='hi'))
        recording.wait_for(count, timeout_sec=30)
    passed = 0.3
    lab.wait_until(lambda: recording.done, timeout_sec=30)
    assert contents() == {'/chatter': ['hi', 'hi']}


@pytest.mark.parametrize(
    'end',
    [lab.stop, lambda: lab.remove('rosbag2_recorder')],
    ids=['lab.stop', 'lab.remove'],
)
def test_it_ends_with_its_node(talker: Node, end: Callable[[], None]) -> None:
    publisher = talker.create_publisher(String, '/chatter', 10)
    recording = lab.record('drive', '/chatter')
    publisher.publish(String(data='hi'))
    recording.wait_for(1, timeout_sec=30)
    end()
    assert recording.done
    assert contents() == {'/chatter': ['hi']}
    recording.stop()  # without effect


def test_it_ends_with_its_script(script: Callable[..., Any], home: Path) -> None:
    done = script(SCRIPT + 'recording.wait_for(3, timeout_sec=30)\n')
    assert (done.exit_code, done.stderr) == (0, '')
    assert len(contents(str(home / 'drive'))['/chatter']) >= 3


SCRIPT = """
import labkit as lab
lab.start()
from rclpy.node import Node
from std_msgs.msg import String

talker = lab.spin(Node('talker'))
publisher = talker.create_publisher(String, '/chatter', 10)
talker.create_timer(0.002, lambda: publisher.publish(String(data='x' * 100)))
recording = lab.record('drive', '/chatter')
"""


def test_two_go_on_at_once(talker: Node) -> None:
    publisher = talker.create_publisher(String, '/chatter', 10)
    with lab.record('one', '/chatter') as one, lab.record('two', '/chatter') as two:
        publisher.publish(String(data='hi'))
        one.wait_for(1, timeout_sec=30)
        two.wait_for(1, timeout_sec=30)
        names = {entry.name for entry in runtime.nodes()}
        assert {'/rosbag2_recorder', '/rosbag2_recorder_2'} <= names
        with pytest.raises(LabError, match="'two' is being recorded just now"):
            lab.record('./two', overwrite=True)
    assert contents('one') == contents('two') == {'/chatter': ['hi']}


def test_a_cell_that_is_run_again_ends_its_earlier_recording(kernel: Any) -> None:
    kernel.run(SCRIPT.replace('recording =', 'first ='), cell_id='other')
    code = "recording = lab.record('again', '/chatter', overwrite=True)\nrecording.wait_for(5)"
    for _ in range(3):
        result = kernel.run(f'earlier = globals().get("recording")\n{code}', cell_id='mine')
        assert not result.error, result.traceback
    assert kernel.run('print(earlier.done, recording.done, first.done)').text == (
        'True False False\n'
    )
    again = kernel.run("lab.record('again', '/chatter')")
    assert again.error.startswith('LabError: ')


def test_a_folder_that_is_there_is_refused(talker: Node) -> None:
    lab.record('drive', '/chatter').stop()
    with pytest.raises(LabError, match='already exists'):
        lab.record('drive')
    lab.record('drive', '/chatter', overwrite=True).stop()
    assert '/rosbag2_recorder' not in [entry.name for entry in runtime.nodes()]


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'regex': '['}, 'is no regular expression'),
        ({'topics': 5}, 'topics must be a name'),
        ({'topics': 'two words'}, 'two words'),
        ({'storage': 'mcp'}, "Did you mean 'mcap'"),
        ({'count': 0}, 'count must be'),
        ({'max_duration_sec': -1}, 'max_duration_sec must be'),
    ],
)
def test_wrong_arguments_are_told(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(LabError, match=words):
        lab.record('drive', **arguments)
    assert not Path('drive').exists()


@pytest.mark.slow('waits for messages that do not come')
def test_why_nothing_comes_is_told(talker: Node) -> None:
    publisher = talker.create_publisher(String, '/chatter', 10)
    other = Node('other')
    with lab.record('drive', ['/chatter', '/chattr']) as recording:
        with pytest.raises(LabTimeout, match='None of 2 messages of /chatter'):
            recording.wait_for(2, '/chatter', timeout_sec=0)
        publisher.publish(String(data='hi'))
        recording.wait_for(1, timeout_sec=30)
        with pytest.raises(LabTimeout, match='1 of 2 messages came'):
            recording.wait_for(2, timeout_sec=0)
        with pytest.raises(LabTimeout, match='Nobody publishes'):
            recording.wait_for(1, '/chattr', timeout_sec=0)
        with pytest.raises(LabTimeout, match='not among the chosen topics'):
            recording.wait_for(1, '/elsewhere', timeout_sec=0)
    other.destroy_node()  # type: ignore[no-untyped-call]


def test_messages_that_a_slow_disk_can_not_take_are_counted(
    talker: Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    go_on = threading.Event()
    original = BagWriter.write

    def slow(self: BagWriter, messages: Any) -> None:
        go_on.wait(60)
        original(self, messages)

    monkeypatch.setattr(BagWriter, 'write', slow)
    monkeypatch.setattr(recorder, 'CACHE_BYTES', 0)
    publisher = talker.create_publisher(String, '/chatter', 2000)
    writer = BagWriter(Path('drive'))
    choice = recorder.choose(talker, '/chatter')
    with recorder.start_recording(writer, choice, cache_bytes=100_000) as recording:
        lab.wait_for_subscribers(publisher, timeout_sec=30)
        for _ in range(300):
            publisher.publish(String(data='x' * 1000))
        lab.wait_until(lambda: recording.count + recording.lost == 300, timeout_sec=30)
        assert recording.lost > 0
        assert 'lost' in repr(recording)
        go_on.set()
    assert len(contents()['/chatter']) == recording.count == 300 - recording.lost
    # What waits is bounded: so many messages of that size, and the one that is too many.
    assert recording.count <= 100_000 / 1000 + 1
