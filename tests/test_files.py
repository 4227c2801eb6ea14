"""Files are written whole or not at all, whoever is killed, and whoever writes beside it."""

from __future__ import annotations

import errno
import os
import signal
import stat
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from labkit.files import (
    is_inside,
    locked,
    read_json,
    read_limited,
    rename_to_free,
    replaced,
    write_atomically,
)

TIMEOUT_SEC = 60
# Writes a file, but says so and waits when all of it is on its way and nothing in its place.
SLOW_WRITER = """
import os, sys
from pathlib import Path
from labkit.files import write_atomically
fsync = os.fsync
def slow(handle):
    fsync(handle)
    print('on its way', flush=True)
    sys.stdin.readline()
os.fsync = slow
write_atomically(Path(sys.argv[1]), b'from the other process')
"""


@pytest.fixture
def umask() -> Iterator[None]:
    """Let a test set the umask."""
    before = os.umask(0o022)
    yield
    os.umask(before)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def start_slow_writer(path: Path) -> subprocess.Popen[str]:
    """Start a process that has written a file, and has not yet put it in its place."""
    writer = subprocess.Popen(
        [sys.executable, '-c', SLOW_WRITER, str(path)],
        cwd=Path(__file__).parents[1],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert writer.stdout is not None
    assert writer.stdout.readline() == 'on its way\n'
    return writer


def test_new_and_replaced(tmp_path: Path) -> None:
    path = tmp_path / 'a.json'
    write_atomically(path, b'one')
    assert path.read_bytes() == b'one'
    write_atomically(path, b'')
    assert path.read_bytes() == b''
    with pytest.raises(FileExistsError) as caught:
        write_atomically(path, b'two', replace=False)
    assert caught.value.filename == str(path)
    assert (path.read_bytes(), names(tmp_path)) == (b'', ['a.json'])


def test_the_longest_name_there_can_be(tmp_path: Path) -> None:
    path = tmp_path / ('a' * os.pathconf(tmp_path, 'PC_NAME_MAX'))
    write_atomically(path, b'one')
    write_atomically(path, b'two')
    assert path.read_bytes() == b'two'


@pytest.mark.parametrize(('mask', 'expected'), [(0o022, 0o644), (0o077, 0o600), (0o002, 0o664)])
def test_a_new_file_gets_what_the_umask_leaves(
    umask: None, tmp_path: Path, mask: int, expected: int
) -> None:
    os.umask(mask)
    write_atomically(tmp_path / 'a', b'one')
    write_atomically(tmp_path / 'b', b'one', replace=False)
    assert (mode(tmp_path / 'a'), mode(tmp_path / 'b')) == (expected, expected)


@pytest.mark.parametrize('kept', [0o600, 0o664, 0o444, 0o755])
def test_a_file_that_is_there_keeps_its_permissions(
    umask: None, tmp_path: Path, kept: int
) -> None:
    os.umask(0o027)
    path = tmp_path / 'a'
    path.write_bytes(b'one')
    path.chmod(kept)
    write_atomically(path, b'two')
    assert (path.read_bytes(), mode(path)) == (b'two', kept)


def test_a_secret_is_at_no_moment_for_everybody(
    umask: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, seen, change = tmp_path / 'a', [], os.fchmod
    path.write_bytes(b'one')
    path.chmod(0o600)

    def look_first(handle: int, new: int) -> None:
        seen.append(stat.S_IMODE(os.fstat(handle).st_mode))
        change(handle, new)

    monkeypatch.setattr(os, 'fchmod', look_first)
    os.umask(0)
    write_atomically(path, b'two')
    assert seen == [0o600]


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / 'synced').mkdir()
    real, link = tmp_path / 'synced' / 'a', tmp_path / 'a'
    real.write_bytes(b'one')
    link.symlink_to(real)
    write_atomically(link, b'two')
    assert link.is_symlink() and real.read_bytes() == b'two'
    with pytest.raises(FileExistsError):
        write_atomically(link, b'three', replace=False)
    real.unlink()
    with pytest.raises(FileExistsError):
        write_atomically(link, b'four', replace=False)


@pytest.mark.parametrize('number', [errno.ENOSPC, errno.EIO])
def test_failure_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    path = tmp_path / 'a'
    path.write_bytes(b'one')

    def fail(_handle: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, 'fsync', fail)
    for replace in (True, False):
        with pytest.raises(OSError, match=os.strerror(number)) as caught:
            write_atomically(path if replace else tmp_path / 'b', b'two', replace=replace)
        assert caught.value.filename == str(path if replace else tmp_path / 'b')
    assert (path.read_bytes(), names(tmp_path)) == (b'one', ['a'])


def test_interrupt_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'a'
    path.write_bytes(b'one')

    def interrupt(*_paths: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, 'replace', interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(path, b'two')
    assert (path.read_bytes(), names(tmp_path)) == (b'one', ['a'])


def test_a_folder_that_may_not_be_written_to_is_named_by_the_file() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o555)
        user = os.geteuid()
        if user == 0:
            os.seteuid(65534)  # permissions do not stop root
        try:
            with pytest.raises(PermissionError) as caught:
                write_atomically(folder / 'a', b'one')
        finally:
            os.seteuid(user)
        assert caught.value.filename == str(folder / 'a')
        assert names(folder) == []


def test_a_folder_that_is_missing_is_named_by_the_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        write_atomically(tmp_path / 'no' / 'a', b'one')
    assert caught.value.filename == str(tmp_path / 'no' / 'a')


def test_what_a_killed_process_leaves_behind_goes_with_the_next_write(tmp_path: Path) -> None:
    path = tmp_path / 'a'
    path.write_bytes(b'one')
    with start_slow_writer(path) as writer:
        writer.send_signal(signal.SIGKILL)
    assert path.read_bytes() == b'one'
    assert len(names(tmp_path)) == 2
    write_atomically(tmp_path / 'b', b'two')
    assert names(tmp_path) == ['a', 'b']


def test_what_another_process_is_writing_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / 'a'
    with start_slow_writer(path) as writer:
        write_atomically(path, b'from this one')
        assert path.read_bytes() == b'from this one'
        assert len(names(tmp_path)) == 2
        writer.communicate('go on\n', timeout=TIMEOUT_SEC)
    assert writer.returncode == 0
    assert (path.read_bytes(), names(tmp_path)) == (b'from the other process', ['a'])


def test_what_is_taken_for_left_behind_too_early_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Another process looks between the moment when a file is made and that when it is locked.
    import fcntl

    lock = fcntl.flock
    taken: list[str] = []

    def take_first(handle: int, kind: int) -> None:
        if not taken and not kind & fcntl.LOCK_NB:
            (left,) = tmp_path.iterdir()
            taken.append(left.name)
            left.unlink()
        lock(handle, kind)

    monkeypatch.setattr(fcntl, 'flock', take_first)
    write_atomically(tmp_path / 'a', b'one')
    assert taken and names(tmp_path) == ['a']


def test_a_file_system_without_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import fcntl

    def refuse(*_arguments: object) -> None:
        raise OSError(errno.ENOLCK, 'No locks available')

    monkeypatch.setattr(fcntl, 'flock', refuse)
    (tmp_path / '.labkit-0.new').write_bytes(b'perhaps it is being written')
    write_atomically(tmp_path / 'a', b'one')
    assert names(tmp_path) == ['.labkit-0.new', 'a']


def test_threads_that_write_at_once_leave_what_one_of_them_wrote(tmp_path: Path) -> None:
    path, faults = tmp_path / 'a', []
    contents = [letter * 100_000 for letter in (b'a', b'b', b'c')]
    write_atomically(path, contents[0])

    def write(content: bytes) -> None:
        try:
            for _ in range(20):
                write_atomically(path, content)
        except Exception as error:  # a thread's own error would not fail the test
            faults.append(error)

    writers = [threading.Thread(target=write, args=(content,)) for content in contents]
    for writer in writers:
        writer.start()
    while any(writer.is_alive() for writer in writers):
        assert path.read_bytes() in contents
    assert not faults
    assert names(tmp_path) == ['a']


# --- Renaming ------------------------------------------------------------------------------------


def refuse_links(*_paths: object) -> None:
    raise OSError(errno.EPERM, 'Operation not permitted')


@pytest.mark.parametrize('links', [True, False], ids=['links', 'no links'])
@pytest.mark.parametrize('kind', ['file', 'link', 'folder'])
def test_rename(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, links: bool) -> None:
    if not links:
        monkeypatch.setattr(os, 'link', refuse_links)
    old, new = tmp_path / 'old', tmp_path / 'new'
    if kind == 'file':
        old.write_bytes(b'one')
    elif kind == 'link':
        old.symlink_to('/nowhere')
    else:
        old.mkdir()
        (old / 'inside').write_bytes(b'one')
    rename_to_free(old, new)
    assert names(tmp_path) == ['new']
    assert (new.is_symlink(), new.is_dir()) == (kind == 'link', kind == 'folder')
    old.write_bytes(b'two')
    with pytest.raises(FileExistsError):
        rename_to_free(old, new)
    assert (names(tmp_path), old.read_bytes()) == (['new', 'old'], b'two')


@pytest.mark.parametrize('links', [True, False], ids=['links', 'no links'])
def test_of_those_that_want_a_name_at_once_one_gets_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, links: bool
) -> None:
    if not links:
        monkeypatch.setattr(os, 'link', refuse_links)
    files = [tmp_path / str(number) for number in range(8)]
    for file in files:
        file.write_text(file.name)
    refused: list[str] = []
    start = threading.Barrier(len(files))

    def rename(file: Path) -> None:
        start.wait(TIMEOUT_SEC)
        try:
            rename_to_free(file, tmp_path / 'new')
        except FileExistsError:
            refused.append(file.name)

    threads = [threading.Thread(target=rename, args=(file,)) for file in files]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(refused) == len(files) - 1
    assert names(tmp_path) == sorted([*refused, 'new'])
    assert (tmp_path / 'new').read_text() not in refused


