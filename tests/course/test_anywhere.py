"""The course on machines of others: Codespaces, VS Code and Binder make them from these files.

Their steps are run in a copy of the course, in which nothing has been made yet.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import websocket
from courses import BARE_PATH, ROOT, START, base_python
from hub.person import Notebook
from ports import free_port

from labkit.setup.machine import VERSIONS, clean_environment

BINDER = ROOT / '.binder'
TOKEN = 'robots'
TIMEOUT_SEC = 800
# As the values of BinderHub's chart have it, in short: JupyterLab if there is one.
BINDERHUB = 'import os, sys, jupyterlab; os.execvp("jupyter-lab", sys.argv)'


def devcontainer() -> Any:
    """Return the settings, without the comments that JSON does not have."""
    text = (ROOT / '.devcontainer' / 'devcontainer.json').read_text()
    return json.loads(re.sub(r'^\s*//.*$', '', text, flags=re.MULTILINE))


# --- The files -----------------------------------------------------------------------------------


def test_settings_of_the_container_are_those_of_the_specification() -> None:
    schema = json.loads(Path(__file__).with_name('devcontainer.schema.json').read_text())
    check = jsonschema.Draft201909Validator(schema)
    check.validate(devcontainer())
    for wrong in ({'forwardPort': [8888]}, {'postAttachCommand': 8}, {'hostRequirements': 2}):
        assert not check.is_valid({**devcontainer(), **wrong}), wrong
    (found,) = re.findall(r'python:(\d+)\.(\d+)-', devcontainer()['image'])
    assert tuple(map(int, found)) in VERSIONS


def test_binder_knows_its_files() -> None:
    # Of both names, repo2docker takes neither.
    assert not (ROOT / 'binder').exists()
    names = {path.name for path in BINDER.iterdir()}
    # A Dockerfile, or packages of conda, would be taken instead of these.
    assert names == {'jupyter_server_config.json', 'postBuild', 'runtime.txt', 'start'}
    (found,) = re.findall(r'^python-(\d+)\.(\d+)\n$', (BINDER / 'runtime.txt').read_text())
    assert tuple(map(int, found)) in VERSIONS
    for name in ('postBuild', 'start'):
        assert os.access(BINDER / name, os.X_OK)
        assert (BINDER / name).read_text().startswith('#!/bin/bash\n')
    assert '\nset -e\n' in (BINDER / 'postBuild').read_text()
    # The last line becomes the command that it was given.
    assert re.search(r'\nexec .* "\$@"\n$', (BINDER / 'start').read_text())


# --- Their steps ---------------------------------------------------------------------------------


class Place:
    """A machine with a clone of the course: its folder, its home and its variables."""

    def __init__(self, folder: Path) -> None:
        self.course = folder / 'course'
        left_out = shutil.ignore_patterns('.git', '.venv', 'work', '.*_cache', '__pycache__')
        shutil.copytree(ROOT, self.course, ignore=left_out)
        variables = {
            name: value
            for name, value in clean_environment().items()
            if not name.startswith(('COVERAGE', 'JPY_', 'JUPYTER', 'LABKIT_', 'PYTEST_', 'ROS_'))
        }
        for name in ('PYTHONPATH', 'VIRTUAL_ENV'):
            variables.pop(name, None)
        bin_ = folder / 'bin'
        bin_.mkdir()
        (bin_ / 'python3').symlink_to(base_python())
        # What was fetched before is at hand; all else is in the home.
        cache = Path(os.environ.get('UV_CACHE_DIR') or Path.home() / '.cache' / 'uv')
        self.env = variables | {
            'HOME': str(folder),
            'PATH': f'{bin_}:{BARE_PATH}',
            'SHELL': '/bin/bash',
            'UV_CACHE_DIR': str(cache),
        }

    def run(self, command: list[str], **env: str) -> str:
        done = subprocess.run(
            command,
            cwd=self.course,
            env={**self.env, **env},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=TIMEOUT_SEC,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


class Server:
    """A JupyterLab that a command has started; it is asked as a page asks it."""

    def __init__(self, place: Place, command: list[str], url: str, **env: str) -> None:
        self.url, self.token = url, TOKEN
        self.process = subprocess.Popen(
            command,
            cwd=place.course,
            env={**place.env, **env},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def wait(self) -> None:
        """Wait until it answers."""
        end = time.monotonic() + TIMEOUT_SEC
        while True:
            try:
                self.ask('api')
                return
            except urllib.error.URLError:
                assert self.process.poll() is None and time.monotonic() < end
                time.sleep(0.1)

    def ask(self, path: str, data: object = None) -> Any:
        request = urllib.request.Request(
            self.url + path,
            data=None if data is None else json.dumps(data).encode(),
            headers={'Authorization': f'token {self.token}'},
        )
        with urllib.request.urlopen(request, timeout=TIMEOUT_SEC) as answer:
            return json.loads(answer.read()) if path.startswith('api') else answer.url

    def kernel(self, name: str) -> str:
        """Open a notebook; return the address of its kernel."""
        kernel = {'kernel': {'name': 'python3'}, 'path': name, 'name': name, 'type': 'notebook'}
        kernel_id = self.ask('api/sessions', kernel)['kernel']['id']
        return f'{self.url.replace("http", "ws", 1)}api/kernels/{kernel_id}'

    def close(self) -> None:
        self.process.terminate()
        self.process.communicate(timeout=TIMEOUT_SEC)


@pytest.fixture(scope='module')
def place(tmp_path_factory: pytest.TempPathFactory) -> Place:
    """Give a machine on which Binder's image was made, and nothing else."""
    place = Place(tmp_path_factory.mktemp('machine'))
    said = place.run(['./.binder/postBuild'])
    assert 'The environment is ready.' in said
    return place


