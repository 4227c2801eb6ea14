"""Time that a check lets pass by itself: a minute of a node's life in a second, and exactly.

Timers, rates and clocks of a node follow the ROS clock of that node, and that clock can be set. In
this process the check sets it, from the moment at which a timer is due to the next such moment,
and waits each time until everything that came of it is done. So nothing depends on how busy the
machine is, and nothing is rounded. What does not follow ROS time, such as a thread that calls
`time.sleep()`, goes on in real time meanwhile.

A callback that sleeps takes virtual time. One that computes, or waits for something else, takes
none: how long that is depends on the machine. But it can't take more than there is. So code that
needs more time than passes is found, and time stops early where callbacks need long.

The clocks are switched directly and not by the parameter `use_sim_time`: nobody in the graph, and
no callback of the node's, takes notice of it.
"""

from __future__ import annotations

import contextlib
import math
import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from labkit import stop_button
from labkit.exercises.time.fair_clock import FairClock
from labkit.exercises.time.hanging import Hanging, Standstill, thread_at_work
from labkit.exercises.time.learner_time import clock_of, install, is_asleep, learner_time
from labkit.exercises.time.threads import OtherThreads

if TYPE_CHECKING:
    from rclpy.clock import ROSClock
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.timer import Timer

    from labkit.exercises.time.remote_time import RemoteTime

__all__ = ['VirtualTime']

NANOSECONDS = 1_000_000_000
# How often it is looked at what callbacks do, s of real time.
LOOK_SEC = 0.002
# How long one may run, and how long none may although some are ready, s of what they could have
# had: see `fair_clock`.
HANG_SEC, STILL_SEC = 1.0, 3.0
# An executor of the learner's own that has not gone round for so long is not waited for again, s.
ROUND_SEC = 2.0
# So many callbacks in one moment are a flood: a timer without a period, nodes that answer each
# other for ever.
FLOOD = 2000
# So few are one if they are slow, and have taken so long, s of real time.
SLOW_FLOOD, SLOW_FLOOD_SEC = 40, 2.0


