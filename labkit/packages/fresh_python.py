"""Load a module as `ros2 run` does, in a Python that has loaded nothing else: a script.

Its text is run by `python -c`, in the folder with the module's package. Its argument is JSON: the
`module`, the `submodules` that it reaches as attributes of their packages, the file for the
`answer`, and the most `seconds`. labkit is not needed. What the module prints goes nowhere.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, NoReturn

# Of an error.
MOST_CHARACTERS = 500


class _TooLong(BaseException):
    """The seconds are over. Not an Exception: the module may catch those."""


def _end(_number: int, _frame: FrameType | None) -> NoReturn:
    raise _TooLong


def _lacking(submodules: list[str]) -> list[str]:
    """Return the submodules that are not there when only their packages are imported.

    Messages are: labkit's stand-in for a package of types brings them, and the real one does not.
    """
    brought: dict[str, set[str]] = {}
    for package in sorted({name.rpartition('.')[0] for name in submodules}):
        before = set(sys.modules)
        with suppress(Exception):  # loading the module itself tells that, with its line
            importlib.import_module(package)
            brought[package] = set(sys.modules) - before
    lacking = []
    for name in submodules:
        package, _, word = name.rpartition('.')
        if name not in brought.get(package, {name}) or word in ('msg', 'srv', 'action'):
            with suppress(Exception):
                importlib.import_module(name)
                lacking.append(name)
    return lacking


def _line(traceback: TracebackType | None, module: str) -> int:
    """Return the last line of a module that led to an error, 0 if none did."""
    line = 0
    while traceback is not None:
        if traceback.tb_frame.f_globals.get('__name__') == module:
            line = traceback.tb_lineno
        traceback = traceback.tb_next
    return line


def main(asked: dict[str, Any]) -> None:
    """Load the module, and write what it lacks and where it fails."""
    answer: dict[str, Any] = {'lacking': [], 'error': '', 'line': 0, 'missing': ''}
    sys.path.insert(0, os.getcwd())
    signal.signal(signal.SIGALRM, _end)
    signal.alarm(asked['seconds'])
    try:
        answer['lacking'] = _lacking(asked['submodules'])
        importlib.import_module(asked['module'])
    except BaseException as error:  # SystemExit too
        said = f'It takes longer than {asked["seconds"]} s.'
        if not isinstance(error, _TooLong):
            said = f'{type(error).__name__}: {error}'
        answer['error'] = said[:MOST_CHARACTERS]
        answer['line'] = _line(error.__traceback__, asked['module'])
        if isinstance(error, ModuleNotFoundError):
            answer['missing'] = error.name or ''
    signal.alarm(0)
    Path(asked['answer']).write_text(json.dumps(answer), encoding='utf-8')
    os._exit(0)  # whatever the module has started


if __name__ == '__main__':
    main(json.loads(sys.argv[1]))
