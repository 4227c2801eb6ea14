"""Hold the stop button while there is something to undo: it interrupts only where code waits.

Python raises `KeyboardInterrupt` between any two instructions of the main thread: in the middle of
an `__enter__` that has changed one clock of three, or of an `__exit__` that has set one of them
back. While the button is held, the signal is only noted. It is raised once, at the next `look()`
or `pause()`. So a plain `try ... finally` is enough to undo any change. What waits while it undoes
one does so in `undoing()`.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ['heard_at_once', 'held', 'is_usual', 'look', 'pause', 'undoing', 'wait']

SLICE_SEC = 0.05


class _Button:
    """A handler of SIGINT that notes the signal.

    Args:
        before: The handler that it stands in for, perhaps the learner's own.
    """

    pressed = raised = at_once = undoing = False

    def __init__(self, before: Callable[[int, FrameType | None], object]) -> None:
        self._before = before

    def __call__(self, number: int, frame: FrameType | None) -> None:
        self.pressed = True
        if self.at_once:
            self.look()

    def look(self) -> None:
        # Only once: the cleanup that follows may wait, too.
        if not self.pressed or self.raised or self.undoing:
            return
        if is_usual(self._before):
            self.raised = True
            raise KeyboardInterrupt
        self.pressed = False
        self._before(signal.SIGINT, sys._getframe(1))


def _held() -> _Button | None:
    """Return the button if it is held and this is the main thread."""
    if threading.current_thread() is not threading.main_thread():
        return None
    handler = signal.getsignal(signal.SIGINT)
    return handler if isinstance(handler, _Button) else None


@contextmanager
def held() -> Iterator[None]:
    """Hold the button for a `with` block, where it would interrupt.

    It does so in the main thread, while a cell runs: the kernel ignores it between cells.

    Raises:
        KeyboardInterrupt: At the end of the block, if the button was pressed and nothing waited.
    """
    before = signal.getsignal(signal.SIGINT)
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or not callable(before) or isinstance(before, _Button):
        yield
        return
    button = _Button(before)
    signal.signal(signal.SIGINT, button)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        button.look()


def is_usual(handler: object) -> bool:
    """Return whether a handler of SIGINT is Python's own, or holds the button."""
    return handler is signal.default_int_handler or isinstance(handler, _Button)


@contextmanager
def heard_at_once() -> Iterator[None]:
    """Let the button interrupt a `with` block whose code may never return."""
    button = _held()
    if button is None:
        yield
        return
    button.look()
    button.at_once = True
    try:
        yield
    finally:
        button.at_once = False


@contextmanager
def undoing() -> Iterator[None]:
    """Let a `with` block that undoes something wait without being interrupted.

    A press meanwhile is raised by the next wait after it.
    """
    button = _held()
    if button is None or button.undoing:
        yield
        return
    button.undoing = True
    try:
        yield
    finally:
        button.undoing = False


def look() -> None:
    """Raise `KeyboardInterrupt` if the button was pressed while held."""
    if button := _held():
        button.look()


def pause(seconds: float) -> None:
    """Sleep for a moment, and raise `KeyboardInterrupt` if the button was pressed before."""
    look()
    time.sleep(seconds)


def wait(event: threading.Event, timeout_sec: float) -> bool:
    """Wait for an event; return whether it was set in time."""
    end = time.monotonic() + timeout_sec
    while not event.wait(max(0.0, min(SLICE_SEC, end - time.monotonic()))):
        look()
        if time.monotonic() >= end:
            return False
    return True
