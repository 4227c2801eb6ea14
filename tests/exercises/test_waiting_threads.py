"""Whether a thread waits for another one is seen by its innermost frame."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from labkit.exercises.virtual_time import _waits


@contextmanager
def thread_that(waits: Any, ends: Any) -> Iterator[Any]:
    thread = threading.Thread(target=waits)
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
