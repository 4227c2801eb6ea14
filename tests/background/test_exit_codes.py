"""A program with running nodes ends soon and with its own exit code, however it ends."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow('each way to end, in each state')

# Activities of the background thread at the end of the program.
FAST = 'callbacks run fast'
BUSY = {
    FAST: 'self.publisher.publish(String(data="x"))',
    'a callback is in an endless loop': 'while True: pass',
    'a callback sleeps': 'time.sleep(1000)',
    'a callback waits for ever': 'threading.Event().wait()',
}
# How often an end is tried where callbacks come and go, so that chance decides at which step it
# comes; else the thread stands where it stands. A kernel takes a second to start.
SCRIPTS, KERNELS = 10, 5
NODE = """
import signal, sys, threading, time
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String

at_work = threading.Event()

class Busy(Node):
    def __init__(self):
        super().__init__('busy')
        self.publisher = self.create_publisher(String, 'busy', 10)
        self.create_subscription(String, 'busy', lambda message: None, 10)
        for _ in range(4):
            self.create_timer(0.001, self.on_timer)

    def on_timer(self):
        at_work.set()
        {work}

busy = lab.spin(Busy())
at_work.wait()
"""
READY = "print('ready', flush=True)\n"
# Kind of end -> the last lines of the program, and its expected exit code.
ENDS = {
    'end of the script': ('', 0),
    'sys.exit(3)': ('sys.exit(3)', 3),
    'sys.exit with a text': ("sys.exit('no')", 1),
    'an exception': ("raise ValueError('no')", 1),
    'lab.stop() before the end': ('lab.stop()\nsys.exit(4)', 4),
    'a handler of SIGTERM': (
        'signal.signal(signal.SIGTERM, lambda *_: sys.exit(5))\n'
        'signal.raise_signal(signal.SIGTERM)',
        5,
    ),
    'SIGTERM': (f'{READY}threading.Event().wait()', -signal.SIGTERM),
    'SIGINT': (f'{READY}threading.Event().wait()', -signal.SIGINT),
}
# There to end a hang, not to judge: many processes share a busy machine.
TIMEOUT_SEC = 120


@contextmanager
def started(command: list[str], env: dict[str, str]) -> Iterator[subprocess.Popen[str]]:
    """Start a process; kill it at the end if it is still running."""
    pipe = subprocess.PIPE
    with subprocess.Popen(command, env=env, stdout=pipe, stderr=pipe, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.mark.parametrize('work', BUSY)
@pytest.mark.parametrize('end', ENDS)
def test_script(lab_env: dict[str, str], tmp_path: Path, end: str, work: str) -> None:
    count = SCRIPTS if work == FAST else 1
    last_lines, exit_code = ENDS[end]
    path = tmp_path / 'script.py'
    path.write_text(NODE.format(work=BUSY[work]) + last_lines + '\n')
    with ExitStack() as stack:
        command = [sys.executable, str(path)]
        processes = [stack.enter_context(started(command, lab_env)) for _ in range(count)]
        if end in ('SIGTERM', 'SIGINT'):
            for process in processes:
                assert process.stdout is not None
                assert process.stdout.readline() == 'ready\n'
                process.send_signal(getattr(signal, end))
        for process in processes:
            _, stderr = process.communicate(timeout=TIMEOUT_SEC)
            assert process.returncode == exit_code, stderr
            assert 'terminate called' not in stderr
            assert ('Traceback' in stderr) == (end in ('an exception', 'SIGINT')), stderr


@pytest.mark.parametrize('work', BUSY)
@pytest.mark.parametrize('end', ['shutdown', 'exit()', 'SIGTERM'])
def test_kernel(start_kernel: Callable[..., object], end: str, work: str) -> None:
    for _ in range(KERNELS if work == FAST else 1):
        kernel = start_kernel()
        assert not kernel.run(NODE.format(work=BUSY[work])).error
        if end == 'shutdown':
            exit_code = kernel.shutdown(TIMEOUT_SEC)
        else:
            if end == 'SIGTERM':
                kernel.process.send_signal(signal.SIGTERM)
            else:
                kernel.start('exit()')
            exit_code = kernel.process.wait(TIMEOUT_SEC)
        assert exit_code == (-signal.SIGTERM if end == 'SIGTERM' else 0), kernel.log
        assert 'terminate called' not in kernel.log