@pytest.fixture
def servers() -> Iterator[list[Server]]:
    started: list[Server] = []
    yield started
    for server in started:
        server.close()


@pytest.mark.slow('an environment like that of Binder')
def test_binder_opens_the_first_lesson(place: Place, servers: list[Server]) -> None:
    port = free_port()
    command = ['./.binder/start', 'python3', '-c', BINDERHUB, '--ip=127.0.0.1', f'--port={port}']
    options = ['base_url=/user/robots/', f'token={TOKEN}', 'trust_xheaders=True']
    command += [f'--NotebookApp.{option}' for option in options]
    root = ['--allow-root'] if os.geteuid() == 0 else []
    server = Server(
        place, [*command, '--no-browser', *root], f'http://127.0.0.1:{port}/user/robots/'
    )
    servers.append(server)
    server.wait()
    assert server.ask('').endswith(f'/user/robots/lab/tree/{START}')
    lesson = Notebook('', server.kernel(START), TOKEN)
    for cell in server.ask(f'api/contents/{START}')['content']['cells']:
        if cell['cell_type'] == 'code':
            meant = 'raises-exception' in cell['metadata'].get('tags', ())
            assert ('raised' in lesson.run(cell['source'])) == meant, cell['id']
    environment = str(place.course / '.venv')
    assert lesson.run('import sys; print(sys.prefix)') == f'{environment}\n'
    # What a learner writes lies in `work`, and commands are those of the course.
    assert lesson.run('import os; print(os.getcwd())') == f'{place.course / "work"}\n'
    assert lesson.run('!which ros2').strip() == f'{environment}/bin/ros2'


@pytest.mark.slow('an environment like that of Binder')
def test_codespace_opens_the_first_lesson(place: Place, servers: list[Server]) -> None:
    settings, port = devcontainer(), free_port()
    assert place.run(['sh', '-c', settings['onCreateCommand']]) == ''  # all is there
    command = settings['postAttachCommand'].replace('8888', str(port))
    names = {
        'CODESPACE_NAME': 'robots-7',
        'GITHUB_CODESPACES_PORT_FORWARDING_DOMAIN': 'app.github.dev',
    }
    url = f'http://127.0.0.1:{port}/'
    server = Server(place, ['sh', '-c', command], url, **names)
    servers.append(server)
    assert server.process.stdout is not None
    address = next(line for line in server.process.stdout if 'token=' in line).strip()
    assert address.partition('?')[0] in (f'{url}lab/tree/{START}', f'http://localhost:{port}/lab')
    server.token = address.partition('token=')[2]
    server.wait()
    # The page comes from the codespace's own address, and no other page may use the kernels.
    # (Who has the token may come from anywhere, so the page comes without it.)
    request = urllib.request.Request(f'{url}lab?token={server.token}')
    with urllib.request.urlopen(request, timeout=TIMEOUT_SEC) as answer:
        cookies = answer.headers.get_all('Set-Cookie')
    cookie = '; '.join(one.partition(';')[0] for one in cookies)
    channels = f'{server.kernel(START)}/channels'
    for host, welcome in (('robots-7', True), ('evil-7', False)):
        try:
            websocket.create_connection(
                channels,
                timeout=TIMEOUT_SEC,
                cookie=cookie,
                origin=f'https://{host}-{port}.app.github.dev',
            ).close()
            opened = True
        except websocket.WebSocketBadStatusException as error:
            assert error.status_code == 403
            opened = False
        assert opened == welcome, host


@pytest.mark.slow('an environment like that of a container')
def test_container_of_vs_code_needs_no_origin(place: Place) -> None:
    # There the variable is not set, and the option is not given.
    command = devcontainer()['postAttachCommand'].replace('exec python3', 'echo', 1)
    assert place.run(['sh', '-c', command]) == '-m labkit lab --no-browser --port 8888\n'
