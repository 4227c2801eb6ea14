"""A supervised command ends in its own way, whatever ends it and however far it has started.

How long it may take is set so high here that a command which had to be killed fails the test.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from labkit.programs import supervisor

ROOT = Path(supervisor.__file__).parents[2]
# A hang ends; nothing is judged by it.
TIMEOUT_SEC = 60.0
PATIENT = """
import runpy, sys
main = runpy.run_path(sys.argv[1])['main']
main.__globals__['GRACE_SEC'] = 1e6
sys.exit(main(sys.argv[2:]))
"""
# Says how often it is interrupted. Ends when the test opens the pipe at its other end. It prints
# past `sys.stdout`, which the interrupt may find still busy with the word before.
SLOW_TO_TIDY_UP = """
import os, signal, sys
interrupts = []
signal.signal(signal.SIGINT, lambda *_: interrupts.append(1) or os.write(1, b'interrupted\\n'))
os.write(1, b'up\\n')
open(sys.argv[1]).close()
sys.exit(10 + len(interrupts))
"""
# Stages of the start of a node, as Python names them with -X importtime; then its first words.
STAGES = ('| encodings', 'ros_wheels_bootstrapper', 'rclpy.context', '| rclpy\n', 'Publishing')

Run = Callable[..., 'subprocess.Popen[str]']


@pytest.fixture
def supervise(lab_env: dict[str, str]) -> Iterator[Run]:
    """Return a function that runs a Python command under a supervisor without a time limit."""
    started: list[subprocess.Popen[str]] = []

    def run(*words: str) -> subprocess.Popen[str]:
        patient = [sys.executable, '-I', '-S', '-c', PATIENT, supervisor.__file__]
        started.append(
            subprocess.Popen(
                [*patient, sys.executable, *words],
                cwd=ROOT,
                env=lab_env,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
        )
        return started[-1]

    yield run
    for process in started:
        process.kill()  # its command dies with it
        process.wait()
        for pipe in (process.stdin, process.stdout):
            assert pipe is not None
            pipe.close()


def read_until(process: subprocess.Popen[str], text: str) -> None:
    assert process.stdout is not None
    lines = []
    for line in process.stdout:
        lines.append(line)
        if text in line:
            return
    pytest.fail(f'ended without {text!r}:\n{"".join(lines)}')


def terminate(process: subprocess.Popen[str]) -> None:
    process.send_signal(signal.SIGTERM)


def close(process: subprocess.Popen[str]) -> None:
    assert process.stdin is not None
    process.stdin.close()


ways = pytest.mark.parametrize('ask', [terminate, close])


@ways
def test_a_command_that_ends_when_interrupted_is_not_waited_for(supervise: Run, ask: Run) -> None:
    process = supervise('-c', 'import time; print("up", flush=True); time.sleep(1000)')
    read_until(process, 'up')
    ask(process)
    assert process.wait(TIMEOUT_SEC) == 128 + signal.SIGINT


@ways
@pytest.mark.parametrize('stage', STAGES, ids=lambda stage: stage.strip('| \n'))
def test_a_node_ends_by_itself_however_far_it_has_started(
    supervise: Run, ask: Run, stage: str
) -> None:
    node = ('-m', 'labkit.programs.demo_nodes', 'talker')
    process = supervise('-X', 'importtime', *node)
    read_until(process, stage)
    ask(process)
    # 0: it was spinning. 1: ROS was half up. 130: Python was loading it.
    assert process.wait(TIMEOUT_SEC) in (0, 1, 128 + signal.SIGINT)


def test_asked_in_both_ways_it_interrupts_once(supervise: Run, tmp_path: Path) -> None:
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    process = supervise('-c', SLOW_TO_TIDY_UP, str(pipe))
    read_until(process, 'up')
    close(process)
    read_until(process, 'interrupted')
    terminate(process)
    terminate(process)
    pipe.write_text('')
    assert process.wait(TIMEOUT_SEC) == 11
