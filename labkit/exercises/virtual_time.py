"""Time that a check lets pass by itself: a minute of a node's life in a second, and exactly.

Timers, rates and clocks of a node follow the ROS clock of that node, and that clock can be set. In
this process the check sets it, from the moment at which a timer is due to the next such moment,
and waits each time until everything that came of it is done. So nothing depends on how busy the
machine is, and nothing is rounded. What does not follow ROS time, such as a thread that calls
`time.sleep()`, goes on in real time meanwhile.

The clock is switched directly and not by the parameter `use_sim_time`: nobody in the graph, and no
callback of the node's, takes notice of it.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary, WeakSet

from labkit.exercises.fair_clock import FairClock
from labkit.exercises.hanging import Hanging, Standstill
from labkit.exercises.threads import OtherThreads, waits

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.timer import Timer

    from labkit.exercises.remote_time import RemoteTime

__all__ = ['VirtualTime']

NANOSECONDS = 1_000_000_000
# How often it is looked at what callbacks do, s of real time.
LOOK_SEC = 0.02
# How long one may run, and how long none may although some are ready, s of what they could have
# had: see `fair_clock`.
HANG_SEC, STILL_SEC = 1.0, 3.0
# So many callbacks in one moment are a flood: a timer without a period, nodes that answer each
# other for ever.
FLOOD = 2000
# So few are one if they are slow, and have taken so long, s of real time.
SLOW_FLOOD, SLOW_FLOOD_SEC = 200, 2.0
# How long a thread that sleeps in a rate may take for its work, s of real time on a calm machine;
# and how long one that has ended, or waits for something else. So often in a row it has to be seen
# so: a busy machine may give this thread time, and the other one none.
RATE_SEC = 3.0
IDLE_SEC = 0.1
IDLE_LOOKS = 50
# How long an executor of the learner's own may take to go round, s of real time.
ROUND_SEC = 2.0
POLL_SEC = 0.0002


# Where the last stretch of virtual time of a node ended, ns.
_latest: WeakKeyDictionary[Node, int] = WeakKeyDictionary()


# Timers of rates that are not waited for, across checks: the thread works for too long, or none
# sleeps there any more. The latter are waited for again as soon as one is seen to sleep there.
_slow: WeakSet[Timer] = WeakSet()
_left: WeakSet[Timer] = WeakSet()


class VirtualTime:
    """The ROS time of some nodes of this process, for a `with` block. It stands still at first.

    Args:
        moving: Nodes for which time passes when `advance` is called.
        standing: Nodes for which it does not.
        remote: Nodes of other processes, for which it passes too.
        tick: How often they are told the time, s: their timers are not known here.

    Attributes:
        flooded: Whether more callbacks came in one moment than could be run.
        hanging: The callback that has not returned, if one has not.
        tick: As above; it may be changed on the way.
    """

    def __init__(
        self,
        moving: Sequence[Node],
        standing: Sequence[Node] = (),
        *,
        remote: RemoteTime | None = None,
        tick: float = 0.05,
    ) -> None:
        from labkit.background.runtime import runtime

        self._runtime = runtime
        self._moving = list(moving)
        self._all = [*moving, *(node for node in standing if node not in moving)]
        self._remote = remote
        self.tick = tick
        self._start = self._now = self._told = 0
        self._was_active: list[Node] = []
        self._stuck: set[Executor] = set()
        self._threads = OtherThreads()
        self.flooded = False
        self.hanging: Hanging | None = None

    @property
    def seconds(self) -> float:
        """How much time has passed, s."""
        return (self._now - self._start) / NANOSECONDS

    def __enter__(self) -> VirtualTime:
        from labkit.background import compat

        # Timers are due at this time by the computer's clock, so none is late or early. But time
        # does not go back from one stretch of a node to its next: it may have noted when to act
        # again. A node that has had none may have noted the time, too, and is not to be late.
        latest = (_latest[node] for node in self._moving if node in _latest)
        self._start = self._now = max([time.time_ns(), *latest])
        for node in self._all:
            clock: Any = node.get_clock()
            if clock.ros_time_is_active:
                self._was_active.append(node)
            self._set(node)
            compat.set_ros_time_is_active(clock, True)
        # A timer that was called last in an earlier stretch of virtual time, ahead of this one,
        # begins its period anew when the clock is set for the first time (rcl/src/rcl/timer.c,
        # _rcl_timer_time_jump). So that happens before anything is seen.
        self._now = self._start = self._start + 1
        for node in self._all:
            self._set(node)
        self._told = self._now
        if self._remote is not None:
            self._remote.set(self._now)
        self._threads.__enter__()
        self.settle()
        return self

    def __exit__(self, *_: object) -> None:
        from labkit.background import compat
        from labkit.background.nodes import node_exists

        self._threads.__exit__()
        _latest.update(dict.fromkeys(self._moving, self._now))
        for node in self._all:
            if node not in self._was_active and node_exists(node):
                compat.set_ros_time_is_active(node.get_clock(), False)  # type: ignore[arg-type]
        # They wait for timers as if time stood still.
        for executor in {node.executor for node in self._all if node.executor is not None}:
            executor.wake()

    def restart_timers(self) -> None:
        """Let all timers begin anew, so that they don't depend on when the nodes were made."""
        for node in self._moving:
            for timer in node.timers:
                if not timer.is_canceled():  # type: ignore[no-untyped-call]
                    timer.reset()  # type: ignore[no-untyped-call]

    def advance(
        self, seconds: float, look: Callable[[], bool], begin: Callable[[], None] = lambda: None
    ) -> bool:
        """Let time pass, from one event to the next.

        Args:
            seconds: How much, s.
            look: Called after each event; it says whether to go on.
            begin: Called before each event.

        Returns:
            Whether all of the time has passed.
        """
        end = self._now + round(seconds * NANOSECONDS)
        while not (self.flooded or self.hanging):
            ticked = self._next(end)
            self._now = min([end, self._next_tick(), *ticked.values()])
            begin()
            sleepers = _sleepers(timer for timer, due in ticked.items() if due <= self._now)
            for node in self._moving:
                self._set(node)
            self._settle_all(sleepers)
            if self._remote is not None and self._now >= self._next_tick():
                # Not at each event: to ask another process takes several times as long.
                self._told = self._now
                self._remote.set(self._now)
                self._settle()
            if not look():
                return False
            if self._now >= end:
                return True
        return False

    def settle(self) -> None:
        """Wait until everything that has become ready is done."""
        self._settle_all(_sleepers(self._timers()))
        if self._remote is not None:
            self._remote.settle()
            self._settle()

    @property
    def rates(self) -> bool:
        """Tell whether there are threads that sleep in a `Rate`, or have done so."""
        return bool(_sleepers(self._timers()))

    def settle_rates(self) -> None:
        """Wait until threads sleep in their rates that have left them, and may have come back."""
        _left.difference_update(self._timers())
        self.settle()

    def _next_tick(self) -> int:
        if self._remote is None or not self._remote.names:
            return self._now + NANOSECONDS * 3600
        return self._told + round(self.tick * NANOSECONDS)

    def _next(self, end: int) -> dict[Timer, int]:
        """Return the timers that are due before `end`, and when."""
        found = {}
        for timer in self._timers():
            left = timer.time_until_next_call()  # type: ignore[no-untyped-call]
            # One that is late already is not served at all: its node is not spun, or it hangs.
            if left is not None and 0 < left <= end - self._now:
                found[timer] = self._now + left
        return found

    def _timers(self) -> Iterable[Timer]:
        from labkit.background.nodes import node_exists

        for node in self._moving:
            if node_exists(node):
                clock = node.get_clock()
                yield from (timer for timer in node.timers if timer.clock is clock)

    def _set(self, node: Node) -> None:
        from rclpy.time import Time

        from labkit.background.nodes import node_exists

        if node_exists(node):
            clock: Any = node.get_clock()
            clock.set_ros_time_override(Time(nanoseconds=self._now, clock_type=clock.clock_type))

    def _settle_all(self, sleepers: Mapping[Timer, set[int]]) -> None:
        self._settle()
        for timer, threads in sleepers.items():
            _wait_for_rate(timer, threads)
        if sleepers:
            self._settle()
        # A callback may have handed its work to a thread, and the thread may set off callbacks. An
        # executor of the learner's own spins in such a thread.
        for _ in range(FLOOD):
            if not self._threads.settle():
                return
            self._settle_background()
        self.flooded = True

    def _settle(self) -> None:
        for executor in {node.executor for node in self._all}:
            if executor is self._runtime.executor:
                self._settle_background()
            elif executor is None or executor in self._stuck:
                continue
            elif not _settle_other(executor):
                self._stuck.add(executor)

    def _settle_background(self) -> None:
        executor = self._runtime.executor
        if executor.settle(LOOK_SEC):
            return
        clock, standstill = FairClock(executor.thread), Standstill()
        _, before = standstill.at
        while not executor.settle(LOOK_SEC):
            stands = standstill.seconds
            running, count = standstill.at
            slow = clock.seconds > SLOW_FLOOD_SEC
            self.flooded = count - before > (SLOW_FLOOD if slow else FLOOD)
            if stands > (HANG_SEC if running is not None else STILL_SEC):
                self.hanging = standstill.what()
            if self.flooded or self.hanging or not executor.is_open:
                return


