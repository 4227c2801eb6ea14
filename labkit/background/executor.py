"""The background thread: one executor, callbacks one after the other, and waiting for them.

What was measured of rclpy in a kernel, and decides the shape of this module:

- `rcl_wait` can't be interrupted from Python, so nothing spins in the foreground: a cell that
  waits, waits for the background thread.
- A `SingleThreadedExecutor` bears nodes that come and go while it spins; a multi-threaded one
  fails now and then, and costs more a message.
- rclpy makes a wait set, a task and a coroutine of its own for each message. A message takes a
  third of the time when the wait set is kept (see `wait_set`) and the callback run directly.
- An exception ends `Executor.spin()` silently, so each callback is run on its own.
- A spinning thread at the end of the interpreter aborts the process, so it is joined at exit.
"""

from __future__ import annotations

import threading
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
from rclpy.waitable import Waitable

from labkit.background import compat
from labkit.background.conditions import POLL_SEC, Conditions
from labkit.background.console import Console
from labkit.background.nodes import NodeEntry, callback_name
from labkit.background.under_way import UnderWay, Work
from labkit.background.wait_set import KeptWaitSet, Ready
from labkit.errors import LabError

__all__ = ['BackgroundExecutor']

# How long a thread may take to end that runs no callback, s: only a fault would make it longer.
END_SEC = 30.0
# How long to wait for a callback that keeps a removed node from being let go.
RELEASE_SEC = 1.0


