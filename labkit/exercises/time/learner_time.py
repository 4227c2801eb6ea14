"""The time of the learner's code: the computer's, and while a check lets time pass, virtual.

Code that asks for the time or waits for it is answered here: by the functions of `time`, waits of
`threading` and `queue` that have an end, `asyncio.sleep`, and the clocks of ROS with their timers.
All of them tell one time. It stands still while a check looks on, moves when the check moves it,
and goes on from there afterwards. So it never goes back: it is ahead of the computer's by what
checks have let pass.

A thread that sleeps is a timer like any other, so a check knows when it is due. One that waits for
a queue, an event or a rate is known to rest until it is woken. A loop that asks
for the time again and again waits for it, too, and gets it in small steps. A timer of ROS that was
made with the steady or the system's clock has a ROS clock instead, for only those can be set.

It can be wrong about code that is told the time by something else: `datetime`, `call_later` of
asyncio, a wait in C such as `select` or `rclpy.spin_once(timeout_sec=...)`, a module that has
taken `sleep` from `time` before labkit came. That lives in the computer's time, and a check sees
of it what comes in the second that the check takes; of code in the notebook that does so, the
verdict says it (`other_time.py`). Other processes live in that time, too: by a
clock of this process, their stamps are older than they are.
"""

from __future__ import annotations

import asyncio
import functools
import math
import os
import queue
import sys
import sysconfig
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from types import FrameType
from typing import TYPE_CHECKING, Any, cast
from weakref import WeakKeyDictionary, WeakSet

if TYPE_CHECKING:
    from rclpy.clock import Clock, ROSClock
    from rclpy.time import Time
    from rclpy.timer import Timer

__all__ = ['clock_of', 'install', 'is_asleep', 'is_waking', 'learner_time', 'uninstall']

NANOSECONDS = 1_000_000_000
# So many looks at the clock in one moment are a loop that waits for another moment.
POLLS = 100
# It gets the time in steps of this, ns.
STEP = 1_000_000

_REAL = {
    name: getattr(time, name)
    for name in ('time', 'monotonic', 'perf_counter', 'time_ns', 'perf_counter_ns', 'monotonic_ns')
}
_sleep, _asleep, _wait = time.sleep, asyncio.sleep, threading.Condition.wait
_OWN = os.path.join(os.path.abspath(os.path.join(__file__, *['..'] * 3)), '')
_LIBRARY = tuple({sysconfig.get_path(name) for name in ('stdlib', 'platstdlib')})
# Their functions ask for the time on behalf of who calls them.
_BETWEEN = (
    threading.__file__,
    queue.__file__,
    os.path.join('rclpy', 'clock.py'),
    os.path.join('rclpy', 'timer.py'),
)


class _Sleeper:
    """What waits for a moment, or for `wake()`.

    Attributes:
        due: The moment, ns; None if it waits to be woken only.
        thread: Id of the thread that waits; 0 if it is a task of asyncio.
        woken: Whether it was woken before.
        waking: Whether it is to go on, and has not got its turn yet.
    """

    def __init__(self, due: int | None, thread: int) -> None:
        self.due = due
        self.thread = thread
        self.woken = self.waking = False

    def release(self) -> None:
        """Wake it: `Condition.notify` calls this."""
        with learner_time.changed:
            self.woken = self.waking = True
            learner_time.changed.notify_all()

    def begin(self) -> None:
        """Take notice of another way of time: for a thread, its wait does so."""

    def wake(self) -> None:
        """Let it go on, because it is due."""
        self.waking = True