@pytest.mark.parametrize('links', [True, False], ids=['links', 'no links'])
def test_what_is_not_there_can_not_be_renamed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, links: bool
) -> None:
    if not links:
        monkeypatch.setattr(os, 'link', refuse_links)
    with pytest.raises(FileNotFoundError):
        rename_to_free(tmp_path / 'old', tmp_path / 'new')
    assert names(tmp_path) == []


# --- One at a time -------------------------------------------------------------------------------


def test_who_wants_a_lock_again_and_again_keeps_nobody_out(tmp_path: Path) -> None:
    path = tmp_path / 'a.lock'
    rounds = 0
    stop, held = threading.Event(), threading.Event()

    def insist() -> None:
        nonlocal rounds
        while not stop.is_set():
            with locked(path, TIMEOUT_SEC):
                rounds += 1
                held.set()
                stop.wait(0.02)

    thread = threading.Thread(target=insist)
    thread.start()
    try:
        waited = []
        for _ in range(20):
            held.clear()
            assert held.wait(TIMEOUT_SEC)  # now it has the lock, and will want it again
            before = rounds
            with locked(path, TIMEOUT_SEC):
                waited.append(rounds - before)
    finally:
        stop.set()
        thread.join()
    # Before this one has queued up, on a busy machine, it may have had some more; not hundreds.
    assert sum(waited) <= 100, waited


