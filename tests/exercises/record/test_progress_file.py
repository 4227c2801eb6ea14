from __future__ import annotations

import errno
import json
import os
import random
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from labkit.exercises.record import progress_file
from labkit.exercises.record.progress_file import Store
from labkit.exercises.record.progress_store import ProgressStore

# Notes one try after the other, and says how many it has noted.
WRITER = """
import sys
from pathlib import Path
from labkit.exercises.record import progress_file
from labkit.exercises.record.progress_store import ProgressStore
from labkit.exercises.record.progress_file import Store
# The lock is never held for long, but a disk of a busy machine may take seconds for one write.
progress_file.LOCK_TIMEOUT_SEC = 60
store = ProgressStore(Store(Path(sys.argv[1])))
for number in range(int(sys.argv[2])):
    note = store.note_check('odds', 'count_up', 'FAIL')
    assert note == '', note
    print(number + 1, flush=True)
"""


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path)


def tries(store: Store) -> int:
    data, note = store.read()
    assert note == ''
    return data['lessons'].get('odds', {}).get('exercises', {}).get('count_up', {}).get('tries', 0)


def start_writer(folder: Path, count: int) -> subprocess.Popen[str]:
    command = [sys.executable, '-c', WRITER, str(folder), str(count)]
    root = Path(__file__).resolve().parents[3]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=root)


def test_two_processes_that_write_at_once_lose_nothing(store: Store, tmp_path: Path) -> None:
    writers = [start_writer(tmp_path, 100) for _ in range(2)]
    for writer in writers:
        writer.communicate(timeout=300)
        assert writer.returncode == 0
    assert tries(store) == 200


@pytest.mark.slow('kills many processes')
def test_kill_at_any_moment_leaves_a_whole_file(store: Store, tmp_path: Path) -> None:
    chance = random.Random(1)
    noted = 0
    for _ in range(12):
        with start_writer(tmp_path, 10**6) as writer:
            assert writer.stdout is not None
            for _ in range(chance.randint(1, 30)):
                last = int(writer.stdout.readline())
            writer.send_signal(signal.SIGKILL)
            rest = writer.stdout.read().split()
        # It may have been killed between writing and saying so.
        last = int(rest[-1]) if rest else last
        found = tries(store)
        assert found - noted in (last, last + 1)
        noted = found


def test_killed_writer_leaves_nothing_that_stops_the_next(store: Store, tmp_path: Path) -> None:
    half = store.path.with_name('.labkit-0123456789abcdef.new')
    half.write_text('{"half')
    store.path.with_suffix('.lock').write_text('')
    assert ProgressStore(store).note_check('odds', 'count_up', 'PASS') == ''
    assert tries(store) == 1
    assert not half.exists()


@pytest.mark.parametrize(
    'content',
    ['', '{"version": 1, "les', 'null', '[]', '{"lessons": []}', '{"lessons": {"odds": 3}}',
     '{"lessons": {"odds": {"exercises": {"a": 1}}}}', '\x00\x01', '[' * 200_000,
     f'{{"lessons": {{}}, "new": {"[" * 600}{"]" * 600}}}'],
    ids=lambda content: content[:30],
)  # fmt: skip
def test_damaged_file_is_kept_aside_and_said_so(store: Store, content: str) -> None:
    store.path.write_text(content)
    note = ProgressStore(store).note_check('odds', 'count_up', 'PASS')
    assert 'damaged' in note and 'progress-damaged-1.json' in note
    assert [path.read_text() for path in store.damaged_files()] == [content]
    assert tries(store) == 1
    store.path.write_bytes(b'\xff\xfe')
    data, note = store.read()
    assert 'progress-damaged-2.json' in note and data['lessons'] == {}


def test_what_a_newer_version_has_added_is_kept(store: Store) -> None:
    store.path.write_text(json.dumps({'version': 2, 'new': [1], 'lessons': {}}))
    ProgressStore(store).note_hint('odds', 'count_up', 1)
    data, _ = store.read()
    assert data['new'] == [1] and data['version'] == 2


