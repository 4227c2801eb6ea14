"""The background thread: one executor, callbacks one after the other, and waiting for them.

What was measured of rclpy in a kernel, and decides the shape of this module:

- `rcl_wait` can't be interrupted from Python, so nothing spins in the foreground: a cell that
  waits, waits for the background thread.
- A `SingleThreadedExecutor` bears nodes that come and go while it spins; a multi-threaded one
  fails now and then, and costs more a message.
- An exception ends `Executor.spin()` silently, so each callback is run on its own.
- A spinning thread at the end of the interpreter aborts the process, so it is joined at exit.
"""

from __future__ import annotations

import inspect
import threading
import time
from collections.abc import Callable, Coroutine
from contextlib import AbstractContextManager, suppress
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

from rclpy.exceptions import InvalidHandle
from rclpy.executors import (
    ConditionReachedException,
    ExternalShutdownException,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
)
from rclpy.node import Node
from rclpy.task import Task
from rclpy.timer import Timer
from rclpy.waitable import Waitable

from labkit.background import compat
from labkit.background.console import Console
from labkit.background.nodes import NodeEntry
from labkit.errors import LabError

__all__ = ['BackgroundExecutor', 'callback_name']

# While nothing happens in ROS, a condition that depends on something else is looked at this often.
POLL_SEC = 0.05
# How long a thread may take to end that runs no callback, s: only a fault would make it longer.
END_SEC = 30.0
# How long to wait for a callback that keeps a removed node from being let go.
RELEASE_SEC = 1.0