class LearnerTime:
    """The one time of the learner's code.

    Attributes:
        ahead: How much it is ahead of the computer's, ns.
        changed: Held for whatever is done with it, and notified when it has changed.
        passed: How much has passed in the check, ns; None while it goes on by itself.
        sleepers: What waits for a moment.
        clocks: The ROS clocks that the check sets.
    """

    def __init__(self) -> None:
        self.ahead = 0
        self.changed = threading.Condition(threading.RLock())
        self.passed: int | None = None
        self.sleepers: list[_Sleeper] = []
        self.clocks: WeakSet[ROSClock] = WeakSet()
        self._began: dict[str, Any] = {}
        self._polls: dict[int, tuple[int, int]] = {}

    def now(self, name: str = 'monotonic_ns') -> int:
        """Return what the function of that name in `time` says to the learner's code."""
        with self.changed:
            seen = _REAL[name]() if self.passed is None else self._began[name]
            shift = self.ahead + (self.passed or 0)
            return cast(int, seen + (shift if name.endswith('_ns') else shift / NANOSECONDS))

    def at(self, real: int) -> float:
        """Return when in this time something was that has just been, as `monotonic` says it, s.

        Args:
            real: When it was, ns since 1970.
        """
        with self.changed:
            # While a check lets time pass, none has passed since.
            since = 0 if self.passed is not None else _REAL['time_ns']() - real
            return float(self.now('monotonic')) - since / NANOSECONDS

    def begin(self) -> int:
        """Let it stand still; return what the computer's clock says then, ns since 1970."""
        with self.changed:
            self._began = {name: real() for name, real in _REAL.items()}
            self.passed = 0
            self.changed.notify_all()
            return int(self._began['time_ns'])

    def move(self, passed: int) -> None:
        """Let so much have passed since it has begun to stand still, ns; wake who is due."""
        with self.changed:
            self.passed = passed
            now, due = self.now(), [each for each in self.sleepers if not each.waking]
            due = [each for each in due if each.due is not None and each.due <= now]
            for sleeper in due:
                sleeper.wake()
            if due:
                self.changed.notify_all()

    def end(self) -> None:
        """Let it go on by itself, from where it is. It is never behind the computer's."""
        with self.changed:
            if self.passed is None:
                return
            real = _REAL['monotonic_ns']() - self._began['monotonic_ns']
            self.ahead = max(self.ahead + self.passed - real, 0)
            self.passed = None
            self.changed.notify_all()
            for sleeper in self.sleepers:
                sleeper.begin()

    def next(self) -> Iterator[int]:
        """Give the moments at which something is due, as what will have passed then, ns."""
        with self.changed:
            gone = int(self.now()) - (self.passed or 0)
            for each in self.sleepers:
                if each.due is not None and not each.waking:
                    yield each.due - gone

    def due_of(self, thread: threading.Thread) -> int | None:
        """Return until when a thread waits, likewise; None if it does not wait for a moment."""
        with self.changed:
            gone = int(self.now()) - (self.passed or 0)
            for each in self.sleepers:
                if each.thread == thread.ident and each.due is not None and not each.waking:
                    return each.due - gone
        return None

    def sleep_until(self, due: int) -> None:
        """Let this thread wait for a moment."""
        self.sleep(_Sleeper(due, threading.get_ident()))

    def sleep(self, sleeper: _Sleeper) -> bool:
        """Let this thread wait; tell whether it was woken before the moment that it waits for."""
        with self.changed:
            self.sleepers.append(sleeper)
            if self.passed is not None:
                self.changed.notify_all()  # who waits for this thread to rest
            try:
                while not sleeper.woken:
                    left = None
                    if sleeper.due is not None:
                        left = max(sleeper.due - self.now(), 0)
                    if left == 0:
                        break
                    if left is not None and self.passed is None:
                        _wait(self.changed, left / NANOSECONDS)
                    else:
                        _wait(self.changed)
            finally:
                self.sleepers.remove(sleeper)
            return sleeper.woken

    def wait_until_asleep(self, threads: Sequence[threading.Thread], timeout_sec: float) -> None:
        """Wait until each of these threads waits for a moment, or the time is over."""
        end = _REAL['monotonic']() + timeout_sec
        with self.changed:
            while not all(map(is_asleep, threads)):
                left = end - _REAL['monotonic']()
                if left <= 0:
                    return
                _wait(self.changed, left)

    def is_told(self, clock: Any) -> bool:
        """Tell whether a ROS clock has its time from somebody else, such as a simulator."""
        return clock.ros_time_is_active and clock not in self.clocks

    def poll(self) -> None:
        """Note that a thread looks at the clock. One that does nothing else has to wait."""
        ident, passed = threading.get_ident(), self.passed
        if passed is None or _is_main():
            return
        before, left = self._polls.get(ident, (passed, POLLS))
        left = left - 1 if before == passed else POLLS
        if left <= 0:
            self.sleep_until(int(self.now()) + STEP)
            # It is known now. It may look once, and do something.
            passed, left = self.passed or 0, 1
        self._polls[ident] = passed, left


learner_time = LearnerTime()


def is_asleep(thread: threading.Thread) -> bool:
    """Tell whether a thread waits for a moment, or for another thread, and does nothing else."""
    return any(s.thread == thread.ident and not s.waking for s in tuple(learner_time.sleepers))


