"""What was sent by commands: attempt by attempt, across checks, terminals and a stop of ROS."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import nbformat
import pytest
import rclpy
from std_msgs.msg import Int16

import labkit
from labkit import settings
from labkit.background import domains
from labkit.exercises import Exercise
from labkit.exercises.found_lessons import load
from labkit.exercises.messages_heard import Sample
from labkit.lessons.command_line.sent import is_every, messages_at_once, newest_run, period

NOTEBOOK = Path(__file__).resolve().parents[2] / 'notebooks' / '03_command_line.ipynb'
SETUP = "import labkit as lab\n\nlesson = lab.lesson('command_line')"
ONE = '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{{data: {}}}"\n'
DRIVE = (
    'topic pub {} /cmd_vel geometry_msgs/msg/Twist "{{linear: {{x: 0.2}}, angular: {{z: 0.5}}}}"'
)


def run_of(stamps: Sequence[float], first: int = 1) -> list[Sample]:
    """Return messages of one publisher."""
    return [
        Sample(SimpleNamespace(), stamp, number)
        for number, stamp in enumerate(stamps, start=first)
    ]


def at_rate(hz: float, late: Sequence[float] = (0.0,) * 5) -> list[Sample]:
    """Return five messages of a command, which makes up for a delay with the next one."""
    return run_of([number / hz + delay for number, delay in enumerate(late)])


@pytest.mark.parametrize('hz', [8.6, 9, 10, 11, 11.4])
def test_rate_that_the_task_allows_fits(hz: float) -> None:
    assert is_every(0.1, at_rate(hz), None)


@pytest.mark.parametrize('hz', [1, 5, 8, 12.5, 20, 100])
def test_other_rate_does_not_fit(hz: float) -> None:
    assert not is_every(0.1, at_rate(hz), None)


@pytest.mark.parametrize('late_sec', [0.02, 0.05, 0.09])
@pytest.mark.parametrize('late', [[0], [1], [2], [3], [4], [1, 2], [1, 3], [2, 3]])
def test_late_messages_do_not_decide(late: Sequence[int], late_sec: float) -> None:
    delays = [late_sec if number in late else 0.0 for number in range(5)]
    for commanded in (10.0, None):
        assert is_every(0.1, at_rate(10, delays), commanded)
    for commanded in (5.0, 8.0, 12.5):
        assert not is_every(0.1, at_rate(commanded, delays), commanded)


def test_skipped_calls_of_a_timer_do_not_decide() -> None:
    assert is_every(0.1, run_of([0.0, 0.1, 0.3, 0.4, 0.7]), None)
    assert not is_every(0.1, run_of([0.0, 0.2, 0.4, 0.8, 1.0]), None)


def test_lost_message_changes_no_rate() -> None:
    run = at_rate(10)
    assert period([*run[:2], *run[3:]]) == pytest.approx(0.1)


def test_newest_attempt_is_told_from_earlier_ones() -> None:
    older, newer = run_of([0.0, 0.1, 0.2, 0.3]), run_of([0.6, 0.7, 0.8, 0.9, 1.0])
    assert newest_run([*older, *newer]) == newer
    assert newest_run([*newer, *run_of([1.3])]) == run_of([1.3])
    # The same publisher, after a pause.
    again = run_of([9.0, 9.1, 9.2], first=6)
    assert newest_run([*newer, *again]) == again


def test_two_publishers_at_once_are_seen() -> None:
    one, other = run_of([0.0, 0.1, 0.2]), run_of([0.05, 0.15, 0.25])
    both = sorted([*one, *other], key=lambda sample: sample.stamp)
    run = newest_run(both)
    assert len(run) == 3
    assert messages_at_once(both, run) > 0
    assert messages_at_once(one, newest_run(one)) == 0


# -- checks in between ----------------------------------------------------------------------------

FAIL, PASS = 'FAIL', 'PASS'

# What is published before each check, by a publisher for each list, and what the check says.
Turn = tuple[Sequence[Sequence[int]], str, str]
TURNS: dict[str, list[Turn]] = {
    'one by one': [
        ([[1]], FAIL, 'Still missing: 3, 5.'),
        ([[3]], FAIL, 'Still missing: 5.'),
        ([[5]], PASS, ''),
    ],
    'pressed in between': [
        ([[1], [3]], FAIL, 'Go on with 5.'),
        ([], FAIL, 'Still missing: 5.'),
        ([[5]], PASS, ''),
        ([], PASS, ''),
    ],
    'a wrong one in between': [
        ([[1]], FAIL, 'Go on with 3, then 5.'),
        ([[8]], FAIL, 'Go on with 3, then 5.'),
        ([[3]], FAIL, 'Go on with 5.'),
        ([[3, 3]], FAIL, 'The same number came more than once'),
        ([[5]], PASS, ''),
    ],
    'wrong, then right': [
        ([[2], [4], [6]], FAIL, 'These are even numbers.'),
        ([[5], [3], [1]], FAIL, 'in another order'),
        ([[1], [3], [5]], PASS, ''),
    ],
    'begun twice': [([[1], [1], [3], [5]], PASS, '')],
    'twice': [([[1], [3], [5], [1], [3], [5]], PASS, ''), ([[1], [3], [5]], PASS, '')],
    'one publisher, twice': [([[1, 3, 5, 1, 3, 5]], PASS, '')],
    'a number twice': [([[1, 1], [3], [5]], FAIL, 'The same number came more than once')],
    'the last one twice': [([[1], [3], [5], [5]], FAIL, 'or a number came twice')],
    'other numbers, too': [([[1, 2, 3, 4, 5]], FAIL, 'Other numbers came as well')],
    'one more, of the same publisher': [([[8, 1, 3, 5]], FAIL, 'Other numbers came as well')],
    'one more at the end': [
        ([[1], [3], [5], [7]], FAIL, 'Publish all three numbers again'),
        ([], FAIL, 'Publish all three numbers again'),
        ([[1], [3], [5]], PASS, ''),
    ],
    'after PASS all counts anew': [
        ([[1], [3], [5]], PASS, ''),
        ([[5]], FAIL, 'Still missing: 1, 3.'),
    ],
}


@pytest.fixture
def odds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Exercise]:
    monkeypatch.setenv('LABKIT_HOME', str(tmp_path))
    labkit.start()
    (odds, _) = load('command_line').exercises
    odds.begin()
    odds.forget()
    yield odds
    labkit.stop()
    settings.after_start.clear()


def publish(*numbers: int) -> None:
    node = rclpy.create_node('teller')
    publisher = node.create_publisher(Int16, '/odds', 10)
    for number in numbers:
        publisher.publish(Int16(data=number))
    node.destroy_node()


@pytest.mark.slow('works through a lesson')
@pytest.mark.parametrize('turns', TURNS.values(), ids=TURNS)
def test_check_goes_on_from_what_was_right(turns: Sequence[Turn], odds: Exercise) -> None:
    for published, outcome, says in turns:
        for numbers in published:
            publish(*numbers)
        verdict = odds.check()
        text = ' '.join(repr(verdict).split())
        assert verdict.outcome.value == outcome, text
        assert says in text


@pytest.mark.slow('works through a lesson')
def test_loop_goes_on_after_it_was_held_up(odds: Exercise) -> None:
    node = rclpy.create_node('teller')
    publisher = node.create_publisher(Int16, '/odds', 10)
    said: list[int] = []

    def on_timer() -> None:
        said.append((1, 3, 5)[len(said) % 3])
        publisher.publish(Int16(data=said[-1]))
        if len(said) == 3:
            time.sleep(1.0)

    node.create_timer(0.1, on_timer)
    labkit.spin(node)
    assert 'messages that go on coming' in ' '.join(repr(odds.check()).split())


# -- the notebook ---------------------------------------------------------------------------------


@pytest.fixture
def notebook(start_kernel: Callable[..., Any]) -> Iterator[Any]:
    claim = domains.claim_domain()
    env = {'ROS_DOMAIN_ID': str(claim.domain_id), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
    kernel = start_kernel(**env)
    assert kernel.run(SETUP).error == ''
    yield kernel
    claim.close()


def check(kernel: Any, name: str) -> str:
    kernel.run(f'verdict = lesson.{name}.check()')
    return ' '.join(kernel.run('print(verdict)').text.split())


@pytest.mark.slow('works through a lesson')
def test_cells_of_the_exercises_run_after_a_restart(notebook: Any) -> None:
    cells = {cell.id: cell.source for cell in nbformat.read(NOTEBOOK, as_version=4).cells}
    assert cells['setup'] == SETUP
    notebook.run('lab.stop()')
    notebook.restart()
    for cell_id in ('setup', 'odds-starter', 'drive-starter'):
        assert notebook.run(cells[cell_id]).error == ''
    for name in ('odds', 'drive'):
        assert check(notebook, name).startswith('NOT ATTEMPTED')


@pytest.mark.slow('works through a lesson')
def test_commands_without_percent_are_told_so(notebook: Any) -> None:
    bare = ''.join(ONE.format(number) for number in (1, 3, 5)).replace('%', '')
    for cell in (bare, ONE.format(1) + bare, f'$ {bare}', f'number = 1\n{bare}'):
        assert notebook.run(cell).error.startswith('SyntaxError')
        text = check(notebook, 'odds')
        assert text.startswith('ERROR')
        assert 'A line of a cell that is for the command line begins with %.' in text


@pytest.mark.slow('recordings, in real time')
def test_recordings_go_on_after_stop_without_the_setup_cell(notebook: Any) -> None:
    for _ in range(2):
        notebook.run('lab.stop()')
        for number in (1, 3, 5):
            assert 'publishing #1' in notebook.run(ONE.format(number)).text
        assert check(notebook, 'odds').startswith('PASS')
        notebook.run('lab.stop()')
        notebook.run(f'%ros2 {DRIVE.format("--times 5 -r 10")}')
        assert check(notebook, 'drive').startswith('PASS')
    # The first thing that starts ROS again may be the check.
    notebook.run('lab.stop()')
    notebook.run('lesson.odds.forget()')
    assert check(notebook, 'odds').startswith('NOT ATTEMPTED')


@pytest.mark.slow('works through a lesson')
def test_terminal_is_heard(notebook: Any) -> None:
    """The process knows nothing of the notebook but its domain."""
    words = DRIVE.format('--times 5 --rate 10')
    environment = {'PYTHONPATH': os.fspath(NOTEBOOK.parents[1])}
    notebook.run(
        'import os, shlex, subprocess, sys\n'
        f'line = [sys.executable, "-m", "labkit.ros2", *shlex.split({words!r})]\n'
        f'done = subprocess.run(line, env={{**os.environ, **{environment!r}}})'
    )
    assert check(notebook, 'drive').startswith('PASS')
    # Sent to the background, it is judged when it has ended.
    notebook.run('terminal = subprocess.Popen(line)')
    text = check(notebook, 'drive')
    while 'un this cell again' in text:
        text = check(notebook, 'drive')
    assert text.startswith('PASS'), text
