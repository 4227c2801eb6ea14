"""Threads of the learner's: whether they rest, whatever time they get on a busy machine.

A callback may hand its work to a thread, by a queue or an event. Such a thread is not part of any
executor, so nobody says when it is done. The operating system knows: a thread that rests is
asleep, and has not run between two looks.
"""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary, WeakSet

from labkit import stop_button
from labkit.exercises.time.fair_clock import FairClock
from labkit.exercises.time.learner_time import is_asleep, is_waking, learner_time

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType

__all__ = ['OtherThreads']

# How long a thread may be at work, s of what it could have had: see `fair_clock`.
REST_SEC = 1.0
# A thread that waits for Python's lock asks for it anew after so long. So with more than that
# between two looks, it is seen.
SWITCH_SEC = 0.0005
LOOK_SEC = 3 * SWITCH_SEC
# Whose threads do nothing of the learner's: those of the notebook, of the tests, and our own.
OTHERS = ('IPython', 'execnet', 'ipykernel', 'jupyter_client', 'labkit', 'tornado', 'zmq')
# What the learner's threads begin with: the library, and what labkit has put in its place and in
# that of rclpy's `Executor.spin`.
BETWEEN = ('threading', learner_time.__module__, 'labkit.background.notebook_rclpy')


class OtherThreads:
    """The learner's threads but the one that asks, for a `with` block."""

    def __init__(self) -> None:
        self._seen: WeakKeyDictionary[threading.Thread, object] = WeakKeyDictionary()
        # They are not waited for: they do nothing of the learner's, or they never rest.
        self._left: WeakSet[threading.Thread] = WeakSet()
        self._usual_sec = sys.getswitchinterval()
        self._worked: WeakKeyDictionary[threading.Thread, float] = WeakKeyDictionary()

    @property
    def busiest(self) -> tuple[threading.Thread, float]:
        """Return the thread that has worked longest while it was waited for, and how long, s."""
        worked = {threading.current_thread(): 0.0, **self._worked}
        return max(worked.items(), key=lambda pair: pair[1])

    def __enter__(self) -> OtherThreads:
        self._usual_sec = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_SEC)
        return self

    def __exit__(self, *_: object) -> None:
        sys.setswitchinterval(self._usual_sec)

    def settle(self) -> bool:
        """Wait until each of them rests: it sleeps, or waits for something.

        Returns:
            Whether one has run since this was asked before.
        """
        clocks: dict[threading.Thread, FairClock] = {}
        before = dict(self._worked)
        ran = False
        # All of them, each time: one may hand its work to another one.
        while busy := [thread for thread in self._threads() if self._is_new(thread)]:
            ran = True
            for thread in busy:
                seconds = clocks.setdefault(thread, FairClock(thread)).seconds
                self._worked[thread] = before.get(thread, 0.0) + seconds
                if seconds > REST_SEC:
                    self._left.add(thread)
            stop_button.look()
            learner_time.wait_until_asleep(busy, LOOK_SEC)
        return ran

    def _threads(self) -> Iterator[threading.Thread]:
        this, frames = threading.current_thread(), None
        for thread in threading.enumerate():
            if thread is this or (thread in self._left and not is_asleep(thread)):
                continue
            self._left.discard(thread)
            if thread not in self._seen:
                frames = frames or sys._current_frames()
                if _is_of_others(thread, frames.get(thread.ident or 0)):
                    self._left.add(thread)
                    continue
            yield thread

    def _is_new(self, thread: threading.Thread) -> bool:
        """Tell whether a thread is about to run, or has run since the look before."""
        if is_waking(thread):
            return True
        before, self._seen[thread] = self._seen.get(thread), _look(thread)
        return self._seen[thread] is None or self._seen[thread] != before


def _look(thread: threading.Thread) -> object:
    """Return what is the same again if a thread has not run since; None if it does not sleep."""
    if thread.native_id is None:
        return None  # it is being started
    try:
        with open(f'/proc/self/task/{thread.native_id}/status', 'rb', buffering=0) as file:
            status = file.read()
    except OSError:
        # Not Linux, or the thread has just ended.
        frame = sys._current_frames().get(thread.ident or 0)
        return (id(frame), frame.f_lasti) if frame is not None else ()
    lines = dict(line.split(b':', 1) for line in status.splitlines())
    if lines[b'State'].split()[0] != b'S':
        return None
    return lines[b'voluntary_ctxt_switches'], lines[b'nonvoluntary_ctxt_switches']


def _is_of_others(thread: threading.Thread, frame: FrameType | None) -> bool:
    """Tell whether a thread does nothing of the learner's, by where its work begins."""
    if thread is threading.main_thread():
        return False
    begins = ''
    while frame is not None:
        module = str(frame.f_globals.get('__name__', ''))
        begins = begins if module in BETWEEN else module
        frame = frame.f_back
    return begins.partition('.')[0] in OTHERS
