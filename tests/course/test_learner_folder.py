"""The learner's folder: nothing that a learner has written is ever lost."""

from __future__ import annotations

import errno
import json
import os
import shutil
import stat
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from courses import START, notebook

from labkit.course import learner_folder
from labkit.errors import LabError, SetupError

TALKER = '02_talker_listener.ipynb'


@pytest.fixture
def lessons(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder with two published lessons and a picture; labkit's own look at it."""
    folder = tmp_path / 'notebooks'
    (folder / 'images').mkdir(parents=True)
    (folder / START).write_text(notebook('1 + 1'))
    (folder / TALKER).write_text(notebook('2 + 2'))
    (folder / 'images' / 'graph.svg').write_text('<svg/>')
    (folder / '.ipynb_checkpoints').mkdir()
    (folder / '.ipynb_checkpoints' / START).write_text('left by JupyterLab')
    monkeypatch.setattr(learner_folder, 'LESSONS', folder)
    monkeypatch.setattr(learner_folder, 'WORK', tmp_path / 'work')
    return folder


@pytest.fixture
def work(lessons: Path) -> Path:
    """Give the learner's folder with all copies in it."""
    assert learner_folder.copy_lessons() == []
    return learner_folder.WORK


def source_of(path: Path) -> str:
    return str(json.loads(path.read_text())['cells'][0]['source'][0])


def test_copies_come_without_outputs_and_with_their_pictures(work: Path) -> None:
    files = sorted(str(p.relative_to(work)) for p in work.rglob('*') if p.is_file())
    assert files == ['.labkit.json', START, TALKER, 'images/graph.svg']
    cell = json.loads((work / START).read_text())['cells'][0]
    assert (cell['outputs'], cell['execution_count']) == ([], None)
    assert (cell['id'], cell['metadata']) == ('talker-class', {'tags': ['nbval-ignore-output']})


def test_update_reaches_untouched_lessons_and_spares_edited_ones(
    lessons: Path, work: Path
) -> None:
    (work / TALKER).write_text(notebook('my own'))
    assert learner_folder.copy_lessons() == []
    (lessons / START).write_text(notebook('1 + 1 + 1'))
    (lessons / TALKER).write_text(notebook('2 + 2 + 2'))
    (lessons / '03_command_line.ipynb').write_text(notebook('3'))
    news = learner_folder.copy_lessons()
    assert len(news) == 1
    assert TALKER in news[0] and 'python3 -m labkit reset 02' in news[0]
    assert source_of(work / START) == '1 + 1 + 1'
    assert (work / TALKER).read_text() == notebook('my own')
    assert (work / '03_command_line.ipynb').is_file()


def test_a_newer_version_by_git_spares_what_is_the_learners(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = Path(__file__).resolve().parents[2]
    assert '\ngit pull\npython3 -m labkit lab\n' in (root / 'README.md').read_text()
    theirs, clone = tmp_path / 'theirs', tmp_path / 'clone'

    def git(folder: Path, *words: str) -> str:
        who = ['-c', 'user.name=A', '-c', 'user.email=a@example.org']
        command = ['git', *who, *words]
        return subprocess.run(
            command, cwd=folder, check=True, capture_output=True, text=True
        ).stdout

    (theirs / 'notebooks').mkdir(parents=True)
    shutil.copy(root / '.gitignore', theirs)
    for name in (START, TALKER):
        (theirs / 'notebooks' / name).write_text(notebook('1'))
    git(theirs, 'init', '-q')
    git(theirs, 'add', '.')
    git(theirs, 'commit', '-qm', 'One')
    git(tmp_path, 'clone', '-q', str(theirs), str(clone))
    monkeypatch.setattr(learner_folder, 'LESSONS', clone / 'notebooks')
    monkeypatch.setattr(learner_folder, 'WORK', clone / 'work')
    learner_folder.copy_lessons()
    (clone / 'work' / TALKER).write_text(notebook('my own'))
    (clone / 'work' / 'nodes').mkdir()
    (clone / 'work' / 'nodes' / 'mine.py').write_text('pass\n')

    for name in (START, TALKER):
        (theirs / 'notebooks' / name).write_text(notebook('2'))
    git(theirs, 'commit', '-qam', 'Two')
    git(clone, 'pull')
    news = learner_folder.copy_lessons()
    assert len(news) == 1 and TALKER in news[0]
    assert source_of(clone / 'work' / START) == '2'
    assert source_of(clone / 'work' / TALKER) == 'my own'
    assert (clone / 'work' / 'nodes' / 'mine.py').read_text() == 'pass\n'
    assert git(clone, 'status', '--porcelain') == ''


def test_nothing_is_written_twice(work: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in work.rglob('*.ipynb')}
    learner_folder.copy_lessons()
    assert {path: path.stat().st_mtime_ns for path in work.rglob('*.ipynb')} == before


@pytest.mark.parametrize('damage', ['', '{"00_st', '[]', '{"00_start_here.ipynb": 5}', '\x00\xff'])
def test_damaged_record_loses_nothing(lessons: Path, work: Path, damage: str) -> None:
    (work / TALKER).write_text(notebook('my own'))
    (work / '.labkit.json').write_text(damage, encoding='latin-1')
    (lessons / START).write_text(notebook('new'))
    (lessons / TALKER).write_text(notebook('new'))
    learner_folder.copy_lessons()
    assert (work / TALKER).read_text() == notebook('my own')
    # What can't be told from the learner's work is taken for it, until it is asked for.
    assert source_of(work / START) == '1 + 1'
    learner_folder.reset('00')
    assert source_of(work / START) == 'new'
    (lessons / START).write_text(notebook('newer'))
    learner_folder.copy_lessons()
    assert source_of(work / START) == 'newer'


def test_folder_without_a_record_is_the_learners(lessons: Path) -> None:
    learner_folder.WORK.mkdir()
    (learner_folder.WORK / TALKER).write_text(notebook('my own'))
    assert TALKER in learner_folder.copy_lessons()[0]
    assert (learner_folder.WORK / TALKER).read_text() == notebook('my own')


@pytest.mark.parametrize('word', ['02', '2', 'talker', '02_talker_listener', TALKER])
def test_reset_keeps_each_old_copy(work: Path, word: str) -> None:
    for number in (1, 2, 3):
        (work / TALKER).write_text(notebook(f'attempt {number}'))
        assert f'backups/02_talker_listener.backup-{number}.ipynb' in learner_folder.reset(word)
    assert source_of(work / TALKER) == '2 + 2'
    folder = work / 'backups'
    backups = [folder / f'02_talker_listener.backup-{number}.ipynb' for number in (1, 2, 3)]
    assert [source_of(path) for path in backups] == ['attempt 1', 'attempt 2', 'attempt 3']
    assert 'is a fresh copy already' in learner_folder.reset(word)
    assert sorted(folder.iterdir()) == backups


def test_backups_among_the_lessons_go_to_the_others(work: Path) -> None:
    """As they were made before there was a folder for them."""
    (work / 'backups').mkdir()
    (work / 'backups' / '02_talker_listener.backup-1.ipynb').write_text('old')
    names = ('02_talker_listener.backup-1.ipynb', '02_talker_listener.backup-12.ipynb')
    for name in names:
        (work / name).write_text(name)
    mine = work / 'my.backup-1.ipynb'
    mine.write_text('mine')
    assert learner_folder.copy_lessons() == []
    found = {path.name: path.read_text() for path in (work / 'backups').iterdir()}
    assert found == {
        names[0]: 'old',
        '02_talker_listener.backup-2.ipynb': names[0],
        names[1]: names[1],
    }
    assert [path.name for path in work.glob('*backup-*')] == [mine.name]


def test_file_in_the_place_of_the_backups_loses_nothing(work: Path) -> None:
    (work / 'backups').write_text('notes')
    (work / '02_talker_listener.backup-1.ipynb').write_text('old')
    assert learner_folder.copy_lessons() == []
    (work / TALKER).write_text(notebook('mine'))
    with pytest.raises(LabError, match='Move it away'):
        learner_folder.reset('02')
    assert (work / '02_talker_listener.backup-1.ipynb').read_text() == 'old'
    assert source_of(work / TALKER) == 'mine'


def test_reset_of_a_deleted_lesson(work: Path) -> None:
    (work / TALKER).unlink()
    learner_folder.reset('02')
    assert source_of(work / TALKER) == '2 + 2'
    assert not list(work.rglob('*backup*'))


@pytest.mark.parametrize('word', ['7', '99', 'tlaker', '', '_'])
def test_reset_of_what_is_no_lesson(work: Path, word: str) -> None:
    with pytest.raises(LabError, match='00_start_here, 02_talker_listener'):
        learner_folder.reset(word)


@pytest.fixture
def narrow_umask() -> Iterator[None]:
    """Let what is made here be for its owner alone."""
    before = os.umask(0o077)
    yield
    os.umask(before)


def test_copies_are_for_those_whom_the_umask_lets(narrow_umask: None, work: Path) -> None:
    (work / START).chmod(0o640)
    (work / START).write_text(notebook('an attempt'))
    learner_folder.reset('00')
    files = [path for path in work.rglob('*') if path.is_file() and 'backup' not in path.name]
    assert len(files) == 4
    assert {stat.S_IMODE(path.stat().st_mode) for path in files} == {0o600}


def test_update_keeps_the_permissions_of_a_copy(lessons: Path, work: Path) -> None:
    (work / START).chmod(0o640)
    (lessons / START).write_text(notebook('1 + 1 + 1'))
    learner_folder.copy_lessons()
    assert source_of(work / START) == '1 + 1 + 1'
    assert stat.S_IMODE((work / START).stat().st_mode) == 0o640


def test_file_systems_without_hard_links(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_paths: object) -> None:
        raise OSError('Operation not permitted')

    monkeypatch.setattr(os, 'link', refuse)
    for number in (1, 2):
        (work / TALKER).write_text(notebook(f'attempt {number}'))
        learner_folder.reset('02')
    assert source_of(work / 'backups' / '02_talker_listener.backup-1.ipynb') == 'attempt 1'
    assert source_of(work / 'backups' / '02_talker_listener.backup-2.ipynb') == 'attempt 2'


def test_odd_things_in_the_way_stay(lessons: Path) -> None:
    learner_folder.WORK.mkdir()
    (learner_folder.WORK / START).mkdir()
    (learner_folder.WORK / TALKER).symlink_to('/nowhere')
    assert len(learner_folder.copy_lessons()) == 2
    assert (learner_folder.WORK / START).is_dir()
    assert (learner_folder.WORK / TALKER).is_symlink()


def test_file_instead_of_the_folder(lessons: Path) -> None:
    learner_folder.WORK.write_text('notes')
    with pytest.raises(SetupError, match='Move it away'):
        learner_folder.copy_lessons()
    assert learner_folder.WORK.read_text() == 'notes'


@pytest.fixture
def linked(lessons: Path, work: Path) -> Path:
    """Give a file outside of the folder, untouched, that a relative link in it leads to."""
    (work.parent / 'shared').mkdir()
    target = work.parent / 'shared' / TALKER
    (work / TALKER).rename(target)
    (work / TALKER).symlink_to(f'../shared/{TALKER}')
    (lessons / TALKER).write_text(notebook('newer'))
    return target


def test_an_update_writes_through_no_link(work: Path, linked: Path) -> None:
    before = linked.read_bytes()
    (said,) = learner_folder.copy_lessons()
    assert TALKER in said and 'labkit reset 02' in said
    assert (work / TALKER).is_symlink() and linked.read_bytes() == before


def test_a_reset_keeps_a_link_and_what_it_leads_to(work: Path, linked: Path) -> None:
    before = linked.read_bytes()
    learner_folder.reset('02')
    assert source_of(work / TALKER) == 'newer' and not (work / TALKER).is_symlink()
    assert linked.read_bytes() == before
    backup = work / 'backups' / '02_talker_listener.backup-1.ipynb'
    assert backup.read_bytes() == before


def test_backups_on_another_disk_lose_nothing(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder for them is a link to it; files can't be renamed from one disk to another."""

    def refuse(*_paths: object) -> None:
        raise OSError(errno.EXDEV, os.strerror(errno.EXDEV))

    (work / TALKER).write_text(notebook('mine'))
    monkeypatch.setattr(os, 'link', refuse)
    monkeypatch.setattr(os, 'replace', refuse)
    monkeypatch.setattr(learner_folder, 'copy_lessons', list)
    with pytest.raises(LabError, match='cross-device'):
        learner_folder.reset('02')
    assert source_of(work / TALKER) == 'mine'
    assert list((work / 'backups').iterdir()) == []
