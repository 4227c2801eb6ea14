"""A line that lives under a cell with commands of a shell, while it runs.

colcon builds a package in silence for half a minute. The line says for how long the cell has been
running, and which command is at work: the first of the cell's processes, and the newest below it.
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterator, Sequence, Set
from contextlib import suppress
from pathlib import PurePath
from typing import Any

from labkit import settings
from labkit.progress_bar import ProgressBar

__all__ = ['register', 'words_of']

EVERY_SEC = 0.5
# `%%bash`, or a line that begins with an exclamation mark.
_SHELL = re.compile(r'\s*%%(bash|sh|script)\b|^\s*!', re.MULTILINE)
_SHELLS = {'sh', 'bash', 'dash', 'zsh'}
_PYTHON = re.compile(r'python[\d.]*')


def register() -> None:
    """Follow the cells of a kernel with a learner in front of it. Without effect elsewhere."""
    shell = settings.shell()
    if shell is None or settings.audience() is not settings.LEARNER:
        return
    if not any(isinstance(getattr(each, '__self__', None), _Cells) for each in _called(shell)):
        cells = _Cells()
        shell.events.register('pre_run_cell', cells.begin)
        shell.events.register('post_run_cell', cells.end)


def _called(shell: Any) -> Sequence[Any]:
    return tuple(shell.events.callbacks['pre_run_cell'])


class _Cells:
    """Runs a thread while a cell with commands of a shell does."""

    def __init__(self) -> None:
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def begin(self, info: Any = None) -> None:
        if _SHELL.search(getattr(info, 'raw_cell', '') or ''):
            self._ended.clear()
            before = {process.pid for process in _processes()}
            self._thread = threading.Thread(target=self._show, args=(before,), daemon=True)
            self._thread.start()

    def end(self, result: Any = None) -> None:
        if self._thread is not None:
            self._ended.set()
            self._thread.join()
            self._thread = None

    def _show(self, before: Set[int]) -> None:
        began = time.monotonic()
        bar = ProgressBar('Running')
        while not self._ended.wait(EVERY_SEC):
            names = [words for *_, words in sorted(_commands(before))]
            if names:
                newest = f', {names[-1]}' if names[-1] != names[0] else ''
                bar.show(None, f'{names[0]}, {time.monotonic() - began:.0f} s{newest}')
        bar.close()


def _processes() -> list[Any]:
    import psutil  # type: ignore[import-untyped]

    return list(psutil.Process().children(recursive=True))


def _commands(before: Set[int]) -> Iterator[tuple[float, int, str]]:
    """Yield start, number and command of each process, but of those from before the cell."""
    import psutil

    for process in _processes():
        with suppress(psutil.Error):
            words = words_of(process.cmdline())
            if words and process.pid not in before:
                yield process.create_time(), process.pid, words


def words_of(command: Sequence[str]) -> str:
    """Return a command as one would type it, without its options; '' for a shell."""
    words = list(command)
    if words and _PYTHON.fullmatch(PurePath(words[0]).name):
        words = list(_script(iter(words[1:])))
    words = [word for word in words if not word.startswith('-')]
    if not words or PurePath(words[0]).name in _SHELLS:
        return ''
    verb = words[1:2] if len(words) > 1 and words[1].isalpha() else []
    return ' '.join([PurePath(words[0]).name, *verb])


def _script(words: Iterator[str]) -> Iterator[str]:
    """Yield the script or the module that Python runs, and its words; nothing for -c."""
    for word in words:
        if word in ('-W', '-X'):
            next(words, '')
        elif word == '-c':
            return
        elif word == '-m' or not word.startswith('-'):
            yield from words if word == '-m' else (word, *words)
