"""`ros2 bag` with the options and the output of the real command."""

from __future__ import annotations

import contextlib
import fcntl
import os
import select
import subprocess
import sys
import termios
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from rclpy.node import Node
from std_msgs.msg import String

import labkit
from labkit.background.session import going_on
from labkit.bags.info import size_in_words
from labkit.bags.metadata import read_metadata
from labkit.bags.player import start_playing
from labkit.bags.reader import open_bag
from labkit.bags.recorder import Recording
from labkit.bags.writer import BagWriter
from labkit.errors import LabError
from labkit.ros2 import bag_play, shell
from labkit.ros2.completion import complete_line
from labkit.rosgraph.qos_profiles import read_overrides
from tests.bags import made
from tests.bags.made import Stored

RECORDER = '[INFO] [rosbag2_recorder]: '


@pytest.fixture
def drive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Be where a bag is, with messages ten milliseconds apart."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv('TZ', 'UTC')
    messages: list[Stored] = [
        ('/count' if n % 4 == 3 else '/chatter', n * 10**7, made.int16(n) if n % 4 == 3 else b'')
        for n in range(20)
    ]
    full = [(topic, at, data or made.string(f'hello {at}')) for topic, at, data in messages]
    yield made.make_mcap(Path('drive'), full)


def run(*words: str) -> int:
    """Run a command here."""
    return shell.execute(['bag', *words])


