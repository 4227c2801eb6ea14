"""Keys pressed in a terminal, while a command goes on."""

from __future__ import annotations

import os
import re
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ['DOWN', 'RIGHT', 'SPACE', 'UP', 'pressed_keys']

SPACE, UP, DOWN, RIGHT = ' ', '\x1b[A', '\x1b[B', '\x1b[C'
# Some terminals are told to send O in the place of [.
_KEY = re.compile(r'\x1b[\[O]([A-Z])|.', re.DOTALL)


@contextmanager
def pressed_keys() -> Iterator[Callable[[], list[str]] | None]:
    """Give a function that returns the keys pressed since it was called last.

    Ctrl-C stays what it is. None where there is no terminal, or another program has it.
    """
    import termios
    import tty

    try:
        terminal = sys.stdin.fileno()
        before = termios.tcgetattr(terminal)
        in_front = os.tcgetpgrp(terminal) == os.getpgrp()
    except (OSError, ValueError, termios.error):  # e.g. a pipe, or a kernel
        yield None
        return
    if not in_front:
        yield None
        return

    def pressed() -> list[str]:
        ready, _, _ = select.select([terminal], [], [], 0)
        text = os.read(terminal, 1024).decode(errors='replace') if ready else ''
        return [f'\x1b[{key[1]}' if key[1] else key[0] for key in _KEY.finditer(text)]

    tty.setcbreak(terminal)
    try:
        yield pressed
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)