def is_waking(thread: threading.Thread) -> bool:
    """Tell whether a thread is to go on that has waited so, and has not got its turn yet."""
    if thread is threading.main_thread() and any(s.waking for s in tuple(_tasks)):
        return True
    return any(s.thread == thread.ident and s.waking for s in tuple(learner_time.sleepers))


# -- who asks ------------------------------------------------------------------------------------


@functools.cache
def _is_learners_file(name: str) -> bool:
    if name.startswith(('<frozen', _OWN, *_LIBRARY)):
        return False
    return 'site-packages' not in name


def _is_learners(frame: FrameType | None) -> bool:
    """Tell whether the learner's code asks: cells, and modules that no package has brought."""
    while frame is not None and frame.f_code.co_filename.endswith(_BETWEEN):
        frame = frame.f_back
    if frame is not None:
        return _is_learners_file(frame.f_code.co_filename)
    # A thread of the library's alone: a Timer does what the learner has given it.
    function = getattr(threading.current_thread(), 'function', None)
    code = getattr(getattr(function, '__func__', function), '__code__', None)
    return code is not None and _is_learners_file(code.co_filename)


def _is_main() -> bool:
    return threading.get_ident() == threading.main_thread().ident


# -- what is asked -------------------------------------------------------------------------------


def _clock(name: str) -> Callable[[], int | float]:
    real = _REAL[name]

    @functools.wraps(real)
    def look() -> int | float:
        if not _is_learners(sys._getframe(1)):
            return real()  # type: ignore[no-any-return]
        learner_time.poll()
        return learner_time.now(name)

    return look


def _in(seconds: float) -> int:
    """Return the moment in so many seconds, ns.

    It is rounded up: what is left of a wait may be less than a nanosecond, which is as much as the
    sum of two floats may be off. A wait that lasts no time would be asked for again, for ever.
    """
    return int(learner_time.now()) + math.ceil(seconds * NANOSECONDS)


_LOOKS = {name: _clock(name) for name in _REAL}
# Where the library has taken its `monotonic` from `time`.
_COPIES = ((threading, '_time'), (queue, 'time'))


@functools.wraps(_sleep)
def _learner_sleep(seconds: float, /) -> None:
    if _is_main() or not seconds > 0 or not _is_learners(sys._getframe(1)):
        _sleep(seconds)
    else:
        learner_time.sleep_until(_in(seconds))


@functools.wraps(_wait)
def _learner_wait(self: threading.Condition, timeout: float | None = None) -> bool:
    at_once = timeout is not None and not timeout > 0
    if at_once or _is_main() or not _is_learners(sys._getframe(1)):
        return _wait(self, timeout)
    inner: Any = self
    due = None
    if timeout is not None:
        due = _in(timeout)
    sleeper = _Sleeper(due, threading.get_ident())
    inner._waiters.append(sleeper)
    saved = inner._release_save()
    try:
        return learner_time.sleep(sleeper)
    finally:
        inner._acquire_restore(saved)
        if not sleeper.woken:
            inner._waiters.remove(sleeper)


_tasks: list[_Task] = []


class _Task(_Sleeper):
    """A task of asyncio that sleeps."""

    def __init__(self, due: int) -> None:
        super().__init__(due, 0)
        self._moment = due
        self._loop = asyncio.get_running_loop()
        self.future = self._loop.create_future()

    def begin(self) -> None:
        left = max(self._moment - learner_time.now(), 0) / NANOSECONDS
        self._loop.call_soon_threadsafe(self._loop.call_later, left, self._look)

    def _look(self) -> None:
        if learner_time.passed is None and not self.waking:
            self._go_on()

    def wake(self) -> None:
        self.waking = True
        _tasks.append(self)
        self._loop.call_soon_threadsafe(self._go_on)

    def _go_on(self) -> None:
        if not self.future.done():
            self.future.set_result(None)
        # What it does then is done when the loop has gone round.
        self._loop.call_soon(self._loop.call_soon, self._rest)

    def _rest(self) -> None:
        if self in _tasks:
            _tasks.remove(self)


async def _task_sleep(delay: float, result: Any) -> Any:
    with learner_time.changed:
        task = _Task(_in(delay))
        learner_time.sleepers.append(task)
        if learner_time.passed is None:
            task.begin()
    try:
        await task.future
    finally:
        with learner_time.changed:
            learner_time.sleepers.remove(task)
    return result


