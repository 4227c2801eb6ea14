"""Terminals of JupyterLab: they have the commands, and a notebook sees their nodes."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import websocket

from labkit.lessons.package.listener import exercise as listener
from labkit.ros2.open_pages import notebooks_in_pages
from labkit.setup.environment import PYTHON
from tests.browser.jupyter import JupyterLab
from tests.browser.page import Notebook
from tests.conftest import TIMEOUT_SEC

pytestmark = pytest.mark.slow('a page in the browser')


class Terminal:
    """A terminal of JupyterLab, in the learner's folder."""

    def __init__(self, jupyter: JupyterLab, name: str) -> None:
        address = jupyter.address(f'terminals/websocket/{name}').replace('http', 'ws', 1)
        self._socket = websocket.create_connection(address, timeout=1.0)
        self._text = ''

    def type(self, text: str) -> None:
        """Type lines, with Enter after each."""
        self._socket.send(json.dumps(['stdin', text.rstrip('\n').replace('\n', '\r') + '\r']))

    def wait_for(self, path: Path) -> None:
        """Wait until what is typed has made a file, however long the machine takes for it."""
        while not path.exists():
            self._read()

    def _read(self) -> bool:
        """Take what it shows next, if that comes within a second; return whether it did."""
        try:
            kind, *rest = json.loads(self._socket.recv())
        except websocket.WebSocketTimeoutException:
            return False
        self._text += ''.join(rest) if kind == 'stdout' else ''
        return True

    @property
    def text(self) -> str:
        """All that it has shown."""
        while self._read():
            pass
        return self._text

    def close(self) -> None:
        """Close the connection; the terminal goes on."""
        self._socket.close()


@contextmanager
def open_terminal(jupyter: JupyterLab) -> Iterator[Terminal]:
    """Open a terminal, and end it with all that runs in it."""
    name = jupyter.request('api/terminals', 'POST')['name']
    terminal = Terminal(jupyter, name)
    try:
        yield terminal
    finally:
        terminal.close()
        jupyter.request(f'api/terminals/{name}', 'DELETE')


def test_terminal_finds_the_commands_of_the_environment(
    jupyter: JupyterLab, tmp_path: Path
) -> None:
    told = tmp_path / 'path'
    with open_terminal(jupyter) as terminal:
        terminal.type(f'echo "$PATH" > {told}.new; mv {told}.new {told}')
        terminal.wait_for(told)
    assert told.read_text().startswith(f'{PYTHON.parent}:')


def test_a_terminal_knows_which_notebooks_a_page_shows(
    jupyter: JupyterLab, open_lesson: Callable[[str], Notebook], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv('JUPYTER_RUNTIME_DIR', jupyter.runtime_dir)
    for name in ('shown', 'closed'):
        jupyter.write_notebook(name, {'one': '1'})
    open_lesson('shown')
    closed = open_lesson('closed')
    shown = {'shown.ipynb': True, 'closed.ipynb': True}
    assert notebooks_in_pages().items() >= shown.items()
    closed.page.goto('about:blank')
    closed.was_reloaded = True  # nothing is in it any more that could be left
    end = time.monotonic() + TIMEOUT_SEC
    while (told := notebooks_in_pages())['closed.ipynb'] and time.monotonic() < end:
        time.sleep(0.1)
    assert told.items() >= {'shown.ipynb': True, 'closed.ipynb': False}.items()


def test_an_exercise_is_solved_in_two_terminals(
    jupyter: JupyterLab, open_cells: Callable[..., Notebook], tmp_path: Path
) -> None:
    notebook = open_cells(
        setup="import labkit as lab\n\nlesson = lab.lesson('package')",
        domain="import os\n\nlab.start()\nprint(os.environ['ROS_DOMAIN_ID'])",
        check='lesson.listener.check()',
    )
    notebook.run_cell('setup')
    # Where other notebooks run, as beside other tests, `ros2` might take another.
    domain = notebook.run_cell('domain').split()[-1]
    lines = listener.answer.code.removeprefix('%%bash\n')
    package, _, start = lines.partition('source install/setup.bash\n')
    run = start.partition(' >')[0]
    assert run == 'ros2 run ears_lab listener'
    built = tmp_path / 'built'
    with open_terminal(jupyter) as first, open_terminal(jupyter) as second:
        first.type(f'mkdir -p ros2_ws/src\n{package}\ntouch {built}')
        first.wait_for(built)
        assert 'No program of that name runs' in notebook.run_cell('check')
        second.type(f'export ROS_DOMAIN_ID={domain}\ncd ros2_ws\nsource install/setup.bash\n{run}')
        end = time.monotonic() + TIMEOUT_SEC
        while 'PASS' not in (said := notebook.run_cell('check')) and time.monotonic() < end:
            pass
        assert 'PASS: listener' in said, f'{first.text}\n{second.text}'
