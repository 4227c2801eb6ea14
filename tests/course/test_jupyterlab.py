"""JupyterLab as `labkit lab` starts it: on the copies, for those who have the token."""

from __future__ import annotations

import json
import os
import re
import shutil
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
from courses import ROOT, START, TIMEOUT_SEC, Course, notebook, wait_for_line

from labkit.course.jupyterlab import HOME


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
    """Wait until the server answers: while it only listens, a signal would get lost."""
    end = time.monotonic() + TIMEOUT_SEC
    while process.poll() is None and time.monotonic() < end:
        try:
            answer(f'{base}/api')
            return
        except urllib.error.URLError:
            time.sleep(0.05)
    pytest.fail(f'JupyterLab does not answer; exit code {process.poll()}')


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
        line = wait_for_line(process, 'token=').strip()
        base, _, token = line.partition(f'/lab/tree/{START}?')
        assert base.startswith('http://127.0.0.1:')
        wait_for_server(base, process)
        assert [f['name'] for f in answer(f'{base}/api/contents?{token}')['content']] == [START]
        settings = f'{base}/lab/api/settings/@jupyterlab/apputils-extension:notification?{token}'
        defaults = answer(settings)['schema']['properties']
        assert defaults['fetchNews']['default'] == 'false'
        assert defaults['checkForUpdates']['default'] is False
        # The page with all lessons is shown, not its source.
        settings = f'{base}/lab/api/settings/@jupyterlab/docmanager-extension:plugin?{token}'
        viewers = answer(settings)['schema']['properties']['defaultViewers']
        assert viewers['default'] == {'markdown': 'Markdown Preview'}
        kernels = answer(f'{base}/api/kernelspecs?{token}')
        assert kernels['default'] == 'python3'
        assert kernels['kernelspecs']['python3']['spec']['display_name'] != 'wrong'
        with pytest.raises(urllib.error.HTTPError, match='403'):
            answer(f'{base}/api/contents')
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.communicate(timeout=TIMEOUT_SEC)


@pytest.mark.slow('starts JupyterLab')
def test_terminal_has_the_address_alone_on_a_line_and_no_log(ready: Course) -> None:
    process = ready.start(ready.command('lab', '--no-browser'))
    try:
        address = wait_for_line(process, 'token=')
        assert re.fullmatch(r'    http://127\.0\.0\.1:\d+/lab/\S+\n', address)
        wait_for_server(address.strip().partition('/lab/')[0], process)
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        output, _ = process.communicate(timeout=TIMEOUT_SEC)
    assert '[I ' not in output and 'token=' not in output


@pytest.mark.slow('it starts JupyterLab twice')
def test_page_with_all_lessons_opens_once_a_learner_has_begun(ready: Course) -> None:
    for room in ('exercises', 'ros2'):
        shutil.copytree(ROOT / 'labkit' / room, ready.folder / 'labkit' / room)
    state = Path(ready.env['HOME'], 'state')
    state.mkdir()
    (state / 'progress.json').write_text(json.dumps({'version': 1, 'lessons': {}}))
    process = ready.start(ready.command('lab', '--no-browser'), LABKIT_HOME=str(state))
    try:
        assert f'/lab/tree/{HOME}?token=' in wait_for_line(process, 'token=')
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.communicate(timeout=TIMEOUT_SEC)
    page = (ready.folder / 'work' / HOME).read_text()
    assert '[00 Start here](00_start_here.ipynb)' in page


@pytest.mark.slow('starts JupyterLab')
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
