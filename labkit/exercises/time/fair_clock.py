"""How long another thread had for its work, whatever time a busy machine gives it.

The whole machine may stand still for a second, and a class of kernels may keep a thread from its
turn for as long. Neither says anything about what the thread does.
"""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import threading

__all__ = ['FairClock']

# Who looks at the clock does so more often than this, s: what is more has passed for nobody.
MOST_SEC = 0.05


class FairClock:
    """Seconds since it was made, without those in which nobody could work. Look at it often.

    Args:
        thread: The thread that is waited for, or the id of a process. While it, or a thread of the
            process, is ready to run, only what it runs counts, where the operating system tells
            (Linux).
    """

    def __init__(self, thread: threading.Thread | int | None = None) -> None:
        self._thread = thread
        self._seen = time.monotonic()
        self._used = _at_work(thread)[1]
        self._owed = self._seconds = 0.0

    @property
    def seconds(self) -> float:
        """How long it had, s."""
        now, (is_ready, used) = time.monotonic(), _at_work(self._thread)
        passed = min(now - self._seen, MOST_SEC)
        # The operating system counts in steps that may be longer than the time between two looks.
        self._owed = self._owed + used - self._used if is_ready else 0.0
        if is_ready:
            passed = min(passed, self._owed)
            self._owed -= passed
        self._seen, self._used = now, used
        self._seconds += passed
        return self._seconds


def _at_work(thread: threading.Thread | int | None) -> tuple[bool, float]:
    """Tell whether a thread is ready to run, and how long it has run, s; else False and 0."""
    if thread is None:
        return False, 0.0
    place = thread if isinstance(thread, int) else f'self/task/{thread.native_id}'
    try:
        with open(f'/proc/{place}/stat', 'rb', buffering=0) as file:
            # The fields are in proc_pid_stat(5). The second one is a name, in parentheses.
            fields = file.read().rpartition(b')')[2].split()
    except OSError:
        # Not Linux, or it has just ended.
        return False, 0.0
    ticks = int(fields[11]) + int(fields[12])
    is_ready = fields[0] == b'R'
    if isinstance(thread, int):
        from labkit.programs.children import is_at_work

        is_ready = is_at_work(thread)
    return is_ready, ticks / os.sysconf('SC_CLK_TCK')
