"""The nodes that run in the background, by name, so that a cell can be run again.

A callback may make a node at any moment, which needs the lock. So it is held only to access the
table, and never during a wait.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.node import Node

from labkit import stop_button
from labkit.background import compat
from labkit.background.console import Cell, Console
from labkit.background.executor import BackgroundExecutor
from labkit.background.nodes import (
    NodeEntry,
    destroy_node,
    existing_nodes,
    full_name,
    half_made,
)
from labkit.background.wait import wait_for

if TYPE_CHECKING:
    from labkit.background.foreground import Spin

__all__ = ['Registry']

# How long an executor may hold a destroyed node, s. The learner's own lets go at once, unless a
# callback is running.
GONE_SEC = 1.0


class Registry:
    """The nodes that run in the background, each name once.

    Args:
        console: The console, which has the running cell.
        count: Returns the number of nodes of a full name in the graph.
    """

    def __init__(self, console: Console, count: Callable[[str], int]) -> None:
        self._console = console
        self._count = count
        self._lock = threading.Lock()
        self._entries: dict[str, NodeEntry] = {}

    def add(
        self,
        executor: BackgroundExecutor,
        node: Node,
        *,
        budget: int | None = None,
        spin: Spin | None = None,
    ) -> NodeEntry:
        """Put a node on an executor, see `Runtime.add`."""
        name = node.get_fully_qualified_name()
        begun = compat.parameter_values(node)
        cell = self._console.current_cell()
        entry = NodeEntry(node, name, cell, parameters=begun, budget=budget)
        while True:
            with self._lock:
                earlier = self._entries.setdefault(name, entry)
            if earlier is entry:
                break
            if earlier.node is node:
                entry, earlier.budget = earlier, budget
                break
            with stop_button.heard_at_once():  # its destroy_node() may never return
                self.discard(executor, earlier)
        entry.lasts = spin is None
        if spin is not None:
            entry.spins.append(spin)
        executor.add_entry(entry)
        return entry

    def discard(
        self, executor: BackgroundExecutor | None, entry: NodeEntry
    ) -> BaseException | None:
        """Remove a node from its executor and destroy it, see `destroy`."""
        self.release(executor, entry)
        return self.destroy(entry.node, entry.name)

    def destroy(self, node: Node, name: str) -> BaseException | None:
        """Destroy a node of any executor; show an error of its `destroy_node`, and return it."""
        # A node whose __init__ has failed may have no such attribute.
        executor = getattr(node, 'executor', None)
        if executor is not None:
            executor.remove_node(node)
        before = self._count(name)
        error = destroy_node(node)
        # An executor may hold it during its wait: the node leaves the graph only afterwards, its
        # endpoints before. If a node of the same name were made in between, the graph would take
        # its endpoints for those of the old one, and leave them without a node.
        wait_for(lambda: not before or self._count(name) < before, GONE_SEC)
        if error is not None:
            self._console.show_error(name, 'destroy_node', error)
        return error

    def release(self, executor: BackgroundExecutor | None, entry: NodeEntry) -> None:
        """Remove a node from its executor without destroying it."""
        with self._lock:
            if self._entries.get(entry.name) is entry:
                del self._entries[entry.name]
        if executor is not None:
            executor.remove_node(entry.node)

    def entries(self) -> list[NodeEntry]:
        """Return the nodes in the order they were started."""
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
        """Destroy the node of a name before another one of the same name is made.

        Two nodes of one name in one process share rcl's publisher on /rosout, and the first to end
        destroys it. This also finds nodes whose `__init__` has failed, and those that the
        learner's own executor spins.

        Args:
            executor: The background executor, None if ROS is not up.
            name: Full name of the new node.
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
        """Destroy nodes of any name whose `__init__` failed in an earlier run of a cell."""
        for node, made_by in list(half_made.items()):
            if cell.cell_id and made_by is not cell and made_by.cell_id == cell.cell_id:
                self.destroy(node, full_name(node))

    def left_over(self, cell: Cell) -> list[NodeEntry]:
        """Return the nodes that only an earlier run of a cell has started.

        Empty if this run has started no node: then the cell is about something else.
        """
        own = [e for e in self.entries() if cell.cell_id and e.cell.cell_id == cell.cell_id]
        earlier = [entry for entry in own if entry.cell is not cell]
        return earlier if len(own) > len(earlier) else []
