"""What the tests of launch files share: files, what a visit of them leads to, and a run."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import textwrap
import uuid
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
import yaml

from labkit.launching.actions import IncludeLaunchDescription, Source
from labkit.launching.execute import Written
from labkit.launching.launch_files import load
from labkit.launching.model import Context
from tests.conftest import TIMEOUT_SEC

# Among the flags in /proc/PID/stat (include/linux/sched.h).
PF_EXITING = 0x4
# A package with one program, which shows its arguments.
TOYS = {
    'share/ament_index/resource_index/packages/toys': '',
    'lib/toys/echo_args': '#!/usr/bin/env python3\nimport sys\nprint(sys.argv[1:])\n',
    'share/toys/launch/toys.launch.xml': '<launch><arg name="a" default="1"/></launch>',
}


@dataclass
class Visit:
    """What a launch file leads to, before anything is started."""

    said: list[str] = field(default_factory=list)
    warned: list[str] = field(default_factory=list)
    started: list[list[Any]] = field(default_factory=list)
    context: Context = field(default_factory=Context)


def make_toys(folder: Path) -> Path:
    """Install the package `toys` in a folder."""
    write(folder, TOYS)
    (folder / 'lib/toys/echo_args').chmod(0o755)
    return folder


def write(folder: Path, files: dict[str, str]) -> Path:
    """Write files, and return the path of the first."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(textwrap.dedent(text), encoding='utf-8')
    return folder / next(iter(files))


def visit(path: Path, *arguments: str) -> Visit:
    """Visit a launch file, with arguments as on the command line."""
    found = Visit()

    def say(level: str, who: str, text: str) -> None:
        (found.said if who == 'launch.user' else found.warned).append(text)

    found.context = context = Context(argv=list(arguments), say=say, load=load)
    pairs = [one.partition(':=')[::2] for one in arguments]
    with mock.patch.dict(os.environ):  # as if it were a process of its own
        context.visit([IncludeLaunchDescription(Source(str(path)), launch_arguments=pairs)])
    for start in context.starts:
        before = ['', *start.command[:-1]]
        words = [_shown(word, one) for word, one in zip(start.command, before, strict=True)]
        own = {key: text for key, text in start.environment.items() if key.startswith('LAB_')}
        found.started.append([start.name, words, own])
    return found


def _shown(word: str | Written, before: str | Written) -> Any:
    """Return a word of a command; of a file of parameters its content."""
    if isinstance(word, Written):
        return yaml.safe_load(word.text)
    is_file = before == '--params-file' and os.path.exists(word)
    return yaml.safe_load(Path(word).read_text(encoding='utf-8')) if is_file else word


class Launched:
    """`ros2 launch` of a file, in a process of its own."""

    def __init__(self, path: Path, *arguments: str, **environment: str) -> None:
        self.mark = f'LAB_MARK={uuid.uuid4().hex}'
        name, _, value = self.mark.partition('=')
        self.lines: list[str] = []
        self.popen = subprocess.Popen(
            [sys.executable, '-m', 'labkit.ros2', 'launch', str(path), *arguments],
            env={
                **os.environ,
                **{'ROS_DOMAIN_ID': '0', 'ROS_LOG_DIR': str(path.parent / 'log'), name: value},
                **environment,
            },
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def wait_for(self, text: str) -> None:
        """Read until a line has a text."""
        assert self.popen.stdout is not None
        for line in self.popen.stdout:
            self.lines.append(line.rstrip())
            if text in line:
                return
        pytest.fail(f'{text!r} never came:\n' + self.shown)

    def send(self, number: int) -> None:
        self.popen.send_signal(number)

    def end(self) -> int:
        """Wait for its end, and return its exit code."""
        rest, _ = self.popen.communicate(timeout=TIMEOUT_SEC)
        self.lines += rest.splitlines()
        return self.popen.returncode

    @property
    def shown(self) -> str:
        """All lines but that of the log, with P for process ids."""
        lines = [line for line in self.lines if 'All log files' not in line]
        return re.sub(r'pid (\[?)\d+', r'pid \1P', '\n'.join(lines))

    @property
    def left(self) -> list[int]:
        """Processes that it has started and that are still there."""
        found = []
        for folder in Path('/proc').glob('[0-9]*'):
            try:
                if self.mark.encode() in (folder / 'environ').read_bytes() and _lives(folder):
                    found.append(int(folder.name))
            except OSError:
                continue
        return found


def _lives(process: Path) -> bool:
    """Return whether a process runs on: one that was killed may wait for a processor to end."""
    words = (process / 'stat').read_text(errors='replace').rpartition(')')[2].split()
    if words[0] in 'ZX' or int(words[6]) & PF_EXITING:
        return False
    status = (process / 'status').read_text(errors='replace')
    pending = re.findall(r'^(?:SigPnd|ShdPnd):\s*(\w+)', status, re.MULTILINE)
    return not any(int(mask, 16) & 1 << (signal.SIGKILL - 1) for mask in pending)
