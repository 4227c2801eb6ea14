"""Executors of the learner's own: whether somebody spins them, and which callbacks they run.

rclpy does not say either. `notebook_rclpy` notes when they wait, and when a task begins.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from labkit.background import compat
from labkit.background.nodes import callback_name, made

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.task import Task

__all__ = ['Call', 'calls_in', 'in_task', 'is_spun', 'waiting']

# Nobody can tell whether a loop will spin again. A node that none has spun for so long is told as
# one that nobody spins, and that is taken back when one does, s.
_BETWEEN_SEC = 3.0


@dataclass(frozen=True)
class Call:
    """A callback that an executor runs.

    Attributes:
        callback: Its name.
        entity: Its timer, subscription and so on; None for that of a future or a goal.
        node: The node of that.
        seconds: For how long it has been running.
        thread: The number of the thread that runs it.
    """

    callback: str
    entity: Any
    node: Node | None
    seconds: float
    thread: int


@contextmanager
def waiting(executor: Any) -> Iterator[None]:
    """Note in a `with` block that an executor waits for work."""
    executor._labkit_waits = True
    try:
        yield
    finally:
        executor._labkit_waits, executor._labkit_waited = False, time.monotonic()


@contextmanager
def in_task(task: Task) -> Iterator[None]:
    """Note in a `with` block that a thread runs a task."""
    mark: Any = task
    if mark.executing():  # by another thread; this one returns at once
        yield
        return
    mark._labkit_begun = (time.monotonic(), threading.get_ident())
    try:
        yield
    finally:
        mark._labkit_begun = None


def is_spun(node: Node) -> bool:
    """Return whether a node is in an executor of the learner's own that somebody spins."""
    executor: Any = node.executor
    if executor is None:
        return False
    if made.origins.get(node) is None or getattr(executor, '_labkit_waits', False):
        return True  # or it is older than the notes
    waited = getattr(executor, '_labkit_waited', -_BETWEEN_SEC)
    return time.monotonic() - waited < _BETWEEN_SEC or any(True for _ in calls_in(executor))


def calls_in(executor: Executor) -> Iterator[Call]:
    """Yield the callbacks that an executor runs."""
    for task, entity, node in compat.tasks_of(executor):
        begun = getattr(task, '_labkit_begun', None)
        if begun is not None:
            since, thread = begun
            what = entity if entity is not None else compat.callback_of(task)
            yield Call(callback_name(what), entity, node, time.monotonic() - since, thread)