class VirtualTime:
    """The ROS time of some nodes of this process, for a `with` block. It stands still at first.

    Args:
        moving: Nodes for which time passes when `advance` is called.
        standing: Nodes for which it does not.
        remote: Nodes of other processes, for which it passes too.
        step: How often they are told the time, s: their timers are not known here.
        work_sec: How long the learner's code may work in all, s of real time. Then time stops.

    Attributes:
        flooded: Whether more callbacks came in one moment than could be run.
        hanging: The callback that has not returned, if one has not.
        overloaded: The callback or thread that has worked for longer than time has passed.
        overrun: The callback of a timer that has slept for longer than its period.
    """

    def __init__(
        self,
        moving: Sequence[Node],
        standing: Sequence[Node] = (),
        *,
        remote: RemoteTime | None = None,
        step: float = 0.05,
        work_sec: float = math.inf,
    ) -> None:
        from labkit.background.runtime import runtime

        self._runtime = runtime
        self._moving = list(moving)
        self._all = [*moving, *(node for node in standing if node not in moving)]
        self._remote = remote
        self._step = round(step * NANOSECONDS)
        self._origin = self._start = self._now = self._told = 0
        self._clocks: dict[ROSClock, Node] = {}
        # Executors of the learner's own, and the thread that spins each.
        self._spinners: dict[Executor, threading.Thread] = {}
        self._stuck: set[Executor] = set()
        self._work_sec = work_sec
        self._threads = OtherThreads()
        self._asleep_at: object = None
        self._asleep_since = 0
        self.flooded = False
        self.hanging: Hanging | None = None
        self.overloaded: Hanging | None = None
        self.overrun: Hanging | None = None
        self._worked = 0.0

    @property
    def stopped(self) -> bool:
        """Whether there is no use in going on."""
        found = self.flooded or self.hanging or self.overloaded
        return bool(found) or self.worked > self._work_sec

    @property
    def worked(self) -> float:
        """How long the learner's code has worked, s of real time."""
        return self._worked + self._threads.busiest[1]

    @property
    def seconds(self) -> float:
        """How much time has passed, s."""
        return (self._now - self._start) / NANOSECONDS

    def __enter__(self) -> VirtualTime:
        with contextlib.ExitStack() as undo:
            undo.push(self)
            self._begin()
            undo.pop_all()
        return self

    def _begin(self) -> None:
        install()
        with learner_time.changed:
            # Timers are due at this time by the computer's clock, so none is late or early.
            self._origin = self._now = learner_time.begin()
            self._take_clocks(self._all)
        # A timer that was called last in an earlier stretch of virtual time, ahead of this one,
        # begins its period anew when the clock is set for the first time (rcl/src/rcl/timer.c,
        # _rcl_timer_time_jump). So that happens before anything is seen.
        self._now += 1
        self._set_all(self._all)
        self._start = self._now
        self._told = self._now
        if self._remote is not None:
            self._remote.set(self._now + learner_time.ahead)
        self._threads.__enter__()
        self.settle()

    def __exit__(self, *_: object) -> None:
        from labkit.background import compat
        from labkit.background.nodes import node_exists

        self._threads.__exit__()
        with learner_time.changed:
            learner_time.end()
            for clock, node in self._clocks.items():
                if node_exists(node):
                    compat.set_ros_time_is_active(clock, False)
                learner_time.clocks.discard(clock)
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
        while not self.stopped:
            stop_button.look()
            ticked = self._next(end)
            due = (due for due in self._sleepers_due() if due <= end)
            self._now = min([end, self._next_tick(), *ticked.values(), *due])
            begin()
            self._set_all(self._moving)
            self._settle_all()
            if self._remote is not None and self._now >= self._next_tick():
                # Not at each event: to ask another process takes several times as long.
                self._told = self._now
                self._remote.set(self._now + learner_time.ahead)
                self._settle()
            if not look():
                return False
            if self._now >= end:
                return True
        return False

    def settle(self) -> None:
        """Wait until everything that has become ready is done."""
        self._settle_all()
        if self._remote is not None:
            self._remote.settle()
            self._settle()

    def _next_tick(self) -> int:
        if self._remote is None or not self._remote.names:
            return self._now + NANOSECONDS * 3600
        return self._told + self._step

    def _next(self, end: int) -> dict[Timer, int]:
        """Return the timers that are due before `end`, and when."""
        found = {}
        for timer in self._timers():
            left = timer.time_until_next_call()  # type: ignore[no-untyped-call]
            # One that is late already is not served at all: its node is not spun, or it hangs.
            if left is not None and 0 < left <= end - self._now:
                found[timer] = self._now + left
        return found

    def _sleepers_due(self) -> Iterable[int]:
        """Return when code of the learner's is due that waits for a moment."""
        return (max(self._origin + passed, self._now + 1) for passed in learner_time.next())

    def _timers(self) -> Iterable[Timer]:
        from labkit.background.nodes import node_exists

        for node in self._moving:
            if node_exists(node):
                yield from (timer for timer in node.timers if clock_of(timer) in self._clocks)

    def _take_clocks(self, nodes: Iterable[Node]) -> None:
        """Take the clocks of nodes and of their timers, but those that have another time."""
        from labkit.background import compat
        from labkit.background.nodes import node_exists

        for node in nodes:
            if not node_exists(node):
                continue
            for clock in {cast('ROSClock', node.get_clock()), *map(clock_of, node.timers)}:
                # Somebody else may tell it the time, or nobody does: then it stands still.
                if clock in self._clocks or clock.ros_time_is_active:
                    continue
                self._clocks[clock] = node
                learner_time.clocks.add(clock)
                self._set(clock)
                compat.set_ros_time_is_active(clock, True)

    def _set_all(self, nodes: Sequence[Node]) -> None:
        from labkit.background.nodes import node_exists

        with learner_time.changed:
            self._take_clocks(nodes)
            for clock, node in self._clocks.items():
                if node in nodes and node_exists(node):
                    self._set(clock)
            learner_time.move(self._now - self._origin)

    def _set(self, clock: ROSClock) -> None:
        from rclpy.time import Time

        clock.set_ros_time_override(Time(nanoseconds=self._now, clock_type=clock.clock_type))

    def _settle_all(self) -> None:
        self._settle()
        # A callback may have handed its work to a thread, and the thread may set off callbacks. An
        # executor of the learner's own spins in such a thread.
        for _ in range(FLOOD):
            stop_button.look()
            ran = self._threads.settle()
            thread, worked = self._threads.busiest
            if worked > self.seconds + HANG_SEC:
                self.overloaded = self.overloaded or thread_at_work(thread, worked)
            if not ran or self.stopped:
                return
            self._settle_background()
        self.flooded = True

    def _settle(self) -> None:
        for executor in {node.executor for node in self._all}:
            if executor is self._runtime.executor:
                self._settle_background()
            elif executor is not None and executor not in self._stuck:
                self._settle_other(executor)

    def _settle_other(self, executor: Executor) -> None:
        """Wait until an executor of the learner's own has gone round twice, or sleeps."""
        for _ in range(2):
            done = threading.Event()

            def go_round(done: threading.Event = done) -> None:
                self._spinners[executor] = threading.current_thread()
                done.set()

            thread = self._spinners.get(executor)
            if thread is not None and is_asleep(thread):
                return
            executor.create_task(go_round)
            clock, worked = FairClock(thread), self._worked
            while not done.wait(LOOK_SEC):
                stop_button.look()
                self._worked = worked + clock.seconds
                if self._worked > self.seconds + HANG_SEC and thread is not None:
                    self.overloaded = thread_at_work(thread, self._worked)
                if clock.seconds > ROUND_SEC:
                    self._stuck.add(executor)
                if self.stopped or executor in self._stuck or self._sleeps(thread):
                    return

    def _sleeps(self, thread: threading.Thread | None) -> bool:
        """Tell whether a thread sleeps, or any but this one if it is not known."""
        if thread is not None:
            return is_asleep(thread)
        return any(map(is_asleep, threading.enumerate()))

    def _settle_background(self) -> None:
        executor = self._runtime.executor
        if self._callback_sleeps() or executor.settle(LOOK_SEC):
            return
        standstill, worked = Standstill(), self._worked
        _, before = standstill.at
        late_at, late_what = None, None
        while not executor.settle(LOOK_SEC):
            stop_button.look()
            if self._callback_sleeps():
                break
            stands = standstill.seconds
            running, count = standstill.at
            self._worked = worked + standstill.clock.seconds
            late = running is not None and self._worked > self.seconds + HANG_SEC
            # That so many come in one moment says more than that they take long together.
            slow = late or standstill.clock.seconds > SLOW_FLOOD_SEC
            self.flooded = count - before > (SLOW_FLOOD if slow else FLOOD)
            if stands > (HANG_SEC if running is not None else STILL_SEC):
                self.hanging = standstill.what()
            elif late and not self.flooded and late_what is None:
                late_at, late_what = standstill.at, standstill.what()
            # One that returns takes too long. Whether it does, is to be seen first.
            elif late_what is not None and standstill.at != late_at:
                break
            if self.stopped or not executor.is_open:
                return
        self.overloaded = self.overloaded or late_what

    def _callback_sleeps(self) -> bool:
        """Tell whether a callback sleeps: nothing else runs until time has passed.

        One that takes too long of that time hangs.
        """
        due = learner_time.due_of(self._runtime.executor.thread)
        if due is None:
            return False
        standstill = Standstill()
        if standstill.at != self._asleep_at:
            self._asleep_at, self._asleep_since = standstill.at, self._now
        took = (self._origin + due - self._asleep_since) / NANOSECONDS
        asleep = replace(standstill.what(), took=took)
        if took > HANG_SEC:
            self.hanging = asleep
        if 0 < asleep.period < took:
            self.overrun = asleep
        return True
