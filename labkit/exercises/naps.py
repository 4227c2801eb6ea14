"""How long a sleep lasts on this machine, now.

A thread that calls `time.sleep(0.1)` is woken late on a busy machine, and nobody can tell that
from a thread that asked for more. So the check has a thread beside it that does nothing but sleep,
in the same process and under the same lock: what holds up one holds up the other.
"""

from __future__ import annotations

import threading
import time

__all__ = ['Naps']

# As long as the sleeps of a node that commands ten times a second, s.
NAP_SEC = 0.1


class Naps:
    """A thread that sleeps again and again, for a `with` block."""

    def __init__(self) -> None:
        self._late: list[float] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._sleep, name='labkit naps', daemon=True)

    def __enter__(self) -> Naps:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()

    @property
    def seconds(self) -> float:
        """How long it has meant to sleep altogether, s: a clock that a busy machine holds up."""
        return len(self._late) * NAP_SEC

    @property
    def slowness(self) -> float:
        """How many times as long as it was told to it has slept; 1.0 on a calm machine."""
        late = list(self._late)
        return 1.0 + sum(late) / (len(late) * NAP_SEC) if late else 1.0

    @property
    def late(self) -> float:
        """How much longer than told it slept in the one case of ten that was held up least, s."""
        late = sorted(self._late)
        return late[len(late) // 10] if late else 0.0

    def _sleep(self) -> None:
        ended = time.monotonic()
        while not self._ended.is_set():
            began = ended  # what passes between two naps counts as well
            time.sleep(NAP_SEC)
            ended = time.monotonic()
            self._late.append(max(ended - began - NAP_SEC, 0.0))
