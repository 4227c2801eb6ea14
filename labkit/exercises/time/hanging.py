"""Callbacks of this notebook that do not return, told from such as get no turn."""

from __future__ import annotations

import sys
import threading
from dataclasses import dataclass

from labkit.background.wait import wait_for
from labkit.exercises.learner_errors import where_it_hangs
from labkit.exercises.time.fair_clock import FairClock

__all__ = ['Hanging', 'Standstill', 'find_hanging', 'thread_at_work']

# A callback that runs longer than this keeps the others waiting.
HANG_SEC = 0.4


@dataclass(frozen=True)
class Hanging:
    """What does not return.

    Attributes:
        node: Full name of the node whose callback it is; '' if no callback runs, though some are
            ready: something else keeps the background, such as the condition of a wait.
        callback: Name of the callback.
        line: Where in the learner's code it is; '' if that is not known.
        took: How long it was at work, s.
        period: The period of the timer that calls it, s; 0 if no timer does.
        ended: Whether its node has ended: another one may have the name now.
    """

    node: str
    callback: str
    line: str
    took: float = 0.0
    period: float = 0.0
    ended: bool = False


class Standstill:
    """How long the background has been at the same callback. Look at it often.

    Attributes:
        at: The node and the name of the callback that runs, None if none does; and how many have
            been run before.
        clock: How long the background could work.
    """

    def __init__(self) -> None:
        from labkit.background.runtime import runtime

        self._runtime = runtime
        self.clock = FairClock(runtime.executor.thread)
        self.at, self._since = self._progress(), 0.0

    @property
    def seconds(self) -> float:
        """For how long it could go on and has not, s."""
        now, at = self.clock.seconds, self._progress()
        if at != self.at:
            self.at, self._since = at, now
        return now - self._since

    def what(self) -> Hanging:
        """Say where it stands."""
        node, callback = self.at[0] or ('', '')
        executor = self._runtime.executor
        return Hanging(
            node,
            callback,
            _line_of(executor.thread),
            self.seconds,
            executor.running_period(),
            executor.runs_for_an_ended_node(),
        )

    def _progress(self) -> tuple[tuple[str, str] | None, int]:
        count = sum(entry.callbacks for entry in self._runtime.nodes())
        return self._runtime.executor.running_callback(), count


def thread_at_work(thread: threading.Thread, seconds: float) -> Hanging:
    """Say where a thread of the learner's is at work."""
    return Hanging('', '', _line_of(thread), seconds)


def _line_of(thread: threading.Thread) -> str:
    return where_it_hangs(sys._current_frames().get(thread.ident or 0))


def find_hanging() -> Hanging | None:
    """Return the callback that runs just now, if it does not return; None if it does."""
    standstill = Standstill()
    running, _ = began = standstill.at
    if running is None:
        return None
    wait_for(lambda: standstill.seconds > HANG_SEC or standstill.at != began, None)
    return standstill.what() if standstill.at == began else None