@functools.wraps(_asleep)
def _learner_asleep(delay: float, result: Any = None) -> Any:
    if not delay > 0 or not _is_learners(sys._getframe(1)):
        return _asleep(delay, result)
    return _task_sleep(delay, result)


@functools.cache
def _steady_shift() -> int:
    """Return by how much the steady clock of ROS is ahead of Python's, ns."""
    from rclpy.clock import Clock
    from rclpy.clock_type import ClockType

    steady = Clock(clock_type=ClockType.STEADY_TIME)
    real: Time = _before[Clock, 'now'](steady)
    return real.nanoseconds - int(_REAL['monotonic_ns']())


def _told_by(clock: Clock) -> int:
    """Return what a clock of ROS says to the learner's code, ns."""
    from rclpy.clock_type import ClockType

    if clock.clock_type is ClockType.STEADY_TIME:
        return int(learner_time.now()) + _steady_shift()
    return int(learner_time.now('time_ns'))


def _now(self: Clock) -> Time:
    from rclpy.clock import Clock, ROSClock
    from rclpy.time import Time

    is_ros, learners = isinstance(self, ROSClock), _is_learners(sys._getframe(1))
    if learners:
        learner_time.poll()
    with learner_time.changed:
        # A ROS clock tells everybody the learner's time.
        if learner_time.is_told(self) if is_ros else not learners:
            return cast('Time', _before[Clock, 'now'](self))
        return Time(nanoseconds=_told_by(self), clock_type=self.clock_type)


def _sleep_until_time(self: Clock, until: Time, context: Any = None) -> bool:
    from rclpy.clock import Clock, ROSClock
    from rclpy.duration import Duration

    real: Callable[..., bool] = _before[Clock, 'sleep_until']
    is_ros, learners = isinstance(self, ROSClock), _is_learners(sys._getframe(1))
    told = learner_time.is_told(self) if is_ros else not learners
    if until.clock_type != self.clock_type or told:
        return real(self, until, context)
    if _is_main() or not learners:
        ahead = Duration(nanoseconds=learner_time.ahead)
        return real(self, until - ahead, context)
    with learner_time.changed:
        due = int(learner_time.now()) + until.nanoseconds - _told_by(self)
    learner_time.sleep_until(due)
    return True


# The ROS clocks of timers that were made with another kind of clock.
_stand_ins: WeakKeyDictionary[Timer, ROSClock] = WeakKeyDictionary()


def clock_of(timer: Timer) -> ROSClock:
    """Return the ROS clock that a timer goes by."""
    return _stand_ins.get(timer) or cast('ROSClock', timer.clock)


def _make_timer(
    self: Any, callback: Any, callback_group: Any, timer_period_ns: int, clock: Any, **rest: Any
) -> None:
    from rclpy.clock import ROSClock
    from rclpy.timer import Timer

    own = clock if isinstance(clock, ROSClock) else ROSClock()
    _before[Timer, '__init__'](self, callback, callback_group, timer_period_ns, own, **rest)
    if own is not clock:
        _stand_ins[self] = own
        self._clock = clock


def _replaced() -> list[tuple[Any, str, Any]]:
    """Return what is replaced: where, by which name, by what."""
    table: list[tuple[Any, str, Any]] = [
        (time, 'sleep', _learner_sleep),
        (asyncio, 'sleep', _learner_asleep),
        (threading.Condition, 'wait', _learner_wait),
        *((time, name, look) for name, look in _LOOKS.items()),
        *((module, name, _LOOKS['monotonic']) for module, name in _COPIES),
    ]
    if clock := sys.modules.get('rclpy.clock'):
        table += [(clock.Clock, 'now', _now), (clock.Clock, 'sleep_until', _sleep_until_time)]
    if timer := sys.modules.get('rclpy.timer'):
        table += [(timer.Timer, '__init__', _make_timer)]
    return table


_before: dict[tuple[Any, str], Any] = {}


def install() -> None:
    """Let the learner's code have its time from here. What it took from `time` before, it keeps.

    Without ROS, all but its clocks; it may be called again.
    """
    for owner, name, function in _replaced():
        if (owner, name) not in _before:
            _before[owner, name] = owner.__dict__.get(name)
            setattr(owner, name, function)


def uninstall() -> None:
    """Give everything back as it was. Time goes back by what checks have let pass."""
    while _before:
        (owner, name), before = _before.popitem()
        if before is None:
            delattr(owner, name)
        else:
            setattr(owner, name, before)
    learner_time.ahead = 0
