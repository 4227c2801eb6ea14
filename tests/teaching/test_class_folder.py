"""What lies in the folder of a class is read, whatever it is, and does no harm."""

from __future__ import annotations

import csv
import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import pytest

from labkit.errors import LabError
from labkit.exercises.record.class_sheet import FILE_NAME, MOST_BYTES
from labkit.teaching import class_folder
from labkit.teaching.class_folder import MAX_LEARNERS, ClassFolder, chosen_folder
from labkit.teaching.counting import count
from labkit.teaching.tables import gradebook, table
from labkit.views.class_board import text_form

NOW = datetime.now(timezone.utc).replace(microsecond=0)
COUNT_UP = {'lesson': 'odds', 'kind': 'exercise', 'name': 'count_up'}


def sheet(*entries: dict[str, Any], **head: Any) -> bytes:
    data = {'version': 1, 'written_at': NOW.isoformat(), 'entries': list(entries), **head}
    return json.dumps(data).encode()


@pytest.fixture
def share(tmp_path: Path) -> Callable[..., Path]:
    """Give a function that lays a sheet into somebody's folder, and returns its path."""

    def lay(name: str, content: bytes | None = None) -> Path:
        path = tmp_path / name / FILE_NAME
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(sheet() if content is None else content)
        return path

    return lay


def all_forms(path: Path) -> str:
    """Return all that is shown or written of a class."""
    reading = ClassFolder(path).read()
    board = count(reading, NOW)
    return '\n'.join(
        [
            text_form(board, names=True),
            text_form(board, names=False),
            table(reading.learners, NOW),
            gradebook(reading.learners),
        ]
    )


def test_a_class_is_read(share: Callable[..., Path], tmp_path: Path) -> None:
    share('anna', sheet({**COUNT_UP, 'tries': 2, 'last': 'FAIL'}))
    share('ben')
    (tmp_path / 'carl').mkdir()
    reading = ClassFolder(tmp_path).read()
    assert [learner.name for learner in reading.learners] == ['anna', 'ben']
    assert reading.silent == 1 and reading.note == ''
    assert reading.learners[0].sheet is not None
    assert reading.learners[0].sheet.entries['odds', 'exercise', 'count_up'].tries == 2
    # One account made all of it, so it could have made any name up.
    assert not any(learner.certain for learner in reading.learners)


def test_what_is_written_anew_is_read_anew(share: Callable[..., Path], tmp_path: Path) -> None:
    share('anna')
    folder = ClassFolder(tmp_path)
    (before,) = folder.read().learners
    (same,) = folder.read().learners
    assert same is before
    share('anna', sheet({**COUNT_UP, 'tries': 7}))
    (after,) = folder.read().learners
    assert after.sheet is not None and len(after.sheet.entries) == 1
    (tmp_path / 'anna' / FILE_NAME).unlink()
    assert folder.read().learners == ()


# --- Whatever lies there -------------------------------------------------------------------------


def huge(path: Path) -> None:
    with path.open('wb') as file:
        file.truncate(1_000_000_000)


def link(path: Path) -> None:
    path.symlink_to('/etc/passwd')


def device(path: Path) -> None:
    path.symlink_to('/dev/zero')


def second_name(path: Path) -> None:
    other = path.parent.parent / 'of somebody else'
    other.write_bytes(sheet())
    os.link(other, path)


def socket(path: Path) -> None:
    # A path of a socket is short, so it is made from where it lies.
    code = f'import socket; socket.socket(socket.AF_UNIX).bind({FILE_NAME!r})'
    subprocess.run([sys.executable, '-c', code], cwd=path.parent, check=True)


@pytest.mark.parametrize(
    ('lay', 'trouble'),
    [
        (huge, 'too large'),
        (lambda path: path.write_bytes(b' ' * (MOST_BYTES + 1)), 'too large'),
        (os.mkfifo, 'no ordinary file'),
        (os.mkdir, 'no ordinary file'),
        (socket, 'no ordinary file'),
        (link, 'a link'),
        (device, 'a link'),
        (second_name, 'a file of somebody else'),
        (lambda path: path.write_bytes(b'[' * MOST_BYTES), 'no JSON'),
        (lambda path: path.write_bytes(b'\x00\xff' * 1000), 'no JSON'),
        (lambda path: path.write_bytes(sheet({**COUNT_UP, 'tries': 'many'})), 'tries is no int'),
    ],
)
def test_one_who_sends_anything_else_is_told_and_others_are_read(
    lay: Callable[[Path], None], trouble: str, share: Callable[..., Path], tmp_path: Path
) -> None:
    share('anna')
    (tmp_path / 'mallory').mkdir()
    lay(tmp_path / 'mallory' / FILE_NAME)
    anna, mallory = ClassFolder(tmp_path).read().learners
    assert anna.sheet is not None
    assert (mallory.sheet, mallory.trouble) == (None, trouble)
    board = count(ClassFolder(tmp_path).read(), NOW)
    assert board.note.startswith('From 1 of them came something that can not be used.')
    assert f'can not be used: {trouble}' in text_form(board, names=True)
    assert 'mallory' not in text_form(board, names=False)


