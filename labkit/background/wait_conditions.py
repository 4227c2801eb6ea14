"""Conditions that cells wait for, evaluated between two callbacks and never during one."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress

from labkit.background.console import Console
from labkit.background.wait import POLL_SEC, wait_for, wake

__all__ = ['Conditions']


class Conditions:
    """The awaited conditions, and the lock that callbacks run under.

    Attributes:
        lock: Held while a callback runs; holding it delays callbacks.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self.lock = threading.RLock()
        self._looks: list[Callable[[], None]] = []
        self._looking: int | None = None  # id of the thread that evaluates a condition

    @property
    def is_looking(self) -> bool:
        """Return whether a thread is evaluating a condition."""
        return self._looking is not None

    @property
    def caller_is_looking(self) -> bool:
        """Return whether a condition calls this."""
        return self._looking == threading.get_ident()

    def look(self) -> None:
        """Evaluate all conditions, and wake all other waits. The caller holds the lock."""
        for look in tuple(self._looks):
            look()
        wake()

    def wait(
        self,
        condition: Callable[[], object],
        timeout_sec: float | None,
        is_over: Callable[[], bool],
    ) -> bool:
        """Wait until `condition()` is true.

        Args:
            condition: A function without arguments. It is never called during a callback.
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.
            is_over: Returns whether no callback will run any more.

        Returns:
            Whether it became true in time.

        Raises:
            Exception: The exception of `condition`.
        """
        seen: list[object] = []  # True, or the exception of the condition
        alarm = threading.Event()
        with self._console.waiting() as end:

            def look() -> None:
                self._looking = threading.get_ident()
                try:
                    if seen or not condition():
                        return
                    seen.append(True)
                except BaseException as error:  # to be raised in the caller's thread
                    seen.append(error)
                finally:
                    self._looking = None
                end()
                alarm.set()

            def look_between() -> bool:
                # Between callbacks only: a running one may have counted, but not yet printed.
                try:
                    if self.lock.acquire(timeout=POLL_SEC):
                        look()
                finally:
                    # The stop button may strike between acquiring the lock and returning, so only
                    # the lock knows: it raises if this thread does not hold it.
                    with suppress(RuntimeError):
                        self.lock.release()
                return bool(seen) or is_over()

            self._looks.append(look)
            try:
                endless = timeout_sec is None or timeout_sec < 0
                wait_for(look_between, None if endless else timeout_sec, alarm=alarm)
            finally:
                self._looks.remove(look)
        if seen and isinstance(seen[0], BaseException):
            raise seen[0]
        return bool(seen)
