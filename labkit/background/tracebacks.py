"""Tracebacks as the learner's own lines: those of labkit and of ROS say nothing to a beginner.

An error that comes up inside of ROS, or the stop button while a cell waits, would otherwise show
pages of code that the learner has not written.
"""

from __future__ import annotations

import linecache
import os
import re
import sysconfig
import traceback
from types import TracebackType
from typing import Any

import rclpy

from labkit.errors import LabError, cell_name

__all__ = ['install', 'is_learners', 'short_traceback', 'without_ros']

_LABKIT = os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + os.sep
_RCLPY = os.path.dirname(os.path.abspath(rclpy.__file__)) + os.sep
# A kernel of somebody else's has packages in one folder, and ROS in another.
_LIBRARIES = (
    *(sysconfig.get_path('stdlib'), sysconfig.get_path('purelib')),
    os.path.dirname(os.path.dirname(_RCLPY)),
)
_WITH_INIT = """
This is written for a newer release of ROS 2. On Jazzy, rclpy.init() returns nothing, so it can not
stand after `with`. Write instead:
    rclpy.init(args=args)
    ...
    rclpy.shutdown()"""
# What is generated from the files of messages and services: std_msgs/msg/_int16.py
_INTERFACES = tuple(f'{os.sep}{kind}{os.sep}_' for kind in ('msg', 'srv', 'action'))


def short_traceback(error: BaseException) -> str:
    """Return the learner's lines of a traceback and the message, without those of libraries."""
    lines = []
    for frame, number in traceback.walk_tb(error.__traceback__):
        name = frame.f_code.co_filename
        if not is_learners(name):
            continue
        lines.append(f'  {cell_name(name) or name}, line {number}, in {frame.f_code.co_name}')
        source = linecache.getline(name, number).strip()
        if source:
            lines.append(f'    {source}')
    if isinstance(error, LabError):
        return '\n'.join([*lines, f'{type(error).__name__}: {error}'])
    return '\n'.join([*lines, *map(str.rstrip, traceback.format_exception_only(error))])


def is_learners(filename: str) -> bool:
    """Tell whether a file is a cell, or one that the learner has written."""
    if cell_name(filename):
        return True
    path = os.path.abspath(filename)
    return not path.startswith((*_LIBRARIES, _LABKIT)) and os.path.exists(path)


def without_ros(tb: TracebackType | None) -> TracebackType | None:
    """Return a traceback without labkit and ROS, and what those call, but with all callbacks."""
    kept = []
    inside = False
    while tb is not None:
        name = tb.tb_frame.f_code.co_filename
        inside = not is_learners(name) and (inside or _is_ros(name))
        if not inside:
            kept.append(tb)
        tb = tb.tb_next
    result: TracebackType | None = None
    for entry in reversed(kept):
        result = TracebackType(result, entry.tb_frame, entry.tb_lasti, entry.tb_lineno)
    return result


def install(shell: Any) -> None:
    """Let a notebook show errors of its cells that way, unless `%xmode Verbose` is chosen.

    Args:
        shell: The kernel's IPython shell.
    """
    formatter = shell.InteractiveTB
    if 'structured_traceback' in vars(formatter):
        return
    original = formatter.structured_traceback

    def structured_traceback(
        kind: Any, error: Any = None, tb: Any = None, *args: Any, **options: Any
    ) -> Any:
        hint = _hint(error, tb)
        if formatter.mode != 'Verbose' and isinstance(tb, TracebackType):
            tb = without_ros(tb)
        return [*original(kind, error, tb, *args, **options), *hint]

    formatter.structured_traceback = structured_traceback


def _hint(error: object, tb: object) -> list[str]:
    """Return what to write instead of code that is for a newer release of ROS 2."""
    if not isinstance(error, (AttributeError, TypeError)) or not isinstance(tb, TracebackType):
        return []
    lines = [
        linecache.getline(frame.f_code.co_filename, number)
        for frame, number in traceback.walk_tb(tb)
    ]
    # Python 3.10 raises an AttributeError (__enter__), later ones a TypeError.
    about_with = re.search('__enter__|context manager', str(error))
    if about_with and any(re.search(r'\bwith\b.*\binit\(', line) for line in lines):
        return [_WITH_INIT]
    return []


def _is_ros(filename: str) -> bool:
    path = os.path.abspath(filename)
    return path.startswith((_LABKIT, _RCLPY)) or (
        path.startswith(_LIBRARIES) and any(kind in path for kind in _INTERFACES)
    )
