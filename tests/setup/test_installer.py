"""Installing with uv and with pip: from where, with what hashes, shown from its first moment."""

from __future__ import annotations

import io
import shutil
import sys
from pathlib import Path

import pytest
from courses import BARE_PATH, ROOT, Course, sentence

from labkit.setup import installer
from labkit.setup.installer import Progress


class Terminal(io.StringIO):
    """What a terminal is given."""

    def isatty(self) -> bool:
        return True


def test_log_gets_a_line_at_once_and_then_for_news(capsys: pytest.CaptureFixture[str]) -> None:
    progress = Progress(120)
    for what, count in (('Preparing', 0), ('Preparing', 0), ('Fetching', 3), ('Fetching', 51)):
        progress.show(what, count)
    assert capsys.readouterr().out.splitlines() == [
        '  Preparing    0 of 120 packages',
        '  Fetching    50 of 120 packages',
    ]


def test_terminal_gets_one_line_that_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, 'stdout', terminal)
    progress = Progress(4)
    progress.show('Preparing', 0)
    progress.show('Fetching', 4)
    progress.show('Installing', 0)
    progress.show('Installed', 4)
    shown = terminal.getvalue()
    assert '\n' not in shown and shown.count('\r') == 4
    assert 'Preparing    0 of 4 packages, 0 s' in shown
    # The bar does not begin anew.
    assert '[###############...............] Fetching     4 of 4 packages' in shown
    assert '[###############...............] Installing   0 of 4 packages' in shown
    assert '[##############################] Installed    4 of 4 packages' in shown


@pytest.mark.slow('it installs')
def test_installed_with_pip_where_there_is_no_uv(course: Course) -> None:
    done = course.make(PATH=BARE_PATH)
    assert done.returncode == 0, done.stderr
    assert course.installed() == {'alpha-1.0'}
    course.require('./missing-1.0-py3-none-any.whl')
    assert 'missing-1.0' in sentence(course.make(PATH=BARE_PATH))
    course.require('http://127.0.0.1:9/beta-1.0-py3-none-any.whl')
    assert 'Connect to the internet' in sentence(course.make(PATH=BARE_PATH))
    assert course.installed() == {'alpha-1.0'}


@pytest.fixture
def without_uv(course: Course) -> Course:
    """Give a course whose environment was made with pip, and can build labkit itself."""
    course.env['PATH'] = BARE_PATH
    for name in ('pyproject.toml', 'LICENSE'):
        shutil.copy(ROOT / name, course.folder)
    assert course.make().returncode == 0
    course.lend_packages()
    return course


@pytest.mark.slow('it installs')
@pytest.mark.parametrize('works', [True, False], ids=['works', 'fails'])
def test_uv_is_fetched_first_and_pip_helps_where_it_fails(without_uv: Course, works: bool) -> None:
    course = without_uv
    asked = course.folder / 'asked.txt'
    run = f'exec {course.folder}/uv/uv "$@"' if works else 'echo "error: no luck"; exit 1'
    program = f'#!/bin/sh\necho "$@" >> {asked}\n{run}\n'
    course.lock(course.wheel('uv', program=program), course.wheel('alpha', '2.0'))
    course.require('uv==1.0', 'alpha==2.0', '-e .')
    done = course.make()
    assert done.returncode == 0, done.stderr
    assert 'Installed    3 of 3 packages' in done.stdout
    said = "uv could not install the packages: 'error: no luck'. Trying pip"
    assert ('Trying pip' in done.stdout, said in done.stdout) == (not works, not works)
    assert len(asked.read_text().splitlines()) == (2 if works else 1)
    assert {'alpha-2.0', 'uv-1.0'} <= course.installed()
    assert (course.venv / 'bin' / 'labkit').is_file()
    assert course.make().stdout == ''


@pytest.mark.slow('it installs')
def test_uv_takes_packages_from_where_pip_does(without_uv: Course) -> None:
    course = without_uv
    course.env['PATH'] = f'{course.folder / "uv"}:{BARE_PATH}'
    course.lock(course.wheel('alpha', '2.0'))
    course.require('alpha==2.0', '-e .')
    for name in ('PIP_FIND_LINKS', 'PIP_NO_INDEX', 'UV_FIND_LINKS', 'UV_NO_INDEX'):
        del course.env[name]
    settings = course.folder / 'pip.conf'
    settings.write_text(
        '[global]\nno-index = true\nfind-links = /nowhere\n'
        f'[install]\nfind-links =\n  {course.folder}\n  {course.folder / "tests"}\n'
    )
    done = course.make(PIP_CONFIG_FILE=str(settings))
    assert done.returncode == 0, done.stderr
    assert 'Trying pip' not in done.stdout
    assert 'alpha-2.0' in course.installed()


@pytest.mark.parametrize(
    ('installed', 'own', 'asked'),
    [
        (True, False, 'installed'),
        (False, False, 'other'),
        (True, True, 'other'),
    ],
)
def test_which_pip_is_asked_where_packages_come_from(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, installed: bool, own: bool, asked: str
) -> None:
    def pip(name: str) -> str:
        path = tmp_path / name
        path.write_text(f'#!/bin/sh\necho "global.index-url=\'{name}\'"\n')
        path.chmod(0o755)
        return str(path)

    python = pip('installed') if installed else shutil.which('false')
    monkeypatch.setattr(sys, 'executable', python)
    other = [pip('other'), '-I', '-m' if own else '-c', 'pip']
    assert installer._sources(other, tmp_path, {})['UV_DEFAULT_INDEX'] == asked


@pytest.mark.slow('it installs')
@pytest.mark.parametrize('installer', ['uv', 'pip'])
def test_a_package_that_is_not_the_tested_one_is_refused(
    without_uv: Course, installer: str
) -> None:
    course = without_uv
    if installer == 'uv':
        course.env['PATH'] = f'{course.folder / "uv"}:{BARE_PATH}'
    course.lock(course.wheel('alpha', '2.0'))
    course.wheel('alpha', '2.0', size=1)
    course.require('alpha==2.0', '-e .')
    said = ' '.join(sentence(course.make()).split())
    assert 'is not the one that the course was tested with' in said
    assert 'alpha-1.0' in course.installed()


@pytest.mark.slow('it installs')
@pytest.mark.parametrize('installer', ['uv', 'pip'])
def test_a_lock_beside_another_file_is_used_as_well(without_uv: Course, installer: str) -> None:
    course = without_uv
    if installer == 'uv':
        course.env['PATH'] = f'{course.folder / "uv"}:{BARE_PATH}'
    course.lock(course.wheel('alpha', '2.0'))
    course.require('alpha==2.0', '-e .')
    (course.folder / 'tests' / 'requirements.txt').write_text('checker==1.0\n')
    course.lock(course.wheel('checker'), file='tests/requirements.lock')
    files = "('environment.txt', 'tests/requirements.txt')"
    make = f'labkit.setup.environment.make_environment({files})'
    done = course.python(make)
    assert done.returncode == 0, done.stderr
    assert {'alpha-2.0', 'checker-1.0'} <= course.installed()
    (course.folder / 'tests' / 'requirements.txt').write_text('checker==2.0\n')
    course.lock(course.wheel('checker', '2.0'), file='tests/requirements.lock')
    course.wheel('checker', '2.0', size=1)
    said = ' '.join(sentence(course.python(make)).split())
    assert 'is not the one that the course was tested with' in said
    assert 'checker-1.0' in course.installed()
