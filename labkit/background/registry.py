"""Which nodes run in the background, by name, so that a cell can be run again.

A callback may make a node at any moment, and asks here for room for it. So the lock is held for a
look into the table only, and never while somebody waits.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from rclpy.node import Node

from labkit.background.console import Cell, Console
from labkit.background.executor import BackgroundExecutor
from labkit.background.nodes import (
    NodeEntry,
    destroy_node,
    existing_nodes,
    full_name,
    half_made,
)

__all__ = ['Registry']

# How long somebody may hold a node that was destroyed, s. An executor of the learner's own lets go
# at once, unless a callback keeps it.
GONE_SEC = 1.0
POLL_SEC = 0.001


class Registry:
    """The nodes that run in the background, each name once.

    Args:
        console: Knows the cell that is running.
        count: Returns how many nodes of a full name are in the graph.
    """

    def __init__(self, console: Console, count: Callable[[str], int]) -> None:
        self._console = console
        self._count = count
        self._lock = threading.Lock()
        self._entries: dict[str, NodeEntry] = {}

    def add(
        self, executor: BackgroundExecutor, node: Node, *, budget: int | None = None
    ) -> NodeEntry:
        """Put a node on an executor; one of the same name is destroyed.

        Args:
            executor: The background executor.
            node: The node.
            budget: How many callbacks to run before it leaves the executor; None for no end.
        """
        name = node.get_fully_qualified_name()
        entry = NodeEntry(node, name, self._console.current_cell(), budget=budget)
        while True:
            with self._lock:
                earlier = self._entries.setdefault(name, entry)
            if earlier is entry:
                break
            if earlier.node is node:
                entry, earlier.budget = earlier, budget
                break
            self.discard(executor, earlier)
        executor.add_entry(entry)
        return entry

    def discard(
        self, executor: BackgroundExecutor | None, entry: NodeEntry
    ) -> BaseException | None:
        """Take a node from its executor and destroy it, see `destroy`."""
        self.release(executor, entry)
        return self.destroy(entry.node, entry.name)

    def destroy(self, node: Node, name: str) -> BaseException | None:
        """Destroy a node, and show what its own `destroy_node` raises.

        Args:
            node: The node, spun by whomever or not.
            name: Its full name.

        Returns:
            What its `destroy_node` has raised, None if nothing.
        """
        # A node whose __init__ did not get far enough has none.
        executor = getattr(node, 'executor', None)
        if executor is not None:
            executor.remove_node(node)
        before = self._count(name)
        error = destroy_node(node)
        self._wait_until_fewer(name, before)
        if error is not None:
            self._console.show_error(name, 'destroy_node', error)
        return error

    def _wait_until_fewer(self, name: str, count: int) -> None:
        """Wait until nobody holds a node that was destroyed, such as an executor in its wait.

        It leaves the graph only then; what it had leaves before. Were a node of the same name made
        meanwhile, the graph would take the new one's topics for the old one's, and leave them
        nameless.
        """
        end = time.monotonic() + GONE_SEC
        while count and self._count(name) >= count and time.monotonic() < end:
            time.sleep(POLL_SEC)

    def release(self, executor: BackgroundExecutor | None, entry: NodeEntry) -> None:
        """Take a node from its executor and leave it alive."""
        with self._lock:
            if self._entries.get(entry.name) is entry:
                del self._entries[entry.name]
        if executor is not None:
            executor.remove_node(entry.node)

    def entries(self) -> list[NodeEntry]:
        """Return the nodes in the order in which they were started."""
        with self._lock:
            return list(self._entries.values())

    def get(self, name: str) -> NodeEntry | None:
        """Return the node of a full name, None if none runs."""
        return self._entries.get(name)

    def clear(self) -> None:
        """Forget all nodes."""
        with self._lock:
            self._entries.clear()

    def make_room(self, executor: BackgroundExecutor | None, name: str) -> None:
        """Destroy the node of a name before another one of that name is made.

        Two nodes of one name in one process share rcl's publisher on /rosout, and the first that
        goes takes it away. A node whose `__init__` failed half way is found here too, and one that
        an executor of the learner's own spins.

        Args:
            executor: The background executor, None if ROS is not up.
            name: The full name of the node that is about to be made.
        """
        self._end_half_made(self._console.current_cell())
        entry = self.get(name)
        if entry is not None:
            self.discard(executor, entry)
            return
        for node in existing_nodes():
            if node.get_fully_qualified_name() == name:
                self.destroy(node, name)

    def _end_half_made(self, cell: Cell) -> None:
        """End the nodes of earlier runs of a cell whose `__init__` failed, whatever their name."""
        for node, made_by in list(half_made.items()):
            if cell.cell_id and made_by is not cell and made_by.cell_id == cell.cell_id:
                self.destroy(node, full_name(node))

    def left_over(self, cell: Cell) -> list[NodeEntry]:
        """Return the nodes that an earlier run of a cell has started, and this one has not.

        None if this run has started no node: then it is about something else.
        """
        own = [e for e in self.entries() if cell.cell_id and e.cell.cell_id == cell.cell_id]
        earlier = [entry for entry in own if entry.cell is not cell]
        return earlier if len(own) > len(earlier) else []
