"""A bag that is played back: a node can not tell it from what was there."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Int16, String

import labkit as lab
from labkit.background import domains
from labkit.background.runtime import runtime
from labkit.bags.player import Playing, offered_profile
from labkit.bags.reader import BagTopic, open_bag
from labkit.errors import LabError, LabTimeout
from labkit.rosgraph.endpoints import publishers
from tests.bags import made
from tests.bags.made import START_NS, Stored

# Deep enough that nothing is lost, however long the background does not come to it.
LATE = QoSProfile(
    depth=10_000,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class Hearer(Node):
    """Keeps what it hears on the topics of the bag."""

    def __init__(self, chatter: str = '/chatter') -> None:
        super().__init__('hearer')
        self.heard: list[str | int] = []
        self.clocks: list[int] = []
        self.create_subscription(String, chatter, self.on_message, LATE)
        self.create_subscription(Int16, '/count', self.on_message, LATE)
        self.create_subscription(Clock, '/clock', self.on_clock, 1000)

    def on_message(self, message: Any) -> None:
        self.heard.append(message.data)

    def on_clock(self, message: Clock) -> None:
        self.clocks.append(message.clock.sec * 10**9 + message.clock.nanosec)


@pytest.fixture(params=[made.make_mcap, made.make_sqlite], ids=['mcap', 'sqlite3'])
def drive(request: pytest.FixtureRequest, tmp_path: Path, messages: list[Stored]) -> Path:
    """Give a bag of a tenth of a second: its messages are a millisecond apart."""
    close = [(topic, after // 100, data) for topic, after, data in messages]
    path: Path = request.param(tmp_path / 'drive', close)
    return path


@pytest.fixture
def hearer() -> Hearer:
    """Give a node that listens."""
    lab.start()
    return lab.spin(Hearer())


ALL: list[str | int] = [n if n % 4 == 3 else f'hello {n}' for n in range(100)]


def in_order(heard: list[str | int]) -> list[str | int]:
    """Return what was heard, in order: messages of two topics may change places."""
    return sorted(heard, key=lambda one: int(str(one).removeprefix('hello ')))


def test_all_is_heard(drive: Path, hearer: Hearer) -> None:
    playing = lab.play(drive)
    playing.wait(60)
    assert in_order(hearer.heard) == ALL
    for kind in (str, int):
        each = [one for one in hearer.heard if isinstance(one, kind)]
        assert each == [one for one in ALL if isinstance(one, kind)]
    assert playing.done and playing.error is None
    assert playing.counts == {'/chatter': 75, '/count': 25}
    assert playing.position_sec == pytest.approx(0.099)
    assert repr(playing) == f'Played {drive}: 0.1 of 0.1 s: /chatter (75), /count (25)'
    assert '/rosbag2_player' not in [entry.name for entry in runtime.nodes()]


def test_a_recording_of_all_topics_misses_nothing_of_what_is_played(
    drive: Path, tmp_path: Path
) -> None:
    with lab.record(tmp_path / 'again', timeout_sec=0) as recording:
        lab.play(drive, wait=True)
        recording.wait_for(75, '/chatter', timeout_sec=60)
        recording.wait_for(25, '/count', timeout_sec=60)


def test_some_topics_are_played_under_other_names(drive: Path) -> None:
    lab.start()
    hearer = lab.spin(Hearer('/robot/chatter'))
    playing = lab.play(drive, 'chatter', remap={'/chatter': 'robot/chatter'}, wait=True)
    assert hearer.heard == [one for one in ALL if isinstance(one, str)]
    assert playing.counts == {'/robot/chatter': 75}


def test_it_begins_later(drive: Path, hearer: Hearer) -> None:
    lab.play(drive, start_offset=0.05, wait=True)
    assert in_order(hearer.heard) == ALL[50:]


def test_it_stands_still_goes_on_and_elsewhere(drive: Path, hearer: Hearer) -> None:
    with lab.play(drive, paused=True) as playing:
        assert playing.paused and repr(playing).startswith('Paused ')
        with pytest.raises(LabTimeout, match='It stands still'):
            playing.wait(0.2)
        assert hearer.heard == [] and playing.position_sec == 0
        playing.seek(0.09)
        assert playing.position_sec == pytest.approx(0.09)
        playing.resume()
        playing.wait(60)
    assert in_order(hearer.heard) == ALL[90:]


def test_it_goes_on_one_by_one_and_faster(drive: Path, hearer: Hearer) -> None:
    with lab.play(drive, paused=True, rate=0.001) as playing:
        for number in range(1, 4):
            playing.play_next()
            lab.wait_until(lambda number=number: len(hearer.heard) == number, timeout_sec=60)
        assert playing.paused and in_order(hearer.heard) == ALL[:3]
        assert playing.position_sec == pytest.approx(0.002)
        with pytest.raises(LabError, match='rate must be a number above 0, but it is 0'):
            playing.set_rate(0)
        playing.resume()
        playing.play_next()  # it plays: without effect
        playing.set_rate(10)
        playing.wait(60)
    assert in_order(hearer.heard) == ALL


def test_it_is_sent_back_while_it_plays(drive: Path, hearer: Hearer) -> None:
    count = 0

    def pause_at_fifth(_: String) -> None:
        nonlocal count
        count += 1
        if count == 5:
            playing.pause()

    hearer.create_subscription(String, '/chatter', pause_at_fifth, LATE)
    with lab.play(drive, rate=0.005, paused=True) as playing:
        playing.resume()
        lab.wait_until(lambda: playing.paused, timeout_sec=60)
        at = playing.position_sec
        assert 0 < at < 0.099
        playing.seek(0)
        assert playing.position_sec == 0
        playing.resume()
        lab.wait_until(lambda: hearer.heard.count('hello 0') == 2, timeout_sec=60)


def test_it_is_played_again_and_again(drive: Path, hearer: Hearer) -> None:
    playing = lab.play(drive, loop=True)
    lab.wait_until(lambda: hearer.heard.count('hello 98') >= 3, timeout_sec=60)
    assert not playing.done
    playing.stop()
    count = len(hearer.heard)
    assert playing.done and count >= 290
    playing.stop()  # without effect


def test_a_bag_of_one_message_can_be_looped(tmp_path: Path, hearer: Hearer) -> None:
    path = made.make_mcap(tmp_path / 'one', [('/count', 0, made.int16(5))])
    with lab.play(path, loop=True):
        lab.wait_until(lambda: len(hearer.heard) >= 3, timeout_sec=60)
    assert set(hearer.heard) == {5}


def test_nothing_to_play_ends_at_once(tmp_path: Path) -> None:
    path = made.make_mcap(tmp_path / 'one', [('/count', 0, made.int16(5))])
    lab.play(path, [], loop=True, wait=True, timeout_sec=60)


def test_a_clock_says_the_time_of_the_bag(drive: Path, hearer: Hearer) -> None:
    lab.play(drive, clock=500.0, rate=0.5, wait=True)
    assert hearer.clocks == sorted(hearer.clocks)
    assert len(hearer.clocks) >= 5
    assert START_NS <= hearer.clocks[0] <= hearer.clocks[-1] <= START_NS + 99 * 10**6


def test_the_clock_of_the_bag_is_left_out_if_there_is_another(
    tmp_path: Path, hearer: Hearer
) -> None:
    publisher = hearer.create_publisher(Clock, '/clock', 10)
    path = tmp_path / 'clocks'
    with lab.record(path, '/clock') as recording:
        for sec in range(3):
            publisher.publish(_clock(sec))
        recording.wait_for(3, timeout_sec=30)
    lab.play(path, wait=True)
    assert hearer.clocks == [sec * 10**9 for sec in (0, 1, 2, 0, 1, 2)]
    hearer.clocks.clear()
    lab.play(path, clock=100.0, wait=True)
    assert all(stamp > 10**18 for stamp in hearer.clocks)


def _clock(sec: int) -> Clock:
    message = Clock()
    message.clock.sec = sec
    return message


def test_publishers_offer_what_was_offered(drive: Path, hearer: Hearer) -> None:
    with lab.play(drive, paused=True):
        (end,) = publishers(hearer, '/chatter')
        assert end.node == '/rosbag2_player'
        assert end.qos.reliability == ReliabilityPolicy.BEST_EFFORT
        assert end.qos.durability == DurabilityPolicy.TRANSIENT_LOCAL


def test_what_was_offered_in_several_ways_is_offered_as_usual() -> None:
    usual = QoSProfile(depth=10)
    assert offered_profile([]) == usual
    assert offered_profile([LATE, usual]) == usual
    assert offered_profile([LATE, LATE]) == LATE
    unknown = QoSProfile(history=3, depth=0, reliability=ReliabilityPolicy.BEST_EFFORT)
    assert offered_profile([unknown]).depth == 10


@pytest.mark.parametrize(
    'end', [lab.stop, lambda: lab.remove('rosbag2_player')], ids=['lab.stop', 'lab.remove']
)
def test_it_ends_with_its_node(drive: Path, hearer: Hearer, end: Callable[[], None]) -> None:
    playing = lab.play(drive, loop=True)
    lab.wait_until(lambda: len(hearer.heard) >= 5, timeout_sec=60)
    end()
    assert playing.done and playing.error is None


def test_a_type_that_is_not_installed_is_left_out(tmp_path: Path, hearer: Hearer) -> None:
    path = made.make_mcap(tmp_path / 'drive', [('/count', 0, made.int16(5))])
    bag = open_bag(path)
    playing = Playing(bag, [*bag.topics, BagTopic('/robot', 'demo_msgs/msg/Robot', 1, [])])
    playing.wait(60)
    assert hearer.heard == [5]
    assert playing.skipped == {'/robot': 'its type demo_msgs/msg/Robot is not installed here'}
    assert '/robot is not played' in repr(playing)


@pytest.mark.parametrize('name', ['/a\udcff', '/a\0b', '/a\x1b[31m', '/a b', '', '/' + 'a' * 5000])
def test_a_name_that_no_topic_can_have_is_left_out(
    tmp_path: Path, hearer: Hearer, name: str
) -> None:
    path = made.make_mcap(tmp_path / 'drive', [('/count', 0, made.int16(5))])
    bag = open_bag(path)
    playing = Playing(bag, [*bag.topics, BagTopic(name, 'std_msgs/msg/Int16', 1, [])])
    playing.wait(60)
    assert hearer.heard == [5] and playing.counts == {'/chatter': 0, '/count': 1}
    assert 'is no name of a topic' in playing.skipped[name] and len(playing.skipped[name]) < 400
    assert all(line.isprintable() for line in repr(playing).splitlines())


def test_damage_on_the_way_is_told(
    tmp_path: Path, hearer: Hearer, capsys: pytest.CaptureFixture[str]
) -> None:
    path = made.make_mcap(
        tmp_path / 'drive', [('/count', n * 10**5, made.int16(n)) for n in range(50)]
    )
    file = path / 'drive_0.mcap'
    content = bytearray(file.read_bytes())
    place = content.find(made.int16(25)) - 8
    content[place : place + 10] = b'\xff' * 10
    file.write_bytes(content)
    playing = lab.play(path)
    with pytest.raises(LabError, match='has ended early'):
        playing.wait(60)
    assert hearer.heard == list(range(len(hearer.heard))) and len(hearer.heard) < 26
    assert 'is damaged' in capsys.readouterr().out


def test_a_topic_of_another_type_here_is_told(drive: Path) -> None:
    lab.start()
    other = lab.spin(Node('other'))
    other.create_publisher(Int16, '/chatter', 10)
    playing = lab.play(drive, wait=True)
    assert 'std_msgs/msg/Int16' in playing.skipped['/chatter']
    assert playing.counts == {'/count': 25}


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'rate': 0}, 'rate must be'),
        ({'rate': 'fast'}, 'rate must be'),
        ({'clock': -1.0}, 'clock must be'),
        ({'start_offset': -1}, 'start_offset must be'),
        ({'topics': '/chater'}, "Did you mean '/chatter'"),
        ({'remap': {'/odom': '/odom2'}}, "has no topic '/odom'"),
        ({'remap': {'/chatter': 'two words'}}, 'two words'),
    ],
)
def test_wrong_arguments_are_told(drive: Path, arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(LabError, match=words):
        lab.play(drive, **arguments)
    with pytest.raises(LabError, match='There is no bag'):
        lab.play(drive / 'nothing')


def test_a_cell_that_is_run_again_ends_its_earlier_playing(kernel: Any, drive: Path) -> None:
    kernel.run('import labkit as lab')
    for _ in range(3):
        code = 'earlier = globals().get("playing")\n'
        code += f'playing = lab.play({str(drive)!r}, loop=True)'
        assert not kernel.run(code, cell_id='mine').error
    assert kernel.run('print(earlier.done, playing.done)').text == 'True False\n'
    code = 'from labkit.background.runtime import runtime\nprint(len(runtime.nodes()))'
    assert kernel.run(code).text == '1\n'


PROCESS = """
import sys
import labkit as lab
lab.start()
from rclpy.node import Node
from std_msgs.msg import String

