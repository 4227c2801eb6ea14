"""The learner's folder: nothing that a learner has written is ever lost."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zipfile
from pathlib import Path
from typing import Any

import pytest
from courses import ROOT, TIMEOUT_SEC, Course, wait_for_line

from labkit.course import learner_folder
from labkit.errors import LabError, SetupError

START = '00_start_here.ipynb'
TALKER = '02_talker_listener.ipynb'


def notebook(text: str) -> str:
    """Return a lesson with one executed code cell."""
    output = {'output_type': 'stream', 'name': 'stdout', 'text': ['heard\n']}
    cell = {
        'cell_type': 'code',
        'execution_count': 7,
        'id': 'talker-class',
        'metadata': {'tags': ['nbval-ignore-output']},
        'outputs': [output],
        'source': [text],
    }
    metadata = {
        'kernelspec': {'display_name': 'Python 3', 'language': 'python', 'name': 'python3'}
    }
    content = {'cells': [cell], 'metadata': metadata, 'nbformat': 4, 'nbformat_minor': 5}
    return json.dumps(content)


@pytest.fixture
def lessons(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder with two published lessons and a picture; labkit's own look at it."""
    folder = tmp_path / 'notebooks'
    (folder / 'images').mkdir(parents=True)
    (folder / START).write_text(notebook('1 + 1'))
    (folder / TALKER).write_text(notebook('2 + 2'))
    (folder / 'images' / 'graph.svg').write_text('<svg/>')
    (folder / 'conftest.py').write_text('for the tests')
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
        assert f'02_talker_listener.backup-{number}.ipynb' in learner_folder.reset(word)
    assert source_of(work / TALKER) == '2 + 2'
    backups = [work / f'02_talker_listener.backup-{number}.ipynb' for number in (1, 2, 3)]
    assert [source_of(path) for path in backups] == ['attempt 1', 'attempt 2', 'attempt 3']
    assert 'is a fresh copy already' in learner_folder.reset(word)
    assert len(list(work.glob('*backup*'))) == 3


def test_reset_of_a_deleted_lesson(work: Path) -> None:
    (work / TALKER).unlink()
    learner_folder.reset('02')
    assert source_of(work / TALKER) == '2 + 2'
    assert not list(work.glob('*backup*'))


@pytest.mark.parametrize('word', ['7', '99', 'tlaker', '', '_'])
def test_reset_of_what_is_no_lesson(work: Path, word: str) -> None:
    with pytest.raises(LabError, match='00_start_here, 02_talker_listener'):
        learner_folder.reset(word)


def test_file_systems_without_hard_links(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_paths: object) -> None:
        raise OSError('Operation not permitted')

    monkeypatch.setattr(os, 'link', refuse)
    for number in (1, 2):
        (work / TALKER).write_text(notebook(f'attempt {number}'))
        learner_folder.reset('02')
    assert source_of(work / '02_talker_listener.backup-1.ipynb') == 'attempt 1'
    assert source_of(work / '02_talker_listener.backup-2.ipynb') == 'attempt 2'


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


# --- JupyterLab ----------------------------------------------------------------------------------


@pytest.fixture
def ready(tmp_path: Path) -> Course:
    """Give a course whose environment has all that the one of this test has."""
    course = Course(tmp_path / 'course')
    (course.folder / 'notebooks' / START).write_text(notebook('1 + 1'))
    course.make_complete()
    home = tmp_path / 'home'
    home.mkdir()
    course.env.update(HOME=str(home), JUPYTER_CONFIG_DIR=str(home / 'config'))
    return course


def wait_for_server(base: str, process: subprocess.Popen[str]) -> None:
    """Wait until the server listens: it names its address a moment before."""
    host, _, port = base.removeprefix('http://').partition(':')
    end = time.monotonic() + TIMEOUT_SEC
    while process.poll() is None and time.monotonic() < end:
        try:
            socket.create_connection((host, int(port)), timeout=TIMEOUT_SEC).close()
            return
        except ConnectionRefusedError:
            time.sleep(0.05)
    pytest.fail(f'JupyterLab does not listen; exit code {process.poll()}')


def answer(url: str) -> Any:
    with urllib.request.urlopen(url, timeout=TIMEOUT_SEC) as response:
        return json.load(response)


def test_lab_serves_the_copies_to_those_who_have_the_token(ready: Course) -> None:
    # A kernel of the same name that some other Python has left for the user.
    spec = Path(ready.env['HOME'], '.local/share/jupyter/kernels/python3')
    spec.mkdir(parents=True)
    (spec / 'kernel.json').write_text(json.dumps({'argv': ['false'], 'display_name': 'wrong'}))
    process = ready.start(ready.command('lab', '--no-browser'))
    try:
        line = wait_for_line(process, 'token=').split()[-1]
        base, _, token = line.partition(f'/lab/tree/{START}?')
        assert base.startswith('http://127.0.0.1:')
        wait_for_server(base, process)
        assert [f['name'] for f in answer(f'{base}/api/contents?{token}')['content']] == [START]
        settings = f'{base}/lab/api/settings/@jupyterlab/apputils-extension:notification?{token}'
        defaults = answer(settings)['schema']['properties']
        assert defaults['fetchNews']['default'] == 'false'
        assert defaults['checkForUpdates']['default'] is False
        kernels = answer(f'{base}/api/kernelspecs?{token}')
        assert kernels['default'] == 'python3'
        assert kernels['kernelspecs']['python3']['spec']['display_name'] != 'wrong'
        with pytest.raises(urllib.error.HTTPError, match='403'):
            answer(f'{base}/api/contents')
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.communicate(timeout=TIMEOUT_SEC)


def test_port_in_use(ready: Course) -> None:
    with socket.socket() as taken:
        taken.bind(('127.0.0.1', 0))
        taken.listen()
        port = taken.getsockname()[1]
        for words in (
            ['--port', f'{port}'],
            [f'--port={port}'],
            ['--', f'--ServerApp.port={port}'],
        ):
            done = ready.run('lab', '--no-browser', *words)
            assert done.returncode == 2
            assert f'Port {port} can not be used' in done.stderr
            assert 'Give another one with --port' in done.stderr


def test_package_brings_the_defaults_of_jupyterlab(tmp_path: Path) -> None:
    # The editable install of environment.txt, without installing.
    code = 'import sys, flit_core.buildapi as b; print(b.build_editable(sys.argv[1]))'
    built = subprocess.run(
        [sys.executable, '-c', code, str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    with zipfile.ZipFile(tmp_path / built.stdout.strip()) as wheel:
        names = wheel.namelist()
    overrides = 'data/etc/jupyter/labconfig/default_setting_overrides.json'
    assert any(name.endswith(f'.data/{overrides}') for name in names), names