# --- What lies where -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('path', 'folder', 'inside'),
    [
        ('/a/b', '/a', True),
        ('/a', '/a', True),
        ('/a/', '/a', True),
        ('/a', '/', True),
        ('/ab', '/a', False),
        ('/a', '/a/b', False),
        ('/a/../b', '/a', False),
        ('/b/../a/c', '/a/.', True),
    ],
)
@pytest.mark.parametrize('follow_links', [True, False])
def test_is_inside(path: str, folder: str, inside: bool, follow_links: bool) -> None:
    assert is_inside(path, folder, follow_links=follow_links) is inside
    assert is_inside(Path(path), Path(folder), follow_links=follow_links) is inside


def test_links_are_followed_unless_it_counts_where_they_lie(tmp_path: Path) -> None:
    (tmp_path / 'venv').mkdir()
    link = tmp_path / 'venv' / 'python'
    link.symlink_to('/usr/bin/python3')
    assert is_inside(link, tmp_path / 'venv', follow_links=False)
    assert not is_inside(link, tmp_path / 'venv')
    (tmp_path / 'short').symlink_to(tmp_path / 'venv')
    assert is_inside(tmp_path / 'venv' / 'a', tmp_path / 'short')


def test_a_file_of_somebody_else_is_a_regular_one_of_a_bounded_size(tmp_path: Path) -> None:
    file, pipe = tmp_path / 'file', tmp_path / 'pipe'
    file.write_bytes(b'12345')
    os.mkfifo(pipe)  # without a writer, opening it would block
    assert read_limited(file, 5) == b'12345'
    with pytest.raises(OSError, match='Larger than 4 bytes'):
        read_limited(file, 4)
    for other in (pipe, tmp_path, Path('/dev/zero')):
        with pytest.raises(OSError, match='Not a regular file'):
            read_limited(other)


