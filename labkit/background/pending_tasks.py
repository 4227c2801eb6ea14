"""Tasks that have begun and not ended: coroutine callbacks, functions that belong to no entity."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.task import Future, Task

from labkit.background import compat
from labkit.background.nodes import NodeEntry, callback_name
from labkit.errors import LabError

__all__ = ['PendingTasks', 'Work', 'answered_by']

answered_by: WeakKeyDictionary[Future, Any] = WeakKeyDictionary()
"""The client of a service or an action whose callback gives a future its result."""


@dataclass(eq=False)
class Work:
    """A coroutine that awaits something, or a function that belongs to no entity.

    Attributes:
        task: The task, resumed after each callback until it is done.
        entry: The node that it belongs to.
        what: The entity or function whose name is shown with an error.
        entity: The entity that blocks its callback group, None for a function.
    """

    task: Any
    entry: NodeEntry
    what: Any
    entity: Any = None


class PendingTasks:
    """The pending tasks, resumed whenever something has happened.

    Args:
        regroup: Called when the entities that a callback group may run change.
    """

    def __init__(self, regroup: Callable[[], None]) -> None:
        self._regroup = regroup
        self._works: list[Work] = []
        self._notified = False

    def __len__(self) -> int:
        return len(self._works)

    def notify(self) -> None:
        """Note that something has happened that a coroutine may await."""
        self._notified = True

    def due(self) -> list[Work]:
        """Return the tasks to resume: all of them, if `notify` was called since."""
        if not self._notified:
            return []
        self._notified = False
        return list(self._works)

    def add_function(self, task: Task, entry: NodeEntry) -> None:
        """Add a function that belongs to no entity."""
        self._works.append(Work(task, entry, compat.callback_of(task)))

    def add_callback(self, task: Task, entry: NodeEntry, entity: Any) -> BaseException | None:
        """Add the callback of an entity, and block its callback group until it has ended.

        Returns:
            Its exception, if it was about to wait for itself.
        """
        work = Work(task, entry, entity, entity)
        self._works.append(work)
        entity.callback_group.beginning_execution(entity)
        self._regroup()
        return self._after_step(work)

    def is_over(self, work: Work) -> bool:
        """Remove a task that is done or whose node has ended; return whether it was removed."""
        if not work.entry.alive:
            work.task.cancel()
        if not (work.task.done() or work.task.cancelled()):
            return False
        self._end(work)
        return True

    def resume(self, work: Work) -> BaseException | None:
        """Resume a task, and return its exception."""
        task = work.task
        try:
            task()
        except BaseException as error:  # rclpy catches only Exception, not that of sys.exit()
            task.set_exception(error)
        return self._after_step(work)

    def _after_step(self, work: Work) -> BaseException | None:
        """Note what a task has come to, and return its exception."""
        task = work.task
        if not task.done():
            _refuse_deadlock(work)
        if not task.done():
            return None
        self._end(work)
        self._notified = True
        if work.entity is None:
            work.entry.count(None)
        raised: BaseException | None = task.exception()
        return raised

    def cancel(self) -> None:
        """Cancel all tasks: Python warns of coroutines that were never awaited."""
        for work in self._works:
            # One that runs just now can't be, and ends by itself.
            if not work.task.executing():
                work.task.cancel()
        self._works.clear()

    def _end(self, work: Work) -> None:
        """Remove a task, and unblock its callback group."""
        with suppress(ValueError):
            self._works.remove(work)
            if work.entity is not None:
                work.entity.callback_group.ending_execution(work.entity)
                self._regroup()


def _refuse_deadlock(work: Work) -> None:
    """Raise in a callback that awaits what can come only when it has returned."""
    future = compat.awaited_by(work.task) if work.entity is not None else None
    client = answered_by.get(future) if future is not None else None
    group = getattr(client, 'callback_group', None)
    same = work.entity is not None and group is work.entity.callback_group
    if not same or not isinstance(group, MutuallyExclusiveCallbackGroup):
        return
    name = callback_name(work.entity)
    error = LabError(
        f'{name} would wait for ever: it awaits an answer that its client can take only when '
        f'{name} has returned, since both are in the same callback group, which runs one callback '
        'at a time.',
        todo='Give the client a group of its own, with callback_group='
        'MutuallyExclusiveCallbackGroup(). Or do not await: future.add_done_callback(...).',
    )
    try:
        compat.handler_of(work.task).throw(error)
    except StopIteration as returned:
        work.task.set_result(returned.value)
    except BaseException as raised:
        work.task.set_exception(raised)
