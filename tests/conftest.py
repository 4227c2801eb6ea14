"""What all tests share: real kernels, scripts in processes of their own, no silent skips."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parent.parent
PATIENT = ROOT / 'tests/patient'

# Hundreds of processes import the same modules, and each would compile all of them anew.
sys.dont_write_bytecode = False
os.environ.pop('PYTHONDONTWRITEBYTECODE', None)
# Nothing that a test process itself starts is heard outside of it. A test that needs processes to
# find each other passes LOCALHOST and a domain of its own.
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'OFF'
# Whoever starts the tests in the background may have them, and all that they start, ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
# Variables that would make a kernel or a script behave otherwise than in a fresh terminal.
# (ipykernel, for one, does not show what C code prints while PYTEST_CURRENT_TEST is set.)
_FOREIGN = (
    'PYTEST_',
    'ROS_',
    'AMENT_',
    'FASTRTPS_',
    'RCUTILS_',
    'RMW_',
    'JPY_',
    'LABKIT_',
    'NO_COLOR',
    'FORCE_COLOR',
)
# Generous, because machines under test are busy: the limit is there to end a hang, not to judge.
TIMEOUT_SEC = 60.0


# Files that take a minute or more. They come first, so that no worker has one left at the end.
_LONGEST = (
    'tests/lessons/test_proof.py',
    'tests/lessons/test_live_coding.py',
    'tests/setup/test_environment.py',
    'tests/background/test_exit_codes.py',
    'notebooks/12_interfaces_and_actions.ipynb',
    'tests/packages/test_workspace.py',
)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the longest files first."""
    place = {file: number for number, file in enumerate(_LONGEST)}
    items.sort(key=lambda item: place.get(item.nodeid.partition('::')[0], len(place)))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Iterator[None]:
    """With LABKIT_REQUIRE_ALL=1, turn a skipped test into a failed one."""
    report = yield
    if report.skipped and not hasattr(report, 'wasxfail'):
        _refuse_skip(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Iterator[None]:
    """With LABKIT_REQUIRE_ALL=1, turn a skipped module into a failed one."""
    report = yield
    if report.outcome == 'skipped':
        _refuse_skip(report)
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what was skipped, and why."""
    skipped = Counter(
        (report.longrepr[-1].removeprefix('Skipped: '), report.nodeid.partition('::')[0])
        for report in terminalreporter.getreports('skipped')
    )
    for (reason, file), count in sorted(skipped.items()):
        terminalreporter.line(f'{count} skipped in {file}: {reason}')


def _refuse_skip(report: Any) -> None:
    if os.environ.get('LABKIT_REQUIRE_ALL', '') in ('', '0'):
        return
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
    report.outcome = 'failed'
    report.longrepr = f'LABKIT_REQUIRE_ALL is set, so this must run, but: {reason}'


@pytest.fixture(scope='module', autouse=True)
def ros_ends() -> Iterator[None]:
    """End what the tests of a file have started in this process: the next file may start anew."""
    yield
    if loaded := sys.modules.get('labkit.background.runtime'):
        loaded.runtime.stop()
    if rclpy := sys.modules.get('rclpy'):
        assert not rclpy.ok(), 'A test of this file leaves ROS running.'


@dataclass(frozen=True)
class ScriptResult:
    """How a script ended: its exit code and what it wrote."""

    exit_code: int
    stdout: str
    stderr: str


@dataclass(frozen=True)
class Result:
    """What the run of one cell brought.

    Attributes:
        msg_id: Id of the request; outputs that come later still carry it.
        outputs: The outputs as in a notebook file, consecutive pieces of a stream merged.
        error: `'ValueError: no'` if the cell raised, else `''`.
        traceback: What the learner sees of the error, without colours.
    """

    msg_id: str
    outputs: list[dict[str, Any]]
    error: str = ''
    traceback: str = ''

    @property
    def text(self) -> str:
        """Streams, and the plain form of everything displayed, in order."""
        return _text(self.outputs)


def _text(outputs: list[dict[str, Any]]) -> str:
    texts = [output.get('text', output.get('data', {}).get('text/plain')) for output in outputs]
    return ''.join(
        text if 'text' in output else f'{text}\n'
        for output, text in zip(outputs, texts, strict=True)
        if text is not None
    )


class Kernel:
    """A real Jupyter kernel in a folder of its own.

    A thread reads all that the kernel publishes and sorts it by the request that it belongs to,
    so that output of a background thread that is routed to an older cell is found there.

    Args:
        folder: Where the kernel runs; it keeps its state there too.
        env: The kernel's environment.
    """

    def __init__(self, folder: Path, env: dict[str, str]) -> None:
        from jupyter_client.kernelspec import KernelSpecManager
        from jupyter_client.manager import KernelManager

        self.folder = folder
        self._log = (folder / 'kernel.log').open('wb')
        # No folder of kernel specs: 'python3' is then the Python that runs this test.
        # Sockets of its own instead of ports: those may be taken before the kernel has them. Their
        # names must be short.
        self._sockets = tempfile.TemporaryDirectory(prefix='labkit-')
        self._manager = KernelManager(
            kernel_name='python3',
            kernel_spec_manager=KernelSpecManager(kernel_dirs=[]),
            transport='ipc',
            ip=str(Path(self._sockets.name) / 'socket'),
        )
        self._manager.start_kernel(cwd=str(folder), env=env, stdout=self._log, stderr=self._log)
        self.process = self._manager.provisioner.process
        self._connect()

    def _connect(self) -> None:
        self._messages: dict[str, list[dict[str, Any]]] = {}
        self._news = threading.Condition()
        self._closing = False
        self._client = self._manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=TIMEOUT_SEC)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _disconnect(self) -> None:
        self._closing = True
        self._reader.join()
        self._client.stop_channels()

    def _read(self) -> None:
        from queue import Empty

        from jupyter_core.utils import ensure_event_loop

        while not self._closing:
            try:
                message = self._client.get_iopub_msg(timeout=0.1)
            except Empty:
                continue
            with self._news:
                parent = message['parent_header'].get('msg_id', '')
                self._messages.setdefault(parent, []).append(message)
                self._news.notify_all()
        # The blocking client has made an event loop for this thread, and leaves it open.
        ensure_event_loop().close()

    def _wait(self, happened: Callable[[], bool], timeout: float, what: str) -> None:
        """Wait until `happened`, which is asked anew at each message; fail the test otherwise."""
        end = time.monotonic() + timeout
        with self._news:
            while not happened():
                # The kernel's death sends no message, so it is looked for now and then.
                left = end - time.monotonic()
                if self.process.poll() is not None:
                    ended = f'the kernel ended with code {self.process.returncode}'
                    pytest.fail(f'{what}: {ended}\n{self.log}')
                if left <= 0:
                    pytest.fail(f'{what}: not within {timeout} s\n{self.log}')
                self._news.wait(min(left, 0.5))

    @property
    def log(self) -> str:
        """What the kernel's process wrote past the notebook (C code, its last words)."""
        return (self.folder / 'kernel.log').read_text(errors='replace')

    def start(self, code: str, cell_id: str = '') -> str:
        """Start a cell and return its request id at once; see `finish`.

        Args:
            code: The cell's code.
            cell_id: Its id in the notebook, as JupyterLab sends it along.
        """
        content = {
            'code': code,
            'silent': False,
            'store_history': True,
            'user_expressions': {},
            'allow_stdin': False,
            'stop_on_error': False,
        }
        metadata = {'cellId': cell_id} if cell_id else None
        request = self._client.session.msg('execute_request', content, metadata=metadata)
        self._client.shell_channel.send(request)
        return str(request['header']['msg_id'])

    def finish(self, msg_id: str, timeout: float = TIMEOUT_SEC) -> Result:
        """Wait for the end of a started cell."""

        def idle() -> bool:
            return any(
                message['content'].get('execution_state') == 'idle'
                for message in self._messages.get(msg_id, ())
                if message['msg_type'] == 'status'
            )

        try:
            self._wait(idle, timeout, 'end of the cell')
        except pytest.fail.Exception as error:
            pytest.fail(f'{error}\nOutput so far:\n{_text(self.outputs_of(msg_id))}')
        outputs = self.outputs_of(msg_id)
        errors = [output for output in outputs if output['output_type'] == 'error']
        if not errors:
            return Result(msg_id, outputs)
        traceback = re.sub(r'\x1b\[[\d;]*m', '', '\n'.join(errors[0]['traceback']))
        return Result(msg_id, outputs, f'{errors[0]["ename"]}: {errors[0]["evalue"]}', traceback)

    def run(self, code: str, timeout: float = TIMEOUT_SEC, *, cell_id: str = '') -> Result:
        """Run a cell to its end."""
        return self.finish(self.start(code, cell_id), timeout)

    def new_subshell(self) -> str:
        """Ask for a thread that hears what the page says while a cell runs; return its id."""
        request = self._client.session.msg('create_subshell_request', {})
        self._client.control_channel.send(request)
        answer = self._client.control_channel.get_msg(timeout=TIMEOUT_SEC)
        return str(answer['content']['subshell_id'])

    def say(self, comm_id: str, data: dict[str, Any], subshell_id: str) -> None:
        """Say something as the page's end of a comm."""
        message = self._client.session.msg('comm_msg', {'comm_id': comm_id, 'data': data})
        message['header']['subshell_id'] = subshell_id
        self._client.shell_channel.send(message)

    def inspect(self, code: str) -> str:
        """Return what Shift and Tab show at the end of a piece of code."""
        answer = self._client.inspect(code, reply=True, timeout=TIMEOUT_SEC)
        return re.sub(r'\x1b\[[\d;]*m', '', answer['content']['data'].get('text/plain', ''))

    def outputs_of(self, msg_id: str, *, updated: bool = False) -> list[dict[str, Any]]:
        """Return what a cell shows up to now, late output included.

        Args:
            msg_id: The cell's request.
            updated: Whether to show what is displayed as its last update says.
        """
        outputs: list[dict[str, Any]] = []
        with self._news:
            messages = list(self._messages.get(msg_id, ()))
        for message in messages:
            kind, content = message['msg_type'], message['content']
            if kind == 'clear_output':
                outputs.clear()
            if kind not in ('stream', 'display_data', 'execute_result', 'error'):
                continue
            last = outputs[-1] if outputs else {}
            if kind == 'stream' and last.get('name') == content['name']:
                last['text'] += content['text']
            else:
                outputs.append({'output_type': kind, **content})
        for content in self._updates() if updated else ():
            for output in outputs:
                if output.get('transient') == content['transient']:
                    output['data'] = content['data']
        return outputs

    def _updates(self) -> list[dict[str, Any]]:
        """Return the updates of what is displayed, oldest first: any cell may cause one."""
        with self._news:
            messages = [message for sent in self._messages.values() for message in sent]
        found = [m for m in messages if m['msg_type'] == 'update_display_data']
        return [m['content'] for m in sorted(found, key=lambda m: m['header']['date'])]

    def wait_for_output(self, msg_id: str, text: str, timeout: float = TIMEOUT_SEC) -> str:
        """Wait until `text` appears under a cell; return all that is shown there.

        What is displayed may be updated at once, so it is looked for before and after updates.
        """
        found: list[str] = []

        def appears() -> bool:
            forms = [_text(self.outputs_of(msg_id, updated=after)) for after in (False, True)]
            found[:] = [form for form in forms if text in form]
            return bool(found)

        try:
            self._wait(appears, timeout, f'output {text!r}')
        except pytest.fail.Exception as error:
            pytest.fail(f'{error}\nOutput so far:\n{_text(self.outputs_of(msg_id, updated=True))}')
        return found[0]

    def wait_until_gone(self, msg_id: str, text: str) -> None:
        """Wait until `text` is not shown any more under a cell."""
        self._wait(
            lambda: text not in _text(self.outputs_of(msg_id, updated=True)),
            TIMEOUT_SEC,
            f'no {text!r}',
        )

    def interrupt(self) -> None:
        """Press the stop button."""
        self._manager.interrupt_kernel()

    def restart(self) -> None:
        """Restart the kernel as JupyterLab does: ask it to end, then start it anew."""
        self._disconnect()
        self._manager.restart_kernel()
        self.process = self._manager.provisioner.process
        self._connect()

    def shutdown(self, timeout: float = TIMEOUT_SEC) -> int:
        """Ask the kernel to end as JupyterLab does; return its exit code."""
        self._client.shutdown()
        exit_code = self.process.wait(timeout)
        assert exit_code >= 0, f'Ended by {signal.Signals(-exit_code).name}:\n{self.log}'
        return exit_code

    def close(self) -> None:
        """End the kernel for certain."""
        self._disconnect()
        self._manager.shutdown_kernel(now=True)
        self._log.close()
        self._sockets.cleanup()


@pytest.fixture
def lab_env(tmp_path: Path) -> dict[str, str]:
    """Environment for a process of its own: labkit importable, own state, discovery off."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(_FOREIGN)}
    path = [str(ROOT), *filter(None, [env.get('PYTHONPATH')])]
    env.update(
        PYTHONPATH=os.pathsep.join(path),
        ROS_AUTOMATIC_DISCOVERY_RANGE='OFF',
        ROS_LOG_DIR=str(tmp_path / 'ros_log'),
        LABKIT_HOME=str(tmp_path / 'labkit_home'),
        IPYTHONDIR=str(tmp_path / 'ipython'),
    )
    return env


def patiently(env: dict[str, str]) -> dict[str, str]:
    """Return an environment in which the default limit of waits is long, see tests/patient."""
    return {**env, 'PYTHONPATH': os.pathsep.join([str(PATIENT), env['PYTHONPATH']])}


@pytest.fixture
def start_kernel(tmp_path: Path, lab_env: dict[str, str]) -> Iterator[Callable[..., Kernel]]:
    """Give a function that starts a kernel; keyword arguments are environment variables."""
    kernels: list[Kernel] = []

    def start(**env: str) -> Kernel:
        folder = tmp_path / f'kernel_{len(kernels)}'
        folder.mkdir()
        kernels.append(Kernel(folder, {**patiently(lab_env), **env}))
        return kernels[-1]

    yield start
    for kernel in kernels:
        kernel.close()


@pytest.fixture
def kernel(start_kernel: Callable[..., Kernel]) -> Kernel:
    """Give one kernel as a learner has it in JupyterLab (headless switch off)."""
    return start_kernel()


@pytest.fixture
def script(tmp_path: Path, lab_env: dict[str, str]) -> Callable[..., ScriptResult]:
    """Give a function that runs a Python script; keyword arguments are environment variables."""

    def run(code: str, **env: str) -> ScriptResult:
        path = tmp_path / 'script.py'
        path.write_text(code, encoding='utf-8')
        done = subprocess.run(
            [sys.executable, str(path)],
            cwd=tmp_path,
            env={**patiently(lab_env), **env},
            capture_output=True,
            text=True,
            timeout=4 * TIMEOUT_SEC,
        )
        return ScriptResult(done.returncode, done.stdout, done.stderr)

    return run