def test_info_prints_what_the_real_one_prints(
    drive: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    size = (drive / 'drive_0.mcap').stat().st_size
    assert run('info', 'drive') == 0
    out = capsys.readouterr().out
    assert out.splitlines() == [
        '',
        'Files:             drive_0.mcap',
        f'Bag size:          {size_in_words(size)}',
        'Storage id:        mcap',
        'ROS Distro:        jazzy',
        'Duration:          0.190000000s',
        'Start:             Nov 14 2023 22:13:20.000000000 (1700000000.000000000)',
        'End:               Nov 14 2023 22:13:20.190000000 (1700000000.190000000)',
        'Messages:          20',
        'Topic information: Topic: /chatter | Type: std_msgs/msg/String | Count: 15 | '
        'Serialization Format: cdr',
        '                   Topic: /count | Type: std_msgs/msg/Int16 | Count: 5 | '
        'Serialization Format: cdr',
        'Service:           0',
        'Service information: ',
    ]
    assert run('info', '-t', 'drive') == 0
    assert capsys.readouterr().out == '/chatter\n/count\n'


@pytest.mark.parametrize(
    ('size', 'words'),
    [
        (0, '0 B'),
        (1023, '1023 B'),
        (1024, '1.0 KiB'),
        (1_600_000, '1.5 MiB'),
        (2**50, '1024.0 TiB'),
    ],
)
def test_sizes_have_the_units_of_the_real_one(size: int, words: str) -> None:
    assert size_in_words(size) == words


def test_an_unfinished_bag_is_shown_with_a_warning(
    drive: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (drive / 'metadata.yaml').unlink()
    assert run('info', 'drive') == 0
    out = capsys.readouterr().out
    assert out.startswith('[WARN] [ros2bag]: It is not complete')
    assert 'Messages:          20' in out


@pytest.mark.parametrize(
    ('words', 'code', 'said'),
    [
        (['info', 'drvie'], 1, "There is no bag 'drvie'.\nDid you mean 'drive'?"),
        (['info', 'drive', '-s', 'sqlite3'], 1, "'drive' is stored as mcap, not as sqlite3."),
        (['record'], 1, '[ERROR] [ros2bag]: Need to specify at least one option out of --all'),
        (['record', '-a', '-o', 'drive'], 1, "[ERROR] [ros2bag]: Output folder 'drive' already"),
        (
            ['record', '--topics', '/a', '--exclude-regex', 'b'],
            *(1, '[ERROR] [ros2bag]: --exclude-regex argument requires either --all'),
        ),
        (['record', '-e', '['], 1, "'[' is no regular expression"),
        (['record', '-a', '-s', 'mcp'], 2, "did you mean 'mcap'?"),
        (['play', 'drive', '-m', '/chatter'], 2, "'/chatter' is no remapping"),
        (['play', 'drive', '-r', '0'], 2, 'expected a number above 0'),
        (['play', 'drive', '--topics', '/chater'], 1, "Did you mean '/chatter'?"),
        (['play', 'drive', '-x', '/c'], 1, "None of the topics of 'drive' is chosen."),
        (['convert', '-i', 'drive', '-o', 'x.yaml'], 1, "'x.yaml' can not be read"),
        (['convert', '-i', 'drive'], 2, '-o/--output-options'),
        (['reindex', 'nothing'], 1, "'nothing' is no folder with files .mcap or .db3."),
        (['burst', 'drive'], 2, 'ros2 bag burst is part of a full installation of ROS 2'),
        (['record', '-a', '--start-paused'], 2, '--start-paused is not here: there are no keys'),
        (['record', '-a', '--snapshot-mode'], 2, '--snapshot-mode is not here: '),
        (['record', '-a', '--compression-format', 'zstd'], 2, '--compression-format is not here'),
        (['record', '-a', '--compression-mode', 'file'], 1, 'written without compression here'),
        (['record', '-a', '--use-sim-time', '--no-discovery'], 1, 'are incompatible settings'),
        (['record', '-a', '--qos-profile-overrides-path', 'x'], 1, "'x' can not be read"),
        (
            ['play', 'drive', '--clock-topics-all'],
            2,
            '--clock-topics-all is not here: take --clock',
        ),
        (
            ['play', 'drive', '--publish-service-requests'],
            2,
            '--publish-service-requests is not here',
        ),
        (['play', 'drive', '--services', '/go'], 1, "'drive' has no topic '/go/_service_event'"),
        (['play', 'drive', '--playback-duration', 'x'], 2, 'invalid float value'),
    ],
)
@pytest.mark.usefixtures('drive')
def test_what_is_wrong_is_told(
    words: list[str], code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words) == code
    assert said in capsys.readouterr().err
    assert sorted(path.name for path in Path().iterdir()) == ['drive']


def test_a_recording_has_to_end_where_nobody_can_stop_it(
    script: Callable[..., Any], tmp_path: Path
) -> None:
    code = 'import sys\nfrom labkit.ros2.shell import run_line\nsys.exit(run_line({!r}))'
    done = script(code.format('bag record -a'), LABKIT_HEADLESS='1')
    assert done.exit_code == 2 and 'Add --timeout N or --count N.' in done.stderr
    done = script(code.format('bag play -l nothing'), LABKIT_HEADLESS='1')
    assert done.exit_code == 2 and 'Add --timeout N' in done.stderr


@pytest.mark.usefixtures('robot')
def test_what_another_process_publishes_is_recorded_and_played_back(
    ros2: Callable[..., list[Any]], tmp_path: Path
) -> None:
    recorded, again, shown, played = ros2(
        'bag record -o walk --topics /chatter --count 5',
        'bag record -o walk -a',
        'bag info walk',
        'bag play walk --rate 20 --remap /chatter:=/evens --clock 50',
    )
    assert recorded.lines == [
        f'{RECORDER}Listening for topics...',
        f"{RECORDER}Subscribed to topic '/chatter'",
        f'{RECORDER}Recording...',
        f'{RECORDER}Recording stopped',
    ] or recorded.lines == [
        # Where the topic was discovered a moment later.
        f'{RECORDER}Listening for topics...',
        f'{RECORDER}Recording...',
        f"{RECORDER}Subscribed to topic '/chatter'",
        f'{RECORDER}Recording stopped',
    ]
    assert (recorded.code, again.code, shown.code, played.code) == (0, 1, 0, 0)
    assert "Output folder 'walk' already exists" in again.err
    assert 'Topic: /chatter | Type: std_msgs/msg/String | Count: 5 |' in shown.out
    assert played.lines == ['[INFO] [rosbag2_player]: Set rate to 20']
    with open_bag(tmp_path / 'walk') as bag:
        assert (bag.message_count, bag.note) == (5, '')


@pytest.mark.slow('records several bags')
@pytest.mark.usefixtures('robot')
def test_options_of_record_are_those_of_the_real_one(
    ros2: Callable[..., list[Any]], tmp_path: Path
) -> None:
    ros2(
        'bag record -o one /chatter --count 3 -s sqlite3',
        'bag record -o two -a --exclude-topics /rosout --exclude-regex "param" --count 3',
        'bag record -o three -e "chat+er$" --timeout 3 -d 1',
    )
    with open_bag(tmp_path / 'one') as bag:
        assert (bag.storage, [topic.name for topic in bag.topics]) == ('sqlite3', ['/chatter'])
    with open_bag(tmp_path / 'two') as bag:
        names = {topic.name for topic in bag.topics}
        assert '/chatter' in names and not names & {'/rosout', '/parameter_events'}
    with open_bag(tmp_path / 'three') as bag:
        assert [topic.name for topic in bag.topics] == ['/chatter']
        assert len(bag.files) >= 2


def test_messages_that_come_faster_than_they_are_written_are_told_to_be_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    go_on = threading.Event()
    original = BagWriter.write

    def slow(self: BagWriter, messages: Any) -> None:
        go_on.wait(60)
        original(self, messages)

    class Talker(Node):
        def __init__(self) -> None:
            super().__init__('talker')
            self.publisher = self.create_publisher(String, '/chatter', 1000)
            self.create_timer(0.01, self.on_timer)

        def on_timer(self) -> None:
            if any(recording.lost for recording in going_on(Recording)):
                go_on.set()
            for _ in range(100):
                self.publisher.publish(String(data='x' * 1000))

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(BagWriter, 'write', slow)
    labkit.start()
    labkit.spin(Talker())
    options = ('--topics', '/chatter', '--count', '150', '--max-cache-size', '100000')
    assert run('record', '-o', 'lossy', *options) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if 'lost' in line]
    count = int(line.removeprefix('[WARN] [rosbag2_recorder]: ').partition(' ')[0])
    assert count > 0 and 'were lost: they came faster than they were written.' in line


def test_the_kinds_of_storage_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run('list', 'storage') == 0
    assert capsys.readouterr().out == 'mcap\nsqlite3\n'


@pytest.mark.parametrize('maker', [made.make_mcap, made.make_sqlite])
def test_metadata_is_written_anew(
    maker: made.Maker, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stored = [('/count', n * 10**7, made.int16(n)) for n in range(20)]
    path = maker(tmp_path / 'walk', stored)
    before = read_metadata(path / 'metadata.yaml')
    (path / 'metadata.yaml').write_text('nonsense: [')
    assert run('reindex', str(path)) == 0
    assert capsys.readouterr().out.endswith('[INFO] [rosbag2_cpp]: Reindexing complete.\n')
    after = read_metadata(path / 'metadata.yaml')
    assert (after.files, after.start_ns, after.duration_ns, after.count) == (
        *(before.files, before.start_ns, before.duration_ns, before.count),
    )
    with open_bag(path) as bag:
        assert bag.note == '' and len(list(bag.messages())) == 20


def test_metadata_is_written_through_no_link(tmp_path: Path) -> None:
    path = made.make_mcap(tmp_path / 'walk', [('/count', 0, made.int16(0))])
    own = tmp_path / 'thesis.txt'
    own.write_text('years of work')
    (path / 'metadata.yaml').unlink()
    (path / 'metadata.yaml').symlink_to(own)
    assert run('reindex', str(path)) == 0
    assert own.read_text() == 'years of work'
    assert read_metadata(path / 'metadata.yaml').count == 1


@pytest.mark.parametrize(
    ('options', 'count'),
    [
        ([], 20),
        (['--playback-duration', '0.045'], 5),
        (['--playback-duration', '0.045', '--start-offset', '0.1'], 5),
        (['--playback-until-nsec', str(made.START_NS + 45 * 10**6)], 5),
        (['--playback-until-sec', f'{made.START_NS / 1e9 + 0.045:.6f}'], 5),
        (
            [
                '--playback-duration',
                '0.015',
                '--playback-until-sec',
                f'{made.START_NS / 1e9 + 0.045}',
            ],
            5,
        ),
        (['--playback-duration', '-1', '--disable-keyboard-controls', '--log-level', 'warn'], 20),
    ],
)
@pytest.mark.usefixtures('drive')
def test_playing_ends_where_it_is_told_to(
    options: list[str], count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    played = []
    monkeypatch.setattr(
        bag_play,
        'start_playing',
        lambda *a, **k: played.append(start_playing(*a, **k)) or played[0],
    )
    assert run('play', 'drive', *options) == 0
    assert sum(played[0].counts.values()) == count


SERVICES = """
import threading
from pathlib import Path

import labkit as lab
from labkit.bags.reader import open_bag
from labkit.ros2.shell import run_line
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Int16
from std_srvs.srv import SetBool

lab.start()
lamp = Node('lamp')
server = lamp.create_service(SetBool, 'switch', lambda request, response: response)
server.configure_introspection(
    lamp.get_clock(), QoSProfile(depth=10), ServiceIntrospectionState.CONTENTS
)
lab.spin(lamp)


def together(line, other):
    thread = threading.Thread(target=other)
    thread.start()
    assert run_line(line) == 0
    thread.join()
"""


def test_services_with_introspection_are_recorded_and_played(script: Callable[..., Any]) -> None:
    result = script(
        SERVICES
        + """
def call():
    lab.wait_until(lambda: lamp.count_subscribers('/switch/_service_event'), timeout_sec=30)
    run_line('service call /switch std_srvs/srv/SetBool "{data: true}"')


together('bag record -o walk --services /switch --count 2', call)
run_line('bag info walk')
with open_bag('walk') as bag:
    print([message.message.info.event_type for message in bag.messages()])
print(run_line('bag play walk --services /switch'))
"""
    )
    assert result.exit_code == 0, result.stderr
    assert 'Service: /switch | Type: std_srvs/srv/SetBool | Event Count: 2' in result.stdout
    assert '\n[1, 2]\n' in result.stdout and result.stdout.endswith('\n0\n')


def test_a_recording_follows_the_clock_and_overrides(script: Callable[..., Any]) -> None:
    result = script(
        SERVICES
        + """
from labkit.bags.recorder import Recording

clock = lamp.create_publisher(Clock, '/clock', 10)
count = lamp.create_publisher(Int16, '/count', QoSProfile(depth=5))
Path('qos.yaml').write_text('/count: {reliability: best_effort, history: keep_last, depth: 7}')
taken, make = threading.Event(), Recording._make_callback


def make_telling(recorder, name, number):
    record = make(recorder, name, number)

    def both(data, info):
        record(data, info)
        taken.set()

    return both


Recording._make_callback = make_telling


def publish():
    lab.wait_until(lambda: lamp.count_subscribers('/count'), timeout_sec=30)
    print(lamp.get_subscriptions_info_by_topic('/count')[0].qos_profile.reliability.name)
    lab.wait_until(count.get_subscription_count, timeout_sec=30)
    # One, taken before the first time of the clock: a second one may wait until after it.
    count.publish(Int16(data=1))
    # In one piece: the recorder writes its lines from another thread.
    print(f'taken {taken.wait(60)}')
    lab.wait_until(lambda: clock.get_subscription_count(), timeout_sec=30)
    tick = Clock()
    tick.clock.sec = 50
    while not done.is_set():
        clock.publish(tick)
        count.publish(Int16(data=2))
        done.wait(0.01)


done = threading.Event()
thread = threading.Thread(target=publish)
thread.start()
line = 'bag record -o walk --topics /count --count 2 --use-sim-time'
assert run_line(f'{line} --qos-profile-overrides-path qos.yaml') == 0
done.set()
thread.join()
with open_bag('walk') as bag:
    print([(message.stamp_ns, message.message.data) for message in bag.messages()])
"""
    )
    assert result.exit_code == 0, result.stderr
    assert 'BEST_EFFORT' in result.stdout and 'taken True' in result.stdout
    assert '[(50000000000, 2), (50000000000, 2)]' in result.stdout


@pytest.mark.parametrize(
    'text',
    [
        '[',
        '5',
        '/a: 5',
        '/a: {reliability: best}',
        '/a: {depth: -1}',
        '/a: {deadline: 5}',
        '/a: {x: 1}',
    ],
)
def test_what_is_no_file_of_overrides(tmp_path: Path, text: str) -> None:
    path = tmp_path / 'qos.yaml'
    path.write_text(text)
    with pytest.raises(LabError, match='is no file of QoS profiles'):
        read_overrides(str(path))


@pytest.mark.slow('starts other processes')
@pytest.mark.usefixtures('robot')
def test_ctrl_c_ends_a_recording_in_a_terminal(
    tmp_path: Path, domain: dict[str, str], lab_env: dict[str, str]
) -> None:
    process = subprocess.Popen(
        [
            sys.executable,
            '-m',
            'labkit.ros2',
            'bag',
            'record',
            '--topics',
            '/chatter',
            '-o',
            'walk',
        ],
        cwd=tmp_path,
        env={**lab_env, **domain},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    lines = [process.stdout.readline() for _ in range(3)]
    assert any('Subscribed to topic' in line for line in lines)
    process.send_signal(2)
    rest, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert rest.endswith(f'{RECORDER}Recording stopped\n')
    with open_bag(tmp_path / 'walk') as bag:
        assert bag.note == ''


def test_the_stop_button_ends_a_recording_in_a_cell(kernel: Any, tmp_path: Path) -> None:
    code = """
import labkit as lab
lab.start()
from rclpy.node import Node
from std_msgs.msg import String
talker = lab.spin(Node('talker'))
publisher = talker.create_publisher(String, '/chatter', 10)
talker.create_timer(0.01, lambda: publisher.publish(String(data='hi')))
"""
    kernel.run(code)
    msg_id = kernel.start(f'%ros2 bag record -a -o {tmp_path}/walk\nprint("after")')
    kernel.wait_for_output(msg_id, 'Recording...')
    kernel.interrupt()
    result = kernel.finish(msg_id)
    assert not result.error
    assert result.text.endswith(f'{RECORDER}Recording stopped\nafter\n')
    with open_bag(tmp_path / 'walk') as bag:
        assert bag.note == '' and '/chatter' in [topic.name for topic in bag.topics]
    shown = kernel.run(f'%ros2 bag info -t {tmp_path}/walk').text
    assert shown.splitlines() == ['/chatter', '/parameter_events', '/rosout']


@pytest.mark.parametrize(
    ('line', 'words'),
    [
        ('bag ', ['convert', 'info', 'list', 'play', 'record', 'reindex']),
        ('bag info ', ['drive', 'inner/other']),
        ('bag play dr', ['drive']),
        ('bag play drive --topics ', ['/chatter', '/count']),
        ('bag play drive --topics /chatter ', ['/chatter', '/count']),
        ('bag play --topics /chatter --ra', ['--rate']),
        ('bag convert -i ', ['drive', 'inner/other']),
        ('bag record --storage ', ['mcap', 'sqlite3']),
    ],
)
def test_words_are_completed(drive: Path, line: str, words: list[str]) -> None:
    made.make_mcap(Path('inner/other'), [('/count', 0, made.int16(1))])
    assert complete_line(line)[1] == words


@pytest.mark.slow('starts a process of its own')
@pytest.mark.parametrize(
    ('keys', 'said'),
    [
        (' ', ['Resuming play.']),
        ('\x1b[C' * 20, []),  # each of its messages
        ('\x1b[A\x1b[B ', ['Set rate to 1.1', 'Set rate to 0.99', 'Resuming play.']),
    ],
)
def test_keys_of_a_terminal_let_a_paused_bag_go_on(
    drive: Path, lab_env: dict[str, str], keys: str, said: list[str]
) -> None:
    above, terminal = os.openpty()
    command = [sys.executable, '-m', 'labkit.ros2', 'bag', 'play', '-p', 'drive']
    with subprocess.Popen(
        command, stdin=terminal, stdout=terminal, stderr=terminal, env=lab_env,
        start_new_session=True, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
    ) as player:  # fmt: skip
        os.close(terminal)
        try:
            text = read_until(above, 'CURSOR_DOWN for Decrease Rate 10%')
            assert 'Press SPACE for Pause/Resume' in text
            os.write(above, keys.encode())
            text = read_until(above, None)
            assert player.wait(60) == 0, text
        finally:
            player.kill()
            os.close(above)
    assert [line for line in said if line not in text] == []


def read_until(terminal: int, words: str | None) -> str:
    """Read from a terminal until it has said some words, or its program has ended."""
    text = ''
    with contextlib.suppress(OSError):  # nobody has the other end any more
        while words is None or words not in text:
            assert select.select([terminal], [], [], 60)[0], text
            text += os.read(terminal, 4096).decode()
    return text