class BackgroundExecutor(SingleThreadedExecutor):
    """Runs the callbacks of all nodes in one background thread, in a fixed order.

    Nodes come in the order in which they were added, and messages before timers: what a timer has
    published is heard before its next tick, however late the machine is. So the output of a cell
    is the same each time.

    Args:
        console: Where the output of callbacks goes.
    """

    def __init__(self, console: Console) -> None:
        super().__init__()
        self._console = console
        self._entries: dict[Node, NodeEntry] = {}
        self._callback_lock = threading.RLock()
        self._round_begun = threading.Condition()
        self._rounds = 0
        self._round_awaited = 0
        self._running: tuple[NodeEntry, Any] | None = None
        self._owners: WeakKeyDictionary[Task, NodeEntry] = WeakKeyDictionary()
        self._conditions: list[Callable[[], None]] = []
        self._closing = False
        self._settling: threading.Event | None = None
        self._settle_lock = threading.Lock()
        self._gathering = False
        # The thread that is looking at a condition of `wait` just now.
        self._looking: int | None = None
        self._ready: list[tuple[Any, Any, Any]] = []
        # What was ready in the round before, and how many rounds in a row held nothing else.
        self._before: set[Task] = set()
        self._idle_rounds = 0
        self._thread = threading.Thread(target=self._spin, name='labkit', daemon=True)

    def start(self) -> None:
        """Start the background thread."""
        self._thread.start()

    @property
    def is_open(self) -> bool:
        """Tell whether the background thread was started, and not ended since."""
        return self._thread.is_alive() and not self._closing

    def close(self, timeout_sec: float) -> bool:
        """End the background thread, and wait for a callback that is still running.

        A thread that runs none ends by itself, however late a busy machine lets it: the end of
        the interpreter would abort the process before.

        Args:
            timeout_sec: How long to wait for a callback, s.

        Returns:
            Whether the thread has ended in time.
        """
        self._closing = True
        self.wake()
        left = timeout_sec
        while self._thread.is_alive() and not self.in_callback():
            is_busy = self._running is not None or self._looking is not None
            if left <= (0 if is_busy else -END_SEC):
                break
            self._thread.join(POLL_SEC)
            left -= POLL_SEC  # no clock: the whole machine may have stood still meanwhile
        for task, _, _ in self._ready:
            task.cancel()  # else Python complains of coroutines that were never awaited
        self._ready.clear()
        return not self._thread.is_alive()

    # -- nodes ----------------------------------------------------------------------------------

    def add_entry(self, entry: NodeEntry) -> None:
        """Run the callbacks of a node from now on."""
        self._entries[entry.node] = entry
        self.add_node(entry.node)

    def remove_node(self, node: Node) -> None:
        """Run the callbacks of a node no more, and let go of its timers and subscriptions.

        What a wait holds is destroyed only afterwards. Were a node of the same name made before,
        the graph would take the new one's topics for the old one's, and leave them nameless.
        """
        known = self._entries.pop(node, None)
        if known is not None and node.executor is self:
            compat.forget_executor(node)
        seen = self._rounds
        super().remove_node(node)
        # Who looks at a condition keeps the thread from its next round.
        waits_in_vain = self.in_callback() or self._looking == threading.get_ident()
        if self.is_open and not waits_in_vain:
            with self._round_begun:
                self._round_awaited += 1
                try:
                    self._round_begun.wait_for(lambda: self._rounds > seen, RELEASE_SEC)
                finally:
                    self._round_awaited -= 1

    def entry_of(self, node: Node) -> NodeEntry | None:
        """Return the entry of a node, None if it is not on this executor."""
        return self._entries.get(node)

    def get_nodes(self) -> list[Node]:
        """Return the nodes on this executor, in the order in which they were added."""
        if self._gathering and self.in_callback():  # at the start of each round
            self._rounds += 1
            if self._round_awaited:
                with self._round_begun:
                    self._round_begun.notify_all()
        return list(self._entries)

    def can_execute(self, entity: Any) -> bool:
        """Tell whether a callback can be run now."""
        # Asked for every entity in every round. rclpy looks into the callback group each time,
        # which costs a tenth of a message's way; but between rounds no callback is under way,
        # unless it is a coroutine.
        if not compat.has_tasks(self):
            return not compat.is_queued(entity)
        return bool(super().can_execute(entity))

    def create_task(
        self, callback: Callable[..., Any] | Coroutine[Any, Any, Any], *args: Any, **kwargs: Any
    ) -> Task:
        """Run a callback that belongs to no entity, such as one added to a future.

        It is a part of the node whose callback asks for it; outside of callbacks, of the cell.
        """
        running = self._running if self.in_callback() else None
        if running is not None:
            owner = running[0]
        else:
            first = next(iter(self._entries.values()))
            owner = replace(first, cell=self._console.current_cell(), counts={}, budget=None)
        task = Task(callback, args, kwargs, executor=self)  # type: ignore[no-untyped-call]
        self._owners[task] = owner
        compat.add_task(self, task)
        self.wake()
        return task

    # -- waiting --------------------------------------------------------------------------------

    def wait(self, condition: Callable[[], object], timeout_sec: float | None) -> bool:
        """Wait until `condition()` is true; it is looked at after each callback.

        Args:
            condition: A function without arguments. It is never called during a callback.
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Returns:
            Whether it became true in time.

        Raises:
            Exception: What `condition` raises.
        """
        done = threading.Event()
        failed: list[BaseException] = []
        with self._console.waiting() as end:

            def look() -> None:
                self._looking = threading.get_ident()
                try:
                    if done.is_set() or not condition():
                        return
                except BaseException as error:  # it belongs to the caller, not to this thread
                    failed.append(error)
                finally:
                    self._looking = None
                end()
                done.set()

            self._conditions.append(look)
            try:
                self._wait_for(done, look, timeout_sec)
            finally:
                self._conditions.remove(look)
        if failed:
            raise failed[0]
        return done.is_set()

    def _wait_for(
        self, done: threading.Event, look: Callable[[], None], timeout_sec: float | None
    ) -> None:
        endless = timeout_sec is None or timeout_sec < 0
        end = float('inf') if endless else time.monotonic() + (timeout_sec or 0.0)
        while True:
            # Between callbacks only: one that is half way may have counted, but not yet printed.
            try:
                if self._callback_lock.acquire(timeout=POLL_SEC):
                    look()
            finally:
                # The stop button may strike between acquiring and knowing of it, so the lock
                # itself is asked: it refuses when this thread does not hold it.
                with suppress(RuntimeError):
                    self._callback_lock.release()
            left = end - time.monotonic()
            if done.wait(max(0.0, min(POLL_SEC, left))) or left <= 0 or self._closing:
                return

    def settle(self, timeout_sec: float) -> bool:
        """Wait until nothing is left to run, nor has become ready through what was run.

        Within one process a message is in the queue of its subscriptions when `publish` returns.
        So whatever a message has set off, one callback after the other, has happened then, except
        for what other threads do.

        Args:
            timeout_sec: Seconds to wait: a callback may not return, or a timer without a period
                be ready for ever.

        Returns:
            Whether it became quiet in time.
        """
        with self._settle_lock:
            done = self._settling = threading.Event()
            self.wake()
            quiet = done.wait(timeout_sec)
            self._settling = None
        return quiet

    def between_callbacks(self) -> AbstractContextManager[bool]:
        """Return what keeps callbacks waiting for a `with` block, which must not wait itself."""
        return self._callback_lock

    def in_callback(self) -> bool:
        """Tell whether the caller is the background thread itself, that is, a callback."""
        return threading.current_thread() is self._thread

    def refuse_in_callback(self, what: str, todo: str = '') -> None:
        """Raise a LabError when a callback or a condition calls: it would wait for itself.

        Args:
            what: What can't be done there, such as `'Waiting'`.
            todo: What to do instead in a callback.
        """
        if self._looking == threading.get_ident():
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

    def caller(self) -> tuple[NodeEntry, str] | None:
        """Return the node whose callback calls this, and the callback's name."""
        running = self._running
        if running is None or not self.in_callback():
            return None
        return running[0], callback_name(running[1])

    def running_callback(self) -> tuple[str, str] | None:
        """Return the node and the name of the callback that runs at this moment, or None."""
        running = self._running
        return (running[0].name, callback_name(running[1])) if running is not None else None

    # -- the background thread ------------------------------------------------------------------

    def _spin(self) -> None:
        # A callback may have shut down this executor, or ROS past labkit: `is_open` tells.
        while not (self._closing or compat.is_shut_down(self)):
            try:
                self.spin_once()
            except ExternalShutdownException:
                return
            except InvalidHandle:
                # A node was destroyed between waiting and taking: there is nothing to run.
                continue
            except BaseException as error:  # a fault of labkit's own must not silence every node
                if not self.context.ok():
                    return
                self._console.show_error('labkit itself', 'spin_once', error)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and run it. Called by the background thread only."""
        if not self._ready:
            settling = self._settling
            stop = self._closed if settling is not None else self._asked
            self._gathering = True
            try:
                # When woken without work it goes on waiting, unless it is asked for something.
                self._ready.extend(
                    compat.ready_callbacks(self, timeout_sec if settling is None else 0, stop)
                )
            except (TimeoutException, ShutdownException, ConditionReachedException):
                pass
            finally:
                self._gathering = False
            self._ready.sort(key=_is_timer)
            if settling is not None and (not self._ready or self._only_awaits()):
                settling.set()
                self._settling = None
            if not self._ready:
                return
        task, entity, node = self._ready.pop(0)
        entry = self._owners.get(task) if node is None else self._entries.get(node)
        if entry is None or (node is None and not entry.alive):
            # Its node has ended: a goal under way, for one, goes on no more.
            _drop(task)
        else:
            self._run(task, entity, entry)

    def _only_awaits(self) -> bool:
        """Tell whether nothing is left but coroutines that await what does not come.

        One that awaits is ready in each round. What it awaits may have come in the round before,
        so there have to be two rounds without anything new.
        """
        tasks = {task for task, _, _ in self._ready}
        self._idle_rounds = self._idle_rounds + 1 if tasks <= self._before else 0
        self._before = tasks
        return self._idle_rounds > 1

    def _closed(self) -> bool:
        return self._closing

    def _asked(self) -> bool:
        return self._closing or self._settling is not None

    def _run(self, task: Any, entity: Any, entry: NodeEntry) -> None:
        self._console.speak_for(entry.cell)
        with self._callback_lock:
            what = entity or compat.callback_of(
                task
            )  # a task forgets its function when it is done
            self._running = (entry, what)
            try:
                task()
            except BaseException as let_through:  # by rclpy, such as that of sys.exit()
                task.set_exception(let_through)
            self._running = None
            error = task.exception()
            # Not when the node was removed meanwhile, or an action: then the error is that it was.
            ended = isinstance(error, InvalidHandle) and isinstance(entity, Waitable)
            if error is not None and entry.node in self._entries and not ended:
                self._console.show_error(entry.name, callback_name(what), error)
            entry.counts[entity] = entry.counts.get(entity, 0) + 1
            if entry.budget is not None:
                entry.budget -= 1
                if entry.budget <= 0:
                    self.remove_node(entry.node)
            for look in tuple(self._conditions):
                look()


def _drop(task: Any) -> None:
    """Give up a callback that is not to be run; Python warns of a coroutine that is forgotten."""
    handler = compat.handler_of(task)
    task.cancel()
    if inspect.iscoroutine(handler):
        handler.close()


def _is_timer(work: tuple[Any, Any, Any]) -> bool:
    return isinstance(work[1], Timer)


def callback_name(what: Any) -> str:
    """Return the name of a callback, or of that of a timer, a subscription or a service."""
    callback = getattr(what, 'callback', None) or what
    return getattr(callback, '__name__', None) or type(what).__name__