def _sleepers(timers: Iterable[Timer]) -> dict[Timer, set[int]]:
    """Return the timers of rates, each with the ids of the threads that sleep in its rate."""
    from labkit.background.compat import rate_is_awaited, rate_sleepers

    rates = {timer: awaited for timer in timers if (awaited := rate_is_awaited(timer)) is not None}
    _left.difference_update(timer for timer, awaited in rates.items() if awaited)
    return {timer: rate_sleepers(timer) for timer in rates}


def _wait_for_rate(timer: Timer, threads: set[int]) -> None:
    """Wait until a thread that was woken by a rate sleeps in it again.

    One that has ended, or works for long, is not waited for again.

    Args:
        timer: The timer of the rate.
        threads: Ids of the threads that slept there.
    """
    from labkit.background.compat import rate_is_awaited
    from labkit.background.patience import answer_sec

    if rate_is_awaited(timer):
        _slow.discard(timer)
    clock, looks = FairClock(), 0
    while not (rate_is_awaited(timer) or timer in _slow or timer in _left):
        passed = clock.seconds
        if passed > IDLE_SEC:
            looks = 0 if _is_at_work(timer, threads) else looks + 1
        if passed > answer_sec(RATE_SEC):
            _slow.add(timer)
        if looks > IDLE_LOOKS:
            _left.add(timer)
        time.sleep(POLL_SEC if passed < IDLE_SEC else 10 * POLL_SEC)


def _is_at_work(timer: Timer, threads: set[int]) -> bool:
    """Tell whether one of the threads has not ended, and does not wait for something else.

    On a busy machine a thread may take long to leave the rate that has woken it.
    """
    from labkit.background.compat import rate_sleepers

    frames = sys._current_frames()
    inside = rate_sleepers(timer)
    return any(ident in inside or not waits(frames[ident]) for ident in threads & frames.keys())


def _settle_other(executor: Executor) -> bool:
    """Wait until an executor of the learner's own has gone round twice; tell whether it has."""
    for _ in range(2):
        task: Any = executor.create_task(lambda: None)
        clock = FairClock()
        while not task.done():
            if clock.seconds > ROUND_SEC:
                return False
            time.sleep(POLL_SEC)
    return True
