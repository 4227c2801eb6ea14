"""Notebooks that are lost come back: from copies that are made as JupyterLab saves them."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from courses import ROOT, START, notebook
from traitlets.config import PyFileConfigLoader

from labkit.__main__ import main
from labkit.course import copies, learner_folder

TALKER = '02_talker_listener.ipynb'
CONFIG = ROOT / 'labkit' / 'data' / 'etc' / 'jupyter' / 'jupyter_server_config.py'
Save = Callable[..., None]


@pytest.fixture
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a learner's folder with two lessons."""
    lessons, folder = tmp_path / 'notebooks', tmp_path / 'work'
    lessons.mkdir()
    for name in (START, TALKER):
        (lessons / name).write_text(notebook('as published'))
    monkeypatch.setattr(learner_folder, 'LESSONS', lessons)
    monkeypatch.setattr(learner_folder, 'WORK', folder)
    monkeypatch.setenv('LABKIT_HOME', str(tmp_path / 'home'))
    learner_folder.copy_lessons()
    return folder


@pytest.fixture
def hook(work: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Give what JupyterLab calls when it has saved a file."""
    monkeypatch.setenv('LABKIT_COPIES', str(copies.copies_folder()))
    config = PyFileConfigLoader(str(CONFIG)).load_config()
    found: Callable[..., None] = config.ContentsManager.post_save_hook
    return found


@pytest.fixture
def save(work: Path, hook: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> Save:
    def save(
        name: str, text: str, at: str = '2026-11-26 09:00:00', kind: str = 'notebook'
    ) -> None:
        (work / name).parent.mkdir(parents=True, exist_ok=True)
        (work / name).write_text(text)
        clock = SimpleNamespace(strftime=lambda form: form.replace('%Y-%m-%d %H:%M:%S', at))
        monkeypatch.setitem(hook.__globals__, 'time', clock)
        manager = SimpleNamespace(root_dir=str(work))
        hook(os_path=str(work / name), model={'type': kind}, contents_manager=manager)

    return save


def source_of(path: Path) -> str:
    return str(json.loads(path.read_text())['cells'][0]['source'][0])


def kept() -> list[str]:
    folder = copies.copies_folder()
    return sorted(str(path.relative_to(folder)) for path in folder.rglob('*') if path.is_file())


def test_each_saved_change_is_copied_without_outputs(work: Path, save: Save) -> None:
    save(TALKER, notebook('mine'), '2026-11-26 09:00:00')
    save(TALKER, notebook('mine'), '2026-11-26 09:02:00')
    save(TALKER, notebook('more of mine'), '2026-11-26 09:04:00')
    save('own/robot.ipynb', notebook('drive'), '2026-11-26 09:05:00')
    # No notebooks, or not in the folder: saved, and not copied.
    save('notes.txt', 'hello', kind='file')
    save('broken.ipynb', '{"cells": 7}')
    save('../outside.ipynb', notebook('1'))
    assert kept() == [
        f'{TALKER}/2026-11-26 09:00:00.gz',
        f'{TALKER}/2026-11-26 09:04:00.gz',
        'own/robot.ipynb/2026-11-26 09:05:00.gz',
    ]
    copy = gzip.decompress((copies.copies_folder() / kept()[0]).read_bytes())
    assert json.loads(copy)['cells'][0]['outputs'] == []


def test_saving_goes_on_where_nothing_can_be_copied(work: Path, save: Save) -> None:
    copies.copies_folder().parent.mkdir(exist_ok=True)
    copies.copies_folder().write_text('in the way')
    save(TALKER, notebook('mine'))
    assert source_of(work / TALKER) == 'mine'


def test_the_whole_folder_comes_back(
    work: Path, save: Save, capsys: pytest.CaptureFixture[str]
) -> None:
    save(TALKER, notebook('first'), '2026-11-26 09:00:00')
    save(TALKER, notebook('mine'), '2026-11-26 09:04:00')
    save('own/robot.ipynb', notebook('drive'), '2026-11-26 09:05:00')
    shutil.rmtree(work)
    assert main(['restore']) == 0
    said = capsys.readouterr().out
    assert f'{work / TALKER} is as it was saved at 2026-11-26 09:04:00' in said
    assert source_of(work / TALKER) == 'mine'
    assert source_of(work / 'own' / 'robot.ipynb') == 'drive'
    assert source_of(work / START) == 'as published'
    assert f'Without a copy, as the course has published it: {START}.' in said
    assert main(['restore']) == 0
    assert capsys.readouterr().out == 'No notebook is lost.\n'
    # JupyterLab may have been started in between, which brings lessons as they are published.
    shutil.rmtree(work)
    learner_folder.copy_lessons()
    copies.restore()
    assert source_of(work / TALKER) == 'mine'
    assert not (work / 'backups').exists()
    # An update never takes it for untouched.
    assert not learner_folder.is_untouched(TALKER)


@pytest.mark.parametrize('wreck', ['', '{', '{"cells": [7]}', '\x00\xff' * 9, '[]'])
def test_a_notebook_that_can_not_be_read_comes_back(work: Path, save: Save, wreck: str) -> None:
    save(TALKER, notebook('mine'))
    (work / TALKER).write_text(wreck)
    (said,) = copies.restore()
    assert source_of(work / TALKER) == 'mine'
    backup = work / 'backups' / '02_talker_listener.backup-1.ipynb'
    assert str(backup) in said and backup.read_text() == wreck


def test_what_has_no_copy_is_told(work: Path) -> None:
    (work / TALKER).write_text('{')
    (said,) = copies.restore()
    assert f'can not be read: {TALKER}. For a fresh lesson: labkit reset 02' in said


def test_a_link_to_nowhere_is_lost_too(work: Path, save: Save) -> None:
    save(TALKER, notebook('mine'))
    (work / TALKER).unlink()
    (work / TALKER).symlink_to('/nowhere/at/all')
    copies.restore()
    assert source_of(work / TALKER) == 'mine'


def test_one_can_go_further_back(
    work: Path, save: Save, capsys: pytest.CaptureFixture[str]
) -> None:
    for minute, text in enumerate(('one', 'two', 'all deleted')):
        save(TALKER, notebook(text), f'2026-11-26 09:0{minute}:00')
    assert main(['restore', '02']) == 0
    assert 'restore 02 --at TIME' in capsys.readouterr().out
    assert source_of(work / TALKER) == 'two'
    assert main(['restore', 'talker', '--at', '2026-11-26 09:00']) == 0
    assert source_of(work / TALKER) == 'one'
    assert main(['restore', '02', '--at', '2026-11-25']) == 2
    assert "None is of '2026-11-25'" in capsys.readouterr().err
    assert main(['restore', '07']) == 2
    assert "'07' is not a lesson" in capsys.readouterr().err
    assert main(['restore', '00']) == 2
    assert f'There is no copy of {START}' in capsys.readouterr().err
    assert source_of(work / 'backups' / '02_talker_listener.backup-1.ipynb') == 'all deleted'


@pytest.mark.parametrize('damage', [b'', b'no gzip', b'\x1f\x8b\x08\x00'])
def test_a_damaged_copy_is_told_and_holds_up_no_other(
    work: Path, save: Save, capsys: pytest.CaptureFixture[str], damage: bytes
) -> None:
    save(START, notebook('begun'), '2026-11-26 09:00:00')
    save(TALKER, notebook('one'), '2026-11-26 09:01:00')
    for name, minute in ((TALKER, 2), (START, 3)):
        save(name, notebook('newest'), f'2026-11-26 09:0{minute}:00')
        (copies.copies_folder() / name / f'2026-11-26 09:0{minute}:00.gz').write_bytes(damage)
    save('own.ipynb', notebook('x'), '2026-11-26 09:04:00')
    (copies.copies_folder() / 'own.ipynb' / '2026-11-26 09:04:00.gz').write_bytes(damage)
    shutil.rmtree(work)
    assert main(['restore']) == 0
    said = capsys.readouterr().out
    assert (source_of(work / START), source_of(work / TALKER)) == ('begun', 'one')
    assert 'saved at 2026-11-26 09:01:00, without outputs. Newer, but damaged: 2026-11-26' in said
    assert 'no other copy of own.ipynb that can be read. Damaged: 2026-11-26 09:04:00' in said
    assert main(['restore', '02']) == 2
    assert 'There is no other copy of 02_talker_listener.ipynb' in capsys.readouterr().err
    assert main(['restore', '02', '--at', '2026-11-26 09:02']) == 2
    assert 'can not be read' in (error := capsys.readouterr().err) and '09:01:00' in error
    assert main(['restore', '02', '--at', '2026-11-26 09:01']) == 0


def test_copies_take_so_much_and_no_more(
    work: Path, save: Save, hook: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    save(START, notebook('the only one'), '2026-11-01 09:00:00')
    size = (copies.copies_folder() / kept()[0]).stat().st_size
    monkeypatch.setitem(hook.__globals__, '_MOST_BYTES', 4 * size)
    for minute in range(10, 60):
        save(TALKER, notebook(f'number {minute}'), f'2026-11-26 09:{minute}:00')
    folder = copies.copies_folder()
    assert sum((folder / path).stat().st_size for path in kept()) <= 4 * size
    assert kept()[0] == f'{START}/2026-11-01 09:00:00.gz'
    assert kept()[-1] == f'{TALKER}/2026-11-26 09:59:00.gz'
    assert len(kept()) >= 3


def test_it_works_where_the_folder_was(work: Path, save: Save, tmp_path: Path) -> None:
    """As in the terminal in which somebody has deleted it."""
    save(TALKER, notebook('mine'))
    env = {**os.environ, 'LABKIT_WORK': str(work), 'LABKIT_HOME': str(tmp_path / 'home')}
    script = f'cd {work} && rm -rf {work} && {sys.executable} -m labkit restore'
    done = subprocess.run(['sh', '-c', script], env=env, capture_output=True, text=True)
    assert done.returncode == 0, done
    assert source_of(work / TALKER) == 'mine'


def test_nothing_is_restored_through_a_link(work: Path, save: Save, tmp_path: Path) -> None:
    save(TALKER, notebook('one'), '2026-11-26 09:00:00')
    save(TALKER, notebook('two'), '2026-11-26 09:01:00')
    fresh = learner_folder.fresh_lesson('02')[1]
    target = tmp_path / 'shared.ipynb'
    target.write_bytes(fresh)
    (work / TALKER).unlink()
    (work / TALKER).symlink_to(target)
    copies.restore('02')
    assert source_of(work / TALKER) == 'two' and not (work / TALKER).is_symlink()
    assert target.read_bytes() == fresh


def test_no_copy_is_deleted_through_a_link(
    work: Path, save: Save, hook: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = work.parent / 'elsewhere'
    elsewhere.mkdir()
    (elsewhere / '2026-01-01 09:00:00.gz').write_bytes(b'x' * 10_000)
    copies.copies_folder().mkdir(parents=True)
    (copies.copies_folder() / START).symlink_to(elsewhere)
    monkeypatch.setitem(hook.__globals__, '_MOST_BYTES', 1)
    for minute in range(3):
        save(TALKER, notebook(f'number {minute}'), f'2026-11-26 09:0{minute}:00')
    assert [path.name for path in elsewhere.iterdir()] == ['2026-01-01 09:00:00.gz']
