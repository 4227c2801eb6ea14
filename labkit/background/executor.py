"""The background thread: one executor that runs callbacks one after the other.

Measurements of rclpy in a kernel that decide the design of this module:

- `rcl_wait` can't be interrupted from Python, so nothing spins in the foreground: a cell that
  waits, waits for the background thread.
- A `SingleThreadedExecutor` tolerates nodes that come and go while it spins; a multi-threaded one
  fails now and then, and costs more per message.
- rclpy makes a wait set, a task and a coroutine for each message. A message takes a third of the
  time when the wait set is kept (see `wait_set`) and the callback is run directly.
- An exception ends `Executor.spin()` silently, so each callback is run separately.
- A spinning thread at the end of the interpreter aborts the process, so it is joined at exit.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Coroutine
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Any, NoReturn

from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor
from rclpy.guard_condition import GuardCondition
from rclpy.node import Node
from rclpy.task import Task
from rclpy.timer import Timer
from rclpy.waitable import Waitable

from labkit import settings
from labkit.background import compat
from labkit.background.console import Console
from labkit.background.foreground import ENDS
from labkit.background.nodes import NodeEntry, callback_name
from labkit.background.pending_tasks import PendingTasks, Work
from labkit.background.wait import POLL_SEC
from labkit.background.wait_conditions import Conditions
from labkit.background.wait_set import KeptWaitSet, Ready
from labkit.errors import LabError

__all__ = ['BackgroundExecutor']

# How long a thread that runs no callback may take to end, s; only a bug would exceed it.
END_SEC = 30.0
# How long to wait for a callback that keeps a removed node from being released, s.
RELEASE_SEC = 1.0
# How old the number of seconds may be for which others ran instead: to read it for each of
# thousands of messages would cost as much as some callbacks do, s.
READ_SEC = 0.02
# Whose a task is that a cell has made: in messages, in place of the name of a node.
_EXECUTOR = 'the executor'


class BackgroundExecutor(Executor):
    """Runs the callbacks of all nodes in one background thread, in a fixed order.

    Nodes have their turns in the order they were added, and messages come before timers: what a
    timer has published is received before its next tick, however slow the machine is. So the
    output of a cell is the same each time.

    Args:
        console: Shows what callbacks print and raise.
        end_program: Ends a node whose callback, of that name, has raised what ends a program.
    """

    def __init__(
        self,
        console: Console,
        end_program: Callable[[NodeEntry, str, BaseException], None],
    ) -> None:
        super().__init__()
        self._end_program = end_program
        self._console = console
        self._entries: dict[Node, NodeEntry] = {}
        self._round_begun = threading.Condition()
        self._rounds = 0
        self._round_awaited = 0
        self._running: tuple[NodeEntry, Any] | None = None
        self._running_since = 0.0
        self._waits = self._waits_read = 0.0
        self._conditions = Conditions(console)
        self._closing = False
        self._settled = threading.Event()  # not set while somebody waits for it
        self._settled.set()
        self._settle_lock = threading.Lock()
        self._wait_set = KeptWaitSet(self)
        self._pending_tasks = PendingTasks(self._wait_set.invalidate)
        self._ready: deque[Ready | Work] = deque()
        self.thread = threading.Thread(target=self._spin, name='labkit', daemon=True)

    def start(self) -> None:
        """Start the background thread."""
        self.thread.start()

    @property
    def is_open(self) -> bool:
        """Return whether the background thread is running."""
        return self.thread.is_alive() and not self._closing

    @property
    def awaiting(self) -> int:
        """Return the number of pending coroutines and tasks."""
        return len(self._pending_tasks)

    def close(self, timeout_sec: float) -> bool:
        """End the background thread, wait for a running callback, and return whether it ended.

        A thread that runs no callback ends by itself, and is waited for longer: otherwise the end
        of the interpreter would abort the process.

        Args:
            timeout_sec: Seconds to wait for a callback.
        """
        self._closing = True
        self.wake()
        left = timeout_sec
        while self.thread.is_alive() and not self.in_callback():
            if left <= (0 if self._is_busy else -END_SEC):
                break
            self.thread.join(POLL_SEC)
            left -= POLL_SEC  # no clock: the whole machine may be suspended meanwhile
        self._pending_tasks.cancel()
        self._wait_set.invalidate()
        return not self.thread.is_alive()

    # -- nodes ----------------------------------------------------------------------------------

    def add_entry(self, entry: NodeEntry) -> None:
        """Add a node."""
        self._entries[entry.node] = entry
        self.add_node(entry.node)
        self.wake()

    def wake(self) -> None:
        """Gather the entities again. rclpy calls it when one was made or destroyed."""
        self._wait_set.invalidate()
        self._notify()

    def _notify(self) -> None:
        """End a wait to resume pending tasks. The entities are still the same."""
        self._pending_tasks.notify()
        super().wake()

    def remove_node(self, node: Node) -> None:
        """Remove a node, and release its timers and subscriptions.

        Entities held by a wait are destroyed only afterwards. If a node of the same name were made
        before that, the graph would take its endpoints for those of the old one, and leave them
        without a node.
        """
        known = self._entries.pop(node, None)
        if known is not None and node.executor is self:
            compat.forget_executor(node)
        seen = self._rounds
        super().remove_node(node)
        self.wake()
        # A callback and a condition keep the thread from its next round.
        waits_in_vain = self.in_callback() or self._conditions.caller_is_looking
        if self.is_open and not waits_in_vain:
            self._await_round_after(seen)

    def _await_round_after(self, seen: int) -> None:
        """Wait until the background has released its wait set, unless a callback is running."""
        left = END_SEC
        with self._round_begun:
            self._round_awaited += 1
            try:
                while not self._round_begun.wait_for(lambda: self._rounds > seen, RELEASE_SEC):
                    left -= RELEASE_SEC  # no clock: the whole machine may be suspended
                    if self._is_busy or not self.is_open or left <= 0:
                        return
            finally:
                self._round_awaited -= 1

    def entry_of(self, node: Node) -> NodeEntry | None:
        """Return the entry of a node, None if it is not on this executor."""
        return self._entries.get(node)

    def get_nodes(self) -> list[Node]:
        """Return the nodes on this executor, in the order they were added."""
        return list(self._entries)

    def create_task(
        self, callback: Callable[..., Any] | Coroutine[Any, Any, Any], *args: Any, **kwargs: Any
    ) -> Task:
        """Run a callback that belongs to no entity, such as one added to a future.

        It belongs to the node whose callback calls this; outside of callbacks, to the cell.
        """
        running = self._running if self.in_callback() else None
        if running is not None:
            owner = running[0]
        else:
            first = next(iter(self._entries.values()))
            cell = self._console.current_cell()
            # Labkit's own node runs it, which is nobody's business.
            owner = replace(first, name=_EXECUTOR, cell=cell, counts={}, took={})
        task = Task(callback, args, kwargs, executor=self)  # type: ignore[no-untyped-call]
        self._pending_tasks.add_function(task, owner)
        self._notify()
        return task

    def spin(self, *_: Any, **__: Any) -> NoReturn:
        """Raise a LabError: the background spins already."""
        raise LabError(
            'This executor can not be asked to spin: it spins in the background already.',
            todo='Wait for what you expect: lab.wait_until(lambda: future.done()), or '
            'lab.wait_for_message(...).',
        )

    spin_once = spin_until_future_complete = spin_once_until_future_complete = spin

    # -- waiting --------------------------------------------------------------------------------

    def wait(self, condition: Callable[[], object], timeout_sec: float | None) -> bool:
        """Wait until `condition()` is true, see `Conditions.wait`."""
        return self._conditions.wait(condition, timeout_sec, lambda: self._closing)

    def settle(self, timeout_sec: float) -> bool:
        """Wait until no callback is left to run, and return whether that was in time.

        Within one process a message is in the queue of its subscriptions when `publish` returns.
        So all callbacks that a message has triggered, directly or through others, have run then,
        except for what other threads do.

        Args:
            timeout_sec: Seconds to wait: a callback may not return, or a timer without a period
                be ready for ever.
        """
        with self._settle_lock:
            settled = self._settled = threading.Event()
            try:
                self._notify()
                return settled.wait(timeout_sec)
            finally:
                settled.set()

    def between_callbacks(self) -> AbstractContextManager[bool]:
        """Return a lock that delays callbacks in a `with` block, which must not wait itself."""
        return self._conditions.lock

    def in_callback(self) -> bool:
        """Return whether a callback calls this."""
        return threading.current_thread() is self.thread

    def refuse_in_callback(self, what: str, todo: str = '') -> None:
        """Raise a LabError if a callback or a condition calls this: it would wait for itself.

        Args:
            what: The refused action, such as `'Waiting'`.
            todo: The alternative in a callback.
        """
        if self._conditions.caller_is_looking:
            raise LabError(
                f'{what} inside the condition of a wait can not work: a condition is looked at '
                'between callbacks, and no message comes until it has answered.',
                todo='Let the condition only look: lab.wait_until(lambda: node.count >= 3). To '
                'wait for a message, call lab.wait_for_message(...) on its own.',
            )
        if self.in_callback():
            raise LabError(
                f'{what} inside a callback would wait for ever: the answer can come only when '
                'this callback has returned.',
                todo=todo
                or 'Return from the callback. For a service, use call_async() and '
                'add_done_callback().',
            )

    @property
    def _is_busy(self) -> bool:
        """Whether a callback is running, or a condition being evaluated."""
        return self._running is not None or self._conditions.is_looking

    def caller(self) -> tuple[NodeEntry, str] | None:
        """Return the node whose callback calls this, and the callback's name."""
        running = self._running
        if running is None or not self.in_callback():
            return None
        return running[0], callback_name(running[1])

    def running_callback(self) -> tuple[str, str] | None:
        """Return the node and the name of the running callback, or None."""
        running = self._running
        return (running[0].name, callback_name(running[1])) if running is not None else None

    def running_period(self) -> float:
        """Return the period of the timer whose callback is running, s; 0 if none is."""
        running = self._running
        return _period(running[1]) if running is not None else 0.0

    def runs_for_an_ended_node(self) -> bool:
        """Return whether the running callback is of a node that was ended or replaced since."""
        running = self._running
        return running is not None and running[0].node not in self._entries

    def running_for(self) -> tuple[NodeEntry, str, float] | None:
        """Return the node and the name of the running callback, and its seconds, or None."""
        running, since = self._running, self._running_since
        if running is None:
            return None
        return running[0], callback_name(running[1]), time.monotonic() - since

    # -- the background thread ------------------------------------------------------------------

    def _spin(self) -> None:
        # A callback may have shut down this executor or, bypassing labkit, ROS.
        while not (self._closing or compat.is_shut_down(self)):
            try:
                self._step()
            except InvalidHandle:
                pass  # destroyed between waiting and taking
            except BaseException as error:  # a bug in labkit must not silence every node
                if self.context.ok():
                    self._console.show_error('labkit itself', 'the background', error)
            if not self.context.ok():
                return

    def _step(self) -> None:
        """Run one callback, or wait until there is one to run."""
        self._rounds += 1
        if self._round_awaited:
            with self._round_begun:
                self._round_begun.notify_all()
        if self._ready:
            self._run(self._ready.popleft())
            return
        # Before the next wait: the last callback may have completed what they await.
        if due := self._pending_tasks.due():
            self._ready.extend(due)
            return
        settled = self._settled
        ready = self._wait_set.wait(
            self._entries,
            may_run=self.can_execute if self._pending_tasks else None,
            block=settled.is_set(),
        )
        self._ready.extend(ready)
        if not ready:
            settled.set()

    def _run(self, work: Ready | Work) -> None:
        """Run a callback or resume a task, handle its error, and evaluate the conditions."""
        entry = self._entry_to_run(work)
        if entry is None:
            return
        what = work.what if isinstance(work, Work) else work.entity
        self._console.speak_for(entry.cell)
        with self._conditions.lock:
            if time.monotonic() > self._waits_read + READ_SEC:
                self._read_waits()
            self._running, self._running_since = (entry, what), time.monotonic()
            if isinstance(work, Work):
                error = self._pending_tasks.resume(work)
            else:
                error = self._begin(work, entry)
            self._running = None
            took = time.monotonic() - self._running_since
            late = _late_after(what) if took >= settings.SHORT_SEC else settings.LATE_SEC
            if took >= late:  # a busy machine may have kept it from running
                waited = self._read_waits()
                took = max(self._waits_read - self._running_since - waited, 0.0)
            if took >= late or entry.took:
                key = what if isinstance(what, Timer) else callback_name(what)
                entry.took[key] = (*entry.took.get(key, ())[-2:], took)
            # The error of a node or action that was removed meanwhile is only that it was.
            if error is not None and not self._was_removed(entry, what, error):
                self._hand_over(entry, callback_name(what), error)
            spun = self._entries.get(entry.node)
            if spun is not None and spun.budget is not None and spun.budget <= 0:
                self.remove_node(entry.node)
            self._conditions.look()

    def _read_waits(self) -> float:
        """Return for how long this thread was kept from running since the last reading, s."""
        before, self._waits = self._waits, _waits_for_a_processor()
        self._waits_read = time.monotonic()
        return self._waits - before

    def _was_removed(self, entry: NodeEntry, what: object, error: BaseException) -> bool:
        """Return whether an error is only that its node or action has ended meanwhile."""
        if entry.node in self._entries:
            return _was_destroyed(entry.node, what, error)
        # After its own `rclpy.shutdown()`, a callback may still end its program, or fail.
        return isinstance(error, InvalidHandle)

    def _hand_over(self, entry: NodeEntry, callback: str, error: BaseException) -> None:
        """Pass on what a callback has raised, to a foreground spin if its node has one."""
        # A coroutine may have begun in an earlier spin, and with another entry.
        spun = self._entries.get(entry.node)
        ends = isinstance(error, ENDS)
        if any(spin.take(error, callback) for spin in reversed((spun or entry).spins[:])):
            if spun is not None and (ends or not (spun.lasts or len(spun.spins) > 1)):
                self.remove_node(entry.node)
        elif spun is None:
            return  # it has ended, and its spin, too
        elif ends:
            self._end_program(entry, callback, error)
        else:
            self._console.show_error(entry.name, callback, error)

    def _entry_to_run(self, work: Ready | Work) -> NodeEntry | None:
        """Return the node of a callback, None if the callback is not to run now."""
        if isinstance(work, Work):
            if self._pending_tasks.is_over(work):
                return None
            # After `rclpy.spin_once()`, it is resumed when its node is spun again.
            return work.entry if work.entry.node in self._entries else None
        entry = self._entries.get(work.node)
        if entry is not None and self._pending_tasks and not self.can_execute(work.entity):
            # Its group is busy. It stays ready, except a guard condition, which the wait resets.
            if isinstance(work.entity, GuardCondition):
                work.entity.trigger()  # type: ignore[no-untyped-call]
            return None
        return entry

    def _begin(self, work: Ready, entry: NodeEntry) -> BaseException | None:
        """Run the callback of an entity, and return its exception."""
        try:
            execute = work.take(work.entity)
        except BaseException as error:
            return error
        if execute is None:
            self._wait_set.invalidate()  # it was destroyed, perhaps without its node
            return None
        self._pending_tasks.notify()
        entry.count(work.entity)
        coroutine = execute()
        try:
            coroutine.send(None)
        except StopIteration:
            return None
        except BaseException as error:
            return error
        task = Task(coroutine)  # type: ignore[no-untyped-call]
        return self._pending_tasks.add_callback(task, entry, work.entity)


def _late_after(what: Any) -> float:
    """Return after how long a callback is late: a timer's at the next time it is due, s."""
    return min(_period(what) or settings.LATE_SEC, settings.LATE_SEC)


def _period(what: Any) -> float:
    """Return the period of a timer, s; 0 if it was destroyed, or it is none."""
    try:
        return float(what.timer_period_ns * 1e-9) if isinstance(what, Timer) else 0.0
    except InvalidHandle:
        return 0.0


def _waits_for_a_processor() -> float:
    """Return for how long this thread could have run, and others did, s; 0 if nobody counts it.

    Source: the kernel's Documentation/scheduler/sched-stats.rst, /proc/<pid>/schedstat.
    """
    try:
        with open('/proc/thread-self/schedstat', encoding='ascii') as file:
            return int(file.read().split()[1]) * 1e-9
    except (OSError, ValueError, IndexError):
        return 0.0


def _was_destroyed(node: Node, what: object, error: BaseException) -> bool:
    """Return whether an error is only that an action was destroyed before it was taken."""
    if not isinstance(what, Waitable):
        return False
    removed = isinstance(error, compat.RCLError) and what not in node.waitables
    return removed or isinstance(error, InvalidHandle)
