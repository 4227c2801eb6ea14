"""What the tests of the `ros2` words share: a domain of their own, and nodes that live there."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

import labkit
from labkit.background import domains

ROBOT = Path(__file__).with_name('robot.py')

# Runs lines one after the other, and tells what each has printed.
ASKER = """
import contextlib, io, json, sys
import labkit
from labkit import settings
from labkit.ros2.shell import run_line

settings.is_ros2_command = {for_a_script}
answers = []
for line in {lines!r}:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run_line(line)
    answers.append([code, out.getvalue(), err.getvalue()])
print(json.dumps(answers))
"""


@dataclass(frozen=True)
class Answer:
    """What a line has brought."""

    code: int
    out: str
    err: str

    @property
    def lines(self) -> list[str]:
        return self.out.splitlines()


@pytest.fixture(autouse=True)
def ros_ends() -> Iterator[None]:
    """Stop ROS, which some lines start in this process: other tests have to start it anew."""
    yield
    labkit.stop()


@pytest.fixture
def domain() -> Iterator[dict[str, str]]:
    """Give the variables for processes that are to hear each other, and nobody else."""
    claim = domains.claim_domain()
    yield {
        'ROS_DOMAIN_ID': str(claim.domain_id),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
    }
    claim.close()


@pytest.fixture
def robot(domain: dict[str, str], lab_env: dict[str, str]) -> Iterator[subprocess.Popen[str]]:
    """Let nodes run in another process that knows nothing of labkit."""
    process = subprocess.Popen(
        [sys.executable, str(ROBOT)],
        env={**lab_env, **domain},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdin is not None and process.stdout is not None
    assert process.stdout.readline() == 'ready\n'
    yield process
    process.stdin.close()
    process.wait(60)
    process.stdout.close()


@pytest.fixture
def ros2(script: Callable, domain: dict[str, str]) -> Callable[..., list[Answer]]:
    """Give a function that runs lines in a process of its own, as `%ros2` would.

    With `for_a_script` it is `ros2` with its output in a pipe instead.
    """

    def run(*lines: str, for_a_script: bool = False, **env: str) -> list[Answer]:
        code = ASKER.format(lines=list(lines), for_a_script=for_a_script)
        result = script(code, **{**domain, **env})
        assert result.exit_code == 0, result.stderr
        return [Answer(*answer) for answer in json.loads(result.stdout.splitlines()[-1])]

    return run
