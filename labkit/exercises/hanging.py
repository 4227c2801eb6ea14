"""Callbacks of this notebook that do not return, told from such as get no turn."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass

from labkit.exercises.fair_clock import FairClock
from labkit.exercises.learner_errors import where_it_hangs

__all__ = ['Hanging', 'Standstill', 'find_hanging']

# A callback that runs longer than this keeps the others waiting.
HANG_SEC = 0.4
POLL_SEC = 0.004


@dataclass(frozen=True)
class Hanging:
    """What does not return.

    Attributes:
        node: Full name of the node whose callback it is; '' if no callback runs, though some are
            ready: something else keeps the background, such as the condition of a wait.
        callback: Name of the callback.
        line: Where in the learner's code it is; '' if that is not known.
    """

    node: str
    callback: str
    line: str


class Standstill:
    """How long the background has been at the same callback. Look at it often.

    Attributes:
        at: The node and the name of the callback that runs, None if none does; and how many have
            been run before.
    """

    def __init__(self) -> None:
        from labkit.background.runtime import runtime

        self._runtime = runtime
        self._clock = FairClock(runtime.executor.thread)
        self.at, self._since = self._progress(), 0.0

    @property
    def seconds(self) -> float:
        """For how long it could go on and has not, s."""
        now, at = self._clock.seconds, self._progress()
        if at != self.at:
            self.at, self._since = at, now
        return now - self._since

    def what(self) -> Hanging:
        """Say where it stands."""
        node, callback = self.at[0] or ('', '')
        frame = sys._current_frames().get(self._runtime.executor.thread.ident or 0)
        return Hanging(node, callback, where_it_hangs(frame))

    def _progress(self) -> tuple[tuple[str, str] | None, int]:
        count = sum(entry.callbacks for entry in self._runtime.nodes())
        return self._runtime.executor.running_callback(), count


def find_hanging() -> Hanging | None:
    """Return the callback that runs just now, if it does not return; None if it does."""
    standstill = Standstill()
    running, _ = began = standstill.at
    while running is not None and standstill.at == began:
        if standstill.seconds > HANG_SEC:
            return standstill.what()
        time.sleep(POLL_SEC)
    return None
