"""JupyterLab as a learner has it: started by labkit's own command, on a copy of the lessons."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path
from types import TracebackType
from typing import Any

import nbformat

from tests.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
START_SEC = 60.0
# Variables of whoever runs the tests that a learner's terminal does not have.
_FOREIGN = (
    *('IPYTHON', 'JPY_', 'JUPYTER_', 'LABKIT_', 'PYTEST_', 'XDG_'),
    *('FASTDDS_', 'FASTRTPS_', 'RCUTILS_', 'RMW_', 'ROS_'),
)
# The command `labkit lab`, but for two things: the lessons are copied to a temporary folder, and
# the environment is the one that runs this.
_START = """
import sys
from pathlib import Path
from labkit.course import jupyterlab, learner_folder
learner_folder.WORK = Path(sys.argv[1])
jupyterlab.make_environment = lambda: Path(sys.executable)
jupyterlab.start_lab(sys.argv[2:])
"""


class JupyterLab:
    """A running JupyterLab with a home, a state folder and lessons of its own.

    Args:
        folder: An empty folder for all of that.
        env: Environment variables besides those of a fresh terminal.

    Attributes:
        work: The learner's folder, with the lessons.
        runtime_dir: Where it notes how it is reached.
        url: The address, token included, that `labkit lab` opens in the learner's browser.
        hangs: Whether it did not end when it was asked to.
    """

    def __init__(self, folder: Path, env: dict[str, str] | None = None) -> None:
        self.work = folder / 'work'
        self.url = ''
        self.hangs = False
        self._log: list[str] = []
        self._ready = threading.Event()
        home = folder / 'home'
        home.mkdir(parents=True)
        self.runtime_dir = str(home / '.local' / 'share' / 'jupyter' / 'runtime')
        variables = {k: v for k, v in os.environ.items() if not k.startswith(_FOREIGN)}
        variables.update(
            HOME=str(home),
            LABKIT_HOME=str(home / 'labkit'),
            PYTHONPATH=os.pathsep.join([str(ROOT), *filter(None, [variables.get('PYTHONPATH')])]),
            **(env or {}),
        )
        options = ['--no-browser', f'--port={free_port()}']
        self._process = subprocess.Popen(
            [sys.executable, '-c', _START, str(self.work), *options],
            env=variables,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors='replace',
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        if not self._ready.wait(START_SEC) or not self.url or not self._answers():
            self.close()
            raise RuntimeError(f'JupyterLab did not start:\n{self.log}')

    def _answers(self) -> bool:
        """Wait until the server listens, which is some time after it says so."""
        end = time.monotonic() + START_SEC
        while self._process.poll() is None and time.monotonic() < end:
            try:
                socket.create_connection(('127.0.0.1', self.port)).close()
            except ConnectionRefusedError:
                time.sleep(0.05)
            else:
                return True
        return False

    def _read(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as lines:
            for line in lines:
                self._log.append(line)
                found = re.search(r'http://\S+token=\w+', line)
                if found and not self.url:
                    self.url = found[0]
                    self._ready.set()
        self._ready.set()

    @property
    def log(self) -> str:
        """What JupyterLab and its kernels have written so far."""
        return ''.join(self._log)

    @property
    def port(self) -> int:
        return int(re.findall(r'http://[^/]+:(\d+)/', self.url)[0])

    @property
    def token(self) -> str:
        return self.url.partition('token=')[2]

    def address(self, path: str, *, token: bool = True) -> str:
        """Return the address of a path such as `lab/tree/x.ipynb`."""
        return f'http://127.0.0.1:{self.port}/{path}' + f'?token={self.token}' * token

    def request(self, path: str, method: str = 'GET') -> Any:
        """Ask the server's interface (`api/sessions`) and return its answer."""
        request = urllib.request.Request(self.address(path), method=method)
        try:
            with urllib.request.urlopen(request, timeout=START_SEC) as answer:
                return json.loads(answer.read() or 'null')
        except urllib.error.HTTPError as error:
            said = error.read().decode(errors='replace')
            raise RuntimeError(f'{method} {path}: {error}\n{said}\n{self.log}') from error

    def write_notebook(self, name: str, cells: dict[str, str]) -> None:
        """Write a notebook of code cells into the learner's folder.

        Args:
            name: The file's name, without `.ipynb`.
            cells: Id of each cell and its code.
        """
        notebook = nbformat.v4.new_notebook()
        notebook.metadata.kernelspec = {
            'name': 'python3',
            'display_name': 'Python 3 (ipykernel)',
            'language': 'python',
        }
        for cell_id, code in cells.items():
            notebook.cells.append(nbformat.v4.new_code_cell(code.strip(), id=cell_id))
        nbformat.write(notebook, self.work / f'{name}.ipynb')

    def end_kernels(self) -> None:
        """Shut down every notebook's kernel."""
        for session in self.request('api/sessions'):
            self.request(f'api/sessions/{session["id"]}', 'DELETE')

    def close(self) -> None:
        """Stop JupyterLab, which ends its kernels."""
        self._process.send_signal(signal.SIGTERM)
        try:
            self._process.wait(START_SEC)
        except subprocess.TimeoutExpired:
            self.hangs = True
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        self._reader.join(START_SEC)

    def __enter__(self) -> JupyterLab:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()
