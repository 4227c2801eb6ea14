"""What cells wait for: conditions that are looked at between two callbacks, never during one."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress

from labkit.background.console import Console

__all__ = ['POLL_SEC', 'Conditions']

# While nothing happens in ROS, a condition that depends on something else is looked at this often.
POLL_SEC = 0.05


class Conditions:
    """The conditions that are waited for, and the lock that callbacks run under.

    Args:
        console: Where the output of callbacks goes.

    Attributes:
        lock: Held while a callback runs. Who holds it keeps callbacks waiting.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self.lock = threading.RLock()
        self._looks: list[Callable[[], None]] = []
        # The thread that is looking at a condition just now.
        self._looking: int | None = None

    @property
    def is_looking(self) -> bool:
        """Tell whether some thread is looking at a condition just now."""
        return self._looking is not None

    @property
    def caller_is_looking(self) -> bool:
        """Tell whether the caller is a condition itself, or called by one."""
        return self._looking == threading.get_ident()

    def look(self) -> None:
        """Look at all of them. The caller holds the lock."""
        for look in tuple(self._looks):
            look()

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
            is_over: Tells that no callback will run any more.

        Returns:
            Whether it became true in time.

        Raises:
            Exception: What `condition` raises.
        """
        done = threading.Event()
        failed: list[BaseException] = []
        with self._console.waiting() as end:

            def look() -> None:
                self._looking = threading.get_ident()
                try:
                    if done.is_set() or not condition():
                        return
                except BaseException as error:  # it belongs to the caller, not to this thread
                    failed.append(error)
                finally:
                    self._looking = None
                end()
                done.set()

            self._looks.append(look)
            try:
                self._wait_for(done, look, timeout_sec, is_over)
            finally:
                self._looks.remove(look)
        if failed:
            raise failed[0]
        return done.is_set()

    def _wait_for(
        self,
        done: threading.Event,
        look: Callable[[], None],
        timeout_sec: float | None,
        is_over: Callable[[], bool],
    ) -> None:
        endless = timeout_sec is None or timeout_sec < 0
        end = float('inf') if endless else time.monotonic() + (timeout_sec or 0.0)
        while True:
            # Between callbacks only: one that is half way may have counted, but not yet printed.
            try:
                if self.lock.acquire(timeout=POLL_SEC):
                    look()
            finally:
                # The stop button may strike between acquiring and knowing of it, so the lock
                # itself is asked: it refuses when this thread does not hold it.
                with suppress(RuntimeError):
                    self.lock.release()
            left = end - time.monotonic()
            if done.wait(max(0.0, min(POLL_SEC, left))) or left <= 0 or is_over():
                return
