"""A learner joins a class, continues, leaves; in this process and in separate kernels."""

from __future__ import annotations

import json
import os
import stat
from pathlib import Path

import pytest

from labkit import settings
from labkit.errors import LabError
from labkit.exercises.record import membership
from labkit.exercises.record.class_sheet import FILE_NAME
from labkit.exercises.record.membership import (
    follow_class,
    join_class,
    leave_class,
    wait_until_sent,
)
from labkit.exercises.record.progress_file import Store
from labkit.exercises.record.progress_store import ProgressStore, progress_store


@pytest.fixture(autouse=True)
def alone(monkeypatch: pytest.MonkeyPatch, home: Path) -> None:
    """Start without a class, and without followers from other tests."""
    for name in ('LABKIT_CLASS_FOLDER', 'JUPYTERHUB_USER', 'LABKIT_HEADLESS'):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(settings, 'audience', lambda: settings.TERMINAL)
    monkeypatch.setattr(progress_store, 'store', Store())
    monkeypatch.setattr(progress_store, 'after_change', [])
    monkeypatch.setattr(membership, '_sender', membership._Sender())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / 'class'
    made.mkdir()
    return made


def entries(folder: Path, name: str) -> dict[str, int]:
    data = json.loads((folder / name / FILE_NAME).read_text())
    return {item['name']: item['tries'] for item in data['entries']}


def test_a_learner_joins_works_and_leaves(folder: Path) -> None:
    progress_store.note_check('odds', 'count_up', 'FAIL')
    card = join_class('anna', folder=folder)
    # The card shows the sheet.
    path = folder / 'anna' / FILE_NAME
    assert card.code == path.read_text()
    assert ('Where', str(path)) in card.rows and 'lab.leave_class()' in repr(card)
    follow_class('odds')
    progress_store.note_check('odds', 'evens', 'FAIL')
    progress_store.note_check('odds', 'evens', 'FAIL')
    assert wait_until_sent(60)
    assert entries(folder, 'anna') == {'count_up': 1, 'evens': 2}
    assert json.loads(path.read_text())['lesson'] == 'odds'
    assert join_class().code == path.read_text()
    assert str(path) in leave_class().text
    progress_store.note_check('odds', 'evens', 'PASS')
    assert wait_until_sent(60)
    assert list(folder.iterdir()) == []
    assert 'You share nothing' in repr(leave_class())


def test_nothing_is_sent_unless_one_has_joined(folder: Path, monkeypatch) -> None:
    monkeypatch.setenv('LABKIT_CLASS_FOLDER', str(folder))
    monkeypatch.setenv('JUPYTERHUB_USER', 'anna')
    follow_class('odds')
    progress_store.note_check('odds', 'count_up', 'PASS')
    assert wait_until_sent(60)
    assert list(folder.iterdir()) == []


def test_a_program_that_runs_a_lesson_shares_nothing(folder: Path, monkeypatch) -> None:
    join_class('anna', folder=folder)
    before = (folder / 'anna' / FILE_NAME).read_text()
    monkeypatch.setattr(settings, 'audience', lambda: settings.RECORDING)
    assert 'Nothing is shared' in repr(join_class('ben', folder=folder))
    follow_class('odds')
    assert progress_store.after_change == []
    assert (folder / 'anna' / FILE_NAME).read_text() == before
    assert [path.name for path in folder.iterdir()] == ['anna']


def test_other_notebooks_of_a_member_share_too(folder: Path, script, home: Path) -> None:
    join_class('anna', folder=folder)
    done = script(
        'from labkit.exercises.record.progress_store import progress_store\n'
        'from labkit.exercises.record.membership import follow_class, wait_until_sent\n'
        'follow_class("talker_listener")\n'
        'progress_store.note_check("talker_listener", "every_two_seconds", "PASS")\n'
        'assert wait_until_sent(60)\n',
        LABKIT_HOME=str(home),
    )
    assert done.exit_code == 0, done.stderr
    assert entries(folder, 'anna') == {'every_two_seconds': 1}


@pytest.mark.parametrize('name', ['', ' anna', 'a/b', '..', '.anna', 'a\nb', 'a\u202eb', 'x' * 41])
def test_what_can_be_no_name_is_refused(folder: Path, name: str) -> None:
    with pytest.raises(LabError):
        join_class(name, folder=folder)
    assert list(folder.iterdir()) == []


def test_what_is_wrong_is_said(folder: Path, home: Path) -> None:
    with pytest.raises(LabError, match='Which class'):
        join_class('anna')
    with pytest.raises(LabError, match='What are you called'):
        join_class(folder=folder)
    with pytest.raises(LabError, match='is not there'):
        join_class('anna', folder=folder / 'nowhere')
    (folder / 'anna').mkdir()
    with pytest.raises(LabError, match="There is a 'anna' in"):
        join_class('anna', folder=folder)
    assert not (home / 'class.json').exists()


def test_who_can_not_be_noted_as_a_member_shares_nothing(folder: Path) -> None:
    membership._path().mkdir(parents=True)  # as unwritable as a full disk
    with pytest.raises(LabError, match='Nothing is shared') as caught:
        join_class('anna', folder=folder)
    assert 'disk full' in caught.value.todo
    assert list(folder.iterdir()) == []


def test_another_name_leaves_nothing_under_the_old_one(folder: Path) -> None:
    join_class('anna', folder=folder)
    join_class('Ännchen of the 2nd row', folder=folder)
    assert [path.name for path in folder.iterdir()] == ['Ännchen of the 2nd row']


def test_a_link_that_somebody_lays_leads_nowhere(folder: Path, tmp_path: Path) -> None:
    join_class('anna', folder=folder)
    mine = tmp_path / 'mine'
    mine.write_text('dear diary')
    sheet = folder / 'anna' / FILE_NAME
    sheet.unlink()
    sheet.symlink_to(mine)
    join_class()
    assert mine.read_text() == 'dear diary'
    assert not sheet.is_symlink() and json.loads(sheet.read_text())['version'] == 1


def test_teachers_may_read_it_whatever_the_umask_says(folder: Path) -> None:
    before = os.umask(0o077)
    try:
        join_class('anna', folder=folder)
        join_class()
    finally:
        os.umask(before)
    sheet = folder / 'anna' / FILE_NAME
    assert stat.S_IMODE(sheet.stat().st_mode) == 0o644
    assert stat.S_IMODE(sheet.parent.stat().st_mode) == 0o755


def test_a_drive_that_is_gone_holds_up_nothing(folder: Path) -> None:
    join_class('anna', folder=folder)
    follow_class('odds')
    assert wait_until_sent(60)
    (folder / 'anna' / FILE_NAME).unlink()
    (folder / 'anna').rmdir()
    assert progress_store.note_check('odds', 'count_up', 'FAIL') == ''
    assert wait_until_sent(60)
    (folder / 'anna').mkdir()
    progress_store.note_check('odds', 'count_up', 'FAIL')
    assert wait_until_sent(60)
    assert entries(folder, 'anna') == {'count_up': 2}


def test_on_a_hub_name_and_folder_are_known(folder: Path, monkeypatch, home: Path) -> None:
    monkeypatch.setenv('LABKIT_CLASS_FOLDER', str(folder))
    monkeypatch.setenv('JUPYTERHUB_USER', 'anna')
    (folder / 'anna').mkdir()
    ProgressStore(Store()).note_check('odds', 'count_up', 'PASS')
    assert 'your teachers' in repr(join_class())
    assert entries(folder, 'anna') == {'count_up': 1}
    leave_class()
    # The folder is the hub's.
    assert list((folder / 'anna').iterdir()) == []
