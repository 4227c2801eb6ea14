"""The life of a live view: from the cell that shows it to whatever ends it.

It lives until it is closed, until its cell is run again, or until ROS is stopped. What is shown in
a page of its own ends for another reason too: nobody looks (`labkit.views.live_page`).
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, ClassVar

from labkit import settings
from labkit.background.console import Cell
from labkit.background.nodes import after_destroy, node_exists
from labkit.background.runtime import runtime

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.timer import Timer
    from typing_extensions import Self

__all__ = ['STOPPED', 'Live', 'helper', 'living']

STOPPED = 'ROS was stopped. Run this cell to start it again.'

# The views that live. (A dictionary, because that may be changed by one thread at any moment.)
_views: dict[Live, None] = {}


def helper() -> Node:
    """Return labkit's hidden node, which listens for views: they are no part of the graph.

    ROS is started if it is not up.
    """
    runtime.start()
    assert runtime.helper is not None
    return runtime.helper


def living() -> tuple[Live, ...]:
    """Return the views that live, in the order in which they were made."""
    return tuple(_views)


class Live:
    """A view that follows what happens. What it shows is up to those that are made on it.

    They extend `_open` and `_close`, which say when it listens, and do in `_tick` what is to be
    done again and again meanwhile.
    """

    # What it is called where it speaks of itself.
    _name: ClassVar[str] = 'view'
    # So often it looks for what is new, s.
    _period: ClassVar[float]

    def __init__(self) -> None:
        # A person looks at a page. Nobody is asked but here.
        self._watched = settings.audience().live
        # Pages speak in one thread, ROS in another one. Nobody waits while holding it.
        self._lock = threading.RLock()
        # Both are there while it listens.
        self._node: Node | None = None
        self._timer: Timer | None = None
        # Why it has ended, '' if it has not.
        self._ended = ''
        self._cell = Cell()

    def close(self) -> None:
        """Listen no more. What is shown stays as it is."""
        self._end(f'This {self._name} has ended. Run its cell to start a new one.')

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- from here on it lives ------------------------------------------------------------------

    def _take_place(self) -> None:
        """Live from now on, in place of what an earlier run of this cell has left."""
        self._cell = cell = runtime.console.current_cell()
        for other in living():
            same = cell.cell_id and cell.cell_id == other._cell.cell_id
            if same and cell.request_id != other._cell.request_id and other is not self:
                other.close()
        _views[self] = None

    # -- listening ------------------------------------------------------------------------------

    def _open(self) -> None:
        """Listen from now on, with labkit's hidden node."""
        with self._lock:
            self._node = helper()
            self._timer = self._node.create_timer(self._period, self._on_timer)

    def _close(self) -> None:
        """Listen no more, until it is opened again."""
        with self._lock:
            if self._node is not None and self._timer is not None and node_exists(self._node):
                self._node.destroy_timer(self._timer)
            self._node = self._timer = None

    def _on_timer(self) -> None:
        with self._lock:
            if self._node is not None and self._node is runtime.helper:
                self._tick()

    def _tick(self) -> None:
        """Look for what is new, and show it."""
        raise NotImplementedError

    # -- the end --------------------------------------------------------------------------------

    def _cut_off(self) -> str:
        """Return why it can't go on, '' if it can."""
        # It is not started again from here: whoever stopped ROS meant to.
        gone = self._node is not None and self._node is not runtime.helper
        return STOPPED if gone or not runtime.started else ''

    def _on_destroyed(self) -> None:
        """Some node has been destroyed."""
        words = self._cut_off()
        if words:
            self._end(words)

    def _end(self, words: str) -> None:
        """Live no more.

        Args:
            words: Why, and what to do, for whoever looks at it.
        """
        self._ended = self._ended or words
        _views.pop(self, None)
        self._close()
        self._say_end()

    def _say_end(self) -> None:
        """Show that it has ended, and why."""
        raise NotImplementedError


def _on_destroyed() -> None:
    for view in living():
        view._on_destroyed()


after_destroy.append(_on_destroyed)