@pytest.mark.parametrize('text', ['[' * 100_000, '{"a":' * 100_000, '[' * 900 + '1', '', '\xff'])
def test_json_that_can_not_be_taken(tmp_path: Path, text: str) -> None:
    path = tmp_path / 'data.json'
    path.write_text(text, encoding='latin-1')
    with pytest.raises(ValueError, match=r'.'):
        read_json(path)


# --- What is replaced ----------------------------------------------------------------------------


@pytest.mark.parametrize('kind', ['folder', 'file', 'link', 'nothing'])
@pytest.mark.parametrize('fails', [False, True])
def test_a_name_is_replaced_or_as_it_was(tmp_path: Path, kind: str, fails: bool) -> None:
    target, place = tmp_path / 'target', tmp_path / 'place' / 'lab'
    for folder in (target, place.parent):
        folder.mkdir()
    (target / 'kept').write_text('years of work')
    if kind == 'folder':
        place.mkdir()
        (place / 'old').write_text('old')
        (place / 'inner').symlink_to(target)
    elif kind == 'file':
        place.write_text('old')
    elif kind == 'link':
        place.symlink_to(target)
    before = names(place) if kind in ('folder', 'link') else kind

    def make() -> None:
        with replaced(place):
            place.mkdir()
            (place / 'new').write_text('new')
            if fails:
                raise OSError(errno.ENOSPC, 'No space left on device')

    if not fails:
        make()
        assert names(place) == ['new'] and not place.is_symlink()
    else:
        with pytest.raises(OSError, match='No space'):
            make()
        assert place.is_symlink() == (kind == 'link')
        assert (names(place) if place.is_dir() else kind) == before
        assert names(place.parent) == ([] if kind == 'nothing' else ['lab'])
    assert (target / 'kept').read_text() == 'years of work' and names(target) == ['kept']


def test_a_lock_leaves_what_is_in_its_file(tmp_path: Path) -> None:
    own = tmp_path / 'thesis.txt'
    own.write_text('years of work')
    (tmp_path / 'lock').symlink_to(own)
    with locked(tmp_path / 'lock', 0):
        pass
    assert own.read_text() == 'years of work'