def test_a_file_that_grows_while_it_is_read_is_not_read_to_its_end(
    share: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = share('mallory')
    asked = []
    real = os.read

    def read(file: int, size: int) -> bytes:
        asked.append(size)
        with path.open('ab') as more:
            more.write(b' ' * MOST_BYTES)
        return real(file, size)

    monkeypatch.setattr(class_folder.os, 'read', read)
    (mallory,) = ClassFolder(tmp_path).read().learners
    assert mallory.trouble == 'too large'
    assert sum(asked) < 3 * MOST_BYTES


def test_what_is_no_folder_of_a_learner_is_counted_and_not_opened(
    share: Callable[..., Path], tmp_path: Path
) -> None:
    share('anna')
    os.mkfifo(tmp_path / 'ben')
    (tmp_path / 'carl').symlink_to(tmp_path / 'anna')
    (tmp_path / 'dora').write_text('x')
    reading = ClassFolder(tmp_path).read()
    assert [learner.name for learner in reading.learners] == ['anna']
    assert reading.note.startswith('3 things in the folder')


@pytest.mark.slow('writes 100,000 files')
def test_a_hundred_thousand_entries_do_not_push_a_class_out(
    share: Callable[..., Path], tmp_path: Path
) -> None:
    for name in ('anna', 'zoe'):
        share(name)
    folder = ClassFolder(tmp_path)
    assert len(folder.read().learners) == 2
    for number in range(100_000):
        (tmp_path / f'm{number}').touch()
    for number in range(2 * MAX_LEARNERS):
        share(f'mallory {number}')
    reading = folder.read()
    names = {learner.name for learner in reading.learners}
    assert {'anna', 'zoe'} <= names and len(names) <= MAX_LEARNERS
    assert 'more names in the folder than a class has' in reading.note


HOSTILE = (
    '<img src=x onerror=alert(1)>',
    '=HYPERLINK("http:evil")',
    '+1',
    '-1',
    '@SUM(A1)',
    '\t=1',
    ' =1',
    'anna\u202egnp.',
    'ben\x1b[31m',
    'ben\nmaria',
    os.fsdecode(b'\xff\xfe'),
    'x' * 200,
)


@pytest.mark.parametrize('name', HOSTILE)
def test_names_turn_no_line_and_are_no_formula(
    name: str, share: Callable[..., Path], tmp_path: Path
) -> None:
    share(name)
    (learner,) = ClassFolder(tmp_path).read().learners
    assert learner.name.isprintable() and len(learner.name) <= 40
    shown = all_forms(tmp_path)
    shown.encode()
    assert '\x1b' not in shown and '\u202e' not in shown
    reading = ClassFolder(tmp_path).read()
    for text in (table(reading.learners, NOW), gradebook(reading.learners)):
        for row in csv.reader(io.StringIO(text)):
            assert not any(cell.lstrip().startswith(('=', '+', '-', '@')) for cell in row)


def test_a_folder_that_is_gone_or_closed_is_said(
    share: Callable[..., Path], tmp_path: Path
) -> None:
    reading = ClassFolder(tmp_path / 'nowhere').read()
    assert reading.learners == () and 'can not be read' in reading.note
    shown = text_form(count(reading, NOW), names=True)
    assert 'can not be read' in shown and 'Nobody shares' not in shown
    for wrong in (tmp_path / 'nowhere', share('anna')):
        with pytest.raises(LabError, match='is not a folder'):
            chosen_folder(wrong)


def test_which_folder_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv('LABKIT_CLASS_FOLDER', raising=False)
    with pytest.raises(LabError, match='Which class'):
        chosen_folder(None)
    monkeypatch.setenv('LABKIT_CLASS_FOLDER', str(tmp_path))
    assert chosen_folder(None) == tmp_path


@pytest.mark.skipif(os.geteuid() != 0, reason='only root gives folders to accounts')
def test_the_machine_vouches_for_a_name_that_it_has_given(
    share: Callable[..., Path], tmp_path: Path
) -> None:
    tmp_path.chmod(0o755)
    for name, owner, mode in (('anna', 4001, 0o755), ('ben', 4002, 0o777), ('carl', 0, 0o755)):
        path = share(name)
        os.chown(path, owner, owner)
        os.chown(path.parent, owner, owner)
        path.parent.chmod(mode)
    # In dora's folder lies a file of anna's.
    path = share('dora')
    os.chown(path.parent, 4003, 4003)
    os.chown(path, 4001, 4001)
    anna, ben, carl, dora = ClassFolder(tmp_path).read().learners
    assert anna.certain and not ben.certain and not carl.certain
    assert dora.sheet is None and dora.trouble == 'a file of somebody else'
    board = count(ClassFolder(tmp_path).read(), NOW)
    assert board.certain and 'those of their accounts' in board.told
    assert [row.remark for row in board.learners if row.name == 'ben'] == [
        'others can write there'
    ]
    tmp_path.chmod(0o777)
    assert not any(learner.certain for learner in ClassFolder(tmp_path).read().learners)
    assert 'So are the names.' in count(ClassFolder(tmp_path).read(), NOW).told
    # What is remembered of a folder does not outlive that it was opened to others.
    later = NOW + timedelta(days=1)
    assert not count(ClassFolder(tmp_path).read(), later).certain