class BackgroundExecutor(Executor):
    """Runs the callbacks of all nodes in one background thread, in a fixed order.

    Nodes come in the order in which they were added, and messages before timers: what a timer has
    published is heard before its next tick, however late the machine is. So the output of a cell
    is the same each time.

    Args:
        console: Where the output of callbacks goes.

    Attributes:
        thread: The background thread.
    """

    def __init__(self, console: Console) -> None:
        super().__init__()
        self._console = console
        self._entries: dict[Node, NodeEntry] = {}
        self._round_begun = threading.Condition()
        self._rounds = 0
        self._round_awaited = 0
        self._running: tuple[NodeEntry, Any] | None = None
        self._conditions = Conditions(console)
        self._closing = False
        self._settling: threading.Event | None = None
        self._settle_lock = threading.Lock()
        self._wait_set = KeptWaitSet(self)
        self._under_way = UnderWay(self._wait_set.give_up)
        self._ready: deque[Ready | Work] = deque()
        self.thread = threading.Thread(target=self._spin, name='labkit', daemon=True)

    def start(self) -> None:
        """Start the background thread."""
        self.thread.start()

    @property
    def is_open(self) -> bool:
        """Tell whether the background thread was started, and not ended since."""
        return self.thread.is_alive() and not self._closing

    @property
    def awaiting(self) -> int:
        """Return how many coroutines and tasks have begun, or are to, and have not ended."""
        return len(self._under_way)

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
        while self.thread.is_alive() and not self.in_callback():
            if left <= (0 if self._is_busy else -END_SEC):
                break
            self.thread.join(POLL_SEC)
            left -= POLL_SEC  # no clock: the whole machine may have stood still meanwhile
        self._under_way.cancel()
        self._wait_set.give_up()
        return not self.thread.is_alive()

    # -- nodes ----------------------------------------------------------------------------------

    def add_entry(self, entry: NodeEntry) -> None:
        """Run the callbacks of a node from now on."""
        self._entries[entry.node] = entry
        self.add_node(entry.node)
        self.wake()

    def wake(self) -> None:
        """Look anew at what there is. rclpy calls it when an entity was made or destroyed."""
        self._wait_set.give_up()
        self._rouse()

    def _rouse(self) -> None:
        """End a wait, to look at what is under way. The entities are still the same."""
        self._under_way.stir()
        super().wake()

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
        self.wake()
        # Who looks at a condition keeps the thread from its next round.
        waits_in_vain = self.in_callback() or self._conditions.caller_is_looking
        if self.is_open and not waits_in_vain:
            self._await_round_after(seen)

    def _await_round_after(self, seen: int) -> None:
        """Wait until what the background waited for is let go, unless a callback keeps it."""
        left = END_SEC
        with self._round_begun:
            self._round_awaited += 1
            try:
                while not self._round_begun.wait_for(lambda: self._rounds > seen, RELEASE_SEC):
                    left -= RELEASE_SEC  # no clock: the whole machine may have stood still
                    if self._is_busy or not self.is_open or left <= 0:
                        return
            finally:
                self._round_awaited -= 1

    def entry_of(self, node: Node) -> NodeEntry | None:
        """Return the entry of a node, None if it is not on this executor."""
        return self._entries.get(node)

    def get_nodes(self) -> list[Node]:
        """Return the nodes on this executor, in the order in which they were added."""
        return list(self._entries)

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
        self._under_way.add_function(task, owner)
        self._rouse()
        return task

    def spin(self, *_: Any, **__: Any) -> NoReturn:
        """Refuse to spin: the background does, and two at once would take from each other.

        Raises:
            LabError: Always.
        """
        raise LabError(
            'This executor can not be asked to spin: it spins in the background already.',
            todo='Wait for what you expect: lab.wait_until(lambda: future.done()), or '
            'lab.wait_for_message(...).',
        )

    spin_once = spin_until_future_complete = spin_once_until_future_complete = spin

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
        return self._conditions.wait(condition, timeout_sec, lambda: self._closing)

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
            self._rouse()
            quiet = done.wait(timeout_sec)
            self._settling = None
        return quiet

    def between_callbacks(self) -> AbstractContextManager[bool]:
        """Return what keeps callbacks waiting for a `with` block, which must not wait itself."""
        return self._conditions.lock

    def in_callback(self) -> bool:
        """Tell whether the caller is the background thread itself, that is, a callback."""
        return threading.current_thread() is self.thread

    def refuse_in_callback(self, what: str, todo: str = '') -> None:
        """Raise a LabError when a callback or a condition calls: it would wait for itself.

        Args:
            what: What can't be done there, such as `'Waiting'`.
            todo: What to do instead in a callback.
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
        """Whether a callback runs, or a condition is looked at."""
        return self._running is not None or self._conditions.is_looking

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
                self._step()
            except InvalidHandle:
                # Something was destroyed between waiting and taking: there is nothing to run.
                pass
            except BaseException as error:  # a fault of labkit's own must not silence every node
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
        # Before the next wait: what they await may have come with the last callback.
        if due := self._under_way.due():
            self._ready.extend(due)
            return
        settling = self._settling
        ready = self._wait_set.wait(
            self._entries,
            may_run=self.can_execute if self._under_way else None,
            block=settling is None,
        )
        self._ready.extend(ready)
        if settling is not None and not ready:
            self._settling = None  # before the one who waits asks anew
            settling.set()

    def _run(self, work: Ready | Work) -> None:
        """Run a callback, or go on with what is under way, and look what has come of it."""
        entry = self._entry_to_run(work)
        if entry is None:
            return
        what = work.what if isinstance(work, Work) else work.entity
        self._console.speak_for(entry.cell)
        with self._conditions.lock:
            self._running = (entry, what)
            if isinstance(work, Work):
                error = self._under_way.go_on(work)
            else:
                error = self._begin(work, entry)
            self._running = None
            # Not when the node was removed meanwhile, or an action: then the error is that it was.
            if (
                error is not None
                and entry.node in self._entries
                and not _was_destroyed(entry.node, what, error)
            ):
                self._console.show_error(entry.name, callback_name(what), error)
            if entry.budget is not None and entry.budget <= 0:
                self.remove_node(entry.node)
            self._conditions.look()

    def _entry_to_run(self, work: Ready | Work) -> NodeEntry | None:
        """Return the node whose callback is to be run now, None if none is."""
        if isinstance(work, Work):
            if self._under_way.is_over(work):
                return None
            # Spun with `rclpy.spin_once()`, it goes on when its node is spun again.
            at_rest = work.entity is not None and work.entry.node not in self._entries
            return None if at_rest else work.entry
        entry = self._entries.get(work.node)
        if entry is not None and self._under_way and not self.can_execute(work.entity):
            # One of its group is under way. It stays ready, but for what a wait itself takes.
            if isinstance(work.entity, GuardCondition):
                work.entity.trigger()  # type: ignore[no-untyped-call]
            return None
        return entry

    def _begin(self, work: Ready, entry: NodeEntry) -> BaseException | None:
        """Run the callback of an entity; return what it raises."""
        try:
            execute = work.take(work.entity)
        except BaseException as error:
            return error
        if execute is None:
            self._wait_set.give_up()  # it was destroyed, perhaps past its node
            return None
        self._under_way.stir()
        entry.count(work.entity)
        coroutine = execute()
        try:
            coroutine.send(None)
        except StopIteration:
            return None
        except BaseException as error:
            return error
        task = Task(coroutine)  # type: ignore[no-untyped-call]
        self._under_way.add_callback(task, entry, work.entity)
        return None


def _was_destroyed(node: Node, what: object, error: BaseException) -> bool:
    """Tell whether an error is only that an action's end was destroyed before it was taken."""
    if not isinstance(what, Waitable):
        return False
    removed = isinstance(error, compat.RCLError) and what not in node.waitables
    return removed or isinstance(error, InvalidHandle)
