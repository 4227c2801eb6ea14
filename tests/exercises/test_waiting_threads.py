"""Whether a thread waits for another one is seen by its innermost frame."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from labkit.background.compat import rate_is_awaited
from labkit.exercises.virtual_time import _sleepers, _wait_for_rate, _waits


@contextmanager
def thread_that(waits: Any, ends: Any) -> Iterator[Any]:
    thread = threading.Thread(target=waits, daemon=True)
    thread.start()
    yield thread
    ends()
    thread.join()


def test_a_thread_that_waits_for_an_event_waits() -> None:
    event = threading.Event()
    with thread_that(event.wait, event.set) as thread:
        while not _waits(sys._current_frames()[thread.ident]):
            time.sleep(0.001)


def test_one_that_clears_an_event_is_at_work() -> None:
    event = threading.Event()
    frames: list[FrameType] = []

    class Lock:
        """A lock that notes who takes it."""

        def __enter__(self) -> None:
            frames.append(sys._getframe(1))

        def __exit__(self, *_: object) -> None: ...

    event._cond = Lock()  # type: ignore[attr-defined]
    event.clear()
    (frame,) = frames
    assert frame.f_code is threading.Event.clear.__code__
    assert not _waits(frame)


def test_one_that_computes_is_at_work() -> None:
    assert not _waits(sys._getframe())


def test_a_rate_that_was_left_is_waited_for_again_as_soon_as_a_thread_sleeps_in_it() -> None:
    class Ticks:
        """A timer of a rate."""

        callback = threading.Event().set

    timer: Any = Ticks()
    event = timer.callback.__self__
    done: list[int] = []

    def work() -> None:
        while len(done) < 2:
            event.wait()
            time.sleep(0.3)
            done.append(1)
            event.clear()

    # Nobody sleeps there.
    _wait_for_rate(timer, set())
    with thread_that(work, event.set) as thread:
        while not rate_is_awaited(timer):
            time.sleep(0.001)
        sleepers = _sleepers([timer])
        assert sleepers == {timer: {thread.ident}}
        event.set()
        _wait_for_rate(timer, sleepers[timer])
        assert done == [1]
