"""What the tests of launch files share: files in a folder, and what a visit of them leads to."""

from __future__ import annotations

import os
import textwrap
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

import yaml

from labkit.launching.actions import IncludeLaunchDescription, Source
from labkit.launching.execute import Written
from labkit.launching.launch_files import load
from labkit.launching.model import Context

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
