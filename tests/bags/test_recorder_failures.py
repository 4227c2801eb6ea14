"""Whatever ends a recording, what was written before can be read."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rosbags.highlevel import AnyReader

from labkit.bags.reader import open_bag

SCRIPT = """
import resource, sys
import labkit as lab
lab.start()
from rclpy.node import Node
from std_msgs.msg import String

talker = lab.spin(Node('talker'))
publisher = talker.create_publisher(String, '/chatter', 10)
ticks = [0]

def tick():
    publisher.publish(String(data=f'{ticks[0]} ' + 'x' * 1000))
    ticks[0] += 1

talker.create_timer(0.001, tick)
"""
KILLED = """
recording = lab.record('drive', '/chatter', storage=sys.argv[1])
recording.wait_for(20, timeout_sec=60)
print('recording', flush=True)
lab.wait_until(lambda: False, timeout_sec=None)
"""
FULL = """
resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))
recording = lab.record('drive', '/chatter', storage='{storage}')
lab.wait_until(lambda: recording.done, timeout_sec=60)
now = ticks[0]
lab.wait_until(lambda: ticks[0] > now + 10, timeout_sec=60)
print('others go on')
try:
    recording.wait_for(10**6)
except lab.LabError as error:
    print('told:', error)
"""
BOTH = pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])


@BOTH
def test_the_kernel_is_killed(tmp_path: Path, lab_env: dict[str, str], storage: str) -> None:
    process = subprocess.Popen(
        [sys.executable, '-c', SCRIPT + KILLED, storage],
        cwd=tmp_path,
        env=lab_env,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == 'recording\n'
        path = tmp_path / 'drive'
        count, end = 0, time.monotonic() + 60
        while count < 100 and time.monotonic() < end:
            with open_bag(path) as bag:  # while it is being written
                count = bag.message_count
            time.sleep(0.1)
    finally:
        process.kill()
        process.communicate()
    with open_bag(path) as bag:
        assert 'It is not complete' in bag.note
        numbers = [int(each.message.data.split()[0]) for each in bag.messages()]
        assert bag.message_count == len(numbers) >= count >= 100
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
        assert len(bag.stamps('/chatter')) == len(numbers)
        last = bag.at('/chatter', bag.end_ns)
        assert last is not None and int(last.message.data.split()[0]) == numbers[-1]


@pytest.mark.slow('records until something ends it')
@BOTH
def test_the_disk_fills_up(tmp_path: Path, script: Callable[..., Any], storage: str) -> None:
    done = script(SCRIPT + FULL.format(storage=storage))
    assert done.exit_code == 0, done.stderr
    assert done.stdout.count("rosbag2_recorder: 'drive' can not be written: ") == 1
    # The system says why; that the disk were full is not what has happened here.
    assert 'What was written before can be read.\n' in done.stdout
    assert 'Is the disk full' not in done.stdout
    assert 'others go on\ntold: The recording of' in done.stdout
    with open_bag(tmp_path / 'drive') as bag:
        numbers = [int(each.message.data.split()[0]) for each in bag.messages()]
        assert 'It is not complete' in bag.note
    assert len(numbers) > 10
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


def test_the_disk_is_full_from_the_start(tmp_path: Path, script: Callable[..., Any]) -> None:
    code = """
import resource
import labkit as lab
lab.start()
resource.setrlimit(resource.RLIMIT_FSIZE, (5, resource.RLIM_INFINITY))
try:
    lab.record('drive')
except lab.LabError as error:
    print('told:', error)
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
print(lab.record('drive'))
"""
    done = script(code)
    assert "told: 'drive' can not be written" in done.stdout, done.stderr
    # Once there is room again, the name is free.
    assert 'Recording drive' in done.stdout, done.stderr


def test_a_recording_that_is_interrupted_is_whole(tmp_path: Path, kernel: Any) -> None:
    kernel.run(SCRIPT)
    code = f"""
with lab.record({str(tmp_path / 'drive')!r}, '/chatter') as recording:
    recording.wait_for(5)
    print('now')
    recording.wait_for(10**9, timeout_sec=None)
"""
    msg_id = kernel.start(code)
    kernel.wait_for_output(msg_id, 'now')
    kernel.interrupt()
    assert kernel.finish(msg_id).error.startswith('KeyboardInterrupt')
    with AnyReader([tmp_path / 'drive']) as reader:
        assert reader.message_count >= 5
    with open_bag(tmp_path / 'drive') as bag:
        assert bag.note == ''


@pytest.mark.slow('records until something ends it')
def test_a_kernel_that_is_shut_down_leaves_a_whole_bag(tmp_path: Path, kernel: Any) -> None:
    kernel.run(SCRIPT)
    path = str(tmp_path / 'drive')
    result = kernel.run(f"lab.record({path!r}, '/chatter').wait_for(5)")
    assert not result.error, result.traceback
    kernel.shutdown()
    with open_bag(path) as bag:
        assert (bag.note, bag.message_count >= 5) == ('', True)