node = lab.spin(Node('elsewhere'))
heard = []
node.create_subscription(String, '/chatter', lambda message: heard.append(message.data), {qos})
print('ready', flush=True)
lab.wait_until(lambda: 'hello 98' in heard, timeout_sec=60)
print(len(heard), heard[0], flush=True)
sys.stdin.read()  # who leaves gives no answer, and the player would wait for one
"""


PLAY = """
import os, signal, sys, time
import labkit as lab
from labkit.asking import delivery, discovery
from labkit.bags import player

# What is judged is that it waits, not that a busy machine is fast enough.
discovery.MOST_SEC = player.RECEIVE_SEC = 60.0
delivery.wait_until_found.__defaults__ = (60.0,)
pid = int(sys.argv[1])
discovery.asking_node()
discovery.MOST_SEC = 0.0  # who is known and does not answer is not asked again
if '{held_up}' == 'at first':
    os.kill(pid, signal.SIGSTOP)
playing = lab.play('drive', rate=10)
if '{held_up}' == 'at last':
    lab.wait_until(lambda: playing.counts['/chatter'] > 70, timeout_sec=60)
    os.kill(pid, signal.SIGSTOP)
if '{held_up}':
    time.sleep(0.5)
    os.kill(pid, signal.SIGCONT)
playing.wait(60)
"""


HELD_UP = pytest.mark.slow('starts and stops another process')


@pytest.mark.parametrize(
    'held_up',
    [
        '',
        pytest.param('at first', marks=HELD_UP),
        pytest.param('at last', marks=HELD_UP),
    ],
)
def test_another_process_hears_the_first_message_and_the_last(
    tmp_path: Path, messages: list[Stored], lab_env: dict[str, str], held_up: str
) -> None:
    made.make_mcap(tmp_path / 'drive', messages)
    claim = domains.claim_domain()
    env = {
        **lab_env,
        'ROS_DOMAIN_ID': str(claim.domain_id),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
    }
    qos = '__import__("rclpy.qos").qos.QoSProfile(depth=100, reliability=2)'
    hearer = subprocess.Popen(
        [sys.executable, '-c', PROCESS.format(qos=qos)],
        env=env,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert hearer.stdout is not None
        assert hearer.stdout.readline() == 'ready\n'
        play = [sys.executable, '-c', PLAY.format(held_up=held_up), str(hearer.pid)]
        done = subprocess.run(play, env=env, cwd=tmp_path, timeout=120)
        assert done.returncode == 0
        out, _ = hearer.communicate(timeout=120)
    finally:
        hearer.kill()
        claim.close()
    assert out == '75 hello 0\n'
