"""`ros2 bag` with the options and the output of the real command."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from labkit.bags.info import size_in_words
from labkit.bags.reader import open_bag
from labkit.ros2 import shell
from labkit.ros2.completion import complete_line
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
    assert out.startswith('[WARN] [ros2bag]: It was not finished')
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
        (['convert', '-i', 'a', 'b', 'c', '-o', 'x.yaml'], 2, '--input expects 1 or 2 arguments'),
        (['convert', '-i', 'drive', '-o', 'x.yaml'], 1, "'x.yaml' can not be read"),
        (['convert', '-i', 'drive'], 2, '-o/--output-options'),
        (['reindex', 'drive'], 2, "ros2 bag has no verb 'reindex'"),
    ],
)
@pytest.mark.usefixtures('drive')
def test_what_is_wrong_is_told(
    words: list[str], code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words) == code
    assert said in capsys.readouterr().err
    assert sorted(path.name for path in Path().iterdir()) == ['drive']


def test_a_bag_is_converted(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path('out.yaml').write_text(
        'output_bags:\n- {uri: copy, storage_id: sqlite3, all_topics: true}\n'
        '- {uri: some, topics: [/count]}'
    )
    assert run('convert', '-i', 'drive', 'mcap', '-o', 'out.yaml') == 0
    assert capsys.readouterr().out == 'copy: 20 messages\nsome: 5 messages\n'
    with open_bag('copy') as bag:
        assert (bag.storage, bag.message_count) == ('sqlite3', 20)


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
        ('bag ', ['convert', 'info', 'play', 'record']),
        ('bag info ', ['drive', 'inner/other']),
        ('bag play dr', ['drive']),
        ('bag play drive --topics ', ['/chatter', '/count']),
        ('bag play drive --topics /chatter ', ['/chatter', '/count']),
        ('bag play --topics /chatter --ra', ['--rate']),
        ('bag record --storage ', ['mcap', 'sqlite3']),
        ('bag convert -i ', ['drive', 'inner/other']),
    ],
)
def test_words_are_completed(drive: Path, line: str, words: list[str]) -> None:
    made.make_mcap(Path('inner/other'), [('/count', 0, made.int16(1))])
    assert complete_line(line)[1] == words
