"""A terminal of JupyterLab: it has the commands of the environment."""

from __future__ import annotations

import json
import time

import pytest
import websocket

from labkit.setup.environment import PYTHON
from tests.conftest import TIMEOUT_SEC

pytestmark = pytest.mark.slow('a page in the browser')


def test_terminal_finds_the_commands_of_the_environment(jupyter, tmp_path):
    told = tmp_path / 'path'
    name = jupyter.request('api/terminals', 'POST')['name']
    address = jupyter.address(f'terminals/websocket/{name}').replace('http', 'ws', 1)
    terminal = websocket.create_connection(address, timeout=TIMEOUT_SEC)
    terminal.send(json.dumps(['stdin', f'echo "$PATH" > {told}.new; mv {told}.new {told}\r']))
    end = time.monotonic() + TIMEOUT_SEC
    while not told.exists() and time.monotonic() < end:
        terminal.recv()
    terminal.close()
    jupyter.request(f'api/terminals/{name}', 'DELETE')
    assert told.read_text().startswith(f'{PYTHON.parent}:')
