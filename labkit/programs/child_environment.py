"""Environment variables of the programs that labkit starts, and the pipe that is named in one.

Loading this needs no rclpy: a program that only starts others does not wait for it.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from labkit import settings

__all__ = ['READY', 'environment', 'teller']

READY = 'LABKIT_READY'
"""Environment variable with the file descriptor of the pipe that a `Process` reads."""


def environment() -> dict[str, str]:
    """Return environment variables for a process that needs labkit and readable output."""
    variables = dict(os.environ)
    folder = str(Path(__file__).parents[2])
    paths = [folder, *filter(None, [variables.get('PYTHONPATH')])]
    variables['PYTHONPATH'] = os.pathsep.join(dict.fromkeys(paths))
    if settings.in_kernel():
        variables.setdefault('PYTHONUNBUFFERED', '1')
        # The same form as that of the notebook's own nodes.
        variables.setdefault('RCUTILS_CONSOLE_OUTPUT_FORMAT', '[{severity}] [{name}]: {message}')
    return variables


def teller() -> Callable[[dict[str, Any]], None] | None:
    """Return a function that tells the notebook what happens, line by line; None without one."""
    pipe = os.environ.pop(READY, '')
    if not pipe.isdecimal():
        return None
    os.set_inheritable(int(pipe), False)

    def tell(event: dict[str, Any]) -> None:
        with contextlib.suppress(OSError):
            os.write(int(pipe), f'{json.dumps(event)}\n'.encode())

    return tell
