"""What has begun and not ended: coroutines as callbacks, functions that belong to no entity."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from rclpy.task import Task

from labkit.background import compat
from labkit.background.nodes import NodeEntry

__all__ = ['UnderWay', 'Work']


@dataclass(eq=False)
class Work:
    """A coroutine that awaits something, or a function that belongs to no entity.

    Attributes:
        task: Gone on with after each callback, until it is done.
        entry: The node that it is a part of.
        what: The entity or the function, whose name is shown with an error.
        entity: Keeps others of its callback group waiting; None for a function without entity.
    """

    task: Any
    entry: NodeEntry
    what: Any
    entity: Any = None


class UnderWay:
    """All that is under way. It is gone on with whenever something has happened.

    Args:
        regroup: Called when a callback group may run other entities than before.
    """

    def __init__(self, regroup: Callable[[], None]) -> None:
        self._regroup = regroup
        self._works: list[Work] = []
        # Whether something has happened since what is under way was gone on with.
        self._stirred = False

    def __len__(self) -> int:
        return len(self._works)

    def stir(self) -> None:
        """Tell that something has happened, for which a coroutine may have waited."""
        self._stirred = True

    def due(self) -> list[Work]:
        """Return what is to be gone on with now: all, if something has happened since."""
        if not self._stirred:
            return []
        self._stirred = False
        return list(self._works)

    def add_function(self, task: Task, entry: NodeEntry) -> None:
        """Let a function be run that belongs to no entity."""
        self._works.append(Work(task, entry, compat.callback_of(task)))

    def add_callback(self, task: Task, entry: NodeEntry, entity: Any) -> None:
        """Go on with the callback of an entity; others of its group wait until it has ended."""
        self._works.append(Work(task, entry, entity, entity))
        entity.callback_group.beginning_execution(entity)
        self._regroup()

    def is_over(self, work: Work) -> bool:
        """Tell whether there is nothing to go on with. It is then under way no more."""
        if not work.entry.alive:
            work.task.cancel()  # a goal, for one, goes on no more when its node has ended
        if not (work.task.done() or work.task.cancelled()):
            return False
        self._end(work)
        return True

    def go_on(self, work: Work) -> BaseException | None:
        """Go on with something; return what it raises."""
        task = work.task
        try:
            task()
        except BaseException as let_through:  # by rclpy, such as that of sys.exit()
            task.set_exception(let_through)
        if not task.done():
            return None
        self._end(work)
        self._stirred = True
        if work.entity is None:
            work.entry.count(None)
        error: BaseException | None = task.exception()
        return error

    def cancel(self) -> None:
        """End all of it: Python complains of coroutines that were never awaited."""
        for work in self._works:
            work.task.cancel()
        self._works.clear()

    def _end(self, work: Work) -> None:
        """Let others of its group run again."""
        with suppress(ValueError):
            self._works.remove(work)
            if work.entity is not None:
                work.entity.callback_group.ending_execution(work.entity)
                self._regroup()
