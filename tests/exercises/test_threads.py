"""Whether a thread rests, or is at work, is seen however little time it gets."""

from __future__ import annotations

import queue
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from types import FrameType
from typing import Any

from labkit.background.compat import rate_is_awaited
from labkit.exercises.threads import OtherThreads, waits
from labkit.exercises.virtual_time import _sleepers, _wait_for_rate


@contextmanager
def thread_that(works: Any, ends: Any) -> Iterator[Any]:
    thread = threading.Thread(target=works, daemon=True)
    thread.start()
    yield thread
    ends()
    thread.join()


def test_a_thread_that_waits_for_an_eventwaits() -> None:
    event = threading.Event()
    with thread_that(event.wait, event.set) as thread:
        while not waits(sys._current_frames()[thread.ident]):
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
    assert not waits(frame)


def test_one_that_computes_is_at_work() -> None:
    assert not waits(sys._getframe())


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


def test_work_that_goes_from_thread_to_thread_is_waited_for_to_its_end() -> None:
    stages = [queue.SimpleQueue[int]() for _ in range(4)]

    def work(taken: queue.SimpleQueue[int], given: queue.SimpleQueue[int]) -> None:
        while (number := taken.get()) >= 0:
            sum(range(200_000))
            given.put(number + 1)
        given.put(number)

    for taken, given in pairwise(stages):
        threading.Thread(target=work, args=(taken, given), daemon=True).start()
    with OtherThreads() as threads:
        threads.settle()
        for number in range(30):
            stages[0].put(number)
            assert threads.settle()
            # Nobody waits here: it has come, or it has not.
            assert stages[-1].get_nowait() == number + 3
            assert not threads.settle()
    stages[0].put(-1)
    assert stages[-1].get() == -1


def test_a_thread_that_never_rests_is_waited_for_once() -> None:
    done = threading.Event()

    def work() -> None:
        while not done.is_set():
            pass

    with thread_that(work, done.set), OtherThreads() as threads:
        assert threads.settle()
        assert not threads.settle()


def test_one_that_waits_for_this_thread_rests() -> None:
    lock, done = threading.Lock(), threading.Event()

    def work() -> None:
        with lock:
            done.wait()

    lock.acquire()
    with thread_that(work, done.set), OtherThreads() as threads:
        threads.settle()
        assert not threads.settle()
        # It was not given up: it is seen as soon as it runs.
        lock.release()
        assert threads.settle()


def test_threads_of_the_notebook_itself_are_not_waited_for(kernel):
    code = """
import threading
from labkit.exercises.threads import OtherThreads
lab.start()
with OtherThreads() as threads:
    threads.settle()
    print(len(threading.enumerate()) > 5, list(threads._threads()))
"""
    kernel.run('import labkit as lab')
    assert kernel.run(code).text == 'True []\n'