@pytest.mark.parametrize('where', ['.json', '.lock'])
def test_folder_that_cannot_be_written_is_said_and_nothing_raises(
    store: Store, where: str
) -> None:
    # Also for root, whom permissions do not stop: a folder is where a file should be.
    store.path.with_suffix(where).mkdir()
    note = ProgressStore(store).note_check('odds', 'count_up', 'PASS')
    assert note.startswith('Your progress could not be saved')


def test_full_disk_is_said_and_leaves_the_old_file(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    ProgressStore(store).note_check('odds', 'count_up', 'FAIL')

    def fail(_handle: int) -> None:
        raise OSError(errno.ENOSPC, 'No space left on device')

    monkeypatch.setattr(os, 'fsync', fail)
    note = ProgressStore(store).note_check('odds', 'count_up', 'PASS')
    assert note.startswith('Your progress could not be saved')
    assert 'No space left on device' in note
    assert tries(store) == 1


def test_home_that_is_a_file_is_said(tmp_path: Path) -> None:
    (tmp_path / 'home').write_text('')
    note = ProgressStore(Store(tmp_path / 'home')).note_check('odds', 'x', 'PASS')
    assert note.startswith('Your progress could not be saved')


def test_file_that_stays_locked_is_said(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    import fcntl

    monkeypatch.setattr(progress_file, 'LOCK_TIMEOUT_SEC', 0.1)
    with store.path.with_suffix('.lock').open('w') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        note = ProgressStore(store).note_check('odds', 'count_up', 'PASS')
    assert 'another notebook keeps the file locked' in note


def test_passed_stays_passed(store: Store) -> None:
    noting = ProgressStore(store)
    noting.note_check('odds', 'count_up', 'PASS')
    first = store.read()[0]['lessons']['odds']['exercises']['count_up']['passed_at']
    noting.note_check('odds', 'count_up', 'FAIL')
    entry = store.read()[0]['lessons']['odds']['exercises']['count_up']
    assert entry['passed_at'] == first and entry['last'] == 'FAIL' and entry['tries'] == 2


def test_check_that_was_not_attempted_is_not_counted(store: Store) -> None:
    ProgressStore(store).note_check('odds', 'count_up', 'NOT ATTEMPTED')
    assert not store.path.exists()


def test_program_that_runs_a_notebook_leaves_no_trace(home: Path) -> None:
    code = (
        'from labkit.exercises.record.progress_store import progress_store as store\n'
        "store.note_check('odds', 'count_up', 'PASS')\n"
        "print(store.store.read()[0]['lessons']['odds']['exercises']['count_up']['tries'])"
    )
    root = Path(__file__).resolve().parents[3]
    env = {**os.environ, 'LABKIT_HEADLESS': '1', 'LABKIT_HOME': str(home)}
    done = subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, cwd=root, env=env
    )
    assert done.stdout == '1\n', done.stderr
    assert not home.exists()


def test_a_pipe_instead_of_the_file_holds_up_nothing(store: Store) -> None:
    store.path.parent.mkdir(exist_ok=True)
    os.mkfifo(store.path)
    assert 'Not a regular file' in store.read()[1]
    assert 'Not a regular file' in ProgressStore(store).note_check('odds', 'count_up', 'PASS')


def test_what_was_done_follows_an_exercise_into_another_lesson(store: Store) -> None:
    old = {
        'theory': {'exercises': {'ears': {'tries': 2}, 'mouth': {'tries': 1}}, 'questions': {}},
        'talker_listener': {'exercises': {'mouth': {'tries': 5}, 'say_once': {'tries': 1}}},
    }
    store.path.write_text(json.dumps({'version': 1, 'lessons': old}))
    data, note = store.read()
    assert note == ''
    assert data['lessons']['theory']['exercises'] == {}
    now = data['lessons']['talker_listener']['exercises']
    assert {name: entry['tries'] for name, entry in now.items()} == {
        'say_once': 1,
        'ears': 2,
        'mouth': 5,
    }
    store.update(lambda data: None)
    assert 'ears' not in json.loads(store.path.read_text())['lessons']['theory']['exercises']
