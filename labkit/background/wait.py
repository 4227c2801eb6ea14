"""The one wait: look, sleep until something may have happened, look again.

The background thread calls `wake` after each callback, so what callbacks in this process change is
seen at once. Changes of the graph and output of processes come without notice, so a wait also
polls. It sleeps in slices, between which Python hears the stop button. A cell that waits for
longer than a moment says so.

`Conditions` builds on it the waits of cells, which look between two callbacks and show output.
Everything else waits here, and shows nothing. An event that another thread sets is waited for
directly.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TypeVar

from labkit import stop_button
from labkit.progress_bar import ProgressBar

__all__ = ['POLL_SEC', 'wait_for', 'wake']

Found = TypeVar('Found')

POLL_SEC = 0.01

_sleeping: list[threading.Event] = []


def wait_for(
    look: Callable[[], Found],
    timeout_sec: float | None,
    *,
    alarm: threading.Event | None = None,
) -> Found:
    """Call `look` until its answer is true or the time is over; return the last answer.

    Args:
        look: A function without arguments. An exception of it ends the wait.
        timeout_sec: Seconds to wait, None for no limit. Look once if not above 0.
        alarm: Event to look at once. By default each callback is one.
    """
    began = time.monotonic()
    end = float('inf') if timeout_sec is None else began + timeout_sec
    in_cell = threading.current_thread() is threading.main_thread()
    bar = ProgressBar('Waiting') if in_cell else None
    own = alarm or threading.Event()
    try:
        if alarm is None:
            _sleeping.append(own)
        while True:
            own.clear()  # before the look: an event meanwhile requires another one
            found = look()
            stop_button.look()
            left = end - time.monotonic()
            if found or left <= 0:
                return found
            if bar is not None:
                _show(bar, time.monotonic() - began, timeout_sec)
            own.wait(min(POLL_SEC, left))
    finally:
        if own in _sleeping:
            _sleeping.remove(own)
        if bar is not None:
            bar.close()


def _show(bar: ProgressBar, passed: float, timeout_sec: float | None) -> None:
    if timeout_sec is None:
        bar.show(None, f'{passed:.0f} s')
    else:
        bar.show(passed / timeout_sec, f'{passed:.0f} of {round(timeout_sec, 1):g} s')


def wake() -> None:
    """Let all waits look now."""
    for alarm in tuple(_sleeping):
        alarm.set()
