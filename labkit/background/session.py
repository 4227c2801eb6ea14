"""Background work with a thread, a node and a cell: recording, playback, a shared topic."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, ClassVar, TypeVar

from rclpy.exceptions import InvalidHandle

from labkit.background.nodes import after_destroy, helper_node, node_exists
from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.rosgraph.snapshot import node_names

if TYPE_CHECKING:
    from rclpy.node import Node
    from typing_extensions import Self

__all__ = ['Session', 'end_earlier', 'going_on']

Kind = TypeVar('Kind', bound='Session')


class Session:
    """Work in its own thread, until it is done or stopped.

    It ends with `stop()`, with its node (`lab.stop()`, `lab.remove(...)`), with its `with` block,
    and when its cell is run again.

    Attributes:
        error: The error that ended it early, if any.
    """

    _going_on: ClassVar[list[Session]] = []

    def __init__(self, node_name: str) -> None:
        self.error: Exception | None = None
        self._cell = runtime.console.current_cell()
        self._name = node_name
        self._stopping, self._ended = threading.Event(), threading.Event()
        self._node: Node = helper_node(_free_name(node_name))
        runtime.add(self._node)
        self._thread = threading.Thread(target=self._run, name=node_name, daemon=True)

    @property
    def done(self) -> bool:
        """Return whether it has ended."""
        return self._ended.is_set()

    def stop(self) -> None:
        """End it, and wait for its thread. Without effect when it has ended."""
        self._stopping.set()
        self._end_node()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # -- for subclasses -------------------------------------------------------------------------

    def _go(self) -> None:
        """Start the thread."""
        Session._going_on.append(self)
        self._thread.start()

    def _run(self) -> None:
        try:
            self._work()
        except InvalidHandle:
            self._stopping.set()  # its node is being destroyed, publishers first
        except Exception as error:
            # Publishing fails once ROS is shut down, and that needs no report.
            if isinstance(error, LabError) or node_exists(self._node):
                self._fail(error)
        finally:
            self._end_node()
            self._ended.set()
            Session._going_on.remove(self)

    def _work(self) -> None:
        """Do the work until `_stopping` is set."""
        raise NotImplementedError

    def _fail(self, error: Exception) -> None:
        """Store the error, and show it under the cell."""
        self.error = error
        runtime.console.write_under(self._cell, f'{self._name}: {error}\n')

    def _end_node(self) -> None:
        if node_exists(self._node):
            runtime.destroy(self._node)


def going_on(kind: type[Kind]) -> list[Kind]:
    """Return the running sessions of a class, oldest first."""
    return [session for session in tuple(Session._going_on) if isinstance(session, kind)]


def end_earlier(kind: type[Session]) -> None:
    """End the sessions of a class that an earlier run of this cell has started."""
    cell = runtime.console.current_cell()
    for session in going_on(kind):
        same = cell.cell_id and session._cell.cell_id == cell.cell_id
        if same and session._cell is not cell:
            session.stop()


def _free_name(name: str) -> str:
    assert runtime.helper is not None
    taken = set(node_names(runtime.helper))
    number, free = 1, name
    while f'/{free}' in taken:
        number += 1
        free = f'{name}_{number}'
    return free


def _end_with_node() -> None:
    for session in tuple(Session._going_on):
        if not node_exists(session._node):
            session.stop()


after_destroy.append(_end_with_node)
