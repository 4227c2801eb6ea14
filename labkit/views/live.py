"""The lifetime of a live view, from the cell that shows it to its end.

It ends when it is closed, when its cell is run again, or when ROS is stopped. A view in a page
also ends when nobody looks at it (`labkit.views.live_page`).
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

__all__ = ['STOPPED', 'Live', 'helper', 'live_views']

STOPPED = 'ROS was stopped. Run this cell to start it again.'

# The live views, in order. A dictionary, because one operation on it is atomic across threads.
_views: dict[Live, None] = {}


def helper() -> Node:
    """Return labkit's hidden node, which subscribes for views; start ROS if it is not up."""
    runtime.start()
    assert runtime.helper is not None
    return runtime.helper


def live_views() -> tuple[Live, ...]:
    """Return the live views, oldest first."""
    return tuple(_views)


class Live:
    """A view that follows changes. Subclasses decide what it shows.

    They extend `_open` and `_close`, and do their periodic work in `_tick`.
    """

    # Its name; and the one in messages, if that is another.
    _name: ClassVar[str] = 'view'
    _called: ClassVar[str] = ''
    # Period of `_tick`, s.
    _period: ClassVar[float]

    def __init__(self) -> None:
        # Whether a person looks at a page. Asked only here.
        self._watched = settings.audience().live
        # Pages call from one thread, ROS from another. Nothing may block while holding it.
        self._lock = threading.RLock()
        # Both exist while it is open.
        self._node: Node | None = None
        self._timer: Timer | None = None
        # Why it has ended, '' while it is live.
        self._ended = ''
        self._cell = Cell()

    def close(self) -> None:
        """Unsubscribe. The last picture stays."""
        self._end(f'This {self._called or self._name} has ended. Run its cell to start a new one.')

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- lifetime -------------------------------------------------------------------------------

    def _start(self) -> None:
        """Register as live, and close the view of an earlier run of this cell."""
        self._cell = cell = runtime.console.current_cell()
        for other in live_views():
            same = cell.cell_id and cell.cell_id == other._cell.cell_id
            if same and cell.request_id != other._cell.request_id and other is not self:
                other.close()
        _views[self] = None

    def _open(self) -> None:
        """Start to listen, with labkit's hidden node."""
        with self._lock:
            self._node = helper()
            self._timer = self._node.create_timer(self._period, self._on_timer)

    def _close(self) -> None:
        """Stop listening until it is opened again."""
        with self._lock:
            if self._node is not None and self._timer is not None and node_exists(self._node):
                self._node.destroy_timer(self._timer)
            self._node = self._timer = None

    def _on_timer(self) -> None:
        with self._lock:
            if self._node is not None and self._node is runtime.helper:
                self._tick()

    def _tick(self) -> None:
        """Update the view."""
        raise NotImplementedError

    def _why_stopped(self) -> str:
        """Return why it can't go on, '' if it can."""
        # A view must not restart ROS: stopping it was deliberate.
        gone = self._node is not None and self._node is not runtime.helper
        return STOPPED if gone or not runtime.started else ''

    def _on_destroyed(self) -> None:
        """Handle the destruction of any node."""
        words = self._why_stopped()
        if words:
            self._end(words)

    def _end(self, words: str) -> None:
        """End the view; `words` tell the learner why, and what to do."""
        self._ended = self._ended or words
        _views.pop(self, None)
        self._close()
        self._show_end()

    def _show_end(self) -> None:
        """Show that it has ended, and why."""
        raise NotImplementedError


def _on_destroyed() -> None:
    for view in live_views():
        view._on_destroyed()


after_destroy.append(_on_destroyed)
