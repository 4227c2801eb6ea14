"""A wait set that is kept from wait to wait.

rclpy makes a new wait set for every callback, and enters and exits the handle of every entity of
every node: the more nodes there are, the longer each message takes. Here the entities are gathered
once and only added again before each wait, until `invalidate` is called. That is when rclpy wakes
the executor: whenever something was created or destroyed.

Why nothing is used after it was destroyed: gathering an entity enters its handle, and an entered
handle is destroyed only after it was exited. `invalidate` exits all of them: at once outside of a
wait; during a wait, when it has returned, for which the caller triggers the executor's guard
condition. A guard condition stays triggered, so it does not matter whether the wait has begun
already. A ready entity may be destroyed before its turn: taking from it enters its handle again,
and rclpy answers that there is nothing to take.

rclpy's own fast executor, `rclpy.experimental.EventsExecutor`, runs callbacks in the order of
their events. Here the order is fixed, and errors of each callback are handled.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.exceptions import InvalidHandle
from rclpy.waitable import NumberOfEntities

from labkit.background import compat

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node

__all__ = ['KeptWaitSet', 'Ready']

# Nothing reports an entity that is destroyed without its node, so all are gathered again this
# often, s.
RENEW_SEC = 1.0

FOREVER = -1

# Kind of entity and the node's attribute, in the order of the turns within a node.
_KINDS = (
    ('subscription', 'subscriptions'),
    ('guard_condition', 'guards'),
    ('client', 'clients'),
    ('service', 'services'),
)
_TIMERS = ('timer', 'timers')
_COUNTED = {
    'subscription': 'num_subscriptions',
    'guard_condition': 'num_guard_conditions',
    'timer': 'num_timers',
    'client': 'num_clients',
    'service': 'num_services',
}


@dataclass(frozen=True)
class Ready:
    """An entity of a node that is ready.

    Attributes:
        entity: The subscription, timer, client, service, guard condition or waitable.
        node: Its node.
        take: Takes from the entity. Returns a function that makes the coroutine which runs the
            callback, or None if there is nothing.
        turn: Its place in the order, lowest first.
    """

    entity: Any
    node: Node
    take: Callable[[Any], Any]
    turn: int


class KeptWaitSet:
    """The wait set for all nodes of an executor. Only one thread may wait."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        # Reentrant: anything here may trigger the garbage collector, and that a destructor.
        self._lock = threading.RLock()
        self._takers = {**compat.takers(executor), 'timer': self._take_timer}
        self._call_timer = compat.takers(executor)['timer']
        self._wait_set: Any = None
        self._entered: list[Any] = []
        self._handles: dict[str, list[Any]] = {}
        self._add: list[tuple[Callable[[Any], Any], Any]] = []
        self._events: list[Ready] = []
        self._waitables: list[Ready] = []
        self._by_pointer: dict[int, Ready] = {}
        self._waiting = False
        self._stale = True
        self._renew_at = 0.0

    def invalidate(self) -> None:
        """Release all entities, and gather again before the next wait. Any thread may call it."""
        with self._lock:
            self._stale = True
            if not self._waiting:
                self._leave()

    def wait(
        self, nodes: Iterable[Node], *, may_run: Callable[[Any], bool] | None, block: bool
    ) -> list[Ready]:
        """Wait until something is ready, or the executor was woken.

        Args:
            nodes: The nodes, in the order of their turns.
            may_run: Returns whether an entity's callback may run now, None if all may. Called when
                the entities are gathered: call `invalidate` when an answer changes.
            block: Whether to wait at all.

        Returns:
            The ready entities in the order of their turns: messages before timers.
        """
        with self._lock:
            try:
                if self._stale or time.monotonic() >= self._renew_at:
                    self._leave()
                    self._gather(nodes, may_run)
                wait_set = self._fill()
            except BaseException:
                self._leave()  # a custom waitable may have more entities now: count again
                raise
            self._waiting = True
        try:
            wait_set.wait(FOREVER if block else 0)
            return self._ready(wait_set)
        finally:
            with self._lock:
                self._waiting = False
                if self._stale:
                    self._leave()

    def _gather(self, nodes: Iterable[Node], may_run: Callable[[Any], bool] | None) -> None:
        self._stale = False  # first: a change from here on affects the next wait
        self._renew_at = time.monotonic() + RENEW_SEC
        nodes = list(nodes)
        turn = 0
        count: Any = NumberOfEntities()  # type: ignore[no-untyped-call]
        self._handles = {kind: [] for kind in _COUNTED}
        waitable: Any
        for node in nodes:
            for waitable in node.waitables:
                if (may_run is None or may_run(waitable)) and self._enter(waitable):
                    turn += 1
                    known = self._waitables if compat.event_of(waitable) is None else self._events
                    known.append(Ready(waitable, node, self._takers['waitable'], turn))
                    count += waitable.get_num_entities()
        for kinds in (_KINDS, (_TIMERS,)):
            for node in nodes:
                for kind, plural in kinds:
                    for entity in getattr(node, plural):
                        if (may_run is None or may_run(entity)) and self._enter(entity.handle):
                            turn += 1
                            self._handles[kind].append(entity.handle)
                            self._by_pointer[entity.handle.pointer] = Ready(
                                entity, node, self._takers[kind], turn
                            )
        for guard in compat.own_guards(self._executor):
            if self._enter(guard.handle):
                self._handles['guard_condition'].append(guard.handle)
        for kind, counter in _COUNTED.items():
            setattr(count, counter, getattr(count, counter) + len(self._handles[kind]))
        context = self._executor.context.handle
        if self._enter(context):
            self._wait_set = compat.new_wait_set(context, count)
            self._plan(self._wait_set)

    def _plan(self, wait_set: Any) -> None:
        """Note what to add before each wait, so that event handlers are asked only once."""
        for event in self._events:
            # It stores its index, which stays the same: events come first, in this order.
            event.entity.add_to_wait_set(wait_set)
            self._add.append((wait_set.add_event, compat.event_of(event.entity)))
        for kind, handles in self._handles.items():
            add = getattr(wait_set, f'add_{kind}')
            self._add += [(add, handle) for handle in handles]

    def _take_timer(self, timer: Any) -> Any:
        # An earlier callback of this round may have cancelled or reset it.
        try:
            return self._call_timer(timer) if timer.is_ready() else None
        except InvalidHandle:
            return None

    def _enter(self, handle: Any) -> bool:
        """Enter a handle, which keeps it from being destroyed; return False if it was already."""
        try:
            handle.__enter__()
        except InvalidHandle:
            return False
        self._entered.append(handle)
        return True

    def _leave(self) -> None:
        """Exit all entered handles."""
        self._stale = True
        self._wait_set = None
        self._waitables, self._events, self._add = [], [], []
        self._by_pointer, self._handles = {}, {}
        while self._entered:
            self._entered.pop().__exit__(None, None, None)

    def _fill(self) -> Any:
        """Add all entities to the wait set, which each wait empties."""
        wait_set = self._wait_set
        if wait_set is None:
            raise InvalidHandle('ROS is shut down')
        wait_set.clear_entities()
        for add, handle in self._add:
            add(handle)
        for waitable in self._waitables:
            waitable.entity.add_to_wait_set(wait_set)
        return wait_set

    def _ready(self, wait_set: Any) -> list[Ready]:
        ready = [waitable for waitable in self._waitables if waitable.entity.is_ready(wait_set)]
        for place, event in enumerate(self._events):
            if wait_set.is_ready('event', place) and event.entity.is_ready(wait_set):
                ready.append(event)
        for kind, handles in self._handles.items():
            if handles:
                for pointer in wait_set.get_ready_entities(kind):
                    found = self._by_pointer.get(pointer)
                    if found is not None:
                        ready.append(found)
        if len(ready) > 1:
            ready.sort(key=lambda one: one.turn)
        return ready
